"""The scale: what the parts of a system weigh, and by how much they are over their limits.

All weights are shares: of one processor, and of a network of 100 Mbit/s. So they can be added.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterable, Sequence
from functools import lru_cache
from typing import TypeAlias

from jausml.language.metamodel.classes import bridge
from jausml.language.metamodel.classes.system import Host
from jausml.views.analysis.partition.weighing import Cost, Group, Limits, Weighing, united, world_of
from jausml.views.analysis.report import PACKET

Part: TypeAlias = "frozenset[int]"
"""The groups that one bridge carries, by their numbers."""

PROCESS = 0.005
"""Share of a processor that one more bridge takes at rest (benchmarks/partition.py)."""

LINK = 12.5e6
"""Bytes that a network of 100 Mbit/s carries in a second."""

INERTIA = 1e-6
"""Weight of moving a connection: what is as good as before stays."""

NEAR = 1000.0
"""Bytes each second for which no bridge is run on another host."""


class Scale:
    """The costs of parts of a system, each worked out once.

    `are_divided`: whether each connection is a group of its own, as if it were tied to none.
    """

    def __init__(self, weighing: Weighing, limits: Limits, *, are_divided: bool = False) -> None:
        self.weighing = weighing
        self.limits = limits
        self.groups = weighing.groups(limits, are_divided=are_divided)
        self._known: dict[Part, tuple[float, float]] = {frozenset(): (0.0, 0.0)}
        self.cost = lru_cache(1024)(self._cost)
        self.origins = lru_cache(1024)(self._origins)

    def weight(self, part: Part) -> tuple[float, float]:
        """Returns the excess of a part over its limits, and its weight."""
        known = self._known.get(part)
        if known is None:
            known = self._known[part] = self._weighed(part, self.cost(part))
        return known

    def added(self, part: Part, number: int) -> tuple[float, float]:
        """Returns the rise of the excess and of the weight of a part by one more group."""
        if not part:
            return self.weight(frozenset((number,)))
        new, before = part | {number}, self.weight(part)
        after = self._known.get(new)
        if after is None:
            cost = united([self.cost(part), self.groups[number].cost])
            after = self._known[new] = self._weighed(new, cost)
        return round(after[0] - before[0], 9), round(after[1] - before[1], 9)

    def size(self, number: int) -> tuple[float, int]:
        """Returns a sort key of groups: the heaviest is first."""
        return -self.groups[number].cost.share, number

    def _weighed(self, part: Part, cost: Cost) -> tuple[float, float]:
        origins = self._origins(part)
        moved = cost.connections - origins.most_common(1)[0][1]
        network = cost.away(self._best_host(origins, cost)) / LINK
        weight = PROCESS + sum(cost.datagrams.values()) * PACKET + network + INERTIA * moved
        return self._excess(part, cost), weight

    def total(self, parts: Iterable[Part]) -> tuple[float, float]:
        """Returns the sum of some parts."""
        over, weight = 0.0, 0.0
        for part in parts:
            own = self.weight(part)
            over, weight = over + own[0], weight + own[1]
        return round(over, 9), round(weight, 9)

    def _cost(self, part: Part) -> Cost:
        """Returns the cost of the groups of a part in one bridge."""
        return united([self.groups[number].cost for number in sorted(part)])

    def _origins(self, part: Part) -> Counter[bridge.Bridge]:
        """Returns the bridges that carry the connections of a part now, and how many each."""
        return Counter(owner for number in sorted(part) for owner in self.groups[number].origins)

    def host(self, part: Part) -> Host | None:
        """Returns the host with the fewest bytes to and from others; home, if as good."""
        return self._best_host(self.origins(part), self.cost(part))

    def _best_host(self, origins: Counter[bridge.Bridge], cost: Cost) -> Host | None:
        home = self.weighing.homes[origins.most_common(1)[0][0]]
        if home is None or not cost.remote:
            return home
        known = [host for host in self.weighing.hosts if host.transport is home.transport]
        return min((home, *known), key=lambda host: cost.away(host) + NEAR * (host is not home))

    def _excess(self, part: Part, cost: Cost) -> float:
        """Returns the excess of a part over the limits: 0 where it is within all."""
        limits = self.limits
        over = max(0.0, cost.share / limits.load - 1) + max(0.0, cost.wait / limits.wait - 1)
        if limits.most:
            over += max(0.0, cost.connections / limits.most - 1)
        # What cannot be together weighs more than any load.
        return over + 1000.0 * len(self.clashes([self.groups[number] for number in part]))

    @staticmethod
    def clashes(groups: Sequence[Group], owner: bridge.Bridge | None = None) -> list[str]:
        """Returns why groups cannot be in one bridge, or in that of an owner."""
        worlds = frozenset[tuple[str, Hashable]]().union(*(group.world for group in groups))
        needed = {name for name, _ in worlds}
        if owner is not None:
            worlds |= {pair for pair in world_of(owner) if pair[0] in needed}
        twice = Counter(key for group in groups for key in group.unique)
        said = [f"both provide {key}" for key, number in twice.items() if number > 1]
        if len(worlds) == len(needed):
            return said
        values = {
            name: sorted(str(value) for key, value in worlds if key == name) for name in needed
        }
        return said + [
            f"{name} is {' here, '.join(some)} there"
            for name, some in sorted(values.items())
            if len(some) > 1
        ]

"""Plans: the bridges of a system before and after a change, with what they carry and cost."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, count

import networkx

from jausml.language.metamodel.classes import bridge
from jausml.language.metamodel.classes.system import Host, System
from jausml.language.semantics.hosts import host_of
from jausml.language.semantics.paths.scopes import Carrier, carriers_of
from jausml.views.analysis.partition.cutting import attractions, cut, halved
from jausml.views.analysis.partition.scale import Part, Scale
from jausml.views.analysis.partition.weighing import Group, Limits, Weighing
from jausml.views.analysis.sizes import Assumptions

_ROUTES = "bridge is", "namespace is", "subsystem is", "transport is"
"""Properties that no proposal mixes, and a person may."""

_MOST = 5  # names, and changes, that are told


@dataclass(frozen=True)
class Planned:
    """A bridge of a plan.

    Attributes:
        owner: The bridge of the model that it is, None for a new one.
        origin: The bridge whose settings it has.
        share: Share of a processor.
        datagrams: JAUS datagrams each second, both ways.
        remote: Bytes each second that cross to other hosts.
        wait: Seconds that a message waits when one of each connection comes at once.
        reasons: Why it carries what it carries.
    """

    name: str
    owner: bridge.Bridge | None
    origin: bridge.Bridge
    host: Host | None
    carriers: tuple[Carrier, ...]
    share: float
    datagrams: float
    remote: float
    wait: float
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class Plan:
    """The bridges of a system before and after.

    `faults`: what keeps it from being done. `excess`: the limits that it does not hold, and why.
    """

    before: tuple[Planned, ...]
    after: tuple[Planned, ...]
    faults: tuple[str, ...] = ()
    excess: tuple[str, ...] = ()

    @property
    def moved(self) -> list[tuple[Carrier, Planned]]:
        """The connections that change their bridge, each with the new one."""
        home = {carrier: old.owner for old in self.before for carrier in old.carriers}
        return [
            (carrier, new)
            for new in self.after
            for carrier in new.carriers
            if home[carrier] is not new.owner
        ]

    @property
    def is_change(self) -> bool:
        """Whether a connection, or a bridge, goes elsewhere."""
        hosts = {old.owner: old.host for old in self.before}
        return bool(self.moved) or any(hosts[new.owner] is not new.host for new in self.after)

    @property
    def gone(self) -> list[bridge.Bridge]:
        """The bridges that carried connections, and carry none any more."""
        kept = {new.owner for new in self.after}
        return [old.origin for old in self.before if old.carriers and old.owner not in kept]


class Planner:
    """Makes plans for the bridges of a system."""

    def __init__(self, system: System, assumptions: Assumptions) -> None:
        self._weighing = Weighing(system, assumptions)

    def propose(self, limits: Limits) -> Plan:
        """Returns the partition that costs least, of those that hold the limits.

        `LookupError`: they name a connection that there is not.
        """
        scale = Scale(self._weighing, limits)
        parts = cut(scale, _now(scale))
        after = self._named(scale, parts)
        return Plan(self.before, after, excess=tuple(_excess(scale, parts, after)))

    def assigned(self, names: Mapping[Carrier, str], *, are_kept: bool = False) -> Plan:
        """Returns the plan in which bridges that a person names carry some connections.

        All others stay. `faults` says which connections stay together, or cannot be there.
        `are_kept`: whether bridges stay that carry nothing any more, and where they run.
        """
        homes = {carrier: str(owner.name) for carrier, owner in self._weighing.owner_of.items()}
        wanted = {**homes, **names}
        scale = Scale(self._weighing, Limits(load=math.inf))
        parts: dict[str, list[int]] = {name: [] for name in self._owners} if are_kept else {}
        faults = []
        for number, group in enumerate(scale.groups):
            if len({wanted[carrier] for carrier in group.carriers}) > 1:
                faults.append(_together(group))
            parts.setdefault(wanted[group.carriers[0]], []).append(number)
        for name, part in parts.items():
            moved = [
                number
                for number in part
                if any(str(origin.name) != name for origin in scale.groups[number].origins)
            ]
            whys = scale.clashes([scale.groups[number] for number in part], self._owners.get(name))
            who = _listed(
                [carrier for number in moved for carrier in scale.groups[number].carriers]
            )
            # A person may give what others command another JAUS id; names become whole.
            apart = [why for why in whys if moved and not why.startswith(_ROUTES)]
            faults += [f"{name} cannot carry {who}: {why}" for why in apart]
        after = [
            self._planned(scale, name, frozenset(part), is_placed=are_kept)
            for name, part in parts.items()
        ]
        return Plan(self.before, tuple(after), tuple(faults))

    def companions(self, carriers: Collection[Carrier]) -> Mapping[Carrier, tuple[str, ...]]:
        """Returns connections with those that have to go along, each with why."""
        return {
            carrier: group.reasons
            for group in self._weighing.groups(Limits())
            if not set(carriers).isdisjoint(group.carriers)
            for carrier in group.carriers
        }

    def changes(self) -> list[tuple[tuple[Planned, ...], tuple[Planned, ...]]]:
        """Returns the plans with some bridges as one, the lightest first, and with each as two."""
        scale = Scale(self._weighing, Limits(load=math.inf))
        now, graph = _now(scale), attractions(scale)
        joins = [((a, b), (a | b,)) for a, b in combinations(now, 2) if not scale.weight(a | b)[0]]
        joins.sort(key=lambda join: scale.total(join[1])[1] - scale.total(join[0])[1])
        halves = [((part,), tuple(halved(graph, part))) for part in now if len(part) > 1]
        return [
            (self._named(scale, old), self._named(scale, new))
            for old, new in (*joins[:_MOST], *halves[:_MOST])
        ]

    def new_name(self, carrier: Carrier) -> str:
        """Returns the name of a new bridge for a connection."""
        return self._free(self._weighing.owner_of[carrier], ())

    def _free(self, origin: bridge.Bridge, taken: Collection[str]) -> str:
        used = {str(participant.name).lower() for participant in self._weighing.participants}.union(
            taken
        )
        free = (f"{origin.name}_{number}" for number in count(2))
        return next(name for name in free if name.lower() not in used)

    @cached_property
    def _owners(self) -> Mapping[str, bridge.Bridge]:
        return {str(owner.name): owner for owner in self._weighing.owners}

    @cached_property
    def before(self) -> tuple[Planned, ...]:
        """The bridges as they are."""
        scale = Scale(self._weighing, Limits(load=math.inf), are_divided=True)
        numbers = {group.carriers[0]: number for number, group in enumerate(scale.groups)}
        return tuple(
            self._planned(
                scale,
                name,
                frozenset(numbers[carrier] for carrier in carriers_of(owner)),
                is_placed=True,
            )
            for name, owner in self._owners.items()
        )

    def _named(self, scale: Scale, parts: Sequence[Part]) -> tuple[Planned, ...]:
        """Assigns parts to the bridges with most of their connections, else to new names."""
        groups = [[scale.groups[number] for number in part] for part in parts]
        names = {
            number: group.pin for number, part in enumerate(groups) for group in part if group.pin
        }
        graph: networkx.Graph[tuple[str, int | str]] = networkx.Graph()
        for number, part in enumerate(parts):
            for owner, carried in scale.origins(part).items():
                is_free = number not in names and str(owner.name) not in names.values()
                if is_free and not scale.clashes(groups[number], owner):
                    graph.add_edge(("part", number), ("bridge", str(owner.name)), weight=carried)
        for pair in networkx.max_weight_matching(graph):
            (_, name), (_, number) = sorted(pair)
            names[number] = name
        taken = {name.lower() for name in names.values()}
        for number, part in enumerate(parts):
            if number not in names:
                origin = next(iter(scale.origins(part)))
                names[number] = self._free(origin, taken)
                taken.add(names[number].lower())
        order = list(self._owners)
        planned = [self._planned(scale, names[number], part) for number, part in enumerate(parts)]
        return tuple(
            sorted(planned, key=lambda one: (_place(order, one.name), len(one.name), one.name))
        )

    def _planned(self, scale: Scale, name: str, part: Part, *, is_placed: bool = False) -> Planned:
        """Returns the bridge for a part; one that is placed stays on its host."""
        owner = self._owners.get(name)
        cost, groups = scale.cost(part), [scale.groups[number] for number in sorted(part)]
        origins = [origin for origin, _ in scale.origins(part).most_common()]
        origin = owner or next(
            (origin for origin in origins if not scale.clashes(groups, origin)), origins[0]
        )
        home = host_of(self._weighing.system, origin)
        host = home if is_placed or not part else scale.host(part)
        reasons = [_together(group) for group in groups if group.reasons]
        if host is not home and host is not None:
            reasons.append(f"on {host.name} fewest bytes cross the network")
        return Planned(
            name,
            owner,
            origin,
            host,
            tuple(carrier for group in groups for carrier in group.carriers),
            cost.share,
            sum(cost.datagrams.values()),
            cost.away(host),
            cost.wait,
            tuple(reasons),
        )


def _place(order: Sequence[str], name: str) -> int:
    return order.index(name) if name in order else len(order)


def _now(scale: Scale) -> list[Part]:
    """Returns the present parts; connections to be together are in the bridge of most of them."""
    parts: dict[bridge.Bridge, set[int]] = {}
    for number in range(len(scale.groups)):
        own = next(iter(scale.origins(frozenset((number,)))))
        parts.setdefault(own, set()).add(number)
    return [frozenset(part) for part in parts.values()]


def _excess(scale: Scale, parts: Sequence[Part], after: Sequence[Planned]) -> Iterator[str]:
    """Yields which parts are over which limits."""
    limits = scale.limits
    for part in parts:
        if not scale.weight(part)[0]:
            continue
        groups = [scale.groups[number] for number in sorted(part)]
        name = next(planned.name for planned in after if groups[0].carriers[0] in planned.carriers)
        cost = scale.cost(part)
        if limits.most and cost.connections > limits.most:
            yield f"{name} carries {cost.connections} connections, more than {limits.most}"
        if cost.share > limits.load:
            yield f"{name} takes {cost.share:.1%} of a processor, more than {limits.load:.1%}"
        if cost.wait > limits.wait:
            longest = f"more than {limits.wait * 1e3:g} ms"
            yield f"{name} lets messages wait {cost.wait * 1e3:.2f} ms, {longest}"
        yield from (f"{name}: {why}" for why in scale.clashes(groups))


def _together(group: Group) -> str:
    together = " stay together" if len(group.carriers) > 1 else ""
    return f"{_listed(group.carriers)}{together}: {'; '.join(group.reasons)}"


def _listed(carriers: Sequence[Carrier]) -> str:
    names = [str(carrier.name) for carrier in carriers]
    more = f" and {len(names) - _MOST} more" if len(names) > _MOST else ""
    return ", ".join(names[:_MOST]) + more

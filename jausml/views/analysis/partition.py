"""Partition: which bridges carry which groups of connections, so that commands need not wait."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from jausml.language.semantics.hosts import host_of
from jausml.views.analysis.groups import Group, groups_of
from jausml.views.analysis.placing import nearest_host
from jausml.views.analysis.traffic import traffic_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jausml.language.metamodel.classes import bridge
    from jausml.language.metamodel.classes.system import Host, System
    from jausml.views.analysis.assumptions import Assumptions

HEAVY_MESSAGE = 250e-6
"""Seconds for which one message may keep a bridge busy before commands should not wait for it: four
times a small message."""

HEAVY_SHARE = 0.1
"""Share of a processor from which on commands should not share a bridge with a group."""

LARGEST_SHARE = 0.5
"""Share of a processor that a bridge may take: the other half is for what was not foreseen."""


class UnsplittableError(ValueError):
    """A system cannot be split so."""


@dataclass
class Part:
    """A bridge of the proposal.

    Attributes:
        host: Where it runs best, None when the model names no host.
    """

    origin: bridge.Bridge
    groups: list[Group] = field(default_factory=list)
    host: Host | None = None

    @property
    def share(self) -> float:
        """Share of a processor."""
        return sum(each.share for each in self.groups)

    @property
    def has_commands(self) -> bool:
        """Whether it carries commands."""
        return any(each.has_commands for each in self.groups)

    @property
    def is_commanded(self) -> bool:
        """Whether others command the bridge."""
        return any(each.is_commanded for each in self.groups)

    @property
    def mixed(self) -> list[Group]:
        """The heavy groups that commands of others wait for."""
        commanding = [each for each in self.groups if each.has_commands]
        return [each for each in self.groups if is_heavy(each) and set(commanding) - {each}]


@dataclass(frozen=True)
class Proposal:
    """How the bridges of a system are split.

    Attributes:
        parts: The bridges, those of one origin side by side; the first of each keeps its name.
        reason: Why there are so many.
    """

    parts: tuple[Part, ...]
    reason: str


def is_heavy(group: Group) -> bool:
    """Tells whether commands should not wait for a group."""
    return group.longest > HEAVY_MESSAGE or group.share > HEAVY_SHARE


def propose(system: System, assumptions: Assumptions, number: int | None) -> Proposal:
    """Returns how to split the bridges of a system.

    Bridges are split and never merged; external ones stay as they are.

    Args:
        number: How many bridges there shall be; None for as many as are needed.

    Raises:
        UnsplittableError: There is no bridge, or there cannot be so many or so few.
    """
    owners = [each for each in system.bridges if not each.external]
    _check(number, owners)
    traffic = traffic_of(system, assumptions)
    groups = {each: groups_of(each, traffic, assumptions) for each in owners}
    if number is None:
        splits = {each: _sufficient(each, groups[each]) for each in owners}
        parts, reason = _joined(splits.values()), _why(splits.values())
    else:
        parts, reason = _joined(_numbered(groups, number)), _wish(number)
    placed: set[bridge.Bridge] = set()
    for part in parts:
        part.host = host_of(system, part.origin)
        if part.origin in placed:
            part.host = nearest_host(part.origin, part.groups, system, traffic, assumptions)
        placed.add(part.origin)
    return Proposal(parts, reason)


def _check(number: int | None, owners: Sequence[bridge.Bridge]) -> None:
    if not owners:
        raise UnsplittableError("the system has no bridge")
    if number is not None and number < len(owners):
        raise UnsplittableError(
            f"the system has {len(owners)} bridges, and bridges are not merged: "
            f"name {len(owners)} or more"
        )


def _sufficient(owner: bridge.Bridge, groups: Sequence[Group]) -> list[Part]:
    """Returns the fewest parts in which commands are apart from what is heavy, and no load is high.

    Where a group alone is too heavy, more parts than bring something are none the better.
    """
    best = _split(owner, groups, 1)
    unavoidable = _faults([Part(owner, [each]) for each in groups])
    for number in range(2, len(groups) + 1):
        if _faults(best) <= unavoidable:
            break
        further = _split(owner, groups, number)
        if _faults(further) < _faults(best):
            best = further
    return best


def _wish(number: int) -> str:
    return "one was asked for" if number == 1 else f"{number} were asked for"


def _numbered(groups: dict[bridge.Bridge, list[Group]], number: int) -> Iterable[list[Part]]:
    """Returns parts of each bridge, so many of all; the one that needs it most is split next."""
    splits = {owner: _split(owner, known, 1) for owner, known in groups.items()}
    while sum(map(len, splits.values())) < number:
        splittable = [each for each in splits if len(groups[each]) > len(splits[each])]
        if not splittable:
            raise UnsplittableError(_no_further(groups, number))
        neediest = max(
            splittable, key=lambda each: (*_faults(splits[each]), _highest(splits[each]))
        )
        splits[neediest] = _split(neediest, groups[neediest], len(splits[neediest]) + 1)
    return splits.values()


def _no_further(groups: dict[bridge.Bridge, list[Group]], number: int) -> str:
    total = sum(map(len, groups.values()))
    largest = max((group for each in groups.values() for group in each), key=_size)
    text = f"no more than {total} bridges are possible, {number} were asked for"
    if largest.reasons:
        names = ", ".join(str(each.name) for each in largest.connections)
        text += f"; {names} stay together: {'; '.join(largest.reasons)}"
    return text


def _size(group: Group) -> int:
    return len(group.connections)


def _faults(parts: Sequence[Part]) -> tuple[int, float]:
    """Returns what is wrong with a split: heavy groups beside commands, load above the limit."""
    excess = sum(max(0.0, each.share - LARGEST_SHARE) for each in parts)
    return sum(len(each.mixed) for each in parts), round(excess, 9)


def _highest(parts: Sequence[Part]) -> float:
    return max(each.share for each in parts)


def _split(owner: bridge.Bridge, groups: Sequence[Group], number: int) -> list[Part]:
    """Returns so many parts with the fewest faults and the most even load."""
    if number == 1:
        return [Part(owner, list(groups))]
    heavy = [each for each in groups if is_heavy(each) and not each.has_commands]
    others = [each for each in groups if each not in heavy]
    candidates = [_spread(owner, [list(groups)], [number])]
    if heavy and others:
        fewest, most = max(1, number - len(others)), min(len(heavy), number - 1)
        candidates += [
            _spread(owner, [heavy, others], [each, number - each])
            for each in range(fewest, most + 1)
        ]
    best = min(candidates, key=lambda parts: (*_faults(parts), _highest(parts)))
    for part in best:
        part.groups.sort(key=groups.index)
    # The part that is commanded keeps name and address, for those who command it.
    return sorted(best, key=lambda part: (not part.is_commanded, not part.has_commands))


def _spread(
    owner: bridge.Bridge, kinds: Sequence[Sequence[Group]], numbers: Sequence[int]
) -> list[Part]:
    """Returns parts of each kind, the heaviest groups given to the lightest parts first."""
    parts = []
    for groups, number in zip(kinds, numbers, strict=True):
        found = [Part(owner) for _ in range(number)]
        for group in sorted(groups, key=lambda each: -each.share):
            min(found, key=lambda part: (bool(part.groups), part.share)).groups.append(group)
        parts += found
    return parts


def _joined(splits: Iterable[Sequence[Part]]) -> tuple[Part, ...]:
    return tuple(part for parts in splits for part in parts)


def _why(splits: Iterable[Sequence[Part]]) -> str:
    parts = _joined(splits)
    mixed, excess = _faults(parts)
    limit = f"{LARGEST_SHARE:.0%} of a processor"
    if not mixed and not excess:
        return (
            "the fewest in which no command waits for something heavy, and none takes more than "
            + limit
        )
    faults = [f"{mixed} heavy groups stay beside commands"] if mixed else []
    faults += [f"a group alone takes more than {limit}"] if excess else []
    return f"more bridges would fix nothing: {' and '.join(faults)}"

"""Budgets: fair shares of slots and rates, by host first, then by endpoint, then by id.

There is no fixed share. Nobody is refused or cut while there is room; when there is none, the
host gives way that has most, then its largest endpoint, then its largest id. A hundred components
of one honest host so keep all that they ask for, and many sockets of one stranger get no more
than one.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

Place = tuple[Hashable, ...]

LEVELS = 3  # host, endpoint and id
T = TypeVar("T")
K = TypeVar("K", bound="Hashable")


@dataclass(frozen=True, slots=True)
class Held(Generic[T]):
    """Something that holds a slot and asks for a rate."""

    item: T
    place: Place
    is_proved: bool = True
    is_kept: bool = False
    wanted: float = 0.0  # reports a second that it asks for


def who_gives_way(held: Sequence[Held[T]], asker: Held[object]) -> T | None:
    """Returns what makes room for one more; None when nothing has to.

    What is not proved goes first, whosever it is; a flood of forged requests thus takes its own
    places only. For the same reason an asker without proof takes nothing from those who have one.

    Args:
        held: All that hold a slot, in the order in which they got it.
    """
    left = [holder for holder in held if not holder.is_kept]
    unproved = [holder for holder in left if not holder.is_proved]
    if unproved:
        left = unproved
    elif not asker.is_proved:
        return None
    for level in range(LEVELS):
        groups = _grouped(left, level)
        if not groups:
            return None
        largest = max(groups, key=lambda group: len(groups[group]))
        if largest != asker.place[level]:
            own = len(groups.get(asker.place[level], ()))
            # With one more the asker would have as many: to change places would only go to and fro.
            is_fair = not unproved and not asker.is_kept and len(groups[largest]) <= own + 1
            return None if is_fair else groups[largest][-1].item
        # The asker is among the largest itself, so one of its own gives way: look a level deeper.
        left = groups[largest]
    # Within one id the present ones stay, unless the asker has a place of its own.
    return left[-1].item if unproved or asker.is_kept else None


def fair_rates(held: Sequence[Held[T]], capacity: float, level: int = 0) -> list[tuple[T, float]]:
    """Shares a rate max-min fairly: nobody is cut who asks for less than an equal share.

    Args:
        capacity: What there is a second.
        level: Level of the tree that it is shared by first.
    """
    # The usual case: there is enough for all.
    if sum(holder.wanted for holder in held) <= capacity:
        return [(holder.item, holder.wanted) for holder in held]
    if level == LEVELS:
        shares = _filled({index: holder.wanted for index, holder in enumerate(held)}, capacity)
        return [(holder.item, shares[index]) for index, holder in enumerate(held)]
    groups = _grouped(held, level)
    wanted = {who: sum(holder.wanted for holder in group) for who, group in groups.items()}
    shared = _filled(wanted, capacity)
    return [
        rate for who, group in groups.items() for rate in fair_rates(group, shared[who], level + 1)
    ]


def _filled(wanted: Mapping[K, float], capacity: float) -> dict[K, float]:
    """Fills shares like water, the smallest first; what is left goes to the others."""
    shares: dict[K, float] = {}
    ordered = sorted(wanted.items(), key=lambda item: item[1])
    for index, (who, amount) in enumerate(ordered):
        shares[who] = min(amount, capacity / (len(ordered) - index))
        capacity -= shares[who]
    return shares


def _grouped(held: Sequence[Held[T]], level: int) -> dict[Hashable, list[Held[T]]]:
    groups: dict[Hashable, list[Held[T]]] = defaultdict(list)
    for holder in held:
        groups[holder.place[level]].append(holder)
    return groups

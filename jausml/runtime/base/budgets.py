"""Budgets: fair shares of slots and rates, by host first, then by endpoint, then by id.

No share is fixed. While there is room, every request is met; when there is none, the host with the
most slots gives way, there its largest endpoint, there its largest id. So a hundred components of
one honest host keep all that they request, and many sockets of one stranger get no more than one
socket.
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
    """An item that holds a slot and requests a rate."""

    item: T
    place: Place  # host, endpoint and id
    is_proved: bool = True  # whether its endpoint has proved that it is no forgery
    is_kept: bool = False  # whether it never gives way
    wanted: float = 0.0  # requested reports a second


def who_gives_way(held: Sequence[Held[T]], asker: Held[object]) -> T | None:
    """Returns the item that gives its slot to the asker; None when none does.

    Unproved holders give way first, on whatever host; so a flood of forged requests takes only its
    own slots. For the same reason, an unproved asker takes no slot of a proved holder.

    Args:
        held: All holders of a slot, in the order in which they got it.
    """
    candidates = [holder for holder in held if not holder.is_kept]
    unproved = [holder for holder in candidates if not holder.is_proved]
    if unproved:
        candidates = unproved
    elif not asker.is_proved:
        return None
    for level in range(LEVELS):
        groups = _grouped(candidates, level)
        if not groups:
            return None
        largest = max(groups, key=lambda group: len(groups[group]))
        if largest != asker.place[level]:
            own = len(groups.get(asker.place[level], ()))
            # With one more, the asker would have as many: slots would only go to and fro.
            is_fair = not unproved and not asker.is_kept and len(groups[largest]) <= own + 1
            return None if is_fair else groups[largest][-1].item
        # The asker is of the largest group itself, so one of its own gives way, a level deeper.
        candidates = groups[largest]
    # Within one id the holders stay, unless the asker is kept.
    return candidates[-1].item if unproved or asker.is_kept else None


def fair_rates(held: Sequence[Held[T]], capacity: float, level: int = 0) -> list[tuple[T, float]]:
    """Returns max-min fair rates by item: a request below an equal share is met in full.

    Args:
        capacity: Reports a second that are shared.
        level: Level of `Held.place` by which they are shared first.
    """
    # The usual case: there is enough for all.
    if sum(holder.wanted for holder in held) <= capacity:
        return [(holder.item, holder.wanted) for holder in held]
    if level == LEVELS:
        shares = _filled({index: holder.wanted for index, holder in enumerate(held)}, capacity)
        return [(holder.item, shares[index]) for index, holder in enumerate(held)]
    groups = _grouped(held, level)
    wanted = {name: sum(holder.wanted for holder in group) for name, group in groups.items()}
    group_shares = _filled(wanted, capacity)
    return [
        rate
        for name, group in groups.items()
        for rate in fair_rates(group, group_shares[name], level + 1)
    ]


def _filled(wanted: Mapping[K, float], capacity: float) -> dict[K, float]:
    """Returns shares by key: the smallest are met first, and the rest is left to the others."""
    shares: dict[K, float] = {}
    ordered = sorted(wanted.items(), key=lambda item: item[1])
    for index, (key, amount) in enumerate(ordered):
        shares[key] = min(amount, capacity / (len(ordered) - index))
        capacity -= shares[key]
    return shares


def _grouped(held: Sequence[Held[T]], level: int) -> dict[Hashable, list[Held[T]]]:
    groups: dict[Hashable, list[Held[T]]] = defaultdict(list)
    for holder in held:
        groups[holder.place[level]].append(holder)
    return groups

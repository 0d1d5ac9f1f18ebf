"""Places in the page for the sequence numbers of the datagrams that a guardian may have to send."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

from .page import MOST_STOPS, Page

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..base.address import JausAddress

Route: TypeAlias = "tuple[JausAddress, JausAddress]"
"""Source and destination, which share one sequence of numbers."""


@dataclass
class _Slot:
    """Where the number of a route stands, how to find it out, and who sends on that route."""

    place: int
    sequence: Callable[[], int]
    users: set[object] = field(default_factory=set)


class Slots:
    """One place for each route, while somebody sends on it.

    Peers that a search finds are as many as the network says, and a page has an end: who finds no
    place has no stop, which is told.
    """

    def __init__(self) -> None:
        self._slots: dict[Route, _Slot] = {}
        self._refused: set[Route] = set()

    @property
    def refused(self) -> int:
        """How many routes have found no place."""
        return len(self._refused)

    def take(self, user: object, route: Route, sequence: Callable[[], int]) -> int | None:
        """Returns the place of a route until all users have given it back; None without room.

        The sequence returns the number that the next datagram should have.
        """
        slot = self._slots.get(route)
        if slot is None:
            if len(self._slots) >= MOST_STOPS:
                self._refused.add(route)
                return None
            taken = {other.place for other in self._slots.values()}
            place = next(place for place in range(MOST_STOPS) if place not in taken)
            slot = self._slots[route] = _Slot(place, sequence)
            self._refused.discard(route)
        slot.users.add(user)
        return slot.place

    def give_back(self, user: object, route: Route) -> None:
        """Takes note that somebody does not send on a route any more."""
        self._refused.discard(route)
        slot = self._slots.get(route)
        if slot is not None:
            slot.users.discard(user)
            if not slot.users:
                del self._slots[route]

    def clear(self) -> None:
        """Takes all places back."""
        self._slots.clear()
        self._refused.clear()

    def write(self, page: Page) -> None:
        """Notes the sequence numbers that datagrams should have now."""
        for slot in self._slots.values():
            page.numbers[slot.place] = slot.sequence()

"""Requests of events: the ids and refusals that report and command events share (AS5710)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..base.errors import JausError
from ..messages import RejectEventRequest

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..base.address import JausAddress
    from .host import Host

RejectCode = RejectEventRequest.ResponseCode

EVENT_IDS = 255
"""Event ids are 0 to 254; peers take 255 for "no event"."""

MAX_TEXT = 80
"""Characters that an ErrorMessage holds."""


class RequestError(JausError):
    """An event request that cannot be met."""

    def __init__(self, code: RejectCode, text: str) -> None:
        super().__init__(text)
        self.code = code


class EventIds:
    """Hands out the ids that are free, each as late as possible after its last use."""

    def __init__(self, limit: int, make_room: Callable[[JausAddress], object]) -> None:
        """Start with all ids free.

        Args:
            limit: Most ids in use at a time, 0 to 255.
            make_room: Gives an id back, if somebody must give way to a client.
        """
        self._limit = limit
        self._make_room = make_room
        self._used: set[int] = set()
        self._next = 0

    def take(self, client: JausAddress) -> int:
        """Return a free id; raises RequestError when nobody has to give way to the client."""
        if len(self._used) >= self._limit:
            self._make_room(client)
        if len(self._used) >= self._limit:
            raise RequestError(RejectCode.CONNECTION_REFUSED, "too many events")
        while self._next in self._used:
            self._next = (self._next + 1) % EVENT_IDS
        event_id = self._next
        self._next = (event_id + 1) % EVENT_IDS
        self._used.add(event_id)
        return event_id

    def give_back(self, event_id: int) -> None:
        """Take an id for free again."""
        self._used.discard(event_id)


def reject(component: Host, client: JausAddress, request_id: int, error: RequestError) -> None:
    """Refuse a request of a client."""
    component.counters.add("events.rejected")
    message = RejectEventRequest(
        request_id=request_id, response_code=error.code, error_message=str(error)[:MAX_TEXT]
    )
    component.send(message, client)

"""Commands in the order in which they were sent, over networks that change it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..base.address import JausAddress
    from ..base.fast_path import FastPath
    from ..transports.delivery import Arrival

LATEST = 2.0
"""Seconds by which a message may be late; a lower number after them is that of a new process."""

FARTHEST = 1024
"""Messages of its source that may have come before a late one."""

_MOST_SOURCES = 256


class Ordering:
    """Tells which messages of one kind are older than one of the same source that came before.

    Sequence numbers count per source (AS5669A), and anew in each process, which is heard from a
    socket of its own: an operator who commands again at once is not late by the numbers of the
    process before.
    """

    def __init__(self, arrival: Arrival, clock: Callable[[], float]) -> None:
        self._arrival = arrival
        self._clock = clock
        self._latest: dict[JausAddress, tuple[int, float, object]] = {}

    def is_late(self, sender: JausAddress) -> bool:
        """Return whether the present message of a sender is late; remember it if it is not.

        One that asks for acknowledgement is to be taken in any case. What was sent before it and
        comes after it is late all the same: it must not undo a stop.
        """
        number = self._arrival.number
        if number is None:
            return False
        now = self._clock()
        latest = self._latest.get(sender)
        if latest is not None:
            behind = (latest[0] - number) & 0xFFFF
            if (
                0 < behind <= FARTHEST
                and now - latest[1] < LATEST
                and latest[2] == self._arrival.origin
            ):
                return not self._arrival.is_sure
        elif len(self._latest) >= _MOST_SOURCES:
            self._latest.clear()
        self._latest[sender] = number, now, self._arrival.origin
        return False

    def minded(self, path: FastPath, sender: JausAddress) -> FastPath:
        """Return a fast path on which the messages of a sender keep their order.

        What takes it comes from where the latest message came from.
        """
        passed, latest = path.passed, self._latest
        _, _, origin = latest.get(sender, (0, 0.0, None))

        def note(payload: bytes, number: int, at: float, unknown: int) -> None:
            latest[sender] = number, at, origin
            passed(payload, number, at, unknown)

        return replace(path, passed=note, latest=lambda: latest.get(sender))

"""Refusals of control: answered, but not as fast as somebody may ask for them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..base.address import JausAddress
    from ..base.loop import Loop

LIMIT = 10
"""Like refusals that a requester gets at once in each second."""

PERIOD = 1.0
"""Seconds in which they are counted."""

MAX_REQUESTERS = 256
"""Requesters that are counted at a time; a flood of false ones must not fill the memory."""


class _Count:
    __slots__ = ("code", "number", "since", "waits")

    def __init__(self, code: int, since: float) -> None:
        self.code = code
        self.since = since
        self.number = 0
        self.waits = False


class Refusals:
    """Counts the refusals of each requester, and puts off those that are too many.

    Some clients ask again as soon as they are refused, as fast as the network carries it.
    """

    def __init__(self, loop: Loop) -> None:
        self._loop = loop
        self._counts: dict[JausAddress, _Count] = {}

    def put_off(self, requester: JausAddress, code: int, again: Callable[[], None]) -> bool:
        """Tell whether a refusal is not to be sent now; the request is then judged again later.

        Args:
            code: Why it is refused; another reason is told at once.
            again: Judges the request again; of several that wait the first one is.
        """
        now = self._loop.now()
        count = self._counts.get(requester)
        if count is None or count.code != code or now >= count.since + PERIOD:
            waits = count is not None and count.waits
            count = self._begin(requester, code, now)
            if count is None:
                return False
            count.waits = waits
        count.number += 1
        if count.number <= LIMIT:
            return False
        if not count.waits:
            count.waits = True
            self._loop.call_at(count.since + PERIOD, lambda: self._judge(requester, again))
        return True

    def _begin(self, requester: JausAddress, code: int, now: float) -> _Count | None:
        if requester not in self._counts and len(self._counts) >= MAX_REQUESTERS:
            lately = self._counts.items()
            self._counts = {a: c for a, c in lately if c.waits or now < c.since + PERIOD}
            if len(self._counts) >= MAX_REQUESTERS:
                return None
        self._counts[requester] = _Count(code, now)
        return self._counts[requester]

    def _judge(self, requester: JausAddress, again: Callable[[], None]) -> None:
        count = self._counts.get(requester)
        if count is not None:
            count.waits = False
        again()

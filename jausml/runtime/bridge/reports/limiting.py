"""Counts of what a translation cannot carry: values out of range, and messages that are dropped."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, TypeVar

from ...conversions import ConversionError
from ...conversions.types import UnevenError
from ...wire.message import DecodeError, EncodeError
from ...wire.records import FEWEST
from ..messages.limits import (
    CLAMP,
    DROP_FIELD,
    ERROR,
    AbsentFieldError,
    Clamp,
    DropField,
    DropMessage,
    Error,
    OutOfRangeError,
    StaleJoinError,
)

if TYPE_CHECKING:
    from collections.abc import Callable, MutableSequence, Sequence

    from ...base.counters import Counters
    from .diagnostics import Statistics

T = TypeVar("T")
Made = TypeVar("Made")

BLOCKED = "blocked"
FAILED = "translation_failed"
OUT_OF_RANGE = "out_of_range"
STALE_JOIN = "stale_join"

_REASONS: tuple[tuple[type[Exception], str], ...] = (
    (AbsentFieldError, "absent_field"),
    (ConversionError, "no_counterpart"),
    (EncodeError, "not_encodable"),
    (DecodeError, "not_decodable"),
)


def reason_of(error: Exception) -> str:
    """Returns under which name a message is counted of which a translation made an error."""
    if isinstance(error, OutOfRangeError):
        return OUT_OF_RANGE
    if isinstance(error, StaleJoinError):
        return f"{STALE_JOIN}_{error.join}"
    return next((reason for kind, reason in _REASONS if isinstance(error, kind)), FAILED)


FAILURES = frozenset([FAILED, *(reason for _, reason in _REASONS)])
"""Reasons for which a message could not be translated, whatever its values."""


class Limiting:
    """What translations call for values that may not fit, and what counts those that do not.

    Attributes:
        drop_field: Leaves fields out whose value is out of range.
        drop_message: Drops messages with a value out of range.
        error: Does the same, as an error.
        goes_over_lists: Whether lists are gone over as a whole where they can be.
    """

    name: str
    statistics: Statistics
    counters: Counters
    goes_over_lists: bool = True

    def __init__(self) -> None:
        """Counts in the statistics alone until the bridge is open."""
        self.clamp = Clamp(self._note_out_of_range)
        self.drop_field = DropField(self._note_out_of_range)
        self.drop_message = DropMessage(self._note_out_of_range)
        self.error = Error(self._note_out_of_range)
        self._is_open = False

    def each(
        self, make: Callable[[T], Made], items: Sequence[T], code: str = ""
    ) -> MutableSequence[Made]:
        """Returns what a function makes of each element of a list.

        It is called once for all elements, if they lie alike: numbers in them are arrays of numpy
        then. Where it does not treat them alike, it is called for each.

        Args:
            make: Makes an element, or a number, of an element.
            items: The elements.
            code: Format character of the numbers that are made; empty for elements.
        """
        if self.goes_over_lists and len(items) >= FEWEST:
            from ..messages import columns  # noqa: PLC0415 - numpy where lists are gone over

            counts = self._counts()
            try:
                return columns.each(make, items, code)
            except UnevenError:
                self._restore(counts)
        return [make(item) for item in items]

    def each_counted(
        self, make: Callable[[int, T], Made], items: Sequence[T], code: str = ""
    ) -> MutableSequence[Made]:
        """Does the same with a function that is given the index of each element before it."""
        if self.goes_over_lists and len(items) >= FEWEST:
            from ..messages import columns  # noqa: PLC0415 - numpy where lists are gone over

            counts = self._counts()
            try:
                return columns.each_counted(make, items, code)
            except UnevenError:
                self._restore(counts)
        return [make(index, item) for index, item in enumerate(items)]

    def _counts(self) -> tuple[int, dict[tuple[str, str], int]]:
        return self.statistics.limited, dict(self.statistics.out_of_range)

    def _restore(self, counts: tuple[int, dict[tuple[str, str], int]]) -> None:
        """Forgets what was limited on the way: it is counted again with its element."""
        limited, out_of_range = counts
        self.statistics.limited = limited
        self.statistics.out_of_range.clear()
        self.statistics.out_of_range.update(out_of_range)

    def drop(self, reason: str, detail: str = "", error: Exception | None = None) -> None:
        """Counts a message that is not passed on."""
        drops = self.statistics.drops
        drops[reason] = drops.get(reason, 0) + 1
        self.counters.count(f"bridge.{self.name}.{reason}", detail, error=error)

    def refuse(self, reason: str, detail: str = "") -> None:
        """Counts a message that comes, and is not looked at."""
        self.statistics.arrivals += 1
        self.drop(reason, detail)

    def _note_out_of_range(self, policy: str, field: str, reason: str) -> None:
        """Counts a value that its target field cannot carry.

        A value that is left out is ordinary traffic: ROS marks what is unknown by values that no
        JAUS field carries. One that is clamped stands for another one, of which the log tells once
        and the end of the process again. What is dropped goes into the log.
        """
        counts = self.statistics.out_of_range
        counts[policy, field] = counts.get((policy, field), 0) + 1
        self.statistics.limited += policy == CLAMP
        if not self._is_open:  # a translation that is tried
            return
        name = f"bridge.{self.name}.{OUT_OF_RANGE}.{policy}.{field}"
        if policy == DROP_FIELD:
            self.counters.add(name)
        else:
            level = logging.ERROR if policy == ERROR else logging.WARNING
            self.counters.count(name, reason, level=level, once=policy == CLAMP)

    def note_blocking(self, seconds: float) -> None:
        """Counts a translation during which nothing else went on."""
        detail = f"the translation took {seconds:.1f} s; nothing was received meanwhile"
        self.counters.count(f"bridge.{self.name}.{BLOCKED}", detail)

    def _refuse(self, error: OutOfRangeError) -> None:
        """Counts a message that is not passed on because of one of its values."""
        drops = self.statistics.drops
        drops[OUT_OF_RANGE] = drops.get(OUT_OF_RANGE, 0) + 1
        self.statistics.errors += error.policy == ERROR
        self._note_out_of_range(error.policy, error.field, str(error))

    def fail(self, error: Exception) -> None:
        """Counts a message that could not be translated or handed over."""
        if isinstance(error, OutOfRangeError):
            self._refuse(error)
            return
        if isinstance(error, StaleJoinError):
            self.drop(reason_of(error), str(error))
            return
        reason = reason_of(error)
        text = repr(error) if reason == FAILED else str(error)
        self.statistics.failures.setdefault(reason, text)
        self.drop(reason, text, error if reason == FAILED else None)

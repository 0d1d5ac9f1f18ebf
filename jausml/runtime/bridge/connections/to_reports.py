"""Connections that carry ROS topics to JAUS as reports that are offered."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from typing import Any, Concatenate, TypeVar

from ...wire.message import Message
from ..ends.ends import Ends, ReportHolder
from ..messages import limits
from ..reports.states import StopReason
from .from_topics import FromTopics

SourceT = TypeVar("SourceT")
TargetT = TypeVar("TargetT", bound="Message")
ValueT = TypeVar("ValueT")

_OF_MANY = ("sensor_msgs/msg/JointState", "diagnostic_msgs/msg/DiagnosticStatus")


class TopicsToReport(FromTopics[SourceT, TargetT]):
    """Serves the newest ROS message as a JAUS report, to queries and events alike."""

    def __init__(
        self,
        name: str,
        translate: Callable[Concatenate[SourceT, ...], TargetT | None],
        *,
        query: type[Message],
        freshness: float = 0.0,
        empty: Callable[[], TargetT] | None = None,
        silence_timeout: float = 0.0,
        **options: Any,
    ) -> None:
        """Prepares the connection.

        Args:
            translate: Makes the JAUS report, or None to keep the one before.
            freshness: Seconds after which a message is too old to be reported; 0 means never.
            empty: Makes the report that says that there is no data, when its fields are optional.
        """
        # A report that is too old and a source that is silent are one thing.
        super().__init__(name, translate, silence_timeout=silence_timeout or freshness, **options)
        self._query = query
        self._empty = empty
        self._report: ReportHolder
        self._put: Callable[[bytes | None], None]
        self._parts: dict[str, dict[str, tuple[float, Any]]] = {}
        self._oldest = math.inf

    def open(self, ends: Ends) -> None:
        """Offers the report, then makes the subscriptions."""
        self._parts.clear()
        self._report = ends.shared_messages.report(self._query, self._message)
        self._sink.deliver = self._put = self._putting(ends)
        super().open(ends)

    def pass_on(self, data: bytes, origin: int) -> None:
        """Translates a message and makes it the present report."""
        super().pass_on(data, origin)
        # Also of a message that was not put: its values must not age the next one.
        self._oldest = math.inf

    def by_name(
        self, names: Collection[str], keys: Sequence[str], values: Sequence[ValueT], needed: str
    ) -> list[ValueT | None]:
        """Returns values in the order of names; messages before may have said some of them.

        Several nodes publish joint states of one robot, each of its own joints. The newest value of
        each name counts, for as long as a report of it would: such a report is as old as its oldest
        value. A message with all names stands by itself.
        """
        values_by_name = dict(zip(keys, values, strict=False))
        if not self._is_open or all(name in values_by_name for name in names):
            return limits.by_name(names, keys, values, needed)
        now, parts = self._ends.clock.now(), self._parts.setdefault(needed, {})
        parts |= {name: (now, values_by_name[name]) for name in names if name in values_by_name}
        since = now - self.silence_timeout if self.silence_timeout > 0 else -math.inf
        fresh = {name: part for name, part in parts.items() if part[0] > since}
        ordered_values = limits.by_name(
            names, [*fresh], [value for _, value in fresh.values()], needed
        )
        self._oldest = min(self._oldest, *(at for at, _ in fresh.values()))
        return ordered_values

    def deliver(self, payload: bytes) -> bool:
        """Makes the message the present report."""
        self._put(payload)
        return True

    def stop(self, reason: StopReason) -> bool:
        """Reports the safe value; without one, that there is no data.

        A number that is old is no report. Where the standard lets every field be absent, queries
        and events say so; else queries stay without an answer, and events pause.
        """
        stood = super().stop(reason)
        # Of several connections to one report, the one that spoke last has the word.
        if self._safe_value is None and self._report.judge_silence in (None, self.judge_silence):
            self._put(self.encode(self._empty()) if self._empty is not None else None)
        return stood

    def _putting(self, ends: Ends) -> Callable[[bytes | None], None]:
        """Returns what makes a message the present report and tells subscribers of changes."""
        holder, message, changed = self._report, self._message, ends.component.report_changed

        def put(report: bytes | None) -> None:
            holder.value, holder.judge_silence = report, self.judge_silence
            # A report that was put together is as old as the oldest of its values.
            if self._oldest < math.inf:
                self.statistics.heard = self._oldest
            changed(message)

        return put

    @property
    def has_one_source(self) -> bool:
        """A report is of one sensor; messages that name what they are of may come from many."""
        return str(getattr(self._type, "TYPE", "")) not in _OF_MANY

    def describe_peers(self) -> list[tuple[str, str]]:
        """Reports go to whoever asks."""
        return [("peer", "any")]

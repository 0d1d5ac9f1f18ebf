"""Connections that offer ROS messages as JAUS reports."""

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

# Types whose messages name their joints or devices, so that several nodes may publish them.
_NAMED_SOURCES = ("sensor_msgs/msg/JointState", "diagnostic_msgs/msg/DiagnosticStatus")


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
            translate: Returns the JAUS report, or None to keep the one before.
            query: The query that the report answers.
            freshness: Seconds after which a message is too old to be reported; 0 means never.
            empty: Makes the report without data, where all fields are optional.
        """
        # A report is too old when its source is silent for so long.
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
        # Also after a message that failed: the age of its values must not count for the next one.
        self._oldest = math.inf

    def by_name(
        self, names: Collection[str], keys: Sequence[str], values: Sequence[ValueT], needed: str
    ) -> list[ValueT | None]:
        """Returns values in the order of names, also values of earlier messages.

        Several nodes may publish joint states of one robot, each of its own joints. The newest
        value of each name is used while it is fresh, and the report is as old as its oldest value.
        A message with all names is used alone.

        Args:
            names: Names in the order of the translation.
            keys: Names of the values of this message.
            needed: Field of the values, for the error.

        Raises:
            AbsentFieldError: A name has no value.
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
        self._oldest = min(self._oldest, *(arrival for arrival, _ in fresh.values()))
        return ordered_values

    def deliver(self, payload: bytes) -> bool:
        """Makes the message the present report."""
        self._put(payload)
        return True

    def stop(self, reason: StopReason) -> bool:
        """Reports the safe value; without one, withdraws the report.

        Old values are not reported. Where all fields of the report are optional, an empty report
        takes its place; otherwise queries have no answer, and events pause.
        """
        was_running = super().stop(reason)
        # Of several connections to one report, only the one that reported last withdraws it.
        if self._safe_value is None and self._report.judge_silence in (None, self.judge_silence):
            self._put(self.encode(self._empty()) if self._empty is not None else None)
        return was_running

    def _putting(self, ends: Ends) -> Callable[[bytes | None], None]:
        """Returns the function that sets the present report and informs its subscribers."""
        holder, message, changed = self._report, self._message, ends.component.report_changed

        def put(report: bytes | None) -> None:
            holder.value, holder.judge_silence = report, self.judge_silence
            # A report of several messages is as old as its oldest value.
            if self._oldest < math.inf:
                self.statistics.heard = self._oldest
            changed(message)

        return put

    @property
    def has_one_source(self) -> bool:
        """Whether only one node may publish: unless messages name the joint or device."""
        return str(getattr(self._type, "TYPE", "")) not in _NAMED_SOURCES

    def describe_peers(self) -> list[tuple[str, str]]:
        """Returns that any peer may ask for the report."""
        return [("peer", "any")]

"""Connections that carry ROS topics to JAUS, as reports that the bridge offers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from .connection import FILTERED
from .from_topics import FromTopics

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Concatenate

    from ...wire.message import Message
    from ..ends.ends import Ends, ReportHolder
    from ..reports.stops import StopReason
    from .connection import Take
    from .stopping import Switch

SourceT = TypeVar("SourceT")
TargetT = TypeVar("TargetT", bound="Message")


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
        super().__init__(name, translate, silence_timeout=silence_timeout or freshness, **options)
        self._query = query
        self._empty = empty
        self._report: ReportHolder

    def open(self, ends: Ends) -> None:
        """Offers the report, then makes the subscriptions."""
        self._report = ends.report(self._query, self._message)
        super().open(ends)

    def make_take(self, switch: Switch) -> Take:
        """Returns the short way of messages."""
        counts, transcode, now = self.statistics, self._transcode, self._ends.clock.now
        drop, fail, holder, message = self.drop, self.fail, self._report, self._message
        report_changed = self._ends.component.report_changed

        def take(data: bytes, stamp: int = 0) -> None:
            if switch.unusual is not None:
                switch.unusual(data, stamp)
                return
            counts.arrivals += 1
            try:
                target = transcode(data)
                counts.heard = counts.last_arrival = now()
                if target is None:
                    drop(FILTERED)
                    return
                holder.value, holder.feeder = target, self
                report_changed(message)
            except Exception as error:
                counts.last_arrival = now()
                fail(error)
                return
            counts.passed += 1

        return take

    def deliver(self, payload: bytes) -> bool:
        """Makes the message the present report and tells subscribers of changes."""
        self._put(payload)
        return True

    def stop(self, reason: StopReason) -> bool:
        """Reports the safe value; without one, that there is no data.

        A number that is old is no report. Where the standard lets every field be absent, queries
        and events say so; else queries stay without an answer, and events pause.
        """
        stood = super().stop(reason)
        # Of several connections to one report, the one that spoke last has the word.
        if self._safe_value is None and self._report.feeder in (None, self):
            self._put(self.encode(self._empty()) if self._empty is not None else None)
        return stood

    def _put(self, report: bytes | None) -> None:
        self._report.value, self._report.feeder = report, self
        self._ends.component.report_changed(self._message)

    def describe_peers(self) -> list[tuple[str, str]]:
        """Reports go to whoever asks."""
        return [("peer", "any")]

"""Connections that carry ROS topics to JAUS, as reports that the bridge offers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from .from_topics import FromTopics

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Concatenate

    from ...wire.message import Message
    from ..ends.ends import Ends, ReportHolder
    from ..reports.stops import StopReason

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
        self._put: Callable[[bytes | None], None]

    def open(self, ends: Ends) -> None:
        """Offers the report, then makes the subscriptions."""
        self._report = ends.report(self._query, self._message)
        self._handing.deliver = self._put = self._putting(ends)
        super().open(ends)

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
        if self._safe_value is None and self._report.feeder in (None, self):
            self._put(self.encode(self._empty()) if self._empty is not None else None)
        return stood

    def _putting(self, ends: Ends) -> Callable[[bytes | None], None]:
        """Returns what makes a message the present report and tells subscribers of changes."""
        holder, message, changed = self._report, self._message, ends.component.report_changed

        def put(report: bytes | None) -> None:
            holder.value, holder.feeder = report, self
            changed(message)

        return put

    def describe_peers(self) -> list[tuple[str, str]]:
        """Reports go to whoever asks."""
        return [("peer", "any")]

"""Times of the reports of a running system, measured from outside."""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from jausml.live.messages import MessageError
from jausml.live.peers.asking import NoAnswer
from jausml.live.peers.entry_messages import message_class
from jausml.live.peers.operator import Refused
from jausml.live.peers.samples import full_query
from jausml.live.peers.spread import spread_of
from jausml.runtime.conversions import ConversionError, Time, TimeStamp, timestamp_to_time

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.live.messages import MessageEntry
    from jausml.live.peers.operator import Operator
    from jausml.live.peers.spread import Spread
    from jausml.runtime import EventSubscription
    from jausml.runtime.base.address import JausAddress

_STAMP = ("Milliseconds", "Seconds", "Minutes", "Hour", "Day")
_MOST_REPORTS = 100_000
"""Reports that are kept of one stream; the first ones tell as much."""


@dataclass
class Stream:
    """A report of a component, while it is measured.

    Attributes:
        arrivals: When reports came by event: steady seconds, seconds since 1970, and the bytes.
        round_trips: Seconds from a query to its answer; None for one that did not come in time.
        fault: Why there are no events; empty when there may be some.
    """

    component: JausAddress
    query: MessageEntry
    report: MessageEntry
    arrivals: list[tuple[float, float, bytes]] = field(default_factory=list)
    round_trips: list[float | None] = field(default_factory=list)
    fault: str = ""

    def take(self, payload: bytes) -> None:
        """Notes a report that has just come."""
        if len(self.arrivals) < _MOST_REPORTS:
            self.arrivals.append((time.perf_counter(), time.time(), payload))

    @property
    def rate(self) -> float | None:
        """Reports each second; None with fewer than two."""
        if len(self.arrivals) < 2:
            return None
        whole = self.arrivals[-1][0] - self.arrivals[0][0]
        return (len(self.arrivals) - 1) / whole if whole > 0 else None

    @property
    def jitter(self) -> Spread | None:
        """How far the times between reports are from their median, in seconds."""
        times = [each[0] for each in self.arrivals]
        gaps = [later - earlier for earlier, later in pairwise(times)]
        middle = statistics.median(gaps) if gaps else 0.0
        return spread_of(abs(each - middle) for each in gaps)

    @property
    def ages(self) -> Spread | None:
        """Ages of the reports by their TimeStamp, in seconds; None when they have none.

        Below 0 the clock of the component is ahead of ours. A TimeStamp has whole milliseconds.
        """
        found = (self._age(arrived, payload) for _, arrived, payload in self.arrivals)
        return spread_of(each for each in found if each is not None)

    def _age(self, arrived: float, payload: bytes) -> float | None:
        try:
            parts = _stamp_in(self.report.decode(payload))
        except MessageError:
            return None
        if parts is None:
            return None
        now = Time(*divmod(round(arrived * 1e9), 10**9))
        try:
            sent = timestamp_to_time(TimeStamp(*(int(parts[each]) for each in _STAMP)), near=now)
        except ConversionError:
            return None
        return (now.sec - sent.sec) + (now.nanosec - sent.nanosec) / 1e9

    @property
    def answers(self) -> Spread | None:
        """How the round trips of the query were spread; None without an answer."""
        return spread_of(each for each in self.round_trips if each is not None)


def _stamp_in(fields: Any) -> dict[str, Any] | None:
    """Returns the parts of the first TimeStamp in the records of a report."""
    if not isinstance(fields, dict):
        return None
    if all(each in fields for each in _STAMP):
        return fields
    found = (_stamp_in(value) for value in fields.values())
    return next((each for each in found if each is not None), None)


def offered_reports(operator: Operator, target: JausAddress) -> list[str]:
    """Returns names of the queries for the reports that a component offers, without core ones."""
    services = operator.services(target)
    if not services:
        raise operator.unanswered(target, "QueryServices", "ReportServices")
    names: dict[str, None] = {}
    for each in services:
        entry = operator.catalogue.services.get((each.urn, f"{each.major}.{each.minor}"))
        if entry is None or ":core:" in each.urn:
            continue
        reports = {report.name.removeprefix("Report") for report in entry.outputs}
        names |= {
            query.name: None
            for query in entry.inputs
            if query.name.startswith("Query") and query.name.removeprefix("Query") in reports
        }
    return list(names)


def measure(
    operator: Operator,
    wanted: Iterable[tuple[JausAddress, str]],
    *,
    duration: float,
    rate: float | None,
    interval: float,
) -> list[Stream]:
    """Measures reports for a while.

    Args:
        duration: Seconds to measure.
        rate: Reports each second that the events are to have; None for one at every change.
        interval: Seconds between two questions for a report.

    Returns:
        One stream for each report.

    Raises:
        MessageError: There is no such message.
    """
    streams = [Stream(target, *operator.exchange(target, name)) for target, name in wanted]
    events = [_subscribed(operator, stream, rate) for stream in streams]
    try:
        end = time.monotonic() + duration
        while time.monotonic() < end:
            due = time.monotonic() + interval
            for stream in streams:
                if time.monotonic() < end:
                    stream.round_trips.append(_round_trip(operator, stream))
            time.sleep(max(0.0, min(due, end) - time.monotonic()))
    finally:
        for event in filter(None, events):
            event.cancel()
    return streams


def _subscribed(operator: Operator, stream: Stream, rate: float | None) -> EventSubscription | None:
    exchange = (stream.query, stream.report)
    try:
        return operator.watch_encoded(stream.component, exchange, rate, stream.take)
    except (NoAnswer, Refused) as error:
        stream.fault = str(error)
        return None


def _round_trip(operator: Operator, stream: Stream) -> float | None:
    query = operator.message(stream.query, full_query(stream.query, stream.report))
    return operator.round_trip(stream.component, query, message_class(stream.report))

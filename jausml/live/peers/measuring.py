"""Measured times of a running system, as seen from outside: of reports, and of round trips."""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from jausml.language.metamodel.classes import bridge
from jausml.language.model.model import Model
from jausml.language.semantics.directions import is_to_ros
from jausml.live.messages import MessageEntry, MessageError
from jausml.live.peers.entry_messages import full_query, message_class
from jausml.live.peers.operator import Operator
from jausml.live.peers.query_client import NoAnswer, QueryClient, Refused
from jausml.runtime import EventSubscription
from jausml.runtime.base.address import JausAddress
from jausml.runtime.conversions import ConversionError, Time, TimeStamp, timestamp_to_time
from jausml.runtime.messages import (
    QueryControl,
    QueryHeartbeatPulse,
    QueryIdentification,
    QueryStatus,
    ReportControl,
    ReportHeartbeatPulse,
    ReportIdentification,
    ReportStatus,
)
from jausml.runtime.services.definitions import Scope
from jausml.runtime.wire.message import Message

_STAMP = ("Milliseconds", "Seconds", "Minutes", "Hour", "Day")

_MOST_REPORTS = 100_000  # of one stream; further ones are not noted

# Queries of the core services by name, with their reports; the shortest first.
#
# No service is in every component: Liveness has the heartbeat, Discovery the identification,
# Management the status, Access Control the control.
QUESTIONS: dict[str, tuple[Message, type[Message]]] = {
    "heartbeat": (QueryHeartbeatPulse(), ReportHeartbeatPulse),
    "identification": (QueryIdentification(query_type=Scope.COMPONENT), ReportIdentification),
    "status": (QueryStatus(), ReportStatus),
    "control": (QueryControl(), ReportControl),
}


@dataclass(frozen=True)
class Spread:
    """Figures of measured times in seconds (`p99`: the 99th percentile by nearest rank)."""

    count: int
    least: float
    median: float
    p99: float
    greatest: float

    def milliseconds(self) -> dict[str, float]:
        """Returns the figures by name, in milliseconds, rounded to three digits."""
        named = {"min": self.least, "median": self.median, "p99": self.p99, "max": self.greatest}
        return {name: round(value * 1e3, 3) for name, value in named.items()}


def spread_of(seconds: Iterable[float]) -> Spread | None:
    """Returns the figures of measured times in seconds; None without a time."""
    ranked = sorted(seconds)
    if not ranked:
        return None
    return Spread(len(ranked), ranked[0], _ranked(ranked, 0.5), _ranked(ranked, 0.99), ranked[-1])


def _ranked(ranked: list[float], share: float) -> float:
    return ranked[math.ceil(share * len(ranked)) - 1]


@dataclass
class ReportTimes:
    """The measured times of one report of a component.

    Attributes:
        arrivals: Events in their order: steady seconds, seconds since 1970, and the payload.
        round_trips: Seconds from a query to its report; None for a missing one.
        fault: Why there are no events; empty if the subscription succeeded.
    """

    component: JausAddress
    query: MessageEntry
    report: MessageEntry
    arrivals: list[tuple[float, float, bytes]] = field(default_factory=list)
    round_trips: list[float | None] = field(default_factory=list)
    fault: str = ""

    def take(self, payload: bytes) -> None:
        """Notes a report that came just now."""
        if len(self.arrivals) < _MOST_REPORTS:
            self.arrivals.append((time.perf_counter(), time.time(), payload))

    @property
    def rate(self) -> float | None:
        """Reports each second; None with fewer than two reports."""
        if len(self.arrivals) < 2:
            return None
        whole = self.arrivals[-1][0] - self.arrivals[0][0]
        return (len(self.arrivals) - 1) / whole if whole > 0 else None

    @property
    def jitter(self) -> Spread | None:
        """Distances of the times between reports from their median, in seconds."""
        times = [arrival[0] for arrival in self.arrivals]
        gaps = [later - earlier for earlier, later in pairwise(times)]
        middle = statistics.median(gaps) if gaps else 0.0
        return spread_of(abs(gap - middle) for gap in gaps)

    @property
    def ages(self) -> Spread | None:
        """Ages of the reports by their TimeStamp, in seconds; None without a TimeStamp.

        A negative age means that the clock of the component is ahead of ours. A TimeStamp has whole
        milliseconds.
        """
        ages = (self._age(arrived, payload) for _, arrived, payload in self.arrivals)
        return spread_of(age for age in ages if age is not None)

    def _age(self, arrived: float, payload: bytes) -> float | None:
        try:
            parts = _stamp_in(self.report.decode(payload))
        except MessageError:
            return None
        if parts is None:
            return None
        now = Time(*divmod(round(arrived * 1e9), 10**9))
        try:
            sent = timestamp_to_time(TimeStamp(*(int(parts[name]) for name in _STAMP)), near=now)
        except ConversionError:
            return None
        return (now.sec - sent.sec) + (now.nanosec - sent.nanosec) / 1e9

    @property
    def answers(self) -> Spread | None:
        """Figures of the round trips of the query; None without a report."""
        return spread_of(round_trip for round_trip in self.round_trips if round_trip is not None)


def _stamp_in(fields: Any) -> dict[str, Any] | None:
    """Returns the parts of the first TimeStamp in the records of a report."""
    if not isinstance(fields, dict):
        return None
    if all(name in fields for name in _STAMP):
        return fields
    stamps = (_stamp_in(value) for value in fields.values())
    return next((stamp for stamp in stamps if stamp is not None), None)


def offered_reports(operator: Operator, target: JausAddress) -> list[str]:
    """Returns the queries for the reports of the services of a component, except core ones.

    Raises:
        NoAnswer: Its services are not known.
    """
    services = operator.services(target)
    if not services:
        raise operator.unanswered(target, "QueryServices", "ReportServices")
    names: dict[str, None] = {}
    for service in services:
        entry = operator.catalogue.services.get((service.urn, f"{service.major}.{service.minor}"))
        if entry is None or ":core:" in service.urn:
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
    reports: Iterable[tuple[JausAddress, str]],
    *,
    duration: float,
    rate: float | None,
    interval: float,
) -> list[ReportTimes]:
    """Measures reports for `duration` seconds.

    Args:
        reports: Components and names of their reports.
        rate: Requested reports each second; None for one at every change.
        interval: Seconds between two queries of a report.
    """
    streams = [ReportTimes(target, *operator.exchange(target, name)) for target, name in reports]
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


def _subscribed(
    operator: Operator, stream: ReportTimes, rate: float | None
) -> EventSubscription | None:
    exchange = (stream.query, stream.report)
    try:
        return operator.watch_encoded(stream.component, exchange, rate, stream.take)
    except (NoAnswer, Refused) as error:
        stream.fault = str(error)
        return None


def _round_trip(operator: Operator, stream: ReportTimes) -> float | None:
    query = operator.message(stream.query, full_query(stream.query, stream.report))
    return operator.round_trip(stream.component, query, message_class(stream.report))


@dataclass
class Pings:
    """The round trips of queries to a component in seconds; None for a missing answer."""

    round_trips: list[float | None] = field(default_factory=list)

    @property
    def sent(self) -> int:
        """Number of queries."""
        return len(self.round_trips)

    @property
    def answered(self) -> int:
        """Number of answers."""
        return sum(round_trip is not None for round_trip in self.round_trips)

    @property
    def loss(self) -> float:
        """Share of queries without an answer, from 0 to 1."""
        return 1 - self.answered / self.sent if self.sent else 0.0

    @property
    def spread(self) -> Spread | None:
        """Figures of the round trips; None without an answer."""
        return spread_of(round_trip for round_trip in self.round_trips if round_trip is not None)


def answered_question(client: QueryClient, target: JausAddress) -> str | None:
    """Returns the name of the first of QUESTIONS that a component answers; None if none."""
    index = client.first_answered(target, list(QUESTIONS.values()))
    return None if index is None else list(QUESTIONS)[index]


def reports_of(model: Model) -> list[tuple[JausAddress, str]]:
    """Returns the components of a model with the names of their reports, in model order.

    Reports that a bridge makes from topics are those of the bridge. Peers that are found by service
    have no address in the model, and are left out.
    """
    return list(dict.fromkeys(_reports(model)))


def _reports(model: Model) -> Iterator[tuple[JausAddress, str]]:
    for owner in model.instances(bridge.Bridge, library=False):
        for connection in owner.bridgeConnections:
            if connection.exchange.name == "message":
                continue
            to_ros = is_to_ros(connection)
            for component in connection.peers if to_ros else [owner]:
                yield JausAddress.parse(str(component.address)), str(connection.map.message.name)

"""Rules about joined reports: further JAUS reports from which a map takes values."""

from __future__ import annotations

from collections.abc import Iterator

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections.limits import LEAST_RATE, MAXIMUM_RATE
from jausml.language.semantics.connections.reports import JoinedReport, joined_reports
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.fields import attributes
from jausml.language.semantics.jaus.services import Provider, find_output, is_known, query_name
from jausml.language.semantics.subject import Subject
from jausml.language.validation.findings import provider_name, unprovided
from jausml.language.validation.rule import Finding, Note, rule
from jausml.language.validation.rules.bridge.joins import first_names, join_findings


@rule("JML494", "report join used wrongly", kinds=bridge.AttributeMap)
def report_joins(subject: Subject, attribute_map: bridge.AttributeMap) -> Iterator[Finding]:
    """A report join has a unique name, a time after which it is stale, and a use.

    Source paths of toRos begin with the name of the join, so it differs from the fields of the main
    message and from other joins. Only a connection of topics from JAUS to ROS feeds it, so that
    maps of ROS services and actions have none.

    Bad: `<reportJoins name="X" .../>` in a map of ReportLocalPose, which has a field X

    Good: `<reportJoins name="velocity" .../>`
    """
    if not attribute_map.reportJoins or not subject.is_intact(attribute_map.message):
        return
    fields = {str(attribute.name) for attribute in attributes(attribute_map.message)}
    used = first_names(attribute_map.toRos)
    yield from join_findings(attribute_map.reportJoins, "report join", "message", fields, used)


@report_joins.also(bridge.RosActionConnection)
def _report_joins_ros_action_connection(
    _: Subject, action: bridge.RosActionConnection
) -> Iterator[Finding]:
    yield from _unfed(action, "element")


@report_joins.also(bridge.RosServiceConnection)
def _report_joins_ros_service_connection(
    _: Subject, service: bridge.RosServiceConnection
) -> Iterator[Finding]:
    yield from _unfed(service, "request")
    yield from _unfed(service, "response")


@rule("JML495", "joined report from nowhere", kinds=bridge.Connection)
def report_sources(subject: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A connection from JAUS to ROS says where each joined report of its map comes from, once.

    A join without a source comes from the peers of the connection, as a periodic event at its rate.
    The component that is asked provides a service that sends the report and takes its query.
    Reports of several peers of the connection are not joined, since the velocity of one would be
    combined with the pose of another. A report with a period longer than its freshness is stale in
    between, which is a warning.

    Bad: `<sources join="velocity" peers="camera"/>`, where camera has no VelocityStateSensor

    Good: `<sources join="velocity" peers="vehicle" rate="20"/>`
    """
    map_ = connection.map
    if map_ is None or not subject.is_intact(connection, map_, map_.message):
        return
    yield from _source_findings(connection)
    reports = joined_reports(connection)
    if len(connection.peers) > 1 and any(not joined.has_own_peers for joined in reports):
        message = f"'{connection.name}' has several peers, whose reports would be mixed"
        hint = "make a connection for each peer, or give the joined reports peers"
        yield Finding(connection, message, "peers", hint)
    for report in reports:
        if subject.is_intact(report.join, report.join.message):
            yield from _origin_findings(subject, report)
            yield from _rate_findings(report)


def _unfed(
    connection: bridge.RosActionConnection | bridge.RosServiceConnection, feature: str
) -> Iterator[Finding]:
    """A map with joined reports at a connection that feeds none."""
    map_: bridge.AttributeMap | None = getattr(connection, feature)
    if map_ is not None and map_.reportJoins:
        message = f"map '{map_.name}' has joined reports, which only a connection of topics feeds"
        yield Finding(connection, message, feature, related=(Note(map_, f"map '{map_.name}'"),))


def _source_findings(connection: bridge.Connection) -> Iterator[Finding]:
    """Yields the faults of the sources that a connection states."""
    known = list(connection.map.reportJoins)
    seen: dict[bridge.ReportJoin, bridge.ReportSource] = {}
    for source in connection.sources:
        join = source.join
        if not is_to_ros(connection):
            message = f"'{connection.name}' takes no reports: it leads from ROS to JAUS"
            yield Finding(source, message, "join")
        elif join not in known:
            message = f"report join '{join.name}' is none of map '{connection.map.name}'"
            yield Finding(source, message, "join", related=(Note(join, f"'{join.name}'", "name"),))
        elif seen.setdefault(join, source) is not source:
            note = Note(seen[join], "the other one", "join")
            message = f"two sources feed report join '{join.name}'"
            yield Finding(source, message, "join", related=(note,))


def _origin_findings(subject: Subject, report: JoinedReport) -> Iterator[Finding]:
    """Whether whoever is to send a joined report does."""
    name, peers = report.join.name, report.peers
    asks = report.exchange != "message"
    if asks and not peers:
        message = f"'{report.connection.name}' names no peer to ask for report join '{name}'"
        yield _finding(report, message, "peers", "name peers or search for them")
    for peer in peers:
        if not is_known(subject, peer):
            continue
        if find_output(report.join.message, peer) is None:
            yield _unsent(report, peer)
        elif asks and report.query_of(peer) is None:
            stated = report.stated_query
            wanted = stated.name if stated is not None else query_name(report.join.message)
            message = (
                f"{provider_name(peer)} takes no {wanted}, which asks for report join '{name}'"
            )
            yield _finding(report, message, "query", related=(Note(peer, provider_name(peer)),))


def _unsent(report: JoinedReport, peer: Provider) -> Finding:
    purpose = f" for report join '{report.join.name}'"
    return unprovided(_place(report), peer, report.join.message, "sends", "peers", purpose)


def _rate_findings(report: JoinedReport) -> Iterator[Finding]:
    name, rate = report.join.name, report.rate
    if report.exchange not in {"periodicEvent", "query"}:
        return
    if not LEAST_RATE <= rate <= MAXIMUM_RATE:
        hint = f"{LEAST_RATE:g} to {MAXIMUM_RATE:g}"
        yield _finding(
            report, f"rate {rate:g} of report join '{name}' is out of range", "rate", hint
        )
    elif 0 < report.join.freshness < 1 / rate:
        message = f"report join '{name}' is fresh for {report.join.freshness:g} s, but comes each"
        message += f" {1 / rate:g} s"
        hint = "ask for it more often, or let it be fresh for longer"
        yield _finding(report, message, "rate", hint, severity=Severity.WARNING)


def _finding(
    report: JoinedReport,
    message: str,
    feature: str,
    hint: str = "",
    related: tuple[Note, ...] = (),
    severity: Severity | None = None,
) -> Finding:
    return Finding(_place(report), message, feature, hint, related, severity)


def _place(report: JoinedReport) -> bridge.Connection | bridge.ReportSource:
    """Returns the source of a report, or the connection where none is stated."""
    return report.connection if report.source is None else report.source

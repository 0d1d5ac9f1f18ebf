"""Checks of Discovery: what the target says of itself and of others (AS5710A)."""

from __future__ import annotations

from jausml.live.peers.conformance.check import Check, Step
from jausml.live.peers.conformance.session import Session
from jausml.live.peers.conformance.steps import (
    A,
    AnythingBut,
    Judgement,
    any_of,
    ask,
    expect_none,
    has,
    notes,
    passes,
    send,
    should_have,
    since_1_1,
    skips,
)
from jausml.live.peers.discovery import Services, services_of
from jausml.runtime.base.address import JausAddress
from jausml.runtime.clients.discovery_client import query_service_lists, query_services
from jausml.runtime.messages import (
    QueryConfiguration,
    QueryIdentification,
    QueryServiceList,
    QueryServices,
    QuerySubsystemList,
    ReportConfiguration,
    ReportIdentification,
    ReportServiceList,
    ReportServices,
    ReportSubsystemList,
)
from jausml.runtime.services.definitions import CORE, Scope

_TYPES = {
    Scope.SYSTEM: range(10001, 40001),
    Scope.SUBSYSTEM: range(10001, 40001),
    Scope.NODE: range(40001, 50001),
    Scope.COMPONENT: range(50001, 65536),
}
"""Ranges of Type by QueryType (AS5710A, ReportIdentification)."""

_Listing = ReportServices | ReportServiceList


def _query_service_list(session: Session) -> QueryServiceList:
    return query_service_lists(session.probe.target)


def _query_all(_: Session) -> QueryServices:
    return query_services()


def _query_target(session: Session) -> QueryServices:
    return query_services(session.probe.target)


def _query_nobody(session: Session) -> QueryServices:
    """Returns a query for a component that the target has not listed; skips the check without."""
    known, target = _listed_services(session), session.probe.target
    ids = (JausAddress(target.subsystem, target.node, number) for number in range(254, 0, -1))
    unlisted = [address for address in ids if address not in known]
    session.skip_unless(bool(unlisted), "the target lists each id of its node")
    return query_services(unlisted[0])


def _listed_services(session: Session) -> Services:
    """Asks for all services that the target lists, of itself and of others."""
    return _services(session, session.first.ask(_query_all(session), ReportServices))


def _services(session: Session, report: _Listing) -> Services:
    return services_of(report, session.probe.target.subsystem)


def _holds_target(session: Session, report: _Listing, what: str) -> None:
    services = _services(session, report)
    session.require(session.probe.target in services, f"{what} does not hold the target itself")


def _holds_discovery_once(session: Session, report: ReportServices, _: str) -> None:
    urns = [service.urn for service in _services(session, report)[session.probe.target]]
    session.require(CORE + "Discovery" in urns, "the target answers Discovery but does not list it")
    doubled = sorted({urn for urn in urns if urns.count(urn) > 1})
    if doubled:
        session.note(f"listed more than once: {', '.join(doubled)}")


def _holds_no_others(session: Session, report: ReportServices, what: str) -> None:
    others = [
        str(service) for service in _services(session, report) if service != session.probe.target
    ]
    session.require(not others, f"{what} also holds {others}")


def _agrees(session: Session, report: _Listing, what: str) -> None:
    """Requires that the target has the same services as in ReportServices for all."""
    target = session.probe.target
    own = _listed_services(session).get(target, ())
    session.require(
        sorted(_services(session, report)[target], key=repr) == sorted(own, key=repr),
        f"{what} and ReportServices for all list different services of the target",
    )


def _holds_nobody(session: Session, report: ReportServices, what: str) -> None:
    """Requires that nobody is listed whom the report for all does not list."""
    addresses = sorted(map(str, set(_services(session, report)) - set(_listed_services(session))))
    session.require(not addresses, f"{what} holds {addresses}, which nobody has listed before")


def _configured(report: ReportConfiguration) -> set[tuple[int, int]]:
    """Returns node and component id of each component in the report."""
    return {
        (node.node_rec.node_id, component.component_id)
        for node in report.node_list
        for component in node.component_list
    }


def _configures_target(session: Session, report: ReportConfiguration, what: str) -> None:
    target = session.probe.target
    held = (target.node, target.component) in _configured(report)
    session.require(held, f"{what} does not hold the target")


def _configures_all(session: Session, report: ReportConfiguration, what: str) -> None:
    listed = {(address.node, address.component) for address in _listed_services(session)}
    missing = listed - _configured(report)
    session.require(not missing, f"{what} lacks {sorted(missing)} of ReportServices")


def _holds_subsystem(session: Session, report: ReportSubsystemList, what: str) -> None:
    own = session.probe.target.subsystem
    held = any(subsystem.subsystem_id == own for subsystem in report.subsystem_list)
    session.require(held, f"{what} does not hold the target's subsystem {own}")


def _lists_bases(session: Session) -> None:
    urns = {service.urn for service in session.services}
    bases = (base.urn for service in session.services for base in session.known_bases(service))
    missing = sorted({urn for urn in bases if urn not in urns})
    if missing:
        session.note(f"not listed, though inherited: {', '.join(missing)}")


def _configuration(scope: Scope, *judgements: Judgement[ReportConfiguration]) -> Step:
    query = QueryConfiguration(query_type=scope)
    return ask(A, query, ReportConfiguration, *judgements, unanswered=skips("not answered"))


def _identifies(
    scope: Scope, *judgements: Judgement[ReportIdentification], unanswered: Step | None = passes
) -> Step:
    query = QueryIdentification(query_type=scope)
    expected = (has(query_type=scope), should_have(type_=_TYPES[scope]), *judgements)
    return ask(A, query, ReportIdentification, *expected, unanswered=unanswered)


CHECKS = (
    Check(
        "discovery.identification",
        "Identifies itself as a component",
        "AS5710A Discovery, QueryIdentification 4, ReportIdentification",
        "The report repeats QueryType 4 and holds a type of components and a name.",
        (
            _identifies(
                Scope.COMPONENT, should_have(identification=AnythingBut("")), unanswered=None
            ),
        ),
    ),
    Check(
        "discovery.scopes",
        "Answers for the scope that was asked for, or not at all",
        "AS5710A Discovery, QueryIdentification 1 to 3",
        "A report about system, subsystem or node must say so; a narrower server stays silent.",
        tuple(_identifies(scope) for scope in (Scope.SYSTEM, Scope.SUBSYSTEM, Scope.NODE)),
    ),
    Check(
        "discovery.reserved-type",
        "Does not identify itself as something reserved",
        "AS5710A Discovery, QueryIdentification: QueryType 0 is reserved",
        "QueryType 0 and 200 need no answer.",
        (
            send(A, QueryIdentification(query_type=0)),
            send(A, QueryIdentification(query_type=200)),
            expect_none(A, ReportIdentification, "the QueryType is reserved", tolerated=True),
        ),
    ),
    Check(
        "discovery.services",
        "Lists its services",
        "AS5710A Discovery, QueryServices, ReportServices",
        "ReportServices for all nodes and components holds the target and its Discovery service.",
        (ask(A, _query_all, ReportServices, _holds_target, _holds_discovery_once),),
    ),
    Check(
        "discovery.services-by-id",
        "Lists the services of one component",
        "AS5710A Discovery, QueryServices with node and component id",
        "Asked for its own ids, the target reports itself alone, with the same services.",
        (ask(A, _query_target, ReportServices, _holds_target, _holds_no_others, _agrees),),
    ),
    Check(
        "discovery.services-unknown",
        "Lists nothing for a component that it does not know",
        "AS5710A Discovery, ReportServices: lists may be empty",
        "Asked for an id that nobody has, the report is empty; silence is noted.",
        (
            ask(
                A,
                _query_nobody,
                ReportServices,
                _holds_nobody,
                unanswered=notes("QueryServices for an unknown component is not answered"),
            ),
        ),
    ),
    Check(
        "discovery.service-list",
        "Lists its services in the way of version 1.1 too",
        "AS5710A v1.1 Discovery, QueryServiceList, ReportServiceList",
        "ReportServiceList holds the target with the services that ReportServices holds.",
        (
            since_1_1("Discovery", "Discovery 1.0 has no QueryServiceList"),
            ask(A, _query_service_list, ReportServiceList, _holds_target, _agrees),
        ),
    ),
    Check(
        "discovery.configuration",
        "Lists the components of its node and subsystem",
        "AS5710A Discovery, QueryConfiguration, ReportConfiguration",
        "If the target answers for a scope, the report holds itself; a narrower server is silent.",
        (
            any_of(
                "the target answers for neither its node nor its subsystem",
                _configuration(Scope.NODE, _configures_target),
                _configuration(Scope.SUBSYSTEM, _configures_target, _configures_all),
            ),
        ),
    ),
    Check(
        "discovery.subsystem-list",
        "Lists the subsystems that it knows",
        "AS5710A Discovery, QuerySubsystemList, ReportSubsystemList",
        "If the target answers, the report holds its own subsystem.",
        (
            ask(
                A,
                QuerySubsystemList(),
                ReportSubsystemList,
                _holds_subsystem,
                unanswered=skips("the target does not answer for a subsystem"),
            ),
        ),
    ),
    Check(
        "discovery.inheritance",
        "Lists the services that its services inherit from",
        "AS5684, inheritance; practice: clients look for AccessControl and Management by name",
        "A component with a driver also provides Management, AccessControl, Events and Transport.",
        (_lists_bases,),
    ),
)

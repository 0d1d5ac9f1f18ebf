"""Checks of Discovery: what the target says of itself and of others (AS5710A)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.live.peers.conformance.check import Check, Step, check
from jausml.live.peers.conformance.steps import (
    A,
    AnythingBut,
    Judgement,
    ask,
    expect_none,
    has,
    send,
    usual,
)
from jausml.live.peers.discovery import service_list, services_of
from jausml.runtime.base.address import WILDCARD_COMPONENT, WILDCARD_NODE, JausAddress
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

if TYPE_CHECKING:
    from jausml.live.peers.conformance.session import Session
    from jausml.runtime.services.definitions import ServiceIdentity

_TYPES = {
    Scope.SYSTEM: range(10001, 40001),
    Scope.SUBSYSTEM: range(10001, 40001),
    Scope.NODE: range(40001, 50001),
    Scope.COMPONENT: range(50001, 65536),
}
"""Ranges of Type by QueryType (AS5710A, ReportIdentification)."""


@check(
    "discovery.services",
    "Lists its services",
    "AS5710A Discovery, QueryServices, ReportServices",
)
def services(session: Session) -> None:
    """ReportServices for all nodes and components holds the target and its Discovery service."""
    own = _own(session, WILDCARD_NODE, WILDCARD_COMPONENT)
    session.require(own is not None, "ReportServices does not hold the target itself")
    urns = [service.urn for service in own or ()]
    session.require(CORE + "Discovery" in urns, "the target answers Discovery but does not list it")
    doubled = sorted({urn for urn in urns if urns.count(urn) > 1})
    if doubled:
        session.note(f"listed more than once: {', '.join(doubled)}")


@check(
    "discovery.services-by-id",
    "Lists the services of one component",
    "AS5710A Discovery, QueryServices with node and component id",
)
def services_by_id(session: Session) -> None:
    """Asked for its own ids, the target reports itself alone, with the same services."""
    target = session.probe.target
    named = _listed(session, target.node, target.component)
    session.require(target in named, "ReportServices for the target's ids does not hold it")
    others = [str(address) for address in named if address != target]
    session.require(not others, f"ReportServices for the target's ids also holds {others}")
    everything = _own(session, WILDCARD_NODE, WILDCARD_COMPONENT)
    session.require(
        _names(named[target]) == _names(everything or ()),
        "ReportServices for its ids and for all differ",
    )


@check(
    "discovery.services-unknown",
    "Lists nothing for a component that it does not know",
    "AS5710A Discovery, ReportServices: lists may be empty",
)
def services_unknown(session: Session) -> None:
    """Asked for an id that nobody has, the report is empty; silence is noted."""
    target = session.probe.target
    known = _listed(session, WILDCARD_NODE, WILDCARD_COMPONENT)
    free = next(
        number
        for number in range(254, 0, -1)
        if JausAddress(target.subsystem, target.node, number) not in known
    )
    query = _query(target.node, free)
    report = session.first.asked(query, ReportServices, attempts=1)
    if report is None:
        session.note("QueryServices for an unknown component is not answered")
        return
    found = services_of(report, target.subsystem)
    session.require(
        not any(address.component == free for address in found),
        f"ReportServices holds component {free}, which nobody has listed before",
    )


@check(
    "discovery.service-list",
    "Lists its services in the way of version 1.1 too",
    "AS5710A v1.1 Discovery, QueryServiceList, ReportServiceList",
)
def service_list_agrees(session: Session) -> None:
    """ReportServiceList holds the target with the services that ReportServices holds."""
    session.skip_unless(not session.is_v1_0("Discovery"), "Discovery 1.0 has no QueryServiceList")
    target = session.probe.target
    report = session.first.ask(_query_service_list(target), ReportServiceList)
    found = service_list(report)
    session.require(target in found, "ReportServiceList does not hold the target itself")
    own = _own(session, WILDCARD_NODE, WILDCARD_COMPONENT)
    session.require(
        _names(found[target]) == _names(own or ()),
        "ReportServiceList and ReportServices list different services of the target",
    )


@check(
    "discovery.configuration",
    "Lists the components of its node and subsystem",
    "AS5710A Discovery, QueryConfiguration, ReportConfiguration",
)
def configuration(session: Session) -> None:
    """If the target answers for a scope, the report holds itself; a narrower server is silent."""
    target = session.probe.target
    answered = False
    for scope in (Scope.NODE, Scope.SUBSYSTEM):
        query = QueryConfiguration(query_type=scope)
        report = session.first.asked(query, ReportConfiguration, attempts=1)
        if report is None:
            continue
        answered = True
        members = {
            (node.node_rec.node_id, component.component_id)
            for node in report.node_list
            for component in node.component_list
        }
        session.require(
            (target.node, target.component) in members,
            f"ReportConfiguration for QueryType {int(scope)} does not hold the target",
        )
        if scope is Scope.SUBSYSTEM:
            listed = _listed(session, WILDCARD_NODE, WILDCARD_COMPONENT)
            missing = {(each.node, each.component) for each in listed} - members
            session.require(
                not missing, f"ReportConfiguration lacks {sorted(missing)} of ReportServices"
            )
    session.skip_unless(answered, "the target answers for neither its node nor its subsystem")


@check(
    "discovery.subsystem-list",
    "Lists the subsystems that it knows",
    "AS5710A Discovery, QuerySubsystemList, ReportSubsystemList",
)
def subsystem_list(session: Session) -> None:
    """If the target answers, the report holds its own subsystem."""
    report = session.first.asked(QuerySubsystemList(), ReportSubsystemList, attempts=1)
    session.skip_unless(report is not None, "the target does not answer for a subsystem")
    if report is not None:
        own = session.probe.target.subsystem
        session.require(
            any(each.subsystem_id == own for each in report.subsystem_list),
            f"ReportSubsystemList does not hold the target's subsystem {own}",
        )


@check(
    "discovery.inheritance",
    "Lists the services that its services inherit from",
    "AS5684, inheritance; practice: clients look for AccessControl and Management by name",
)
def inheritance(session: Session) -> None:
    """A component with a driver also provides Management, AccessControl, Events and Transport."""
    urns = {service.urn for service in session.services}
    missing = sorted(
        {
            base.urn
            for service in session.services
            for base in session.known_bases(service)
            if base.urn not in urns
        }
    )
    if missing:
        session.note(f"not listed, though inherited: {', '.join(missing)}")


def _identifies(
    scope: Scope, *judgements: Judgement[ReportIdentification], optional: bool = True
) -> Step:
    query = QueryIdentification(query_type=scope)
    expected = (has(query_type=scope), usual(type_=_TYPES[scope]), *judgements)
    return ask(A, query, ReportIdentification, *expected, optional=optional)


CHECKS = (
    Check(
        "discovery.identification",
        "Identifies itself as a component",
        "AS5710A Discovery, QueryIdentification 4, ReportIdentification",
        "The report repeats QueryType 4 and holds a type of components and a name.",
        (_identifies(Scope.COMPONENT, usual(identification=AnythingBut("")), optional=False),),
    ),
    Check(
        "discovery.scopes",
        "Answers for the scope that was asked for, or not at all",
        "AS5710A Discovery, QueryIdentification 1 to 3",
        "A report about system, subsystem or node must say so; a narrower server stays silent.",
        tuple(_identifies(each) for each in (Scope.SYSTEM, Scope.SUBSYSTEM, Scope.NODE)),
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
    services,
    services_by_id,
    services_unknown,
    service_list_agrees,
    configuration,
    subsystem_list,
    inheritance,
)


def _query(node: int, component: int) -> QueryServices:
    return QueryServices(
        node_list=[
            QueryServices.NodeSeq(
                node_rec=QueryServices.NodeRec(node_id=node),
                component_list=[QueryServices.ComponentRec(component_id=component)],
            )
        ]
    )


def _query_service_list(target: JausAddress) -> QueryServiceList:
    node = QueryServiceList.NodeSeq(
        node_rec=QueryServiceList.NodeRec(node_id=target.node),
        component_list=[QueryServiceList.ComponentRec(component_id=target.component)],
    )
    subsystem = QueryServiceList.SubsystemSeq(
        subsystem_rec=QueryServiceList.SubsystemRec(subsystem_id=target.subsystem),
        node_list=[node],
    )
    return QueryServiceList(subsystem_list=[subsystem])


def _listed(
    session: Session, node: int, component: int
) -> dict[JausAddress, tuple[ServiceIdentity, ...]]:
    report = session.first.ask(_query(node, component), ReportServices)
    return services_of(report, session.probe.target.subsystem)


def _own(session: Session, node: int, component: int) -> tuple[ServiceIdentity, ...] | None:
    return _listed(session, node, component).get(session.probe.target)


def _names(services: tuple[ServiceIdentity, ...]) -> list[tuple[str, int, int]]:
    return sorted((each.urn, each.major, each.minor) for each in services)

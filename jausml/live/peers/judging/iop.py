"""Tasks of the IOP challenge of the Intelligent Ground Vehicle Competition, 2013 to 2020.

Its tool and its table of points are not public: services and parts are as teams quote the rules,
and the points are ours.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.live.peers.conformance import codecs
from jausml.live.peers.conformance.check import step
from jausml.live.peers.conformance.run import fixed_checks
from jausml.live.peers.discovery import services_of
from jausml.live.peers.judging.competition import Competition, Task, part, task
from jausml.live.peers.judging.driving import DRIVER, Course
from jausml.live.peers.judging.igvc import lists_service, own_services, waypoint_navigation
from jausml.runtime.messages import ReportServices
from jausml.runtime.services.discovery_messages import query_all_services

if TYPE_CHECKING:
    from jausml.live.peers.conformance.session import Session

RULES = "IGVC, IOP Challenge, as quoted by teams"

PLATFORM = ("Transport", "Events", "AccessControl", "Liveness", "Discovery")
"""Services of the component for platform management."""

REPORTING = (
    *("Transport", "Events", "AccessControl", "Management", "Liveness"),
    *("LocalWaypointDriver", DRIVER, "VelocityStateSensor", "LocalPoseSensor", "PrimitiveDriver"),
)
"""Services of the component for navigation and reporting."""

_CHECKS = (
    *("liveness.pulse", "liveness.event"),
    *("events.create-periodic", "events.report", "events.update", "events.cancel"),
    *("access.request", "access.equal-authority", "access.preemption", "access.release"),
    *("management.resume", "management.standby-command", "management.resume-by-other"),
    *("management.emergency", "management.clear"),
)
"""Checks of conformance of the services that both parts of the challenge build on."""

_QUERIES = (
    ("VelocityStateSensor", "QueryVelocityState"),
    ("LocalPoseSensor", "QueryLocalPose"),
    ("PrimitiveDriver", "QueryWrenchEffort"),
    (DRIVER, "QueryActiveElement"),
)


def iop_challenge(course: Course) -> Competition:
    """Returns the tasks of the IOP challenge."""
    return Competition(
        "igvc-iop",
        "IGVC IOP Challenge",
        f"{RULES}: two components with their services, and a drive along waypoints. Its tool and "
        "table of points are not public; here each part is worth a point, and the drive 10.",
        (_platform(), _interfaces(), waypoint_navigation(course, RULES)),
        (
            "the cases and penalties of the Conformance Verification Tool, which is for members",
            "SetLocalWaypoint and SetWrenchEffort, which would move the vehicle off its course",
            "the connector and the network of the event",
        ),
    )


def _platform() -> Task:
    return task(
        "platform",
        "Platform management",
        "A component of the subsystem has the services of platform management.",
        f"{RULES}; AS5710A Discovery, QueryServices, ReportServices",
        *(part(each, 1, f"A component lists {each}")(_somebody_lists(each)) for each in PLATFORM),
    )


@step
def _somebody_lists(session: Session, name: str) -> None:
    report = session.first.ask(query_all_services(), ReportServices)
    found = services_of(report, session.probe.target.subsystem)
    session.require(
        any(each.urn.endswith(f":{name}") for services in found.values() for each in services),
        f"no component of ReportServices has {name}",
    )


def _interfaces() -> Task:
    checks = {each.id: each for each in fixed_checks()}
    return task(
        "interfaces",
        "Navigation and reporting",
        "The component has the services of navigation and reporting, and they do what their "
        "standards say.",
        f"{RULES}; AS5710A and AS6009, protocol behaviour",
        part("services", 1, "Reports its services")(own_services),
        *(part(each, 1, f"Lists {each}", "services")(lists_service(each)) for each in REPORTING),
        *(
            part(f"{service}-{query}", 1, f"Answers {query}")(_answers(service, query))
            for service, query in _QUERIES
        ),
        *(
            part(each.replace(".", "-"), 1, checks[each].title)(*checks[each].steps, _let_go)
            for each in _CHECKS
        ),
    )


@step
def _answers(session: Session, service: str, query: str) -> None:
    (entry,) = session.catalogue.find_services(service)
    codecs.answers(session, entry, session.catalogue.message(query, service))


def _let_go(session: Session) -> None:
    """What a part has left in the target does not count for the next one."""
    session.require(session.tidy(), "the target does not answer any more")

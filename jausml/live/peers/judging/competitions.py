"""The competitions by name, the run of one, and the tasks of the IOP challenge, 2013 to 2020.

The tool and the points of the IOP challenge of the Intelligent Ground Vehicle Competition are not
public: services and parts are those in quotes of the rules by teams, and the points are ours.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import replace

from jausml.live.messages import Catalogue
from jausml.live.peers.conformance import codecs
from jausml.live.peers.conformance.check import CheckResult, step
from jausml.live.peers.conformance.probe import RawEndpoint
from jausml.live.peers.conformance.run import CheckFilter, fixed_checks, known_names, opened, run
from jausml.live.peers.conformance.session import Session
from jausml.live.peers.discovery import services_of
from jausml.live.peers.judging import igvc
from jausml.live.peers.judging.competition import (
    Competition,
    Judge,
    Part,
    Score,
    Sheet,
    Task,
    part,
    task,
)
from jausml.live.peers.judging.driving import DRIVER, Course
from jausml.live.peers.judging.igvc import lists_service, own_services, waypoint_navigation
from jausml.live.peers.network import Network
from jausml.runtime.base.address import JausAddress
from jausml.runtime.clients.discovery_client import query_services
from jausml.runtime.messages import ReportServices

RULES = "IGVC, IOP Challenge, as quoted by teams"

# Services of the component for platform management.
PLATFORM = ("Transport", "Events", "AccessControl", "Liveness", "Discovery")

# Services of the component for navigation and reporting.
REPORTING = (
    *("Transport", "Events", "AccessControl", "Management", "Liveness"),
    *("LocalWaypointDriver", DRIVER, "VelocityStateSensor", "LocalPoseSensor", "PrimitiveDriver"),
)

# Conformance checks of the core services.
_CHECKS = (
    *("liveness.pulse", "liveness.event"),
    *("events.create-periodic", "events.report", "events.update", "events.cancel"),
    *("access.request", "access.equal-authority", "access.preemption", "access.release"),
    *("management.resume", "management.standby-command", "management.resume-by-other"),
    *("management.emergency", "management.clear"),
)

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
        *(
            part(service, 1, f"A component lists {service}")(_somebody_lists(service))
            for service in PLATFORM
        ),
    )


@step
def _somebody_lists(session: Session, name: str) -> None:
    report = session.first.ask(query_services(), ReportServices)
    services_by_address = services_of(report, session.probe.target.subsystem)
    session.require(
        any(
            service.urn.endswith(f":{name}")
            for services in services_by_address.values()
            for service in services
        ),
        f"no component of ReportServices has {name}",
    )


def _interfaces() -> Task:
    checks = {fixed_check.id: fixed_check for fixed_check in fixed_checks()}
    return task(
        "interfaces",
        "Navigation and reporting",
        "The component has the services of navigation and reporting, and they do what their "
        "standards say.",
        f"{RULES}; AS5710A and AS6009, protocol behaviour",
        part("services", 1, "Reports its services")(own_services),
        *(
            part(service, 1, f"Lists {service}", "services")(lists_service(service))
            for service in REPORTING
        ),
        *(
            part(f"{service}-{query}", 1, f"Answers {query}")(_answers(service, query))
            for service, query in _QUERIES
        ),
        *(
            part(check.replace(".", "-"), 1, checks[check].title)(*checks[check].steps, _let_go)
            for check in _CHECKS
        ),
    )


@step
def _answers(session: Session, service: str, query: str) -> None:
    (entry,) = session.catalogue.find_services(service)
    codecs.answers(session, entry, session.catalogue.message(query, service))


def _let_go(session: Session) -> None:
    """Resets the target after a part, so that the next one is independent."""
    session.require(session.tidy(), "the target does not answer any more")


CONFORMANCE = "conformance"

# Id of the judge by competition, where the rules fix it.
ID = {"igvc-jaus": "42.1.1", "igvc-iop": "42.1.1"}


class ConformanceJudge(Judge):
    """Judge that gives a point for each conformance check that applies to the target."""

    def __init__(self, selection: CheckFilter, on_score: Callable[[Score], None]) -> None:
        self._selection = selection
        self._groups = {
            group.name: Task(group.name, group.name, "one point for each check that applies")
            for group in selection.groups()
        }
        super().__init__(self._groups.values(), on_score)

    def run(self, session: Session) -> None:
        """Runs the checks."""
        report = run(session, self._selection.groups(), self._note)
        self.interrupted = report.interrupted

    def _note(self, result: CheckResult) -> None:
        self.note(Score(self._groups[result.check.group], Part(result.check, 1), result))


def competition(name: str, course: Course | None = None) -> Competition:
    """Returns a competition by its name."""
    return _COMPETITIONS[name](course or Course())


def _conformance(_: Course) -> Competition:
    return Competition(
        CONFORMANCE,
        "Conformance",
        "The checks of `jausml conformance`, against AS5669A, AS5710 and AS5684; each is worth a "
        "point, and those that do not apply are worth none.",
        not_covered=(
            "checks that end the component, or take minutes: jausml conformance has them",
        ),
        skips_count=False,
    )


_COMPETITIONS: dict[str, Callable[[Course], Competition]] = {
    "igvc-jaus": igvc.jaus_challenge,
    "igvc-iop": iop_challenge,
    CONFORMANCE: _conformance,
}


def task_names(name: str) -> set[str]:
    """Returns the names of the tasks and parts of a competition."""
    if name == CONFORMANCE:
        return known_names()
    tasks = competition(name).tasks
    return {competition_task.name for competition_task in tasks} | {
        part.check.id for task in tasks for part in task.parts
    }


def judged(
    network: Network,
    target: JausAddress,
    catalogue: Catalogue,
    rules: Competition,
    *,
    only: Collection[str] = (),
    on_score: Callable[[Score], None] = lambda _: None,
    timeout: float = 1.0,
    quiet: float = 0.3,
    wire: RawEndpoint | None = None,
) -> Sheet:
    """Judges the tasks of a competition with a component.

    Args:
        only: Names of tasks and parts, whose needs are judged, too; empty for all.
        timeout: Seconds to wait for an answer.
        quiet: Seconds to wait for messages that must not come.

    Raises:
        OSError: The network cannot be used.
        TargetNotReached: No message came from the target.
    """
    judge: Judge
    if rules.name == CONFORMANCE:
        judge = ConformanceJudge(CheckFilter(frozenset(only)), on_score)
    else:
        chosen = (_chosen(competition_task, only) for competition_task in rules.tasks)
        judge = Judge([chosen_task for chosen_task in chosen if chosen_task.parts], on_score)
    with opened(
        network, target, catalogue, timeout=timeout, quiet=quiet, meet=judge.meet, wire=wire
    ) as session:
        begun = next((score.result.begun for score in judge.scores), None) or session.probe.utc()
        judge.run(session)
        host, port = session.probe.endpoint or ("", 0)
        return Sheet(
            rules,
            str(target),
            f"{host}:{port}",
            begun,
            tuple(f"{service.urn} {service.major}.{service.minor}" for service in session.services),
            judge.in_order(),
            judge.interrupted,
        )


def _chosen(task: Task, only: Collection[str]) -> Task:
    if not only or task.name in only:
        return task
    names = {task_part.name for task_part in task.parts if task_part.check.id in only}
    for task_part in reversed(task.parts):
        names |= set(task_part.needs) if task_part.name in names else set()
    return replace(
        task, parts=tuple(task_part for task_part in task.parts if task_part.name in names)
    )

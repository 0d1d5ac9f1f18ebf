"""Run of groups of checks against one target: first contact, checks, the target as it was found."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass, replace
from functools import partial

from jausml.live.messages import Catalogue
from jausml.live.messages.values import listed
from jausml.live.peers.conformance import (
    access,
    codecs,
    discovery,
    events,
    lists,
    management,
    transport,
)
from jausml.live.peers.conformance.check import Check, CheckResult, ConformanceReport
from jausml.live.peers.conformance.evidence import (
    CheckFailed,
    CheckSkipped,
    Trace,
    Verdict,
    describe,
)
from jausml.live.peers.conformance.probe import Probe, RawEndpoint
from jausml.live.peers.conformance.session import PINGS, Limits, Session
from jausml.live.peers.discovery import services_of
from jausml.live.peers.network import Network
from jausml.runtime.base.address import WILDCARD_COMPONENT, WILDCARD_NODE, JausAddress
from jausml.runtime.clients.discovery_client import query_services
from jausml.runtime.messages import ReportServices
from jausml.runtime.services.definitions import ServiceIdentity
from jausml.runtime.wire.message import DecodeError, Message


@dataclass(frozen=True, slots=True)
class CheckGroup:
    """Checks of one topic, by the first part of their ids."""

    name: str
    requires: Callable[[Session], str]
    checks: Callable[[Session], tuple[Check, ...]]


def _of_service(name: str) -> Callable[[Session], str]:
    return partial(Session.missing, name=name)


_FIXED: tuple[tuple[str, Callable[[Session], str], tuple[Check, ...]], ...] = (
    ("transport", transport.requires, transport.CHECKS),
    ("discovery", _of_service("Discovery"), discovery.CHECKS),
    ("liveness", _of_service("Liveness"), lists.LIVENESS),
    ("time", _of_service("Time"), lists.TIME_CHECKS),
    ("events", _of_service("Events"), events.CHECKS),
    ("access", access.requires, access.CHECKS),
    ("management", management.requires, management.CHECKS),
    ("list", _of_service("ListManager"), lists.CHECKS),
)
"""Groups whose checks do not depend on what a target announces."""


def all_groups() -> tuple[CheckGroup, ...]:
    """Returns the groups in the order in which they run."""
    fixed = (CheckGroup(name, requires, _always(checks)) for name, requires, checks in _FIXED)
    return (*fixed, CheckGroup("codecs", codecs.requires, codecs.checks))


def _always(checks: tuple[Check, ...]) -> Callable[[Session], tuple[Check, ...]]:
    return lambda _: checks


def fixed_checks() -> tuple[Check, ...]:
    """Returns the checks that do not depend on what a target announces."""
    return tuple(check for _, _, checks in _FIXED for check in checks)


@dataclass(frozen=True, slots=True)
class CheckFilter:
    """The choice of checks by their ids, or by their groups.

    Attributes:
        only: Ids and groups; all are meant when it is empty.
    """

    only: frozenset[str] = frozenset()
    skip: frozenset[str] = frozenset()

    def groups(self) -> tuple[CheckGroup, ...]:
        """Returns the groups with chosen checks, which have no others."""
        return tuple(
            replace(group, checks=partial(self._chosen, group))
            for group in all_groups()
            if self._may_have(group.name)
        )

    def takes(self, check_id: str) -> bool:
        """Whether a check is chosen."""
        names = {check_id, check_id.partition(".")[0]}
        return not names & self.skip and (not self.only or bool(names & self.only))

    def _may_have(self, group: str) -> bool:
        wanted = {name.partition(".")[0] for name in self.only}
        return group not in self.skip and (not wanted or group in wanted)

    def _chosen(self, group: CheckGroup, session: Session) -> tuple[Check, ...]:
        return tuple(check for check in group.checks(session) if self.takes(check.id))


def unknown(names: Iterable[str]) -> list[str]:
    """Returns names that neither a group nor a check has; those of codecs depend on a target."""
    known = known_names()
    return [name for name in names if name not in known and not name.startswith("codecs.")]


def known_names() -> set[str]:
    """Returns the names of groups and the ids of checks that do not depend on a target."""
    return {group.name for group in all_groups()} | {check.id for check in fixed_checks()}


_GONE = "the target does not answer any more"


class TargetNotReached(Exception):  # noqa: N818 - an outcome of the network, not a fault of ours
    """The target does not answer at all."""


@contextmanager
def opened(
    network: Network,
    target: JausAddress,
    catalogue: Catalogue,
    *,
    limits: Limits | None = None,
    timeout: float = 1.0,
    quiet: float = 0.3,
    meet: Callable[[Session], bool] | None = None,
    wire: RawEndpoint | None = None,
) -> Iterator[Session]:
    """Finds the target and yields the session with it; undoes all effects at the end.

    Args:
        meet: Takes the session before anything is sent, and says whether the target was heard; it
            is looked for unless it was.
        wire: What carries the datagrams and tells the time; sockets by default.

    Raises:
        OSError: The network cannot be used as the settings say.
        TargetNotReached: Nothing came from the target.
    """
    with ExitStack() as stack:
        carrier = wire or stack.enter_context(closing(RawEndpoint(network.settings)))
        trace = Trace(lambda payload: describe(payload, catalogue), carrier.now)
        known = network.settings.address_book.get(target)
        probe = Probe(
            carrier, target, network.own, trace, timeout=timeout, quiet=quiet, known=known
        )
        session = Session(probe, trace, limits or Limits(), catalogue)
        if not (meet is not None and meet(session)) and not probe.find_target():
            raise TargetNotReached(f"{target} does not answer; {_why(probe, network)}")
        session.services = _announced(session)
        session.ping = _answered_query(session)
        try:
            yield session
        finally:
            session.undo()


def _why(probe: Probe, network: Network) -> str:
    if probe.others:
        others = listed([str(other) for other in sorted(probe.others)])
        return f"nothing came from it, but from {others}: check the id and that it runs"
    return f"nothing at all was heard; {network.hints()}"


def _announced(session: Session) -> Sequence[ServiceIdentity]:
    """Returns the services that the target, or the Discovery server of its subsystem, lists."""
    target = session.probe.target
    report = session.tried(query_services(), ReportServices, attempts=2)
    if report is not None:
        own = services_of(report, target.subsystem).get(target)
        if own:
            return own
    query = query_services().encode()
    everyone = JausAddress(target.subsystem, WILDCARD_NODE, WILDCARD_COMPONENT)
    for server, endpoint in session.probe.servers(everyone).items():
        payload = session.probe.ask_bystander(server, endpoint, query)
        if payload is None:
            continue
        try:
            services = services_of(ReportServices.decode(payload), target.subsystem)
        except DecodeError:
            continue
        if target in services:
            return services[target]
    return ()


def _answered_query(session: Session) -> tuple[Message, type[Message]]:
    for query, report_class in PINGS:
        if session.tried(query, report_class) is not None:
            return query, report_class
    return PINGS[0]


def begun(session: Session) -> ConformanceReport:
    """Returns the report of a run in which nothing was checked yet."""
    host, port = session.probe.endpoint or ("", 0)
    services = (f"{service.urn} {service.major}.{service.minor}" for service in session.services)
    return ConformanceReport(str(session.probe.target), f"{host}:{port}", tuple(services), ())


def run(
    session: Session, groups: Sequence[CheckGroup], on_result: Callable[[CheckResult], None]
) -> ConformanceReport:
    """Runs all checks of the groups.

    Control, emergencies and events that are left are undone after each check, also when the run is
    interrupted from the keyboard.

    Args:
        groups: What to check, in this order; destructive checks come after all others.

    Returns:
        The report; of an interrupted run what there is.
    """
    results: list[CheckResult] = []
    interrupted = False
    try:
        for result in _results(session, groups):
            results.append(result)
            on_result(result)
    except KeyboardInterrupt:
        interrupted = True
        session.tidy()
    return replace(begun(session), results=tuple(results), interrupted=interrupted)


def _results(session: Session, groups: Sequence[CheckGroup]) -> Iterator[CheckResult]:
    """Yields the results: of all checks that a target survives, then of risky ones, then the end.

    A target that fell silent is looked for again at the beginning of each group, and before each
    check that is left for the end.
    """
    later: list[tuple[Check, str]] = []
    gone = False
    for group in groups:
        checks = group.checks(session)
        gone = gone and not _comes_back(session, session.probe.timeout)
        obstacle = _GONE if gone else ""
        if not gone and checks:
            obstacle, failure = _obstacle(session, group, checks[0])
            if failure is not None:
                checks = checks[1:]
                yield failure
        for check in checks:
            if check.destructive or check.risky:
                later.append((check, obstacle))
                continue
            result = _result(session, check, _GONE if gone else obstacle)
            if result.left_silent:
                gone = not _comes_back(session, session.limits.restart)
            yield result
    for check, obstacle in sorted(later, key=lambda pair: pair[0].destructive):
        allowed = session.limits.destructive or not check.destructive
        reason = obstacle or ("" if allowed else "ends the target; --destructive runs it")
        if gone and not reason:
            gone = not _comes_back(session, session.probe.timeout)
        result = _result(session, check, reason or (_GONE if gone else ""))
        if result.left_silent:
            gone = not _comes_back(session, session.limits.restart)
        yield result


def _obstacle(session: Session, group: CheckGroup, first: Check) -> tuple[str, CheckResult | None]:
    """Returns why a group cannot run, and its first check as failed if the target is to blame."""
    session.begin()
    try:
        return group.requires(session), None
    except CheckSkipped as reason:
        return str(reason), None
    except CheckFailed as failure:
        result = CheckResult(first, Verdict.FAIL, (str(failure),), session.trace.lines)
        return f"the group could not begin; see {first.id}", result
    finally:
        session.undo()


def _result(session: Session, check: Check, obstacle: str) -> CheckResult:
    if obstacle:
        return CheckResult(check, Verdict.SKIPPED, (obstacle,))
    result = outcome(session, check)
    if session.tidy() or check.destructive:
        return result
    if result.verdict is Verdict.FAIL:
        return replace(result, left_silent=True)
    gone = f"{_GONE} after this check"
    return replace(
        result,
        verdict=Verdict.FAIL,
        messages=(gone,),
        evidence=session.trace.lines,
        left_silent=True,
    )


def outcome(session: Session, check: Check) -> CheckResult:
    """Runs a check, and leaves the target as it is then."""
    session.begin()
    begun, begin = session.probe.utc(), session.probe.now()
    try:
        check.run(session)
    except CheckFailed as failure:
        verdict, messages = Verdict.FAIL, (str(failure), *session.notes)
    except CheckSkipped as reason:
        verdict, messages = Verdict.SKIPPED, (str(reason),)
    else:
        verdict = Verdict.NOTE if session.notes else Verdict.PASS
        messages = tuple(session.notes)
    seconds = session.probe.now() - begin
    return CheckResult(check, verdict, messages, session.trace.lines, seconds, begun=begun)


def _comes_back(session: Session, seconds: float) -> bool:
    """Whether the target answers after all; it may have been restarted."""
    end = session.probe.now() + seconds
    while True:
        if session.probe.find_target() and session.answers():
            return True
        if session.probe.now() >= end:
            return False

"""Checks of conformance: what is sent, what must come back within a time, and how it must be.

What a step needs and depends on the target is a function of the session.
"""

from __future__ import annotations

from collections.abc import Callable, Container
from dataclasses import dataclass, field
from enum import Enum
from functools import wraps
from typing import TYPE_CHECKING, Concatenate, ParamSpec, TypeVar

from jausml.live.peers.conformance.evidence import CheckFailed, CheckSkipped, Verdict
from jausml.live.peers.conformance.session import Session
from jausml.runtime.transports.packets.packet import Priority
from jausml.runtime.wire.message import Message

if TYPE_CHECKING:
    from collections.abc import Iterator
    from datetime import datetime

    from jausml.live.peers.conformance.evidence import TraceLine


P = ParamSpec("P")

Step = Callable[["Session"], None]
"""A part of a check: returns when all is well; raises CheckFailed or CheckSkipped otherwise."""


@dataclass(frozen=True, slots=True)
class Check:
    """One check with a stable id: what is sent and what must come back, step by step.

    Attributes:
        id: Group and name, e.g. `access.equal-authority`; an id is never used for another check.
        destructive: Whether the target cannot go on afterwards; such checks run last, if at all.
        risky: Whether a target that is not robust may not survive it; such checks run after all
            others that leave the target alive.
    """

    id: str
    title: str
    source: str
    explanation: str
    steps: tuple[Step, ...]
    destructive: bool = False
    risky: bool = False

    @property
    def group(self) -> str:
        """The part of the id before the first dot."""
        return self.id.partition(".")[0]

    def run(self, session: Session) -> None:
        """Takes the steps; the first that raises CheckFailed or CheckSkipped ends the check."""
        for check_step in self.steps:
            check_step(session)


def step(function: Callable[Concatenate[Session, P], object]) -> Callable[P, Step]:
    """Makes a function of the session and more a kind of step, which checks declare with the rest.

    The first argument of most kinds is the number of the client that acts.
    """

    @wraps(function)
    def declare(*args: P.args, **kwargs: P.kwargs) -> Step:
        def run(session: Session) -> None:
            function(session, *args, **kwargs)

        return run

    return declare


@dataclass(frozen=True, slots=True)
class CheckResult:
    """The outcome of one check.

    Attributes:
        begun: Time of day at which it began, by which a recording of the run is compared.
    """

    check: Check
    verdict: Verdict
    messages: tuple[str, ...] = ()
    evidence: tuple[TraceLine, ...] = ()
    seconds: float = 0.0
    left_silent: bool = False
    begun: datetime | None = None


@dataclass(frozen=True, slots=True)
class ConformanceReport:
    """The outcome of a run."""

    target: str
    endpoint: str
    services: tuple[str, ...]
    results: tuple[CheckResult, ...] = field(default=())
    interrupted: bool = False

    def count(self, verdict: Verdict) -> int:
        """Returns how many checks ended so."""
        return sum(result.verdict is verdict for result in self.results)

    @property
    def passed(self) -> bool:
        """Whether nothing failed."""
        return self.count(Verdict.FAIL) == 0


T = TypeVar("T")
M = TypeVar("M", bound=Message)

A, B, C = 0, 1, 2
"""Our clients."""

Judgement = Callable[[Session, T, str], None]
"""Judges what came, which has a name; raises CheckFailed or notes what is not as it should be."""

take = step(Session.take)
ready = step(Session.make_ready)
needs = step(Session.authority)
quiet = step(Session.pause)


# -- what the target, or the run, must offer -------------------------------------------------------


@step
def since_1_1(session: Session, service: str, reason: str) -> None:
    """Skips the check where a core service is older than AS5710A."""
    session.skip_unless(not session.is_v1_0(service), reason)


@step
def only_in_1_1(session: Session, service: str, further: Step) -> None:
    """Takes a step unless a core service is older than AS5710A."""
    if not session.is_v1_0(service):
        further(session)


@step
def serves(session: Session, service: str) -> None:
    """Skips the check where the target answers nothing of a core service."""
    session.skip_unless(session.serves(service), f"the target answers nothing of {service}")


@step
def provides(session: Session, service: str, reason: str) -> None:
    """Skips the check where the target does not have a core service."""
    session.skip_unless(session.provides(service), reason)


@step
def slow(session: Session, what: str) -> None:
    """Skips the check unless slow ones are wanted."""
    session.skip_unless(session.limits.slow, f"takes {what}; --slow waits for them")


# -- how a check may end ---------------------------------------------------------------------------


@step
def skips(session: Session, why: str) -> None:
    """Ends the check as skipped."""
    session.skip_unless(holds=False, reason=why)


@step
def notes(session: Session, what: str) -> None:
    """Notes what is not as it should be."""
    session.note(what)


def passes(_: Session) -> None:
    """Takes it as it is."""


@step
def any_of(session: Session, why: str, *steps: Step) -> None:
    """Takes steps of which some may be skipped; the check is, where all are."""
    taken = 0
    for check_step in steps:
        try:
            check_step(session)
        except CheckSkipped:
            continue
        taken += 1
    session.skip_unless(bool(taken), why)


# -- how what came must be -------------------------------------------------------------------------


@dataclass(frozen=True)
class AnythingBut(Container[object]):
    """All values but one."""

    value: object

    def __contains__(self, value: object) -> bool:
        """Whether it is another one."""
        return value != self.value


def has(**fields: object) -> Judgement[object]:
    """Fails unless the fields have these values, or one of a range or tuple."""

    def judge(session: Session, message: object, what: str) -> None:
        for difference in _differences(session, message, what, fields):
            raise CheckFailed(difference)

    return judge


def usual(**fields: object) -> Judgement[object]:
    """Like `has`, but what the standard leaves open is noted."""

    def judge(session: Session, message: object, what: str) -> None:
        for difference in _differences(session, message, what, fields):
            session.note(difference)

    return judge


def _differences(
    session: Session, message: object, what: str, fields: dict[str, object]
) -> Iterator[str]:
    for name, wanted in fields.items():
        expected = wanted(session) if callable(wanted) else wanted
        value = getattr(message, name)
        choice = expected if isinstance(expected, (range, tuple, AnythingBut)) else (expected,)
        if value not in choice:
            yield f"{what} has {name} {value!r} instead of {_words(expected)}"


def _words(expected: object) -> str:
    match expected:
        case range():
            return f"{expected.start} to {expected.stop - 1}"
        case tuple():
            return " or ".join(map(str, expected))
        case AnythingBut(value):
            return f"anything but {value!r}"
        case Enum():
            return f"{expected.value} ({expected.name})"
        case _:
            return repr(expected)


# -- messages --------------------------------------------------------------------------------------

Sent = Message | Callable[[Session], Message]


@step
def send(
    session: Session, client: int, message: Sent, priority: Priority = Priority.STANDARD
) -> None:
    """A client sends a message, which is the latest one from now on."""
    session.send(client, message if isinstance(message, Message) else message(session), priority)


@step
def put(
    session: Session, client: int, what: str, payload: bytes | Callable[[Session], bytes]
) -> None:
    """A client sends a payload as it is."""
    test_client = session.client(client)
    session.latest = f"{what} of {test_client.address}"
    test_client.put(test_client.packet(payload if isinstance(payload, bytes) else payload(session)))


@step
def ask(
    session: Session,
    client: int,
    query: Sent,
    kind: type[M],
    *judgements: Judgement[M],
    unanswered: Step | None = None,
) -> None:
    """A query is answered with a report that is as it should be; `unanswered` says if it may not.

    A query that need not be answered is asked once.
    """
    message = query if isinstance(query, Message) else query(session)
    report = session.client(client).asked(message, kind, attempts=1 if unanswered else 3)
    if report is None:
        if unanswered is None:
            raise CheckFailed(f"{message.NAME} is not answered with {kind.NAME}")
        unanswered(session)
        return
    for judge in judgements:
        judge(session, report, f"{kind.NAME} after {message.NAME}")


@step
def expect(
    session: Session,
    client: int,
    kind: type[M],
    *judgements: Judgement[M],
    within: float | None = None,
    unless: Callable[[Session], str] | None = None,
) -> None:
    """A client is sent a message that is as it should be; `unless` says why it need not come."""
    message = session.client(client).find(kind, within=within)
    excuse = "" if message is not None or unless is None else unless(session)
    if excuse:
        session.note(excuse)
    elif message is None:
        raise CheckFailed(f"no {kind.NAME} came after {session.latest}")
    else:
        for judge in judgements:
            judge(session, message, f"{kind.NAME} after {session.latest}")


@step
def expect_none(
    session: Session,
    client: int,
    kind: type[Message],
    why: str,
    *,
    within: float | None = None,
    tolerated: bool = False,
) -> None:
    """A client is sent no such message within the quiet time; one may be tolerated and noted."""
    seconds = session.probe.quiet if within is None else within
    if session.client(client).find(kind, within=seconds) is not None:
        _deviates(session, f"{kind.NAME} came, but {why}", tolerated)


@step
def silence(session: Session, client: int, why: str, *, tolerated: bool = False) -> None:
    """A client is sent nothing for the quiet time; an answer may be tolerated and noted."""
    test_client = session.client(client)
    if session.probe.wait(lambda: bool(test_client.inbox), session.probe.quiet):
        _deviates(session, f"message {test_client.inbox[0].code:04X} came, but {why}", tolerated)


def _deviates(session: Session, text: str, tolerated: bool) -> None:  # noqa: FBT001
    session.require(tolerated, text)
    session.note(text)


@step
def settle(session: Session, client: int) -> None:
    """What comes to a client in the quiet time does not count."""
    session.pause()
    session.client(client).clear()

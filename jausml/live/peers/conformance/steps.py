"""Steps of checks: what the target must offer, what is sent, and what must come back."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import TypeVar

from jausml.live.peers.conformance.check import Step, step
from jausml.live.peers.conformance.evidence import CheckFailed, CheckSkipped
from jausml.live.peers.conformance.session import Session
from jausml.runtime.transports.packets.packet import Priority
from jausml.runtime.wire.message import Message

T = TypeVar("T")
M = TypeVar("M", bound=Message)

A, B, C = 0, 1, 2
"""Numbers of our three clients."""

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
    """Accepts that no answer comes."""


@step
def any_of(session: Session, why: str, *steps: Step) -> None:
    """Takes several steps; skips the check only if all of them are skipped."""
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
        """Whether it is another value."""
        return value != self.value


def has(**fields: object) -> Judgement[object]:
    """Fails unless the fields have these values, or one of a range or tuple."""

    def judge(session: Session, message: object, what: str) -> None:
        difference = next(_differences(session, message, what, fields), None)
        if difference is not None:
            raise CheckFailed(difference)

    return judge


def should_have(**fields: object) -> Judgement[object]:
    """Like `has`, but only notes the difference: the standard leaves it open."""

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
    _judge(session, report, judgements, message.NAME)


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
        _judge(session, message, judgements, session.latest)


def _judge(session: Session, message: M, judgements: Sequence[Judgement[M]], after: str) -> None:
    for judgement in judgements:
        judgement(session, message, f"{message.NAME} after {after}")


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
    """Messages to a client in the quiet time do not count."""
    session.pause()
    session.client(client).clear()

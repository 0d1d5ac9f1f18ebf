"""Steps of the checks of Events, and what several of these checks ask and compare."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import TypeAlias

from jausml.live.peers.conformance.check import Step, step
from jausml.live.peers.conformance.client import Client, decoded
from jausml.live.peers.conformance.evidence import CheckFailed, CheckSkipped
from jausml.live.peers.conformance.session import Session
from jausml.live.peers.conformance.steps import A, B, Judgement, expect, expect_none, has, send
from jausml.runtime import messages as core
from jausml.runtime.wire.message import Message

Record: TypeAlias = "core.ReportEvents.ReportEventRec"

PERIODIC = core.CreateEvent.EventType.PERIODIC_SC

RATE = 10.0
"""Rate in Hz that the checks ask for."""

SOME_PERIODS = 3 / RATE
FREE_EVENT = 254
UNKNOWN_QUERY = b"\xb7\x7a"

_CANDIDATES: tuple[tuple[str, Message, type[Message]], ...] = (
    ("Management", core.QueryStatus(), core.ReportStatus),
    ("AccessControl", core.QueryControl(), core.ReportControl),
    ("AccessControl", core.QueryAuthority(), core.ReportAuthority),
    ("Liveness", core.QueryHeartbeatPulse(), core.ReportHeartbeatPulse),
)

# -- requests --------------------------------------------------------------------------------------


def subject(session: Session) -> tuple[Message, type[Message]]:
    """Returns a query that the target answers, and its report."""
    for service, query, report_class in _CANDIDATES:
        if session.provides(service):
            return query, report_class
    session.skip_unless(holds=False, reason="the target has no core query to make an event of")
    raise AssertionError  # skip_unless has raised


def creating(hertz: float, query: Message | None = None) -> Callable[[Session], core.CreateEvent]:
    """Returns the function that makes the request for a periodic event."""
    return lambda session: core.CreateEvent(
        1, PERIODIC, hertz, (query or subject(session)[0]).encode()
    )


def damaged(damage: Callable[[bytes], bytes]) -> Callable[[Session], bytes]:
    """Returns the function that makes the payload of such a request with other bytes."""
    return lambda session: damage(creating(RATE)(session).encode())


def updating(hertz: float, number: int | None = None) -> Callable[[Session], core.UpdateEvent]:
    """Returns the function that requests another rate of the event of our first client."""
    return lambda session: core.UpdateEvent(
        2, PERIODIC, hertz, number or event_id(session), subject(session)[0].encode()
    )


def cancelling(session: Session) -> core.CancelEvent:
    """Returns the request for the end of the event of our first client."""
    return core.CancelEvent(3, event_id(session))


def event_id(session: Session) -> int:
    """The id of the event of our first client."""
    return session.first.event.event_id


def next_event(client: Client) -> core.Event:
    """Returns the next report of the event of a client."""
    own = client.event.event_id
    return client.expect(
        core.Event, f"the confirmation of event {own}", lambda event: event.event_id == own
    )


# -- steps -----------------------------------------------------------------------------------------


@step
def created(
    session: Session,
    client: int,
    *judgements: Judgement[core.ConfirmEventRequest],
    query: Message | None = None,
    rate: float = RATE,
) -> None:
    """A client asks for a periodic event, and is told that it has it."""

    def keep(session: Session, confirmation: core.ConfirmEventRequest, _: str) -> None:
        session.client(client).event = confirmation

    send(client, creating(rate, query))(session)
    expect(client, core.ConfirmEventRequest, has(request_id=1), keep, *judgements)(session)


@step
def periodic(session: Session, client: int) -> None:
    """A client has a periodic event; the check is skipped where it is given none."""
    try:
        created(client)(session)
    except CheckFailed as failure:
        raise CheckSkipped(f"{failure}; see events.create-periodic") from failure


@step
def carries(session: Session, client: int, kind: type[Message] | None = None) -> None:
    """The event of a client carries the whole report that answers its query."""
    test_client = session.client(client)
    report_class = kind or subject(session)[1]
    payload = next_event(test_client).report_message
    code = int.from_bytes(payload[:2], "little")
    session.require(
        code == report_class.CODE,
        f"the event carries message {code:04X} instead of {report_class.CODE:04X} "
        f"({report_class.NAME})",
    )
    decoded(report_class, payload)


@step
def numbered(session: Session, client: int, count: int) -> None:
    """Reports of the event of a client come, and have consecutive numbers."""
    test_client = session.client(client)
    numbers = [next_event(test_client).sequence_number for _ in range(count)]
    session.require(
        all((after - before) & 0xFF == 1 for before, after in itertools.pairwise(numbers)),
        f"the sequence numbers of an event are {numbers[:20]}",
    )


def confirmed(request: int) -> Step:
    """A request for the event of our first client is confirmed under the id of the event."""
    return expect(A, core.ConfirmEventRequest, has(request_id=request, event_id=event_id))


def rejected(request: int, *codes: int) -> Step:
    """A request of our first client is rejected, with one of the codes if any."""
    some = {"response_code": (*codes, None)} if codes else {}
    return expect(A, core.RejectEventRequest, has(request_id=request, **some))


def unconfirmed(client: int) -> Step:
    """The request of a client is rejected, or not answered."""
    return expect_none(client, core.ConfirmEventRequest, "no such event can be served")


def ended(client: int) -> Step:
    """No report comes to a client any more."""
    return expect_none(client, core.Event, "the event is no more", within=SOME_PERIODS)


@step
def listed(session: Session, choice: Callable[[Session], core.QueryEvents.QueryEventsVar]) -> None:
    """ReportEvents of a choice holds the event of our first client, and only what was chosen."""
    chosen, own = choice(session), event_id(session)
    events = session.client(B).ask(core.QueryEvents(chosen), core.ReportEvents).event_list
    wanted = (own, PERIODIC, subject(session)[0].encode())
    session.require(
        any((event.event_id, event.event_type, event.query_message) == wanted for event in events),
        f"ReportEvents does not hold event {own} with its type and query",
    )
    others = [event.event_id for event in events if not _is_chosen(chosen, event)]
    session.require(not others, f"ReportEvents holds events that were not asked for: {others}")


def _is_chosen(choice: core.QueryEvents.QueryEventsVar, event: Record) -> bool:
    match choice:
        case core.QueryEvents.MessageIDRec(code):
            return int.from_bytes(event.query_message[:2], "little") == code
        case core.QueryEvents.EventTypeRec(kind):
            return event.event_type == kind
        case core.QueryEvents.EventIDRec(number):
            return event.event_id == number
        case _:
            return True

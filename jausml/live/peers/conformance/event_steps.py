"""Steps of the checks of Events, and what several of these checks ask and compare."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

from jausml.live.peers.conformance.check import step
from jausml.live.peers.conformance.evidence import CheckFailed
from jausml.runtime import messages as core

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.live.peers.conformance.client import Client
    from jausml.live.peers.conformance.session import Session
    from jausml.runtime.wire.message import Message

    Record = core.ReportEvents.ReportEventRec
    Request = core.CreateEvent | core.UpdateEvent | core.CancelEvent | core.CreateCommandEvent
    Answer = core.ConfirmEventRequest | core.RejectEventRequest

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


def creating(session: Session, hertz: float = RATE) -> core.CreateEvent:
    """Returns the request for a periodic event."""
    return core.CreateEvent(1, PERIODIC, hertz, subject(session)[0].encode())


def updating(session: Session, hertz: float, event_id: int) -> core.UpdateEvent:
    """Returns the request for another rate of an event."""
    return core.UpdateEvent(2, PERIODIC, hertz, event_id, subject(session)[0].encode())


def begin_periodic(session: Session, client: Client) -> int:
    """Creates a periodic event as a step before what is to be checked, and returns its id."""
    query, _ = subject(session)
    answer = client.create_event(query, rate=RATE)
    session.skip_unless(
        isinstance(answer, core.ConfirmEventRequest),
        f"no periodic event on {query.NAME} is confirmed; see events.create-periodic",
    )
    client.event = answer.event_id if isinstance(answer, core.ConfirmEventRequest) else 0
    return client.event


# -- answers ---------------------------------------------------------------------------------------


def require_confirmed(answer: Answer, what: str) -> core.ConfirmEventRequest:
    """Returns the confirmation that an answer is."""
    if isinstance(answer, core.RejectEventRequest):
        text = f": {answer.error_message}" if answer.error_message else ""
        raise CheckFailed(f"{what} is rejected with code {answer.response_code}{text}")
    return answer


def require_rejected(session: Session, answer: Answer, code: int | None, what: str) -> None:
    """Fails unless an answer is a rejection, with a code if one is expected."""
    if isinstance(answer, core.ConfirmEventRequest):
        raise CheckFailed(f"{what} is confirmed")
    if answer.response_code is None:
        session.note("the rejection has no response code, which the standard leaves open")
    elif code is not None and answer.response_code != code:
        raise CheckFailed(f"{what} is rejected with code {answer.response_code} instead of {code}")


def next_event(client: Client, event_id: int) -> core.Event:
    """Returns the next report of an event."""
    return client.expect(
        core.Event,
        f"the confirmation of event {event_id}",
        lambda event: event.event_id == event_id,
    )


def require_consecutive(session: Session, client: Client, event_id: int, count: int) -> None:
    """Fails unless the next reports of an event have consecutive numbers."""
    numbers = [next_event(client, event_id).sequence_number for _ in range(count)]
    session.require(
        all((after - before) & 0xFF == 1 for before, after in itertools.pairwise(numbers)),
        f"the sequence numbers of an event are {numbers[:20]}",
    )


def require_listed(
    session: Session, event_id: int, choice: core.QueryEvents.QueryEventsVar
) -> list[Record]:
    """Returns the events of a choice, of which a periodic one of ours must be one."""
    found = list(session.second.ask(core.QueryEvents(choice), core.ReportEvents).event_list)
    payload = subject(session)[0].encode()
    session.require(
        any(
            (each.event_id, each.event_type, each.query_message) == (event_id, PERIODIC, payload)
            for each in found
        ),
        f"ReportEvents does not hold event {event_id} with its type and query",
    )
    return found


# -- steps -----------------------------------------------------------------------------------------


@step
def periodic(session: Session, client: int) -> None:
    """A client has a periodic event."""
    begin_periodic(session, session.client(client))


@step
def numbered(session: Session, client: int, count: int) -> None:
    """Reports of the event of a client come, and have consecutive numbers."""
    found = session.client(client)
    require_consecutive(session, found, found.event, count)


@step
def confirmed(session: Session, client: int, request: Callable[[Session, int], Request]) -> None:
    """A request for the event of a client is confirmed under the id of the event."""
    asking = session.client(client)
    message = request(session, asking.event)
    asking.send(message)
    answer = asking.event_answer(message.request_id, message.NAME)
    found = require_confirmed(answer, message.NAME).event_id
    session.require(
        found == asking.event,
        f"{message.NAME} of event {asking.event} is confirmed for event {found}",
    )
    asking.clear()


@step
def ended(session: Session, client: int) -> None:
    """No report of the event of a client comes any more."""
    found = session.client(client)
    found.cancelled(found.event)
    found.expect_none(core.Event, f"event {found.event} is cancelled", within=SOME_PERIODS)


@step
def refused(
    session: Session, what: str, request: Callable[[Session], Request], code: int | None = None
) -> None:
    """A request is rejected, with a code if one is expected."""
    message = request(session)
    session.first.send(message)
    answer = session.first.event_answer(message.request_id, what)
    require_rejected(session, answer, code, what)


@step
def damaged(session: Session, what: str, damage: Callable[[bytes], bytes]) -> None:
    """A request for an event with other bytes is not confirmed; silence is noted."""
    session.first.put(session.first.packet(damage(creating(session).encode())))
    try:
        answer = session.first.event_answer(1, what)
    except CheckFailed:
        session.note(f"{what} is not answered")
        return
    require_rejected(session, answer, None, what)


@step
def listed(session: Session, choice: Callable[[Session], core.QueryEvents.QueryEventsVar]) -> None:
    """ReportEvents of a choice holds the event of our first client, and only what was chosen."""
    chosen = choice(session)
    found = require_listed(session, session.first.event, chosen)
    others = [each.event_id for each in found if not _is_chosen(chosen, each)]
    session.require(not others, f"ReportEvents holds events that were not asked for: {others}")


def _is_chosen(choice: core.QueryEvents.QueryEventsVar, event: Record) -> bool:
    match choice:
        case core.QueryEvents.MessageIDRec(code):
            return int.from_bytes(event.query_message[:2], "little") == code
        case core.QueryEvents.EventTypeRec(kind):
            return event.event_type == kind
        case _:
            return True

"""Checks of Events: reports at a rate and at every change (AS5710A, protocol behaviour)."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

from jausml.live.peers.conformance.check import check
from jausml.live.peers.conformance.client import decoded
from jausml.live.peers.conformance.evidence import CheckFailed
from jausml.live.peers.conformance.session import Authority
from jausml.runtime.messages import (
    CancelEvent,
    ConfirmEventRequest,
    CreateCommandEvent,
    CreateEvent,
    Event,
    QueryAuthority,
    QueryControl,
    QueryEvents,
    QueryEventTimeout,
    QueryHeartbeatPulse,
    QueryStatus,
    RejectEventRequest,
    ReleaseControl,
    ReportAuthority,
    ReportControl,
    ReportEvents,
    ReportEventTimeout,
    ReportHeartbeatPulse,
    ReportStatus,
    RequestControl,
    UpdateEvent,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.live.peers.conformance.client import Client, ReceivedMessage
    from jausml.live.peers.conformance.session import Session
    from jausml.runtime.wire.message import Message

PERIODIC = CreateEvent.EventType.PERIODIC_SC
EVERY_CHANGE = CreateEvent.EventType.EVERY_CHANGE
RejectCode = RejectEventRequest.ResponseCode

RATE = 10.0
"""Rate in Hz that the checks ask for."""

_CANDIDATES: tuple[tuple[str, Message, type[Message]], ...] = (
    ("Management", QueryStatus(), ReportStatus),
    ("AccessControl", QueryControl(), ReportControl),
    ("AccessControl", QueryAuthority(), ReportAuthority),
    ("Liveness", QueryHeartbeatPulse(), ReportHeartbeatPulse),
)
_SOME_PERIODS = 3 / RATE
_FREE_EVENT = 254
_UNKNOWN_QUERY = b"\xb7\x7a"
_QUERY_OFFSET = 6
"""Bytes of a CreateEvent before the count of its QueryMessage."""


@check(
    "events.create-periodic",
    "Confirms a periodic event",
    "AS5710A Events, CreateEvent, ConfirmEventRequest",
)
def create_periodic(session: Session) -> None:
    """CreateEvent at 10 Hz is confirmed under its request id, with a rate above 0."""
    query, _ = _subject(session)
    answer = session.first.create_event(query, rate=RATE, request_id=17)
    confirmed = _confirmed(answer, f"CreateEvent for {query.NAME} at {RATE:g} Hz")
    session.require(confirmed.confirmed_periodic_rate > 0, "the confirmed rate is 0 Hz")
    if abs(confirmed.confirmed_periodic_rate - RATE) > 0.1:
        session.note(f"{confirmed.confirmed_periodic_rate:.3g} Hz confirmed instead of {RATE:g} Hz")


@check(
    "events.confirm-first",
    "Confirms an event before its first report",
    "AS5710A Events, CreateEvent; practice: clients drop events that they do not know",
)
def confirm_first(session: Session) -> None:
    """ConfirmEventRequest arrives before any Event."""
    query, _ = _subject(session)
    client = session.first
    client.send(_create(query, RATE))
    codes = (ConfirmEventRequest.CODE, Event.CODE)
    session.probe.wait(
        lambda: {each.code for each in client.inbox} >= set(codes), 2 * session.probe.timeout
    )
    order = [each.code for each in client.inbox if each.code in codes]
    client.event_answer(1, "CreateEvent")
    session.require(
        order[:1] == [ConfirmEventRequest.CODE], "the first Event comes before its confirmation"
    )


@check(
    "events.report",
    "Sends the report of the query in its events",
    "AS5710A Events, Event: ReportMessage",
)
def report(session: Session) -> None:
    """The ReportMessage is the complete report, message code and body, and decodes."""
    query, report_class = _subject(session)
    event_id = _periodic(session, session.first)
    event = _next_event(session.first, event_id)
    code = int.from_bytes(event.report_message[:2], "little")
    session.require(
        code == report_class.CODE,
        f"the event for {query.NAME} carries message {code:04X} "
        f"instead of {report_class.CODE:04X} ({report_class.NAME})",
    )
    decoded(report_class, event.report_message)


@check(
    "events.sequence",
    "Numbers the reports of an event",
    "AS5710A Events, Event: SequenceNumber, +1 for each report",
)
def sequence(session: Session) -> None:
    """Five reports have consecutive sequence numbers, also while another event runs."""
    event_id = _periodic(session, session.first)
    _periodic(session, session.second)
    numbers = [_next_event(session.first, event_id).sequence_number for _ in range(5)]
    _consecutive(session, numbers)


@check(
    "events.sequence-wrap",
    "Goes on with 0 after sequence number 255",
    "AS5710A Events, Event: SequenceNumber (unsigned byte)",
)
def sequence_wrap(session: Session) -> None:
    """260 reports are awaited at the highest rate; only with --slow."""
    session.skip_unless(session.limits.slow, "takes 260 reports; --slow waits for them")
    query, _ = _subject(session)
    confirmed = _confirmed(session.first.create_event(query, rate=100.0), "CreateEvent at 100 Hz")
    numbers = [_next_event(session.first, confirmed.event_id).sequence_number for _ in range(260)]
    _consecutive(session, numbers)


@check(
    "events.rate",
    "Sends periodic reports at the confirmed rate",
    "AS5710A Events, ConfirmEventRequest: ConfirmedPeriodicRate",
)
def rate(session: Session) -> None:
    """Ten intervals take between half and twice the time that the confirmed rate gives."""
    query, _ = _subject(session)
    confirmed = _confirmed(session.first.create_event(query, rate=RATE), "CreateEvent")
    period = 1 / max(confirmed.confirmed_periodic_rate, 0.02)
    session.skip_unless(
        10 * period <= session.limits.longest_wait, f"the confirmed period is {period:.1f} s"
    )
    client = session.first
    arrived = session.probe.wait(lambda: len(_events(client)) > 11, 25 * period)
    session.require(arrived, f"{len(_events(client))} of 12 reports came in 25 periods")
    times = [each.time for each in _events(client)]
    mean = (times[-1] - times[1]) / (len(times) - 2)
    session.require(
        0.5 * period <= mean <= 2 * period,
        f"reports come every {mean * 1000:.0f} ms; confirmed are {period * 1000:.0f} ms",
    )


@check(
    "events.two-clients",
    "Serves several clients",
    "AS5710A Events; event ids belong to the provider",
)
def two_clients(session: Session) -> None:
    """Two clients ask for the same report; each receives it under the id that it was told."""
    for client in (session.first, session.second):
        event_id = _periodic(session, client)
        _next_event(client, event_id)


@check(
    "events.update",
    "Updates an event under its id",
    "AS5710A Events, UpdateEvent",
)
def update(session: Session) -> None:
    """UpdateEvent with another rate is confirmed with the same event id, and reports go on."""
    query, _ = _subject(session)
    event_id = _periodic(session, session.first)
    session.first.send(_update(query, RATE / 2, event_id))
    confirmed = _confirmed(session.first.event_answer(2, "UpdateEvent"), "UpdateEvent")
    session.require(
        confirmed.event_id == event_id,
        f"UpdateEvent of event {event_id} is confirmed for event {confirmed.event_id}",
    )
    session.first.clear()
    _next_event(session.first, event_id)


@check(
    "events.update-unknown",
    "Rejects the update of an event that does not exist",
    "AS5710A Events, UpdateEvent: RejectEventRequest 6",
)
def update_unknown(session: Session) -> None:
    """The response code is 6 (invalid event id)."""
    query, _ = _subject(session)
    session.first.send(_update(query, RATE, _FREE_EVENT))
    answer = session.first.event_answer(2, "UpdateEvent of an unknown event")
    _rejected(session, answer, 6, "UpdateEvent of an unknown event")


@check(
    "events.cancel",
    "Sends no reports of a cancelled event",
    "AS5710A Events, CancelEvent: ConfirmEventRequest",
)
def cancel(session: Session) -> None:
    """CancelEvent is confirmed; no report comes afterwards."""
    client = session.first
    event_id = _periodic(session, client)
    client.send(CancelEvent(request_id=3, event_id=event_id))
    confirmed = _confirmed(client.event_answer(3, "CancelEvent"), "CancelEvent")
    client.cancelled(event_id)
    session.require(
        confirmed.event_id == event_id,
        f"CancelEvent of event {event_id} is confirmed for event {confirmed.event_id}",
    )
    client.clear()
    client.expect_none(Event, f"event {event_id} is cancelled", within=_SOME_PERIODS)


@check(
    "events.cancel-unknown",
    "Rejects the cancellation of an event that does not exist",
    "AS5710A Events, CancelEvent: RejectEventRequest",
)
def cancel_unknown(session: Session) -> None:
    """The standard names code 6 for updates; it is the usual one here too."""
    session.first.send(CancelEvent(request_id=4, event_id=_FREE_EVENT))
    answer = session.first.event_answer(4, "CancelEvent of an unknown event")
    if isinstance(answer, ConfirmEventRequest):
        session.first.cancelled(answer.event_id)
        raise CheckFailed("CancelEvent of an unknown event is confirmed")
    if answer.response_code != 6:
        session.note(f"rejected with code {answer.response_code} instead of 6")


@check(
    "events.cancel-by-other",
    "Keeps an event that another client cancels",
    "AS5710A Events; practice: an event belongs to the client that created it",
)
def cancel_by_other(session: Session) -> None:
    """CancelEvent of another client does not end the reports."""
    event_id = _periodic(session, session.first)
    session.second.send(CancelEvent(request_id=5, event_id=event_id))
    session.probe.wait(lambda: False, session.probe.quiet)
    session.first.clear()
    if session.first.find(Event) is None:
        session.note("a client can cancel the event of another one")


@check(
    "events.unsupported-message",
    "Rejects an event on a message that it does not know",
    "AS5710A Events, CreateEvent: RejectEventRequest 5",
)
def unsupported_message(session: Session) -> None:
    """The response code is 5 (message not supported)."""
    message = _create(QueryStatus(), RATE)
    message.query_message = _UNKNOWN_QUERY
    session.first.send(message)
    answer = session.first.event_answer(1, "CreateEvent on an unknown message")
    _rejected(session, answer, 5, "CreateEvent on an unknown message")


@check(
    "events.bad-query",
    "Rejects an event whose query is empty",
    "AS5710A Events, CreateEvent: QueryMessage",
)
def bad_query(session: Session) -> None:
    """A QueryMessage without a message code cannot be served; code 4 or 5 is usual."""
    header = _create(QueryStatus(), RATE).encode()[:_QUERY_OFFSET]
    _not_confirmed(session, header + bytes(4), "CreateEvent without a query")


@check(
    "events.zero-rate",
    "Does not confirm a periodic event at 0 Hz",
    "AS5710A Events, CreateEvent: RequestedPeriodicRate is not 0 for periodic events",
)
def zero_rate(session: Session) -> None:
    """RejectEventRequest 4 (invalid setup) is usual; some stacks take another rate."""
    query, _ = _subject(session)
    session.first.send(_create(query, 0.0))
    answer = session.first.event_answer(1, "CreateEvent at 0 Hz")
    if isinstance(answer, ConfirmEventRequest):
        session.note(f"confirmed with {answer.confirmed_periodic_rate:.3g} Hz")
    elif answer.response_code != RejectCode.INVALID_EVENT_SETUP:
        session.note(f"rejected with code {answer.response_code} instead of 4")


@check(
    "events.unknown-type",
    "Rejects an event type that does not exist",
    "AS5710A Events, CreateEvent: EventType 0 or 1",
)
def unknown_type(session: Session) -> None:
    """Event type 7 cannot be served; code 4 (invalid setup) is usual."""
    query, _ = _subject(session)
    payload = bytearray(_create(query, RATE).encode())
    payload[3] = 7
    _not_confirmed(session, bytes(payload), "CreateEvent of type 7")


@check(
    "events.every-change",
    "Reports every change",
    "AS5710A Events, CreateEvent: EventType 1",
)
def every_change(session: Session) -> None:
    """The event on QueryControl reports when control is taken and released, and not between."""
    session.skip_unless(session.provides("AccessControl"), "needs AccessControl for a change")
    client = session.first
    answer = client.create_event(QueryControl())
    if isinstance(answer, RejectEventRequest):
        session.skip_unless(
            answer.response_code != RejectCode.CHANGE_BASED_EVENTS_NOT_SUPPORTED,
            "the target supports no change-based events (code 2)",
        )
        raise CheckFailed(f"every-change event rejected with code {answer.response_code}")
    client.find(Event, within=session.probe.quiet)  # the present value, which some send at once
    client.expect_none(Event, "nothing has changed")
    session.second.send(RequestControl(authority_code=session.authority(Authority.LOW)))
    taken = _changed_control(client, answer.event_id, "control was taken")
    session.require(
        taken.component_id == session.second.address.component,
        f"the event does not name {session.second.address} as the controller",
    )
    session.second.send(ReleaseControl())
    released = _changed_control(client, answer.event_id, "control was released")
    session.require(released.component_id == 0, "the event still names a controller")


@check(
    "events.query-all",
    "Lists its events",
    "AS5710A Events, QueryEvents variant 3, ReportEvents",
)
def query_all(session: Session) -> None:
    """ReportEvents for all events holds the one just created, with its type and query."""
    _listed(session, lambda _: QueryEvents.AllEventsRec(all_events=0))


@check(
    "events.query-by-message",
    "Lists its events on a message",
    "AS5710A Events, QueryEvents variant 0, ReportEvents",
)
def query_by_message(session: Session) -> None:
    """ReportEvents for the query's message code holds the event, and no other message's."""
    code = _subject(session)[0].CODE
    found = _listed(session, lambda _: QueryEvents.MessageIDRec(message_code=code))
    wrong = [each for each in found if int.from_bytes(each.query_message[:2], "little") != code]
    session.require(not wrong, "ReportEvents holds events on other messages")


@check(
    "events.query-by-type",
    "Lists its events of a type",
    "AS5710A Events, QueryEvents variant 1, ReportEvents",
)
def query_by_type(session: Session) -> None:
    """ReportEvents for periodic events holds the event, and no every-change event."""
    found = _listed(session, lambda _: QueryEvents.EventTypeRec(event_type=PERIODIC))
    session.require(
        all(each.event_type == PERIODIC for each in found), "ReportEvents holds other types"
    )


@check(
    "events.query-by-id",
    "Lists one event",
    "AS5710A Events, QueryEvents variant 2, ReportEvents",
)
def query_by_id(session: Session) -> None:
    """ReportEvents for an event id holds that event alone."""
    found = _listed(session, lambda event_id: QueryEvents.EventIDRec(event_id=event_id))
    session.require(len(found) == 1, f"ReportEvents holds {len(found)} events instead of one")


@check(
    "events.timeout-reported",
    "Reports its event timeout",
    "AS5710A v1.1 Events, QueryEventTimeout",
)
def timeout_reported(session: Session) -> None:
    """QueryEventTimeout is answered with minutes; 0 means never. Events 1.0 has no such query."""
    session.skip_unless(not session.is_v1_0("Events"), "Events 1.0 has no timeout")
    answer = session.first.ask(QueryEventTimeout(), ReportEventTimeout)
    session.trace.remark(f"events lapse after {answer.timeout} minutes (0: never)")


@check(
    "events.timeout",
    "Ends an event that is not updated",
    "AS5710A v1.1 Events, event timeout in minutes",
)
def timeout(session: Session) -> None:
    """No report comes after the announced minutes; only with --slow."""
    session.skip_unless(not session.is_v1_0("Events"), "Events 1.0 has no timeout")
    minutes = session.first.ask(QueryEventTimeout(), ReportEventTimeout).timeout
    session.skip_unless(minutes > 0, "the target announces that events never end")
    session.skip_unless(
        session.limits.slow and minutes <= 2, f"takes {minutes} minutes; --slow waits for two"
    )
    event_id = _periodic(session, session.first)
    session.probe.wait(lambda: False, 60.0 * minutes - 5)
    session.first.clear()
    _next_event(session.first, event_id)
    session.probe.wait(lambda: False, 10.0)
    session.first.clear()
    session.first.expect_none(
        Event, f"the event was not updated for {minutes} minutes", within=_SOME_PERIODS
    )


@check(
    "events.command-event",
    "Answers CreateCommandEvent",
    "AS5710A v1.1 Events, CreateCommandEvent",
)
def command_event(session: Session) -> None:
    """A command event on an unknown message is rejected."""
    session.skip_unless(not session.is_v1_0("Events"), "Events 1.0 has no command events")
    session.first.send(
        CreateCommandEvent(request_id=6, maximum_allowed_duration=1, command_message=_UNKNOWN_QUERY)
    )
    answer = session.first.event_answer(6, "CreateCommandEvent")
    _rejected(session, answer, None, "CreateCommandEvent on an unknown message")


CHECKS = (
    create_periodic,
    confirm_first,
    report,
    sequence,
    sequence_wrap,
    rate,
    two_clients,
    update,
    update_unknown,
    cancel,
    cancel_unknown,
    cancel_by_other,
    unsupported_message,
    bad_query,
    zero_rate,
    unknown_type,
    every_change,
    query_all,
    query_by_message,
    query_by_type,
    query_by_id,
    timeout_reported,
    timeout,
    command_event,
)


def _subject(session: Session) -> tuple[Message, type[Message]]:
    """Returns a query that the target answers, and its report."""
    for service, query, report_class in _CANDIDATES:
        if session.provides(service):
            return query, report_class
    session.skip_unless(holds=False, reason="the target has no core query to make an event of")
    raise AssertionError  # skip_unless has raised


def _create(query: Message, hertz: float) -> CreateEvent:
    return CreateEvent(
        request_id=1,
        event_type=PERIODIC,
        requested_periodic_rate=hertz,
        query_message=query.encode(),
    )


def _update(query: Message, hertz: float, event_id: int) -> UpdateEvent:
    return UpdateEvent(
        request_id=2,
        event_type=PERIODIC,
        requested_periodic_rate=hertz,
        event_id=event_id,
        query_message=query.encode(),
    )


def _periodic(session: Session, client: Client) -> int:
    """Creates a periodic event as a step before what is to be checked, and returns its id."""
    query, _ = _subject(session)
    answer = client.create_event(query, rate=RATE)
    session.skip_unless(
        isinstance(answer, ConfirmEventRequest),
        f"no periodic event on {query.NAME} is confirmed; see events.create-periodic",
    )
    return answer.event_id if isinstance(answer, ConfirmEventRequest) else 0


def _confirmed(answer: ConfirmEventRequest | RejectEventRequest, what: str) -> ConfirmEventRequest:
    if isinstance(answer, RejectEventRequest):
        text = f": {answer.error_message}" if answer.error_message else ""
        raise CheckFailed(f"{what} is rejected with code {answer.response_code}{text}")
    return answer


def _rejected(
    session: Session,
    answer: ConfirmEventRequest | RejectEventRequest,
    code: int | None,
    what: str,
) -> None:
    if isinstance(answer, ConfirmEventRequest):
        raise CheckFailed(f"{what} is confirmed")
    if answer.response_code is None:
        session.note("the rejection has no response code, which the standard leaves open")
    elif code is not None and answer.response_code != code:
        raise CheckFailed(f"{what} is rejected with code {answer.response_code} instead of {code}")


def _not_confirmed(session: Session, payload: bytes, what: str) -> None:
    """Sends a request that cannot be served; silence is noted."""
    session.first.put(session.first.packet(payload))
    try:
        answer = session.first.event_answer(1, what)
    except CheckFailed:
        session.note(f"{what} is not answered")
        return
    _rejected(session, answer, None, what)


def _events(client: Client) -> list[ReceivedMessage]:
    return [each for each in client.inbox if each.code == Event.CODE]


def _next_event(client: Client, event_id: int) -> Event:
    return client.expect(
        Event, f"the confirmation of event {event_id}", lambda event: event.event_id == event_id
    )


def _consecutive(session: Session, numbers: list[int]) -> None:
    pairs = itertools.pairwise(numbers)
    session.require(
        all((after - before) & 0xFF == 1 for before, after in pairs),
        f"the sequence numbers of an event are {numbers[:20]}",
    )


def _changed_control(client: Client, event_id: int, what: str) -> ReportControl:
    event = client.expect(Event, what, lambda each: each.event_id == event_id)
    return decoded(ReportControl, event.report_message)


def _listed(
    session: Session, choice: Callable[[int], QueryEvents.QueryEventsVar]
) -> list[ReportEvents.ReportEventRec]:
    event_id = _periodic(session, session.first)
    query = QueryEvents(query_events_var=choice(event_id))
    found = list(session.second.ask(query, ReportEvents).event_list)
    payload = _subject(session)[0].encode()
    session.require(
        any(
            (each.event_id, each.event_type, each.query_message) == (event_id, PERIODIC, payload)
            for each in found
        ),
        f"ReportEvents does not hold event {event_id} with its type and query",
    )
    return found

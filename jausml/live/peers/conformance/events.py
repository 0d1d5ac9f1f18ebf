"""Checks of Events: reports at a rate and at every change (AS5710A, protocol behaviour)."""

from __future__ import annotations

from jausml.live.peers.conformance.access import request
from jausml.live.peers.conformance.check import Check, step
from jausml.live.peers.conformance.client import Client, ReceivedMessage, decoded
from jausml.live.peers.conformance.event_steps import (
    FREE_EVENT,
    PERIODIC,
    RATE,
    UNKNOWN_QUERY,
    cancelling,
    carries,
    confirmed,
    created,
    creating,
    damaged,
    ended,
    event_id,
    listed,
    next_event,
    numbered,
    periodic,
    rejected,
    subject,
    unconfirmed,
    updating,
)
from jausml.live.peers.conformance.session import Authority, Session
from jausml.live.peers.conformance.steps import (
    A,
    AnythingBut,
    B,
    ask,
    expect,
    expect_none,
    has,
    provides,
    put,
    send,
    settle,
    should_have,
    since_1_1,
    slow,
)
from jausml.runtime import messages as core
from jausml.runtime.wire.message import Message

Confirm, Reject = core.ConfirmEventRequest, core.RejectEventRequest


@step
def _comes_first(session: Session, client: int, first: type[Message], other: type[Message]) -> None:
    """Two messages come to a client in this order."""
    inbox, codes = session.client(client).inbox, (first.CODE, other.CODE)
    session.probe.wait(
        lambda: {message.code for message in inbox} >= set(codes), 2 * session.probe.timeout
    )
    order = [message.code for message in inbox if message.code in codes]
    session.require(
        order[:1] == [first.CODE], f"the first {other.NAME} comes before its confirmation"
    )


@step
def _keeps_rate(session: Session, client: int, intervals: int) -> None:
    """So many intervals take between half and twice the time of the confirmed rate."""
    test_client = session.client(client)
    period = 1 / max(test_client.event.confirmed_periodic_rate, 0.02)
    session.skip_unless(
        intervals * period <= session.limits.longest_wait, f"the confirmed period is {period:.1f} s"
    )
    periods, count = 2.5 * intervals, intervals + 2
    arrived = session.probe.wait(lambda: len(_events(test_client)) >= count, periods * period)
    times = [event.time for event in _events(test_client)]
    session.require(arrived, f"{len(times)} of {count} reports came in {periods:g} periods")
    mean = (times[-1] - times[1]) / (len(times) - 2)
    session.require(
        0.5 * period <= mean <= 2 * period,
        f"reports come every {mean * 1000:.0f} ms; confirmed are {period * 1000:.0f} ms",
    )


@step
def _watches_control(session: Session, client: int) -> None:
    """A client has an event on each change of control; skips where there are no such events."""
    test_client = session.client(client)
    change = core.CreateEvent.EventType.EVERY_CHANGE
    session.send(client, core.CreateEvent(1, change, 0.0, core.QueryControl().encode()))
    rejection = test_client.find(Reject, within=session.probe.quiet)
    unsupported = Reject.ResponseCode.CHANGE_BASED_EVENTS_NOT_SUPPORTED
    code = None if rejection is None else rejection.response_code
    session.skip_unless(code != unsupported, "the target supports no change-based events (code 2)")
    session.require(code is None, f"every-change event rejected with code {code}")
    test_client.event = test_client.expect(Confirm, "CreateEvent")
    # The present value, which some send at once.
    test_client.find(core.Event, within=session.probe.quiet)


@step
def _tells_controller(session: Session, client: int, controller: int | None) -> None:
    """The event of a client names another one as the controller, or nobody."""
    report = decoded(core.ReportControl, next_event(session.client(client)).report_message)
    if controller is None:
        session.require(report.component_id == 0, "the event still names a controller")
        return
    address = session.client(controller).address
    session.require(
        report.component_id == address.component,
        f"the event does not name {address} as the controller",
    )


@step
def _outlives(session: Session, client: int) -> None:
    """The announced minutes pass, up to whose end the event of a client is alive."""
    minutes = session.client(client).ask(core.QueryEventTimeout(), core.ReportEventTimeout).timeout
    session.skip_unless(minutes > 0, "the target announces that events never end")
    session.skip_unless(
        session.limits.slow and minutes <= 2, f"takes {minutes} minutes; --slow waits for two"
    )
    periodic(client)(session)
    session.probe.wait(lambda: False, 60.0 * minutes - 5)
    session.client(client).clear()
    next_event(session.client(client))
    session.probe.wait(lambda: False, 10.0)
    session.client(client).clear()


def _at_the_rate(session: Session, confirmation: core.ConfirmEventRequest, what: str) -> None:
    hertz = confirmation.confirmed_periodic_rate
    if abs(hertz - RATE) > 0.1:
        session.note(f"{what} says {hertz:.3g} Hz")


def _confirmed(session: Session) -> str:
    confirmation = session.first.find(Confirm, within=0)
    return (confirmation and f"confirmed with {confirmation.confirmed_periodic_rate:.3g} Hz") or ""


def _events(client: Client) -> list[ReceivedMessage]:
    return [message for message in client.inbox if message.code == core.Event.CODE]


CHECKS = (
    Check(
        "events.create-periodic",
        "Confirms a periodic event",
        "AS5710A Events, CreateEvent, ConfirmEventRequest",
        "CreateEvent at 10 Hz is confirmed under its request id, with a rate above 0.",
        (created(A, has(confirmed_periodic_rate=AnythingBut(0)), _at_the_rate),),
    ),
    Check(
        "events.confirm-first",
        "Confirms an event before its first report",
        "AS5710A Events, CreateEvent; practice: clients drop events that they do not know",
        "ConfirmEventRequest arrives before any Event.",
        (send(A, creating(RATE)), _comes_first(A, Confirm, core.Event)),
    ),
    Check(
        "events.report",
        "Sends the report of the query in its events",
        "AS5710A Events, Event: ReportMessage",
        "The ReportMessage is the complete report, message code and body, and decodes.",
        (periodic(A), carries(A)),
    ),
    Check(
        "events.sequence",
        "Numbers the reports of an event",
        "AS5710A Events, Event: SequenceNumber, +1 for each report",
        "Five reports have consecutive sequence numbers, also while another event runs.",
        (periodic(A), periodic(B), numbered(A, 5)),
    ),
    Check(
        "events.sequence-wrap",
        "Goes on with 0 after sequence number 255",
        "AS5710A Events, Event: SequenceNumber (unsigned byte)",
        "260 reports are awaited at the highest rate; only with --slow.",
        (slow("260 reports"), created(A, rate=100.0), numbered(A, 260)),
    ),
    Check(
        "events.rate",
        "Sends periodic reports at the confirmed rate",
        "AS5710A Events, ConfirmEventRequest: ConfirmedPeriodicRate",
        "Ten intervals take between half and twice the time that the confirmed rate gives.",
        (created(A), _keeps_rate(A, 10)),
    ),
    Check(
        "events.two-clients",
        "Serves several clients",
        "AS5710A Events; event ids belong to the provider",
        "Two clients ask for the same report; each receives it under the id that it was told.",
        (periodic(A), numbered(A, 1), periodic(B), numbered(B, 1)),
    ),
    Check(
        "events.update",
        "Updates an event under its id",
        "AS5710A Events, UpdateEvent",
        "UpdateEvent with another rate is confirmed with the same event id, and reports go on.",
        (periodic(A), send(A, updating(RATE / 2)), confirmed(2), settle(A), numbered(A, 1)),
    ),
    Check(
        "events.update-unknown",
        "Rejects the update of an event that does not exist",
        "AS5710A Events, UpdateEvent: RejectEventRequest 6",
        "The response code is 6 (invalid event id).",
        (send(A, updating(RATE, FREE_EVENT)), rejected(2, 6)),
    ),
    Check(
        "events.cancel",
        "Sends no reports of a cancelled event",
        "AS5710A Events, CancelEvent: ConfirmEventRequest",
        "CancelEvent is confirmed; no report comes afterwards.",
        (periodic(A), send(A, cancelling), confirmed(3), settle(A), ended(A)),
    ),
    Check(
        "events.cancel-unknown",
        "Rejects the cancellation of an event that does not exist",
        "AS5710A Events, CancelEvent: RejectEventRequest",
        "The standard names code 6 for updates; it is the usual one here too.",
        (
            send(A, core.CancelEvent(4, FREE_EVENT)),
            expect(A, Reject, has(request_id=4), should_have(response_code=6)),
        ),
    ),
    Check(
        "events.cancel-by-other",
        "Keeps an event that another client cancels",
        "AS5710A Events; practice: an event belongs to the client that created it",
        "CancelEvent of another client does not end the reports.",
        (
            periodic(A),
            send(B, cancelling),
            settle(A),
            expect(A, core.Event, unless=lambda _: "anybody can cancel it"),
        ),
    ),
    Check(
        "events.unsupported-message",
        "Rejects an event on a message that it does not know",
        "AS5710A Events, CreateEvent: RejectEventRequest 5",
        "The response code is 5 (message not supported).",
        (send(A, core.CreateEvent(1, PERIODIC, RATE, UNKNOWN_QUERY)), rejected(1, 5)),
    ),
    Check(
        "events.bad-query",
        "Rejects an event whose query is empty",
        "AS5710A Events, CreateEvent: QueryMessage",
        "A QueryMessage without a message code cannot be served; code 4 or 5 is usual.",
        (put(A, "CreateEvent", damaged(lambda event: event[:6] + bytes(4))), unconfirmed(A)),
    ),
    Check(
        "events.zero-rate",
        "Does not confirm a periodic event at 0 Hz",
        "AS5710A Events, CreateEvent: RequestedPeriodicRate is not 0 for periodic events",
        "RejectEventRequest 4 (invalid setup) is usual; some stacks take another rate.",
        (
            send(A, creating(0.0)),
            expect(A, Reject, has(request_id=1), should_have(response_code=4), unless=_confirmed),
        ),
    ),
    Check(
        "events.unknown-type",
        "Rejects an event type that does not exist",
        "AS5710A Events, CreateEvent: EventType 0 or 1",
        "Event type 7 cannot be served; code 4 (invalid setup) is usual.",
        (
            put(A, "CreateEvent", damaged(lambda event: event[:3] + b"\7" + event[4:])),
            unconfirmed(A),
        ),
    ),
    Check(
        "events.every-change",
        "Reports every change",
        "AS5710A Events, CreateEvent: EventType 1",
        "The event on QueryControl reports when control is taken and released, and not between.",
        (
            provides("AccessControl", "needs AccessControl for a change"),
            _watches_control(A),
            expect_none(A, core.Event, "nothing has changed"),
            request(B, Authority.LOW),
            _tells_controller(A, B),
            send(B, core.ReleaseControl()),
            _tells_controller(A, None),
        ),
    ),
    Check(
        "events.query-all",
        "Lists its events",
        "AS5710A Events, QueryEvents variant 3, ReportEvents",
        "ReportEvents for all events holds the one just created, with its type and query.",
        (periodic(A), listed(lambda _: core.QueryEvents.AllEventsRec())),
    ),
    Check(
        "events.query-by-message",
        "Lists its events on a message",
        "AS5710A Events, QueryEvents variant 0, ReportEvents",
        "ReportEvents for the query's message code holds the event, and no other message's.",
        (
            periodic(A),
            listed(lambda session: core.QueryEvents.MessageIDRec(subject(session)[0].CODE)),
        ),
    ),
    Check(
        "events.query-by-type",
        "Lists its events of a type",
        "AS5710A Events, QueryEvents variant 1, ReportEvents",
        "ReportEvents for periodic events holds the event, and no every-change event.",
        (periodic(A), listed(lambda _: core.QueryEvents.EventTypeRec(PERIODIC))),
    ),
    Check(
        "events.query-by-id",
        "Lists one event",
        "AS5710A Events, QueryEvents variant 2, ReportEvents",
        "ReportEvents for an event id holds that event alone.",
        (
            periodic(A),
            periodic(B),
            listed(lambda session: core.QueryEvents.EventIDRec(event_id(session))),
        ),
    ),
    Check(
        "events.timeout-reported",
        "Reports its event timeout",
        "AS5710A v1.1 Events, QueryEventTimeout",
        "QueryEventTimeout is answered with minutes; 0 means never. Events 1.0 has no such query.",
        (
            since_1_1("Events", "Events 1.0 has no timeout"),
            ask(A, core.QueryEventTimeout(), core.ReportEventTimeout),
        ),
    ),
    Check(
        "events.timeout",
        "Ends an event that is not updated",
        "AS5710A v1.1 Events, event timeout in minutes",
        "No report comes after the announced minutes; only with --slow.",
        (since_1_1("Events", "Events 1.0 has no timeout"), _outlives(A), ended(A)),
    ),
    Check(
        "events.command-event",
        "Answers CreateCommandEvent",
        "AS5710A v1.1 Events, CreateCommandEvent",
        "A command event on an unknown message is rejected.",
        (
            since_1_1("Events", "Events 1.0 has no command events"),
            send(A, core.CreateCommandEvent(6, 1, UNKNOWN_QUERY)),
            rejected(6),
        ),
    ),
)

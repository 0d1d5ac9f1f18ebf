"""Checks of Events: reports at a rate and at every change (AS5710A, protocol behaviour)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.live.peers.conformance.check import Check, check
from jausml.live.peers.conformance.client import decoded
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
from jausml.live.peers.conformance.evidence import CheckFailed
from jausml.live.peers.conformance.session import Authority
from jausml.live.peers.conformance.steps import (
    A,
    AnythingBut,
    B,
    ask,
    expect,
    expect_none,
    has,
    put,
    send,
    settle,
    since_1_1,
    slow,
    usual,
)
from jausml.runtime import messages as core

if TYPE_CHECKING:
    from jausml.live.peers.conformance.client import Client, ReceivedMessage
    from jausml.live.peers.conformance.session import Session

Confirm, Reject = core.ConfirmEventRequest, core.RejectEventRequest


@check(
    "events.confirm-first",
    "Confirms an event before its first report",
    "AS5710A Events, CreateEvent; practice: clients drop events that they do not know",
)
def confirm_first(session: Session) -> None:
    """ConfirmEventRequest arrives before any Event."""
    client = session.first
    send(A, creating(RATE))(session)
    codes = (core.ConfirmEventRequest.CODE, core.Event.CODE)
    session.probe.wait(
        lambda: {each.code for each in client.inbox} >= set(codes), 2 * session.probe.timeout
    )
    order = [each.code for each in client.inbox if each.code in codes]
    session.require(
        order[:1] == [core.ConfirmEventRequest.CODE],
        "the first Event comes before its confirmation",
    )


@check(
    "events.rate",
    "Sends periodic reports at the confirmed rate",
    "AS5710A Events, ConfirmEventRequest: ConfirmedPeriodicRate",
)
def rate(session: Session) -> None:
    """Ten intervals take between half and twice the time that the confirmed rate gives."""
    created(A)(session)
    period = 1 / max(session.first.event.confirmed_periodic_rate, 0.02)
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
    "events.every-change",
    "Reports every change",
    "AS5710A Events, CreateEvent: EventType 1",
)
def every_change(session: Session) -> None:
    """The event on QueryControl reports when control is taken and released, and not between."""
    session.skip_unless(session.provides("AccessControl"), "needs AccessControl for a change")
    client = session.first
    query = core.QueryControl().encode()
    client.send(core.CreateEvent(1, core.CreateEvent.EventType.EVERY_CHANGE, 0.0, query))
    rejection = client.find(core.RejectEventRequest, within=session.probe.quiet)
    if rejection is not None:
        code = rejection.response_code
        unsupported = core.RejectEventRequest.ResponseCode.CHANGE_BASED_EVENTS_NOT_SUPPORTED
        session.skip_unless(
            code != unsupported, "the target supports no change-based events (code 2)"
        )
        raise CheckFailed(f"every-change event rejected with code {code}")
    client.event = client.expect(core.ConfirmEventRequest, "CreateEvent")
    # The present value, which some send at once.
    client.find(core.Event, within=session.probe.quiet)
    expect_none(A, core.Event, "nothing has changed")(session)
    session.second.send(core.RequestControl(authority_code=session.authority(Authority.LOW)))
    taken = _changed_control(client)
    session.require(
        taken.component_id == session.second.address.component,
        f"the event does not name {session.second.address} as the controller",
    )
    session.second.send(core.ReleaseControl())
    released = _changed_control(client)
    session.require(released.component_id == 0, "the event still names a controller")


@check(
    "events.timeout",
    "Ends an event that is not updated",
    "AS5710A v1.1 Events, event timeout in minutes",
)
def timeout(session: Session) -> None:
    """No report comes after the announced minutes; only with --slow."""
    since_1_1("Events", "Events 1.0 has no timeout")(session)
    minutes = session.first.ask(core.QueryEventTimeout(), core.ReportEventTimeout).timeout
    session.skip_unless(minutes > 0, "the target announces that events never end")
    session.skip_unless(
        session.limits.slow and minutes <= 2, f"takes {minutes} minutes; --slow waits for two"
    )
    client = session.first
    periodic(A)(session)
    session.probe.wait(lambda: False, 60.0 * minutes - 5)
    client.clear()
    next_event(client)
    session.probe.wait(lambda: False, 10.0)
    client.clear()
    ended(A)(session)


def _at_the_rate(session: Session, confirmation: core.ConfirmEventRequest, what: str) -> None:
    hertz = confirmation.confirmed_periodic_rate
    if abs(hertz - RATE) > 0.1:
        session.note(f"{what} says {hertz:.3g} Hz")


def _confirmed(session: Session) -> str:
    confirmation = session.first.find(Confirm, within=0)
    return (confirmation and f"confirmed with {confirmation.confirmed_periodic_rate:.3g} Hz") or ""


def _events(client: Client) -> list[ReceivedMessage]:
    return [each for each in client.inbox if each.code == core.Event.CODE]


def _changed_control(client: Client) -> core.ReportControl:
    return decoded(core.ReportControl, next_event(client).report_message)


CHECKS = (
    Check(
        "events.create-periodic",
        "Confirms a periodic event",
        "AS5710A Events, CreateEvent, ConfirmEventRequest",
        "CreateEvent at 10 Hz is confirmed under its request id, with a rate above 0.",
        (created(A, has(confirmed_periodic_rate=AnythingBut(0)), _at_the_rate),),
    ),
    confirm_first,
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
    rate,
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
            expect(A, Reject, has(request_id=4), usual(response_code=6)),
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
            expect(A, Reject, has(request_id=1), usual(response_code=4), unless=_confirmed),
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
    every_change,
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
    timeout,
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

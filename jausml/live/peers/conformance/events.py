"""Checks of Events: reports at a rate and at every change (AS5710A, protocol behaviour)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.live.peers.conformance.check import Check, check
from jausml.live.peers.conformance.client import decoded
from jausml.live.peers.conformance.event_steps import (
    FREE_EVENT,
    PERIODIC,
    RATE,
    SOME_PERIODS,
    UNKNOWN_QUERY,
    begin_periodic,
    confirmed,
    creating,
    damaged,
    ended,
    listed,
    next_event,
    numbered,
    periodic,
    refused,
    require_confirmed,
    require_consecutive,
    require_listed,
    subject,
    updating,
)
from jausml.live.peers.conformance.evidence import CheckFailed
from jausml.live.peers.conformance.session import Authority
from jausml.live.peers.conformance.steps import A, B, since_1_1
from jausml.runtime import messages as core

if TYPE_CHECKING:
    from jausml.live.peers.conformance.client import Client, ReceivedMessage
    from jausml.live.peers.conformance.session import Session

RejectCode = core.RejectEventRequest.ResponseCode


@check(
    "events.create-periodic",
    "Confirms a periodic event",
    "AS5710A Events, CreateEvent, ConfirmEventRequest",
)
def create_periodic(session: Session) -> None:
    """CreateEvent at 10 Hz is confirmed under its request id, with a rate above 0."""
    query, _ = subject(session)
    answer = session.first.create_event(query, rate=RATE, request_id=17)
    what = f"CreateEvent for {query.NAME} at {RATE:g} Hz"
    hertz = require_confirmed(answer, what).confirmed_periodic_rate
    session.require(hertz > 0, "the confirmed rate is 0 Hz")
    if abs(hertz - RATE) > 0.1:
        session.note(f"{hertz:.3g} Hz confirmed instead of {RATE:g} Hz")


@check(
    "events.confirm-first",
    "Confirms an event before its first report",
    "AS5710A Events, CreateEvent; practice: clients drop events that they do not know",
)
def confirm_first(session: Session) -> None:
    """ConfirmEventRequest arrives before any Event."""
    client = session.first
    client.send(creating(session))
    codes = (core.ConfirmEventRequest.CODE, core.Event.CODE)
    session.probe.wait(
        lambda: {each.code for each in client.inbox} >= set(codes), 2 * session.probe.timeout
    )
    order = [each.code for each in client.inbox if each.code in codes]
    client.event_answer(1, "CreateEvent")
    session.require(
        order[:1] == [core.ConfirmEventRequest.CODE],
        "the first Event comes before its confirmation",
    )


@check(
    "events.report",
    "Sends the report of the query in its events",
    "AS5710A Events, Event: ReportMessage",
)
def report(session: Session) -> None:
    """The ReportMessage is the complete report, message code and body, and decodes."""
    query, report_class = subject(session)
    event_id = begin_periodic(session, session.first)
    event = next_event(session.first, event_id)
    code = int.from_bytes(event.report_message[:2], "little")
    session.require(
        code == report_class.CODE,
        f"the event for {query.NAME} carries message {code:04X} "
        f"instead of {report_class.CODE:04X} ({report_class.NAME})",
    )
    decoded(report_class, event.report_message)


@check(
    "events.sequence-wrap",
    "Goes on with 0 after sequence number 255",
    "AS5710A Events, Event: SequenceNumber (unsigned byte)",
)
def sequence_wrap(session: Session) -> None:
    """260 reports are awaited at the highest rate; only with --slow."""
    session.skip_unless(session.limits.slow, "takes 260 reports; --slow waits for them")
    query, _ = subject(session)
    answer = session.first.create_event(query, rate=100.0)
    event_id = require_confirmed(answer, "CreateEvent at 100 Hz").event_id
    require_consecutive(session, session.first, event_id, 260)


@check(
    "events.rate",
    "Sends periodic reports at the confirmed rate",
    "AS5710A Events, ConfirmEventRequest: ConfirmedPeriodicRate",
)
def rate(session: Session) -> None:
    """Ten intervals take between half and twice the time that the confirmed rate gives."""
    answer = session.first.create_event(subject(session)[0], rate=RATE)
    hertz = require_confirmed(answer, "CreateEvent").confirmed_periodic_rate
    period = 1 / max(hertz, 0.02)
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
    "events.cancel-unknown",
    "Rejects the cancellation of an event that does not exist",
    "AS5710A Events, CancelEvent: RejectEventRequest",
)
def cancel_unknown(session: Session) -> None:
    """The standard names code 6 for updates; it is the usual one here too."""
    session.first.send(core.CancelEvent(request_id=4, event_id=FREE_EVENT))
    answer = session.first.event_answer(4, "CancelEvent of an unknown event")
    if isinstance(answer, core.ConfirmEventRequest):
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
    event_id = begin_periodic(session, session.first)
    session.second.send(core.CancelEvent(request_id=5, event_id=event_id))
    session.probe.wait(lambda: False, session.probe.quiet)
    session.first.clear()
    if session.first.find(core.Event) is None:
        session.note("a client can cancel the event of another one")


@check(
    "events.zero-rate",
    "Does not confirm a periodic event at 0 Hz",
    "AS5710A Events, CreateEvent: RequestedPeriodicRate is not 0 for periodic events",
)
def zero_rate(session: Session) -> None:
    """RejectEventRequest 4 (invalid setup) is usual; some stacks take another rate."""
    session.first.send(creating(session, 0.0))
    answer = session.first.event_answer(1, "CreateEvent at 0 Hz")
    if isinstance(answer, core.ConfirmEventRequest):
        session.note(f"confirmed with {answer.confirmed_periodic_rate:.3g} Hz")
    elif answer.response_code != RejectCode.INVALID_EVENT_SETUP:
        session.note(f"rejected with code {answer.response_code} instead of 4")


@check(
    "events.every-change",
    "Reports every change",
    "AS5710A Events, CreateEvent: EventType 1",
)
def every_change(session: Session) -> None:
    """The event on QueryControl reports when control is taken and released, and not between."""
    session.skip_unless(session.provides("AccessControl"), "needs AccessControl for a change")
    client = session.first
    answer = client.create_event(core.QueryControl())
    if isinstance(answer, core.RejectEventRequest):
        session.skip_unless(
            answer.response_code != RejectCode.CHANGE_BASED_EVENTS_NOT_SUPPORTED,
            "the target supports no change-based events (code 2)",
        )
        raise CheckFailed(f"every-change event rejected with code {answer.response_code}")
    # The present value, which some send at once.
    client.find(core.Event, within=session.probe.quiet)
    client.expect_none(core.Event, "nothing has changed")
    session.second.send(core.RequestControl(authority_code=session.authority(Authority.LOW)))
    taken = _changed_control(client, answer.event_id, "control was taken")
    session.require(
        taken.component_id == session.second.address.component,
        f"the event does not name {session.second.address} as the controller",
    )
    session.second.send(core.ReleaseControl())
    released = _changed_control(client, answer.event_id, "control was released")
    session.require(released.component_id == 0, "the event still names a controller")


@check(
    "events.query-by-id",
    "Lists one event",
    "AS5710A Events, QueryEvents variant 2, ReportEvents",
)
def query_by_id(session: Session) -> None:
    """ReportEvents for an event id holds that event alone."""
    event_id = begin_periodic(session, session.first)
    found = require_listed(session, event_id, core.QueryEvents.EventIDRec(event_id))
    session.require(len(found) == 1, f"ReportEvents holds {len(found)} events instead of one")


@check(
    "events.timeout-reported",
    "Reports its event timeout",
    "AS5710A v1.1 Events, QueryEventTimeout",
)
def timeout_reported(session: Session) -> None:
    """QueryEventTimeout is answered with minutes; 0 means never. Events 1.0 has no such query."""
    session.skip_unless(not session.is_v1_0("Events"), "Events 1.0 has no timeout")
    answer = session.first.ask(core.QueryEventTimeout(), core.ReportEventTimeout)
    session.trace.remark(f"events lapse after {answer.timeout} minutes (0: never)")


@check(
    "events.timeout",
    "Ends an event that is not updated",
    "AS5710A v1.1 Events, event timeout in minutes",
)
def timeout(session: Session) -> None:
    """No report comes after the announced minutes; only with --slow."""
    session.skip_unless(not session.is_v1_0("Events"), "Events 1.0 has no timeout")
    minutes = session.first.ask(core.QueryEventTimeout(), core.ReportEventTimeout).timeout
    session.skip_unless(minutes > 0, "the target announces that events never end")
    session.skip_unless(
        session.limits.slow and minutes <= 2, f"takes {minutes} minutes; --slow waits for two"
    )
    event_id = begin_periodic(session, session.first)
    session.probe.wait(lambda: False, 60.0 * minutes - 5)
    session.first.clear()
    next_event(session.first, event_id)
    session.probe.wait(lambda: False, 10.0)
    session.first.clear()
    session.first.expect_none(
        core.Event, f"the event was not updated for {minutes} minutes", within=SOME_PERIODS
    )


def _events(client: Client) -> list[ReceivedMessage]:
    return [each for each in client.inbox if each.code == core.Event.CODE]


def _changed_control(client: Client, event_id: int, what: str) -> core.ReportControl:
    event = client.expect(core.Event, what, lambda each: each.event_id == event_id)
    return decoded(core.ReportControl, event.report_message)


CHECKS = (
    create_periodic,
    confirm_first,
    report,
    Check(
        "events.sequence",
        "Numbers the reports of an event",
        "AS5710A Events, Event: SequenceNumber, +1 for each report",
        "Five reports have consecutive sequence numbers, also while another event runs.",
        (periodic(A), periodic(B), numbered(A, 5)),
    ),
    sequence_wrap,
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
        (
            periodic(A),
            confirmed(A, lambda session, event: updating(session, RATE / 2, event)),
            numbered(A, 1),
        ),
    ),
    Check(
        "events.update-unknown",
        "Rejects the update of an event that does not exist",
        "AS5710A Events, UpdateEvent: RejectEventRequest 6",
        "The response code is 6 (invalid event id).",
        (
            refused(
                "UpdateEvent of an unknown event",
                lambda session: updating(session, RATE, FREE_EVENT),
                6,
            ),
        ),
    ),
    Check(
        "events.cancel",
        "Sends no reports of a cancelled event",
        "AS5710A Events, CancelEvent: ConfirmEventRequest",
        "CancelEvent is confirmed; no report comes afterwards.",
        (periodic(A), confirmed(A, lambda _, event: core.CancelEvent(3, event)), ended(A)),
    ),
    cancel_unknown,
    cancel_by_other,
    Check(
        "events.unsupported-message",
        "Rejects an event on a message that it does not know",
        "AS5710A Events, CreateEvent: RejectEventRequest 5",
        "The response code is 5 (message not supported).",
        (
            refused(
                "CreateEvent on an unknown message",
                lambda _: core.CreateEvent(1, PERIODIC, RATE, UNKNOWN_QUERY),
                5,
            ),
        ),
    ),
    Check(
        "events.bad-query",
        "Rejects an event whose query is empty",
        "AS5710A Events, CreateEvent: QueryMessage",
        "A QueryMessage without a message code cannot be served; code 4 or 5 is usual.",
        (damaged("CreateEvent without a query", lambda payload: payload[:6] + bytes(4)),),
    ),
    zero_rate,
    Check(
        "events.unknown-type",
        "Rejects an event type that does not exist",
        "AS5710A Events, CreateEvent: EventType 0 or 1",
        "Event type 7 cannot be served; code 4 (invalid setup) is usual.",
        (damaged("CreateEvent of type 7", lambda payload: payload[:3] + b"\7" + payload[4:]),),
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
    query_by_id,
    timeout_reported,
    timeout,
    Check(
        "events.command-event",
        "Answers CreateCommandEvent",
        "AS5710A v1.1 Events, CreateCommandEvent",
        "A command event on an unknown message is rejected.",
        (
            since_1_1("Events", "Events 1.0 has no command events"),
            refused(
                "CreateCommandEvent on an unknown message",
                lambda _: core.CreateCommandEvent(6, 1, UNKNOWN_QUERY),
            ),
        ),
    ),
)

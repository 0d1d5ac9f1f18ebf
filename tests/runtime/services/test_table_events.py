# ruff: noqa: ARG002 - handlers have the parameters that the component gives them
"""Events, row by row (AS5710 v1.1 and v1.0, Events, protocol behaviour)."""

import pytest

from jausml.runtime import Completion, Guard, JausComponent
from jausml.runtime import messages as core

from .state_tables import V1_0, Row, after, controlled, play, ready, rows

PERIODIC, EVERY_CHANGE = 0, 1
STEP = 1092 / 65535
PULSE = core.QueryHeartbeatPulse().encode()
STATUS = core.QueryStatus().encode()
STANDBY = core.ReportStatus(status=2, reserved=0).encode()
READY = core.ReportStatus(status=1, reserved=0).encode()


class Robot(JausComponent):
    """Has a command that is done at once, one that takes time, and one that fails."""

    def __init__(self, *arguments, **named):
        super().__init__(*arguments, **named)
        self.under_way = []
        self.handle(SlowCommand, self.on_slow, when=Guard.READY)
        self.handle(FailingCommand, self.on_failing)

    def on_slow(self, message, sender):
        self.under_way.append(Completion())
        return self.under_way[-1]

    def on_failing(self, message, sender):
        raise RuntimeError("no such thing")


class SlowCommand(core.SetAuthority):
    """A command of the user that takes time."""

    CODE = 0x1F00
    NAME = "SlowCommand"


class FailingCommand(core.SetAuthority):
    """A command of the user whose handler fails."""

    CODE = 0x1F01
    NAME = "FailingCommand"


def create(query, rate=None, request=7, kind=None):
    chosen = EVERY_CHANGE if rate is None else PERIODIC
    return core.CreateEvent(
        request_id=request,
        event_type=chosen if kind is None else kind,
        requested_periodic_rate=rate or 0.0,
        query_message=query,
    )


def update(event, query, rate=None, request=8):
    return core.UpdateEvent(
        request_id=request,
        event_type=EVERY_CHANGE if rate is None else PERIODIC,
        requested_periodic_rate=rate or 0.0,
        event_id=event,
        query_message=query,
    )


def command(message, duration=60, request=5):
    payload = message if isinstance(message, bytes) else message.encode()
    return core.CreateCommandEvent(
        request_id=request, maximum_allowed_duration=duration, command_message=payload
    )


def confirm(request, event=0, rate=0.0):
    return core.ConfirmEventRequest(
        request_id=request, event_id=event, confirmed_periodic_rate=pytest.approx(rate, abs=STEP)
    )


def event(number, sequence, report):
    return core.Event(event_id=number, sequence_number=sequence, report_message=report)


def ended(result, number=0):
    return core.CommandEvent(event_id=number, command_result=result)


class Reject:
    """A RejectEventRequest of a code, whatever its text."""

    def __init__(self, request, code):
        self.wanted = (request, code)

    def __eq__(self, other):
        return isinstance(other, core.RejectEventRequest) and (
            self.wanted == (other.request_id, other.response_code) and bool(other.error_message)
        )

    __hash__ = None

    def __repr__(self):
        return f"Reject{self.wanted}"


def row(name, *given, when, **expected):
    settings = {"event_timeout": 1, "event_rate_min": 1.0, "event_rate_max": 50.0}
    settings.update(expected.pop("settings", {}))
    return Row(name, given, when, settings=settings, **expected)


HEARTBEATS = ("client", create(PULSE, 10.0))
CHANGES = ("client", create(STATUS))
FIRST_PULSE = event(0, 0, core.ReportHeartbeatPulse().encode())

REQUESTS = (
    row("CreateEvent periodic: Confirm, then the first report", when=HEARTBEATS,
        then={"client": [confirm(7, 0, 10.0), FIRST_PULSE]}),
    row("CreateEvent every change: Confirm, then the last known report", when=CHANGES,
        then={"client": [confirm(7), event(0, 0, STANDBY)]}),
    row("CreateEvent, rate above the fastest: the nearest possible",
        when=("client", create(PULSE, 1000.0), confirm(7, 0, 50.0), FIRST_PULSE)),
    row("CreateEvent, rate below the slowest: the nearest possible",
        when=("client", create(PULSE, 0.1), confirm(7, 0, 1.0), FIRST_PULSE)),
    row("CreateEvent of an event that exists: updated, same id", HEARTBEATS, when=("client",
        create(PULSE, 20.0, request=9), confirm(9, 0, 20.0),
        event(0, 1, core.ReportHeartbeatPulse().encode()))),
    row("CreateEvent of another client: another id", HEARTBEATS, when=("rival", create(PULSE, 10.0),
        confirm(7, 1, 10.0), event(1, 0, core.ReportHeartbeatPulse().encode()))),
    row("UpdateEvent: Confirm with the new rate", HEARTBEATS, when=("client",
        update(0, PULSE, 20.0), confirm(8, 0, 20.0),
        event(0, 1, core.ReportHeartbeatPulse().encode()))),
    row("UpdateEvent without a change: Confirm alone", CHANGES,
        when=("client", update(0, STATUS), confirm(8))),
    row("UpdateEvent of an unknown event: Reject 6",
        when=("client", update(3, PULSE, 10.0), Reject(8, 6))),
    row("UpdateEvent of another client's event: Reject 6", HEARTBEATS,
        when=("rival", update(0, PULSE, 10.0), Reject(8, 6))),
    row("CancelEvent: Confirm with rate 0, no more reports", HEARTBEATS,
        ("client", core.CancelEvent(request_id=9, event_id=0)), when=after(2.0)),
    row("CancelEvent: Confirm with rate 0", HEARTBEATS,
        when=("client", core.CancelEvent(request_id=9, event_id=0), confirm(9))),
    row("CancelEvent of an unknown event: Reject 6",
        when=("client", core.CancelEvent(request_id=9, event_id=0), Reject(9, 6))),
    row("CancelEvent of another client's event: Reject 6", HEARTBEATS,
        when=("rival", core.CancelEvent(request_id=9, event_id=0), Reject(9, 6))),
    row("QueryEventTimeout: minutes",
        when=("client", core.QueryEventTimeout(), core.ReportEventTimeout(timeout=1))),
    row("QueryEventTimeout, disabled: 0",
        when=("client", core.QueryEventTimeout(), core.ReportEventTimeout(timeout=0)),
        settings={"event_timeout": 0}),
    row("QueryEventTimeout, v1.0: unknown, ignored", when=("client", core.QueryEventTimeout()),
        counted="component.unknown_message", version=V1_0),
    row("Timeout: Confirm with rate 0", CHANGES, when=after(60.5), then={"client": [confirm(7)]},
        counted="events.expired"),
    row("Timeout, disabled: never", CHANGES, when=after(7200.0), settings={"event_timeout": 0}),
    row("Timeout, v1.0: never", CHANGES, when=after(7200.0), version=V1_0),
    row("Timeout, renewed by UpdateEvent: not yet", CHANGES, after(50.0),
        ("client", update(0, STATUS)), when=after(50.0)),
    row("Timeout, renewed by CreateEvent: not yet", CHANGES, after(50.0),
        ("client", create(STATUS)), when=after(50.0)),
)  # fmt: skip

ALL = core.ReportEvents(
    event_list=[
        core.ReportEvents.ReportEventRec(event_type=PERIODIC, event_id=0, query_message=PULSE),
        core.ReportEvents.ReportEventRec(event_type=EVERY_CHANGE, event_id=1, query_message=STATUS),
    ]
)
FIRST, SECOND = (core.ReportEvents(event_list=[report_event]) for report_event in ALL.event_list)
BOTH = (HEARTBEATS, CHANGES)


def asks(choice):
    return ("rival", core.QueryEvents(query_events_var=choice))


QUERIES = (
    row("QueryEvents by message: the query's code", *BOTH,
        when=asks(core.QueryEvents.MessageIDRec(message_code=core.QueryStatus.CODE)),
        then={"rival": [SECOND]}),
    row("QueryEvents by message: the report's code", *BOTH,
        when=asks(core.QueryEvents.MessageIDRec(message_code=core.ReportHeartbeatPulse.CODE)),
        then={"rival": [FIRST]}),
    row("QueryEvents by type: periodic", *BOTH,
        when=asks(core.QueryEvents.EventTypeRec(event_type=PERIODIC)), then={"rival": [FIRST]}),
    row("QueryEvents by type: every change", *BOTH,
        when=asks(core.QueryEvents.EventTypeRec(event_type=EVERY_CHANGE)),
        then={"rival": [SECOND]}),
    row("QueryEvents by id", *BOTH, when=asks(core.QueryEvents.EventIDRec(event_id=1)),
        then={"rival": [SECOND]}),
    row("QueryEvents by an id that is unknown: an empty list", *BOTH,
        when=asks(core.QueryEvents.EventIDRec(event_id=200)),
        then={"rival": [core.ReportEvents()]}),
    row("QueryEvents for all", *BOTH, when=asks(core.QueryEvents.AllEventsRec()),
        then={"rival": [ALL]}),
    row("QueryEvents for all, none: an empty list", when=asks(core.QueryEvents.AllEventsRec()),
        then={"rival": [core.ReportEvents()]}),
)  # fmt: skip

REJECTIONS = (
    row("Reject 1: periodic events not supported", when=("client",
        create(core.QueryEvents(core.QueryEvents.AllEventsRec()).encode(), 1.0), Reject(7, 1))),
    row("Reject 2: change-based events not supported",
        when=("client", create(core.QueryTime(presence_vector=3).encode()), Reject(7, 2))),
    row("Reject 3: connection refused, too many events", CHANGES,
        when=("client", create(PULSE, 1.0), Reject(7, 3)), settings={"max_events": 1}),
    row("Reject 4: invalid setup, periodic without a rate",
        when=("client", create(PULSE, kind=PERIODIC), Reject(7, 4))),
    row("Reject 4: invalid setup, a query that cannot be decoded",
        when=("client", create(STATUS + b"\0"), Reject(7, 4))),
    row("Reject 5: message not supported, unknown",
        when=("client", create(b"\xff\x2f"), Reject(7, 5))),
    row("Reject 5: message not supported, a command",
        when=("client", create(core.Resume().encode()), Reject(7, 5))),
)  # fmt: skip

SLOW, FAILING = SlowCommand(), FailingCommand()

COMMANDS = (
    row("CreateCommandEvent, done at once: Confirm, the command, CommandEvent 0", *controlled(),
        when=("client", command(core.Resume()), confirm(5), ended(0)), status=1),
    row("CreateCommandEvent, under way: Confirm alone", *ready(),
        when=("client", command(SLOW), confirm(5))),
    row("CommandCompleted: CommandEvent 0", *ready(), ("client", command(SLOW)),
        when=lambda stage: stage.component.under_way[0].succeed(), then={"client": [ended(0)]}),
    row("Command failed: CommandEvent 1", *ready(), ("client", command(SLOW)),
        when=lambda stage: stage.component.under_way[0].fail(), then={"client": [ended(1)]}),
    row("Command whose handler raises: CommandEvent 1",
        when=("client", command(FAILING), confirm(5), ended(1)),
        counted="component.handler_failed"),
    row("CommandExpired: CommandEvent 1", *ready(), ("client", command(SLOW, duration=3)),
        when=after(3.1), then={"client": [ended(1)]}, counted="events.command_expired"),
    row("CommandCompleted after it expired: nothing", *ready(),
        ("client", command(SLOW, duration=3)), after(3.1),
        when=lambda stage: stage.component.under_way[0].succeed()),
    row("CreateCommandEvent that exists: updated, same id, executed anew", *ready(),
        ("client", command(SLOW)), ("client", command(SLOW, request=6)),
        when=lambda stage: [completion.succeed() for completion in stage.component.under_way],
        then={"client": [ended(0)]}),
    row("CreateCommandEvent that exists: Confirm with the same id", *ready(),
        ("client", command(SLOW)), when=("client", command(SLOW, request=6), confirm(6))),
    row("CreateCommandEvent of an unknown message: Reject 5",
        when=("client", command(b"\xff\x0f"), Reject(5, 5))),
    row("CreateCommandEvent of a query: Reject 5",
        when=("client", command(core.QueryStatus()), Reject(5, 5))),
    row("CreateCommandEvent within another: Reject 5",
        when=("client", command(command(core.Resume())), Reject(5, 5))),
    row("CreateCommandEvent of a command that cannot be decoded: Reject 4",
        when=("client", command(core.Resume().encode() + b"\0"), Reject(5, 4))),
    row("CreateCommandEvent without control: Reject 3",
        when=("client", command(core.Resume()), Reject(5, 3)), status=2,
        counted="component.command_refused"),
    row("CreateCommandEvent of a command that needs Ready in Standby: Reject 3", *controlled(),
        when=("client", command(SLOW), Reject(5, 3)), counted="component.command_refused"),
    row("CreateCommandEvent, too many: Reject 3", CHANGES,
        when=("client", command(core.RequestControl(authority_code=1)), Reject(5, 3)),
        settings={"max_events": 1}),
    row("CancelEvent of a command event: Confirm, no CommandEvent", *ready(),
        ("client", command(SLOW)), ("client", core.CancelEvent(request_id=9, event_id=0)),
        when=lambda stage: stage.component.under_way[0].succeed()),
    row("CancelEvent of another client's command event: Reject 6", *ready(),
        ("client", command(SLOW)),
        when=("rival", core.CancelEvent(request_id=9, event_id=0), Reject(9, 6))),
    row("Command under way, Ready is left: CommandEvent 1", *ready(), ("client", command(SLOW)),
        when=("client", core.Standby(), ended(1))),
    row("Command that ends control itself: CommandEvent 0", *controlled(), when=("client",
        command(core.Reset()), confirm(5), core.RejectControl(response_code=0), ended(0))),
    row("Command under way when the component stops: CommandEvent 1", *ready(),
        ("client", command(SLOW)), when=lambda stage: stage.component.stop(),
        then={"client": [ended(1), core.RejectControl(response_code=0)]}),
    row("CreateCommandEvent, v1.0: unknown, ignored", *controlled(),
        when=("client", command(core.Resume())), status=2, counted="component.unknown_message",
        version=V1_0),
)  # fmt: skip


def beats(count, first=1):
    return [
        event(0, number & 0xFF, core.ReportHeartbeatPulse().encode())
        for number in range(first, first + count)
    ]


DELIVERY = (
    row("Event periodic: every 1/rate, sequence +1", HEARTBEATS, when=after(0.55, steps=11),
        then={"client": beats(5)}),
    row("Event periodic: the sequence wraps from 255 to 0", HEARTBEATS, after(25.45, steps=509),
        when=after(0.2, steps=4), then={"client": beats(2, first=255)}),
    row("Event every change: at a change", CHANGES, *controlled(),
        when=("client", core.Resume(), event(0, 1, READY))),
    row("Event every change: not without a change", *controlled(), CHANGES,
        when=lambda stage: stage.component.report_changed(core.ReportStatus)),
    row("Event of a client: not to others", ("rival", create(STATUS)), *controlled(),
        when=("client", core.Resume()), then={"rival": [event(0, 1, READY)]}),
)  # fmt: skip


@rows(*REQUESTS, *QUERIES, *REJECTIONS, *COMMANDS, *DELIVERY)
def test_row(world, row):
    play(world, row, Robot)


@pytest.mark.parametrize("query", [core.QueryAuthority(), core.QueryControl(), core.QueryStatus()])
def test_every_report_of_the_core_may_be_an_event(world, query):
    stage = play(world, row("start", when=after(0.1)), Robot)
    confirmed, first = stage.peers["client"].ask(create(query.encode()), stage.component)
    assert isinstance(confirmed, core.ConfirmEventRequest)
    assert isinstance(first, core.Event)


def test_a_completion_counts_once(world):
    stage = play(world, row("start", *ready(), when=("client", command(SLOW), confirm(5))), Robot)
    (completion,) = stage.component.under_way
    assert completion.active
    assert completion.succeeded is None
    completion.succeed()
    completion.fail()
    assert completion.succeeded is True
    assert stage.heard() == {"client": [ended(0)]}

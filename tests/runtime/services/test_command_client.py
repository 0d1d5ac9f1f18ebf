"""Commands whose end is told, and emergencies, from the client's side."""

import pytest

from jausml.runtime import Completion, Guard, JausComponent, Status
from jausml.runtime import messages as core
from jausml.runtime.base.address import BROADCAST, JausAddress

from ..conftest import reports_of

TARGET = JausAddress(1, 1, 1)


class Drive(core.SetAuthority):
    """A command that takes time."""

    CODE = 0x1F00
    NAME = "Drive"


class Robot(JausComponent):
    def __init__(self, *arguments, **named):
        super().__init__(*arguments, **named)
        self.drives = []
        self.handle(Drive, self.on_drive, when=Guard.READY)

    def on_drive(self, _message, _sender):
        self.drives.append(Completion())
        return self.drives[-1]


class Outcome:
    """What the client was told."""

    def __init__(self):
        self.done = []
        self.refused = []

    def callbacks(self):
        return {
            "on_done": self.done.append,
            "on_refused": lambda code, text: self.refused.append((code, text)),
        }


@pytest.fixture
def robot(world):
    return world.started(str(TARGET), kind=Robot)


@pytest.fixture
def outcome():
    return Outcome()


@pytest.fixture
def session(world, robot, client):
    made = client.control(TARGET, authority=100)
    world.run(1.0, step=0.1)
    assert robot.status is Status.READY
    return made


@pytest.mark.usefixtures("session")
class TestCommand:
    @pytest.mark.parametrize("good", [True, False])
    def test_end_is_told_once(self, world, robot, client, outcome, good):
        client.command(TARGET, Drive(), **outcome.callbacks())
        world.run(5.0, step=0.5)
        assert (outcome.done, outcome.refused) == ([], [])
        (drive,) = robot.drives
        drive.succeed() if good else drive.fail()
        world.settle()
        assert (outcome.done, outcome.refused) == ([good], [])
        world.run(100.0, step=1.0)
        assert outcome.done == [good]

    def test_command_that_takes_too_long(self, world, robot, client, outcome):
        client.command(TARGET, Drive(), max_duration=5, **outcome.callbacks())
        world.run(6.0, step=0.5)
        assert outcome.done == [False]
        assert not robot.drives[0].active

    def test_refusal(self, world, client, outcome, session):
        session.release()
        world.settle()
        client.command(TARGET, Drive(), **outcome.callbacks())
        world.settle()
        assert outcome.done == []
        ((code, text),) = outcome.refused
        assert code == 3
        assert text

    def test_lost_end(self, world, client, outcome):
        world.lost = lambda _source, _destination, code: code == core.CommandEvent.CODE
        client.command(TARGET, Drive(), max_duration=5, **outcome.callbacks())
        world.run(20.0, step=0.5)
        assert outcome.done == [False]
        assert world.counters.snapshot()["command_client.lost"] == 1

    def test_cancel(self, world, robot, client, outcome):
        pending = client.command(TARGET, Drive(), **outcome.callbacks())
        world.settle()
        pending.cancel()
        world.settle()
        assert world.count(core.CancelEvent.CODE) == 1
        assert not robot.drives[0].active
        world.run(100.0, step=1.0)
        assert (outcome.done, outcome.refused) == ([], [])

    def test_two_commands_at_a_time(self, world, robot, client):
        first, second = Outcome(), Outcome()
        client.command(TARGET, Drive(), **first.callbacks())
        client.command(TARGET, core.Resume(), **second.callbacks())
        world.settle()
        assert (first.done, second.done) == ([], [True])
        robot.drives[0].succeed()
        world.settle()
        assert first.done == [True]

    def test_a_command_that_the_same_one_replaces_has_failed(self, world, robot, client):
        first, second = Outcome(), Outcome()
        client.command(TARGET, Drive(authority_code=1), **first.callbacks())
        world.settle()
        client.command(TARGET, Drive(authority_code=2), **second.callbacks())
        world.settle()
        assert (first.done, second.done) == ([False], [])
        robot.drives[-1].succeed()
        world.settle()
        assert (first.done, second.done) == ([False], [True])

    def test_a_command_that_is_cancelled_when_it_replaces_one_is_told_of_no_more(
        self, world, robot, client, outcome
    ):
        """The end of the former command has its user give up both."""
        following = []
        client.command(TARGET, Drive(), on_done=lambda _: following[0].cancel(), on_refused=None)
        world.settle()
        following.append(client.command(TARGET, Drive(), **outcome.callbacks()))
        world.settle()
        assert not robot.drives[-1].active
        world.run(100.0, step=1.0)
        assert (outcome.done, outcome.refused) == ([], [])
        assert "command_client.lost" not in world.counters.snapshot()

    def test_next_to_events_of_the_same_provider(self, world, client, outcome):
        asked = core.QueryHeartbeatPulse(), core.ReportHeartbeatPulse
        reports = reports_of(client, TARGET, *asked, rate=1)
        client.command(TARGET, core.Resume(), **outcome.callbacks())
        world.run(5.0, step=0.5)
        assert outcome.done == [True]
        assert len(reports) >= 5

    def test_ends_of_two_commands_that_overtake_their_confirmations(self, world, client):
        probe, ends = world.probe("5.1.1"), (Outcome(), Outcome())
        for end in ends:
            client.command(probe.address, Drive(), **end.callbacks())
        first, second = probe.take()
        for event_id, result in ((8, 0), (9, 1)):
            probe.send(core.CommandEvent(event_id=event_id, command_result=result), client)
        for event_id, request in ((8, first), (9, second)):
            confirm = core.ConfirmEventRequest(request_id=request.request_id, event_id=event_id)
            probe.send(confirm, client)
        world.settle()
        assert [end.done for end in ends] == [[True], [False]]

    @pytest.mark.parametrize("ends_by", ["cancel", "confirmation", "rejection"])
    def test_an_early_end_is_not_that_of_a_later_command(self, world, client, outcome, ends_by):
        probe = world.probe("5.1.1")
        before = client.command(probe.address, Drive())
        (request,) = probe.take()
        probe.tell(client, core.CommandEvent(event_id=9, command_result=0))
        if ends_by == "cancel":
            before.cancel()
        elif ends_by == "confirmation":
            confirm = core.ConfirmEventRequest(request_id=request.request_id, event_id=8)
            probe.send(confirm, client)
        else:
            probe.send(core.RejectEventRequest(request_id=request.request_id), client)
        world.settle()
        assert world.counters.snapshot()["command_client.unknown_event"] == 1
        probe.take()
        client.command(probe.address, Drive(), **outcome.callbacks())
        (request,) = probe.take()
        probe.tell(client, core.ConfirmEventRequest(request_id=request.request_id, event_id=9))
        assert outcome.done == []

    def test_reject_without_code_and_text(self, world, client, outcome):
        probe = world.probe("5.1.1")
        client.command(probe.address, Drive(), **outcome.callbacks())
        (request,) = probe.take()
        probe.tell(client, core.RejectEventRequest(request_id=request.request_id))
        assert outcome.refused == [(None, "")]


@pytest.mark.parametrize("ends_by", ["cancel", "no answer", "confirmation", "rejection"])
def test_a_command_without_an_answer_is_not_executed_later(world, client, outcome, ends_by):
    world.detach(TARGET)
    pending = client.command(TARGET, Drive(authority_code=1), **outcome.callbacks())
    world.settle()
    request_id = pending.request_id
    if ends_by == "cancel":
        pending.cancel()
    elif ends_by == "confirmation":
        world.send(TARGET, client.address, core.ConfirmEventRequest(request_id, 5, 0.0).encode())
        world.settle()
        pending.cancel()
    elif ends_by == "rejection":
        world.send(TARGET, client.address, core.RejectEventRequest(request_id, 1).encode())
    world.run(60.0, step=0.5)
    start = core.CreateCommandEvent.CODE.to_bytes(2, "little") + bytes([request_id])
    is_withdrawn = ends_by in {"cancel", "no answer"}
    assert world.count(core.CreateCommandEvent.CODE) == 1
    assert ((None, "no answer") in outcome.refused) is (ends_by == "no answer")
    assert world.withdrawn == [(client.address, TARGET, start)] * is_withdrawn


@pytest.mark.usefixtures("session")
def test_cancel_after_the_end_does_no_harm_to_the_next_command(world, robot, client, outcome):
    first = client.command(robot.address, Drive())
    world.settle()
    robot.drives[0].succeed()
    world.settle()
    client.command(robot.address, Drive(), **outcome.callbacks())
    world.settle()
    first.cancel()
    world.settle()
    assert world.count(core.CancelEvent.CODE) == 0
    assert robot.drives[1].active
    robot.drives[1].succeed()
    world.settle()
    assert outcome.done == [True]


@pytest.mark.usefixtures("session")
def test_a_command_that_is_cancelled_before_its_confirmation_is_cancelled_at_the_target(
    world, robot, client, outcome
):
    cancelled = []
    robot.on_message(core.CancelEvent, lambda message, _: cancelled.append(message.event_id))
    pending = client.command(TARGET, Drive(1), **outcome.callbacks())
    pending.cancel()
    world.run(1.0, step=0.1)

    assert len(cancelled) == 1
    assert (outcome.done, outcome.refused) == ([], [])


@pytest.mark.usefixtures("session")
def test_command_that_follows_a_cancelled_one_is_told_its_own_end(world, robot, client, outcome):
    first = client.command(robot.address, Drive())
    world.settle()
    first.cancel()
    client.command(robot.address, Drive(), **outcome.callbacks())
    world.settle()
    robot.drives[1].succeed()
    world.settle()
    assert outcome.done == [True]


def test_command_before_the_start(world, robot, outcome):
    late = world.component("2.1.1", services=())
    late.command(robot.address, core.Resume(), **outcome.callbacks())
    world.settle()
    assert world.count(core.CreateCommandEvent.CODE) == 0
    late.start()
    world.settle()
    assert outcome.refused[0][0] == 3


def test_end_that_nobody_awaits_is_counted(world, client):
    world.probe("5.1.1").tell(client, core.CommandEvent(event_id=9, command_result=0))
    assert world.counters.snapshot()["command_client.unknown_event"] == 1


def test_stop_awaits_nothing_more(world, client, outcome):
    client.command(TARGET, core.Resume(), **outcome.callbacks())
    client.stop()
    world.run(10.0, step=1.0)
    assert (outcome.done, outcome.refused) == ([], [])


@pytest.mark.parametrize("duration", [-1, 1 << 32])
def test_impossible_durations(client, duration):
    with pytest.raises(ValueError, match="outside"):
        client.command(TARGET, core.Resume(), max_duration=duration)


def test_wildcards_are_refused(client):
    with pytest.raises(ValueError, match="one component"):
        client.command(BROADCAST, core.Resume())


def test_too_many_commands(client):
    for _ in range(31):
        client.command(TARGET, core.Resume())
    with pytest.raises(ValueError, match="31 commands"):
        client.command(TARGET, core.Resume())


def test_emergency_is_set_and_cleared_with_the_highest_priority(world, robot, client):
    priorities = []
    send = world.send

    def watch(source, destination, payload, *, priority, acknowledge, **named):
        priorities.append((int(priority), acknowledge))
        send(source, destination, payload, priority=priority, **named)

    world.send = watch
    client.set_emergency(TARGET)
    world.settle()
    assert robot.status is Status.EMERGENCY
    client.clear_emergency(TARGET)
    world.settle()
    assert robot.status is Status.STANDBY
    assert priorities == [(3, True), (3, True)]

"""Control sessions: control is sought, kept, lost, shared and released."""

import random

import pytest

from jausml.runtime import ControlState, JausComponent, ServiceIdentity, Status
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.quirks import Quirk
from jausml.runtime.messages import (
    ClearEmergency,
    ConfirmControl,
    CreateEvent,
    QueryControl,
    QueryStatus,
    QueryTimeout,
    RejectControl,
    ReleaseControl,
    ReportStatus,
    RequestControl,
    Resume,
    SetEmergency,
    Standby,
)

from .state_tables import V1_0, core_services

TARGET = JausAddress(1, 1, 1)
SEEKING, CONTROLLED, READY, REFUSED = ControlState


def target(world, **settings):
    return world.started(str(TARGET), **settings)


def kill(world, component):
    """Ends a component as a crash does: without a word."""
    component._jaus_access._timer.cancel()
    world.detach(component.address)


def test_session_before_the_start(world):
    tested = target(world)
    late = world.component("2.1.1", services=())
    session = late.control(TARGET, authority=127)
    world.run(5.0)
    assert tested.controller is None
    late.start()
    world.settle()
    assert session.state is READY


def test_target_that_is_not_to_be_resumed(world, client):
    tested = target(world)
    session = client.control(TARGET, authority=127, resume=False)
    world.run(5.0)
    assert session.state is CONTROLLED
    assert tested.status is Status.STANDBY


def test_target_without_management(world, client):
    services = (ServiceIdentity("urn:jaus:jss:core:AccessControl", 1, 0),)
    target(world, services=services)
    session = client.control(TARGET, authority=127)
    world.run(5.0)
    assert session.state is CONTROLLED
    assert world.count(Resume.CODE) == 0


@pytest.mark.parametrize("timeout", [0, 1, 5, 60])
def test_control_is_kept(world, client, timeout):
    tested = target(world, control_timeout=timeout)
    states = []
    client.control(TARGET, authority=127, on_change=states.append)
    world.run(30.0)
    assert states == [CONTROLLED, READY]
    assert tested.controller == client.address
    assert "access_control.timed_out" not in world.counters.snapshot()


def test_control_is_renewed_four_times_in_the_timeout(world):
    patient = world.started("2.1.1", services=(), watch_interval=100.0)
    target(world, control_timeout=10)
    patient.control(TARGET, authority=127)
    world.run(1.0)
    assert world.count(QueryTimeout.CODE) == 1
    world.log.clear()
    world.run(50.0)
    assert world.count(RequestControl.CODE) == 20


def test_target_that_comes_later(world, client):
    session = client.control(TARGET, authority=127)
    world.run(60.0)
    assert session.state is SEEKING
    assert world.count(RequestControl.CODE) == pytest.approx(24, abs=2)
    target(world)
    world.run(5.1)
    assert session.state is READY


def test_target_that_comes_later_and_speaks_is_asked_at_once(world, client):
    session = client.control(TARGET, authority=127)
    world.run(60.0)
    late = target(world)
    late.send(QueryStatus(), client.address)
    world.run(0.3)
    assert session.state is READY


def test_restarted_target_is_resumed_again(world, client):
    first = target(world)
    states = []
    client.control(TARGET, authority=127, on_change=states.append)
    world.run(3.0)
    kill(world, first)
    second = target(world)
    world.run(2.0)
    assert second.controller == client.address
    assert second.status is Status.READY
    assert states == [CONTROLLED, READY, CONTROLLED, READY]


def test_dead_target_is_noticed(world, client):
    tested = target(world)
    states = []
    client.control(TARGET, authority=127, on_change=states.append)
    world.run(1.0)
    kill(world, tested)
    world.run(6.0)
    assert states[-1] is SEEKING
    assert world.counters.snapshot()["control_client.lost"] == 1


def test_target_in_standby_is_resumed(world, client):
    tested = target(world)
    session = client.control(TARGET, authority=127)
    world.settle()
    client.send(Standby(), TARGET)
    world.settle()
    assert tested.status is Status.STANDBY
    world.run(1.1)
    assert tested.status is Status.READY
    assert session.state is READY


def test_target_that_does_not_obey_resume_is_not_flooded(world, client):
    target(world)
    world.lost = lambda *message: message[2] == Resume.CODE
    client.control(TARGET, authority=127)
    world.run(20.0)
    assert world.count(Resume.CODE) == pytest.approx(27, abs=2)  # eight soon, then one a second


def test_higher_authority_elsewhere(world, client):
    tested = target(world)
    rival = world.probe("3.1.1")
    rival.ask(RequestControl(authority_code=200), tested)
    states = []
    session = client.control(TARGET, authority=127, on_change=states.append)
    world.run(4.0)
    assert session.state is REFUSED
    assert states == [REFUSED]
    assert world.count(ConfirmControl.CODE) == 2
    rival.ask(ReleaseControl(), tested)
    world.run(5.1)
    assert session.state is READY


def test_take_over_and_release_are_known_at_once(world, client):
    tested = target(world, control_timeout=0)
    states = []
    session = client.control(TARGET, authority=127, on_change=states.append)
    world.run(3.0)
    rival = world.probe("3.1.1", strict=False)
    rival.ask(RequestControl(authority_code=200), tested)
    world.run(0.2)
    assert session.state is REFUSED
    assert session.controller == rival.address
    assert session.reason == "3.1.1 controls 1.1.1"
    world.run(20.0)
    assert session.state is REFUSED
    rival.ask(ReleaseControl(), tested)
    world.run(1.1)  # as long as the target is asked again who controls it
    assert session.state is READY
    assert session.controller == tested.controller == client.address
    assert session.reason == ""
    assert states == [CONTROLLED, READY, SEEKING, REFUSED, CONTROLLED, READY]


@pytest.mark.parametrize("version", [0, 1])
def test_emergency_and_recovery(world, client, version):
    services = core_services((1, version), "Events", "AccessControl", "Management")
    tested = target(world, services=services)
    session = client.control(TARGET, authority=127)
    world.run(1.0)
    guard = world.probe("3.1.1")
    guard.ask(SetEmergency(emergency_code=1), tested)
    world.run(0.2)
    assert session.state is REFUSED
    assert session.status is Status.EMERGENCY
    assert session.reason == "1.1.1 is in EMERGENCY"
    assert tested.status is Status.EMERGENCY
    world.log.clear()
    world.run(10.0)
    assert world.count(RequestControl.CODE) <= 2
    guard.ask(ClearEmergency(emergency_code=1), tested)
    world.run(1.1)
    assert session.state is READY


def test_events_tell_at_once_what_the_target_does_by_itself(world, client):
    tested = target(world)
    states = []
    session = client.control(TARGET, authority=127, resume=False, on_change=states.append)
    world.settle()
    client.send(Resume(), TARGET)
    world.settle()
    assert session.state is READY
    tested._jaus_management.stand_by()
    world.settle()
    assert states == [CONTROLLED, READY, CONTROLLED]
    assert session.status is Status.STANDBY


def test_events_tell_at_once_that_control_can_be_had_again(world, client):
    tested = target(world, control_timeout=0)
    session = client.control(TARGET, authority=127)
    world.run(1.0)
    rival = world.probe("3.1.1")
    rival.ask(RequestControl(authority_code=200), tested)
    world.run(7.3)
    assert session.state is REFUSED
    rival.ask(ReleaseControl(), tested)
    world.settle()
    assert session.state is READY


def test_target_without_events_is_not_asked_for_them_for_ever(world, client):
    target(world, services=core_services(V1_0, "AccessControl", "Management"))
    session = client.control(TARGET, authority=127)
    world.run(6.0)
    asked = world.count(CreateEvent.CODE)
    assert asked < 40
    world.run(60.0, step=0.05)
    assert session.state is READY
    assert world.count(CreateEvent.CODE) == asked


def test_refused_target_that_dies_is_sought(world, client):
    tested = target(world)
    world.probe("3.1.1").ask(RequestControl(authority_code=200), tested)
    session = client.control(TARGET, authority=127)
    world.run(1.0)
    assert session.state is REFUSED
    kill(world, tested)
    world.run(8.0)
    assert session.state is SEEKING
    assert session.reason == "1.1.1 has not granted control"


def test_questions_that_stay_unanswered_are_given_up(world, client):
    """Some components answer neither QueryTimeout nor QueryControl."""
    target(world, control_timeout=0)
    world.lost = lambda *message: message[2] in (QueryTimeout.CODE, QueryControl.CODE)
    session = client.control(TARGET, authority=127)
    world.run(60.0)
    assert session.state is READY
    assert world.count(QueryTimeout.CODE) == 8
    world.probe("3.1.1", strict=False).ask(RequestControl(authority_code=200), TARGET)
    world.run(60.0)
    assert session.state is REFUSED
    assert world.count(QueryControl.CODE) == 8


def test_a_target_that_grants_and_takes_away_is_not_flooded(world, client):
    tested = target(world)
    tested.on_controller_changed = lambda controller: (
        world.loop.call_soon(lambda: tested._jaus_access.drop(0)) if controller else None
    )
    client.control(TARGET, authority=127)
    world.run(10.0)
    assert world.count(RequestControl.CODE) < 110


@pytest.mark.parametrize("end", ["emergency", "failure", "shutdown"])
def test_a_component_that_must_not_work_controls_nobody(world, end):
    commander = world.started("2.1.1", kind=JausComponent)
    tested = target(world)
    states = []
    session = commander.control(TARGET, authority=127, on_change=states.append)
    world.run(1.0)
    assert tested.status is Status.READY
    guard = world.probe("3.1.1")
    if end == "emergency":
        guard.ask(SetEmergency(emergency_code=1), commander)
    elif end == "failure":
        commander.fail("broken")
    else:
        commander._jaus_management.shut_down()
    world.run(30.0)
    assert tested.controller is None
    assert tested.status is Status.STANDBY
    assert states == [CONTROLLED, READY, SEEKING]
    assert session.reason == "this component may not command now"
    if end == "emergency":
        guard.ask(ClearEmergency(emergency_code=1), commander)
        world.run(0.5)
        assert tested.controller == commander.address
        assert session.state is READY


@pytest.mark.parametrize("hook", ["on_ready", "on_not_ready"])
def test_a_component_that_fails_in_a_hook_controls_nobody(world, hook):
    commander = world.started("2.1.1", kind=JausComponent, control_timeout=0)
    setattr(commander, hook, lambda: commander.fail("a brake is stuck"))
    tested = target(world)
    session = commander.control(TARGET, authority=127)
    world.run(1.0)
    assert session.state is READY
    operator = world.probe("3.1.1", strict=False)
    operator.tell(commander, RequestControl(authority_code=127), Resume(), Standby())
    world.run(3.0)
    assert commander.status is Status.FAILURE
    assert tested.controller is None
    assert session.state is SEEKING


def test_a_session_of_a_component_in_emergency_waits(world):
    commander = world.started("2.1.1")
    tested = target(world)
    guard = world.probe("3.1.1")
    guard.ask(SetEmergency(emergency_code=1), commander)
    session = commander.control(TARGET, authority=127)
    world.run(5.0)
    assert tested.controller is None
    guard.ask(ClearEmergency(emergency_code=1), commander)
    world.run(0.5)
    assert session.state is READY


class TestSharing:
    def test_sessions_add_no_packets(self, world, client):
        target(world)
        first = client.control(TARGET, authority=127)
        world.run(10.0)
        world.log.clear()
        world.run(10.0)
        alone = len(world.log)
        states = []
        second = client.control(TARGET, authority=127, on_change=states.append)
        world.run(1.0)
        assert states == [READY]
        world.log.clear()
        world.run(10.0)
        assert len(world.log) == alone
        first.release()
        world.run(1.0)
        assert second.state is READY
        second.release()
        second.release()
        world.settle()
        assert world.count(ReleaseControl.CODE) == 1

    def test_highest_authority_wins(self, world, client):
        tested = target(world)
        client.control(TARGET, authority=50)
        world.settle()
        client.control(TARGET, authority=60)
        world.settle()
        assert tested.authority == 60


@pytest.mark.parametrize("end", ["release", "stop"])
def test_the_end_of_a_session_or_of_its_component_releases_control(world, client, end):
    tested = target(world)
    session = client.control(TARGET, authority=127)
    world.settle()
    if end == "release":
        session.release()
    else:
        client.stop()
    world.settle()
    assert tested.controller is None
    assert tested.status is Status.STANDBY
    world.log.clear()
    world.run(30.0)
    assert world.log == []


@pytest.mark.parametrize("authority", [-1, 256])
def test_impossible_authority(client, authority):
    with pytest.raises(ValueError, match="authority"):
        client.control(TARGET, authority=authority)


def test_words_of_strangers_are_ignored(world, client):
    target(world)
    session = client.control(TARGET, authority=127)
    world.settle()
    stranger = world.probe("3.1.1")
    stranger.tell(
        client,
        RejectControl(response_code=0),
        ConfirmControl(response_code=2),
        ReportStatus(status=2, reserved=0),
    )
    assert session.state is READY


@pytest.mark.parametrize("moment", [CONTROLLED, READY, REFUSED])
def test_session_that_is_released_in_its_callback_is_over(world, client, moment):
    tested = target(world, default_authority=200 if moment is REFUSED else 0)
    states = []

    def on_change(state):
        states.append(state)
        if state is moment:
            session.release()

    session = client.control(TARGET, authority=127, on_change=on_change)
    world.run(1.0)
    sent, told = world.count(RequestControl.CODE), list(states)
    world.run(30.0, step=0.1)
    assert world.count(RequestControl.CODE) == sent
    assert states == told
    assert tested.controller is None
    assert "loop.callback_failed" not in world.counters.snapshot()


def test_released_session_hears_nothing_more(world, client):
    target(world)
    first = client.control(TARGET, authority=127)
    world.settle()
    states = []
    second = client.control(TARGET, authority=127, on_change=states.append)
    second.release()
    world.settle()
    assert first.state is READY
    assert states == []


def test_release_while_a_request_after_a_refusal_is_on_its_way(world, client):
    tested = target(world, control_timeout=0)
    rival = world.probe("3.1.1")
    rival.ask(RequestControl(authority_code=200), tested)
    session = client.control(TARGET, authority=127)
    world.settle()
    assert session.state is REFUSED
    rival.ask(ReleaseControl(), tested)
    world.lost = lambda _source, _destination, code: code == ConfirmControl.CODE
    world.run(5.5, step=0.1)
    assert tested.controller == client.address
    session.release()
    world.settle()
    assert tested.controller is None


@pytest.mark.timeout(20)
def test_a_target_that_confirms_while_a_release_is_under_way_is_not_flooded(world, client):
    peer = world.probe(str(TARGET))
    session = client.control(TARGET, authority=127)
    peer.ask(ConfirmControl(response_code=0), client)
    assert session.state is CONTROLLED
    deliver, results = world.send, []

    def without_acknowledgements(*message, on_result=None, **options):
        results.append(on_result)
        deliver(*message, **options)

    world.send = without_acknowledgements
    session.release()
    world.settle()
    again = client.control(TARGET, authority=127)
    peer.ask(ConfirmControl(response_code=0), client)
    assert again.state is CONTROLLED
    world.log.clear()
    world.run(2.0)
    assert world.count(RequestControl.CODE) == 0
    assert 0 < world.count(QueryStatus.CODE) < 20
    (acknowledged,) = filter(None, results)
    acknowledged(True)
    world.run(2.0)
    assert world.count(RequestControl.CODE) > 0


@pytest.mark.parametrize("seed", range(12))
def test_whatever_happens_control_comes_back_and_nobody_is_flooded(world, seed):
    """Loss, rivals, emergencies, standby, crashes and a component that must not command itself."""
    chance = random.Random(seed)
    share = chance.choice([0.0, 0.2, 0.5])
    world.lost = lambda *_: chance.random() < share
    client = world.started("2.1.1")
    tested = target(world, control_timeout=chance.choice([0, 1, 2, 10]))
    rival = world.probe("3.1.1", strict=False)
    session = client.control(TARGET, authority=127)
    for _ in range(40):
        kind = chance.randrange(9)
        if kind < 6:
            message = (
                RequestControl(authority_code=200), ReleaseControl(), Standby(),
                SetEmergency(emergency_code=1), ClearEmergency(emergency_code=1),
                SetEmergency(emergency_code=1),
            )[kind]  # fmt: skip
            rival.send(message, client if kind == 5 else tested)
        elif kind == 6:
            kill(world, tested)
            world.run(chance.random() * 8, step=0.05)
            tested = target(world, control_timeout=2)
        elif kind == 7:
            rival.send(ClearEmergency(emergency_code=1), client)
        world.run(chance.random() * 2, step=0.02)
    world.lost = lambda *_: False
    for component in (tested, client):
        rival.send(ClearEmergency(emergency_code=1), component)
    rival.send(ReleaseControl(), tested)
    world.log.clear()
    world.run(12.0)
    assert session.state is READY
    assert tested.controller == client.address
    assert tested.status is Status.READY
    assert len(world.log) < 400
    counts = world.counters.snapshot()
    assert "component.handler_failed" not in counts
    assert "loop.callback_failed" not in counts


def test_an_answer_is_as_good_as_an_acknowledgement(world, client):
    target(world)
    client.control(TARGET, authority=127)
    world.run(60.0)
    start = RequestControl.CODE.to_bytes(2, "little")
    assert (client.address, TARGET, start) in world.answers
    assert world.quirks.of(TARGET) == ()


def test_who_acts_on_repetitions_too_is_known_for_it(world, client):
    probe = world.probe(str(TARGET))
    client.control(TARGET, authority=127)
    world.run(0.1)
    requests = probe.take(RequestControl)
    for _ in range(len(requests) + 1):
        assert world.quirks.of(TARGET) == ()
        probe.tell(client, ConfirmControl(response_code=0))
    (quirk,) = world.quirks.of(TARGET)
    assert quirk == (Quirk.NO_DUPLICATE_FILTER, "answers 2, requests 1")

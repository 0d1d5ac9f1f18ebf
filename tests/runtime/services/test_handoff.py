"""Control goes from one operator to another, by the decision of a person (IOP)."""

import pytest

from jausml.runtime import (
    BridgeSettings,
    ComponentSettings,
    ControlState,
    HandoffAnswer,
    HandoffBridge,
    HandoffDecision,
    JausComponent,
    ServiceIdentity,
)
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.api import JausError
from jausml.runtime.clients.control_session import ControlClient
from jausml.runtime.messages import ConfirmHandoffRequest, RequestReleaseControl
from jausml.runtime.virtual import Link, VirtualWorld

from ..conftest import wait_until
from .bridge_support import Ros
from .state_tables import CORE_NAMES, V1_1, core_services

ROBOT = JausAddress(1, 1, 1)
LOSSY = Link(delay=0.02, loss=0.2)
SERVICES = (
    *core_services(V1_1, *CORE_NAMES),
    ServiceIdentity("urn:jaus:jss:iop:EnhancedAccessControl", 1, 1),
)
GRANTED, QUEUED = HandoffAnswer.GRANTED, HandoffAnswer.QUEUED


class Operator(JausComponent):
    """Shows a person who asks, keeps the answers, and controls what it is granted."""

    def __init__(self, transport, subsystem, authority):
        super().__init__(
            transport,
            JausAddress(subsystem, 1, 1),
            name=f"operator {subsystem}",
            services=(ServiceIdentity("urn:jaus:jss:iop:HandoffController", 1, 1),),
        )
        self.power = authority
        self.session = None
        self.shown = ()
        self.answers = []

    def take(self):
        self.session = self.control(ROBOT, authority=self.power)

    def ask(self):
        return self.request_handoff(
            ROBOT, authority=self.power, explanation="my shift", on_answer=self.on_answer
        )

    def on_answer(self, answer):
        self.answers.append(answer)
        if answer is GRANTED and self.session is None:
            self.take()

    def on_handoff_requested(self, target, requests):
        assert target == ROBOT
        self.shown = requests

    @property
    def is_ready(self):
        return self.session is not None and self.session.state is ControlState.READY


class Scene:
    """A robot and two operators of different authority, of which the first controls it."""

    def __init__(self, robot_transport, transports, **settings):
        self.robot = JausComponent(
            robot_transport,
            ROBOT,
            name="robot",
            services=SERVICES,
            settings=ComponentSettings(register_services=False, **settings),
        )
        self.controllers = []
        self.robot.on_controller_changed = self.controllers.append
        self.first, self.second = (
            Operator(transport, 2 + number, (200, 100)[number])
            for number, transport in enumerate(transports)
        )
        for jaus_component in (self.robot, self.first, self.second):
            jaus_component.start()
        self.first.take()

    def stop(self):
        for jaus_component in (self.second, self.first, self.robot):
            jaus_component.stop()


@pytest.fixture(params=range(6))
def world(request):
    with VirtualWorld(seed=request.param) as made:
        yield made


def scene(world, **settings):
    made = Scene(
        world.transport(out=LOSSY, into=LOSSY), [world.transport() for _ in range(2)], **settings
    )
    world.run_until(lambda: made.first.is_ready, limit=30)
    return made


def test_a_bridge_hands_the_control_of_a_peer_over(world):
    robot_transport, first, second = (world.transport() for _ in range(3))
    made = Scene(robot_transport, [first, second])
    world.run_until(lambda: made.first.is_ready, limit=10)
    asked = []

    class Commanding(HandoffBridge):
        def on_handoff_requested(self, target, requests):
            assert target == ROBOT
            asked.extend(requests)

    own = JausAddress(7, 1, 1)
    bridge = Commanding(BridgeSettings(name="bridge", address=own, authority=255))
    bridge.open(Ros(), world.transport())
    session = bridge.component.part(ControlClient).control(ROBOT, 255)
    world.run_until(lambda: session.state is ControlState.READY, limit=10)
    made.second.ask()
    world.run_until(lambda: asked, limit=10)
    bridge.decide_handoff(asked[0], HandoffDecision.GRANTED)
    world.run_until(lambda: made.second.is_ready, limit=10)
    bridge.close()


def test_a_person_hands_control_over_and_gets_it_back(world):
    made = scene(world)
    first, second = made.first, made.second
    second.ask()
    world.run_until(lambda: first.shown, limit=30)
    (asked,) = first.shown
    assert (asked.client, asked.authority, asked.explanation) == (second.address, 100, "my shift")
    assert second.answers in ([], [QUEUED])
    first.decide_handoff(asked, HandoffDecision.GRANTED)
    world.run_until(lambda: second.is_ready, limit=10)
    world.run_for(60)
    # The first could take it back by its authority; it does not, since a person gave it away.
    assert made.controllers == [first.address, second.address]
    assert (second.is_ready, first.session.state) == (True, ControlState.SEEKING)
    assert "was handed over" in first.session.reason

    first.ask()
    world.run_until(lambda: second.shown, limit=30)
    second.decide_handoff(second.shown[0], HandoffDecision.GRANTED)
    world.run_until(lambda: first.is_ready, limit=10)
    world.run_for(30)
    assert made.controllers == [first.address, second.address, first.address]
    assert first.answers[-1] is GRANTED


def test_without_a_person_nobody_gets_control(world):
    # Shorter than the pause between two requests while the time-out is not known.
    made = scene(world, handoff_timeout=20, enhanced_timeout=3)
    made.second.ask()
    world.run_until(lambda: HandoffAnswer.TIMEOUT in made.second.answers, limit=60)
    world.run_until(lambda: not made.first.shown, limit=30)
    world.run_for(20)
    assert made.controllers == [made.first.address]
    assert set(made.second.answers) <= {QUEUED, HandoffAnswer.TIMEOUT}


def test_a_person_may_deny(world):
    made = scene(world)
    made.second.ask()
    world.run_until(lambda: made.first.shown, limit=30)
    (asked,) = made.first.shown
    made.first.decide_handoff(asked, HandoffDecision.WAIT)
    world.run_until(lambda: HandoffAnswer.DEFERRED in made.second.answers, limit=30)
    made.first.decide_handoff(asked, HandoffDecision.DENIED)
    world.run_until(lambda: made.second.answers[-1] is HandoffAnswer.DENIED, limit=30)
    assert (made.controllers, made.first.is_ready) == ([made.first.address], True)


def test_what_is_taken_back_cannot_be_granted(world):
    made = scene(world)
    pending = made.second.ask()
    world.run_until(lambda: made.first.shown and pending.number is not None, limit=30)
    (asked,) = made.first.shown
    pending.cancel()
    world.run_until(lambda: not made.first.shown, limit=30)
    with pytest.raises(JausError, match=r"3\.1\.1 does not ask for 1\.1\.1 any more"):
        made.first.decide_handoff(asked, HandoffDecision.GRANTED)
    world.run_for(10)
    assert made.controllers == [made.first.address]


def test_what_is_taken_back_before_its_answer_waits_for_nobody(world):
    made = scene(world)
    pending = made.second.ask()
    for _ in range(2):
        pending.cancel()
    world.run_for(3)
    assert (made.first.shown, made.second.answers) == ((), [])


def test_what_is_taken_back_before_the_start_is_not_sent(world):
    operator = Operator(world.transport(), 3, 100)
    operator.ask().cancel()
    operator.start()
    world.run_for(5)
    assert "transport.unacknowledged" not in operator.counters.snapshot()


def test_only_what_is_controlled_may_ask_to_be_given_up(world):
    made = scene(world)
    record = RequestReleaseControl.RequestReleaseControlRec(0, 3, 1, 1, 255, "give it to me")
    made.second.send(RequestReleaseControl([record]), made.first.address, acknowledge=True)
    world.run_for(5)
    assert made.first.shown == ()
    assert made.first.counters.snapshot()["handoff_client.not_controlled"] == 1


def test_an_answer_without_a_meaning_is_counted(world):
    made = Scene(world.transport(), [world.transport() for _ in range(2)])
    made.second.ask()
    robot = made.robot.address
    unknown = ConfirmHandoffRequest(1, 1).encode()[:-1] + b"\xc8"
    made.robot.transport.send(robot, made.second.address, unknown)
    world.run_for(1.0)
    counts = made.second.counters.snapshot()
    assert counts["handoff_client.bad_answer"] == 1
    assert "component.handler_failed" not in counts


@pytest.mark.ports
def test_over_real_sockets(station):
    made = Scene(station().transport, [station().transport for _ in range(2)])
    wait_until(lambda: made.first.is_ready)
    made.second.ask()
    wait_until(lambda: made.first.shown)
    made.first.decide_handoff(made.first.shown[0], HandoffDecision.GRANTED)
    wait_until(lambda: made.second.is_ready)
    assert made.controllers == [made.first.address, made.second.address]
    made.stop()

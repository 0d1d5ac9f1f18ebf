"""`jausml ocu`: a person asks for control, and another one decides (IOP, HandoffController)."""

import pytest

from jausml.live.peers.console import Console
from jausml.live.peers.operator import running_operator
from jausml.runtime import (
    ComponentSettings,
    ControlState,
    HandoffAnswer,
    HandoffDecision,
    JausComponent,
    ServiceIdentity,
)
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.component.process import running_transport

pytestmark = pytest.mark.ports

TARGET, OTHER = JausAddress(100, 1, 1), JausAddress(60, 1, 1)
HANDOFF = ("iop:EnhancedAccessControl",)


class Other(JausComponent):
    """Another operator unit, whose person decides at once, if at all."""

    decision: HandoffDecision | None = None

    def on_handoff_requested(self, _target, requests):
        if requests and self.decision is not None:
            self.decide_handoff(requests[0], self.decision)


@pytest.fixture
def other(free_port):
    with running_transport(TransportSettings(port=free_port)) as transport:
        made = Other(
            transport,
            OTHER,
            name="other",
            services=(ServiceIdentity("urn:jaus:jss:iop:HandoffController", 1, 1),),
            settings=ComponentSettings(register_services=False),
        )
        made.start()
        yield made
        made.stop()


def test_control_that_is_granted_is_kept(jausml, component, other, wait_until):
    target = component(services=HANDOFF)
    other.decision = HandoffDecision.GRANTED
    other.control(TARGET, authority=250)
    wait_until(lambda: target.controller == OTHER)
    result = jausml("ocu", input="handoff 100.1.1 205 my shift begins\nresume\nrelease\n")
    assert result.exit_code == 0, result.output
    lines = result.stdout.splitlines()
    assert lines[-3:] == ["100.1.1 is controlled", "100.1.1 is in READY", "100.1.1 is released"]
    assert target.controller is None


def test_control_that_is_denied_is_not_taken(jausml, component, other, wait_until):
    target = component(services=HANDOFF)
    other.decision = HandoffDecision.DENIED
    other.control(TARGET, authority=100)
    wait_until(lambda: target.controller == OTHER)
    result = jausml("ocu", input="handoff 100.1.1\n")
    assert result.exit_code == 1
    assert "error: 100.1.1 is not handed over: DENIED" in result.stdout
    assert target.controller == OTHER


def test_a_component_without_handoff_is_told(jausml, component):
    component()
    result = jausml("ocu", "--timeout", "0.5", input="handoff 100.1.1\ngrant 7\ngrant\n")
    assert result.exit_code == 1
    assert "nobody asks for control of 100.1.1 under number 7" in result.stdout
    assert "error: which request?; usage: grant [ID] NUMBER" in result.stdout
    assert "RequestHandoff" in result.stdout


def test_the_person_at_the_terminal_decides(network, catalogue, component, other, wait_until):
    target = component(services=HANDOFF)
    said, answers = [], []
    with running_operator(network, catalogue) as operator:
        console = Console(operator, said.append)
        console.execute("control", "100.1.1")
        other.request_handoff(
            TARGET, authority=50, explanation="noon\x1b[2J", on_answer=answers.append
        )
        asks = (
            "note: 60.1.1 asks for control of 100.1.1 with authority 50: 'noon\\x1b[2J'; "
            "'grant 100.1.1 0', 'deny' or 'defer'"
        )
        wait_until(lambda: asks in said)
        console.execute("defer", "0")
        wait_until(lambda: HandoffAnswer.DEFERRED in answers)
        assert target.controller == operator.own
        console.execute("grant", "0")
        wait_until(lambda: target.controller == OTHER)
        wait_until(lambda: HandoffAnswer.GRANTED in answers)
    assert "100.1.1 is told that 60.1.1 is to wait" in said
    assert "100.1.1 is told that 60.1.1 is granted control" in said
    assert console.failures == 0
    assert target.controller == OTHER


def test_control_that_another_one_took_is_given_up_without_waiting_for_an_answer(
    network, catalogue, component, other, wait_until
):
    component()
    with running_operator(network, catalogue, timeout=2.0) as operator:
        hold = operator.control(TARGET, 200)
        other.control(TARGET, authority=250)
        wait_until(lambda: hold.session.state is ControlState.REFUSED)
        # It answers no ReleaseControl of who does not control it: that would be awaited in vain.
        assert operator.release(TARGET)
        assert operator.holds == ()

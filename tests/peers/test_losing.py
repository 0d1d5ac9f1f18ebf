"""A component that is lost while it is commanded, and tools that must not disturb each other."""

import re
import subprocess
from contextlib import ExitStack, contextmanager
from functools import partial
from threading import Event, Thread

import pytest
import warm

from jausml.live.peers.identity import identified
from jausml.live.peers.network import DEFAULT_GROUP, make_network
from jausml.live.peers.operator import running_operator
from jausml.runtime import JausComponent
from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.component.process import running_transport
from jausml.runtime.messages import (
    ClearEmergency,
    QueryStatus,
    RequestControl,
    Resume,
    SetEmergency,
    Standby,
)
from jausml.runtime.services.definitions import Status

pytestmark = pytest.mark.ports

TARGET = JausAddress(100, 1, 1)
STANDBY = 2
STOP = 1
COMMAND = ("ocu", "command", "100.1.1", "SetWrenchEffort", '{"PropulsiveLinearEffortX": 50}')
FOR_EVER = ("--rate", "50", "--duration", "600")


@pytest.fixture
def rival(free_port):
    """Another operator on the network."""
    with ExitStack() as stack:
        transport = stack.enter_context(running_transport(TransportSettings(port=free_port)))
        made = JausComponent(transport, JausAddress(9, 1, 1), name="rival", services=[])
        made.start()
        stack.callback(made.stop)
        yield made


@contextmanager
def meanwhile(action):
    """Runs an action on another thread while the block runs."""
    thread = Thread(target=action)
    thread.start()
    try:
        yield
    finally:
        thread.join()


@pytest.fixture
def driven(jausml, wait_until):
    """Runs the command line; acts once a vehicle has obeyed so many commands."""

    def run(target, act, *words, obeyed=6, **options):
        def wait_and_act():
            wait_until(lambda: len(target.wrenches) >= obeyed, 30)
            act()

        with meanwhile(wait_and_act):
            return jausml(*words, **options)

    return run


def stop_by(rival):
    return partial(rival.send, SetEmergency(emergency_code=STOP), TARGET, acknowledge=True)


def test_a_lost_command_of_management_is_sent_again_but_what_lets_move(jausml, peer, free_port):
    target = peer("loses each first command")
    session = "control 100.1.1\nresume\nresume\nstandby\nrelease\n"
    result = jausml("ocu", "--peer", f"100.1.1=127.0.0.1:{free_port}", input=session)
    # A Resume that is repeated could come after a stop: the person says it again.
    assert "100.1.1 stays in STANDBY after Resume" in result.output
    assert result.output.count("100.1.1 is in READY") == 1
    assert "stays in READY" not in result.output
    assert target.lost == [command.encode() for command in (Resume(), Standby())]
    assert target.state == STANDBY


def test_an_emergency_ends_a_command_and_is_told(driven, vehicle, rival):
    target = vehicle()
    result = driven(target, stop_by(rival), *COMMAND, *FOR_EVER)
    assert result.exit_code == 4
    assert "100.1.1 is lost: EMERGENCY" in result.stderr
    assert "SetWrenchEffort sent to 100.1.1" in result.stderr
    assert "is released" not in result.stderr
    assert target.status is Status.EMERGENCY


def test_an_emergency_of_core_1_0_ends_a_command_for_good(driven, vehicle, rival, wait_until):
    target = vehicle(version=0)
    assert driven(target, stop_by(rival), *COMMAND, *FOR_EVER).exit_code == 4
    wait_until(lambda: target.status is Status.EMERGENCY)
    sent = len(target.wrenches)
    rival.send(ClearEmergency(emergency_code=STOP), TARGET, acknowledge=True)
    wait_until(lambda: target.status is not Status.EMERGENCY)
    wait_until(lambda: target.controller is None)
    assert len(target.wrenches) == sent


def test_a_take_over_ends_a_command_and_says_by_whom(driven, vehicle, rival):
    target = vehicle(control_timeout=0)
    take_over = partial(rival.send, RequestControl(authority_code=255), TARGET, acknowledge=True)
    result = driven(target, take_over, *COMMAND, *FOR_EVER)
    assert result.exit_code == 4
    assert "controlled by 9.1.1 with authority 255" in result.stderr
    assert target.controller == rival.address


def test_a_target_that_dies_ends_a_command(driven, vehicle):
    target = vehicle()
    die = partial(target.transport.detach, TARGET)
    result = driven(target, die, *COMMAND, *FOR_EVER, "--timeout", "0.5")
    assert result.exit_code == 4
    assert "100.1.1 is lost: it does not answer any more" in result.stderr
    assert " of them when it may not have been READY and ours" in result.stderr


def test_a_target_that_dies_unseen_is_noticed_before_the_release(driven, vehicle):
    target = vehicle()
    die = partial(target.transport.detach, TARGET)
    result = driven(target, die, *COMMAND, "--duration", "0.3", "--timeout", "0.5", obeyed=1)
    assert result.exit_code == 4
    assert "it does not answer any more" in result.stderr


def test_who_keeps_sending_is_told_how_much_was_in_vain(driven, vehicle, rival):
    target = vehicle()
    how = ("--rate", "20", "--duration", "3", "--keep-sending")
    result = driven(target, stop_by(rival), *COMMAND, *how)
    assert result.exit_code == 4
    words = result.stderr.partition("SetWrenchEffort sent to 100.1.1 ")[2].split()
    sent, doubtful = int(words[0]), int(words[2])
    assert sent - doubtful == pytest.approx(len(target.wrenches), abs=10)
    assert doubtful > 10


def test_a_session_tells_what_becomes_of_control(driven, vehicle, rival):
    commands = """
        control 100.1.1
        resume
        send SetWrenchEffort {"PropulsiveLinearEffortX": 25}
        wait 2
        send SetWrenchEffort {"PropulsiveLinearEffortX": 50}
    """
    # Once it has sent, the session has seen that the vehicle is ready.
    result = driven(vehicle(), stop_by(rival), "ocu", obeyed=1, input=commands)
    assert result.exit_code == 4
    assert "note: 100.1.1 is not controlled by us any more" in result.stdout
    assert "note: 100.1.1 is in EMERGENCY" in result.stdout
    assert "note: 100.1.1 is not controlled by us; it may ignore SetWrenchEffort" in result.stdout
    # The first one may have been on its way when the emergency came.
    sent = r"note: messages sent to 100\.1\.1 2 times, [12] of them when it may not have been READY"
    assert re.search(sent, result.stdout)


def test_a_session_that_stands_by_itself_loses_nothing(jausml, vehicle):
    vehicle()
    commands = "control 100.1.1\nresume\nstandby\nwait 1\nresume\nrelease\n"
    result = jausml("ocu", input=commands)
    assert result.exit_code == 0
    assert "note" not in result.stdout


def test_tools_of_one_host_have_ids_of_their_own(free_port):
    def network(own=None):
        return make_network(own, "127.0.0.1", free_port, "239.255.0.1", [])

    with identified(network()) as first, identified(network(), 3) as second:
        assert first.own != second.own
        assert second.own.component > first.own.component
        assert not first.is_shared
        with identified(network(str(second.own))) as third:
            assert (third.own, third.is_shared) == (second.own, True)
    with identified(network()) as again:
        assert again.own == first.own


def test_the_node_of_a_tool_is_that_of_its_interface(free_port):
    network = make_network(None, "10.77.0.42", free_port, "239.255.0.1", [])
    with identified(network) as ours:
        assert str(ours.own).startswith("65000.42.")


def test_an_id_that_another_tool_has_is_warned_of(jausml, component, network):
    component()
    with identified(network):
        result = jausml("ocu", "status", "100.1.1", "--id", "65000.1.1")
    assert "warning: another jausml tool of this host has the id 65000.1.1 too" in result.stderr


def test_a_program_that_sends_under_our_id_is_warned_of(jausml, component, free_port):
    component()
    over = Event()

    def impersonate():
        with running_transport(TransportSettings(port=free_port)) as transport:
            double = JausComponent(transport, JausAddress(65000, 1, 1), name="double", services=[])
            double.start()
            while not over.wait(0.05):
                double.send(QueryStatus(), BROADCAST)
            double.stop()

    with meanwhile(impersonate):
        result = jausml("ocu", "discover", "--duration", "1.5", "--id", "65000.1.1")
        over.set()
    assert result.exit_code == 0
    assert "warning: another program of the network sends as 65000.1.1" in result.stderr


def test_a_watch_goes_on_while_another_tool_commands(jausml, vehicle, free_port, wait_until):
    target = vehicle()
    line = [*warm.command(), "ocu", "watch", "100.1.1", "VelocityState", "--port", str(free_port)]
    line += ["--rate", "10", "--count", "40"]
    watch = subprocess.Popen(line, stdout=subprocess.PIPE, text=True)
    try:
        wait_until(lambda: target._jaus_events._events, 60)
        result = jausml(*COMMAND, "--rate", "20", "--duration", "1")
        assert result.exit_code == 0, result.stderr
        out, _ = watch.communicate(timeout=60)
    finally:
        watch.kill()
        watch.wait()
    assert out.count("Velocity_X=1.2500000 m/s") == 40


def test_control_that_cannot_be_asked_for_leaves_nothing_behind(component, free_port, catalogue):
    component()
    network = make_network(None, "127.0.0.1", free_port, DEFAULT_GROUP, ())
    with running_operator(network, catalogue) as operator:
        with pytest.raises(ValueError, match="authority 300"):
            operator.control(TARGET, 300)
        assert operator.holds == ()

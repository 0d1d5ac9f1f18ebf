"""Components over real JUDP: in one process, in several, and how a process begins and ends."""

import signal
from pathlib import Path

import pytest

from jausml.runtime import ComponentSettings, ControlState, JausComponent, Status
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.component import program
from jausml.runtime.messages import (
    QueryHeartbeatPulse,
    QueryStatus,
    QueryTime,
    ReportHeartbeatPulse,
    ReportStatus,
    ReportTime,
    SetTime,
    Shutdown,
)

from ..conftest import reports_of, wait_until
from .state_tables import V1_1, core_services

pytestmark = pytest.mark.ports

SCRIPT = Path(__file__).with_name("robot_process.py")
ROBOT = JausAddress(1, 1, 1)
OPERATOR = JausAddress(2, 1, 1)
DISCOVERY = "urn:jaus:jss:core:Discovery"
QUICK = ComponentSettings(
    register_services=False, retry_max=1.0, watch_interval=0.2, check_interval=0.5
)


@pytest.fixture
def robot(start, free_port):
    """Starts robots on the port."""
    return lambda *arguments: start(SCRIPT, "--jaus-port", free_port, *arguments)


@pytest.fixture
def operator(station):
    """A running component in a process of another port owner."""
    component = JausComponent(
        station().transport, OPERATOR, name="operator", services=(), settings=QUICK
    )
    component.start()
    yield component
    component.stop()


class TestOneProcess:
    @pytest.fixture
    def pair(self, station):
        """Two components on one transport."""
        transport = station().transport
        core = core_services(V1_1, "Events", "AccessControl", "Management", "Liveness", "Discovery")
        made = [
            JausComponent(transport, address, name=str(address), services=core, settings=QUICK)
            for address in (ROBOT, OPERATOR)
        ]
        for jaus_component in made:
            jaus_component.start()
        yield made
        for jaus_component in made:
            jaus_component.stop()

    def test_control_and_events(self, pair):
        robot, operator = pair
        session = operator.control(ROBOT, authority=100)
        statuses = reports_of(operator, ROBOT, QueryStatus(), ReportStatus)
        wait_until(lambda: session.state is ControlState.READY)
        assert robot.controller == OPERATOR
        wait_until(lambda: statuses and statuses[-1].status == Status.READY)
        session.release()
        wait_until(lambda: statuses[-1].status == Status.STANDBY)
        assert robot.controller is None

    def test_discovery_of_each_other(self, pair):
        found = []
        pair[1].discover(DISCOVERY, found.append)
        wait_until(lambda: found)
        assert found[0].address == ROBOT

    def test_address_is_taken(self, pair):
        twin = JausComponent(pair[0].transport, ROBOT, name="twin", services=())
        with pytest.raises(ValueError, match="attached"):
            twin.start()
        assert not twin.running


class TestTwoProcesses:
    def test_commands_reports_and_discovery(self, robot, operator):
        tested = robot()
        found = []
        session = operator.control(ROBOT, authority=100)
        times = reports_of(operator, ROBOT, QueryTime(presence_vector=1), ReportTime)
        tested.expect("ready")
        operator.discover("urn:jaus:jss:core:Management", found.append)
        wait_until(lambda: session.state is ControlState.READY)
        stamp = SetTime.TimeStamp(hour=13, day=1)
        wait_until(lambda: times)
        operator.send(SetTime(time_stamp=stamp), ROBOT)
        tested.expect(f"time 13 of {OPERATOR}")
        wait_until(lambda: times[-1].time_stamp is not None and times[-1].time_stamp.hour == 13)
        wait_until(lambda: found)
        assert found[0].address == ROBOT

    @pytest.mark.slow
    def test_recovery_of_a_killed_robot(self, robot, operator):
        first = robot()
        silences = []
        session = operator.control(ROBOT, authority=100)
        options = {"rate": 20, "silence_timeout": 0.5, "on_silence": lambda: silences.append(1)}
        asked = QueryHeartbeatPulse(), ReportHeartbeatPulse
        pulses = reports_of(operator, ROBOT, *asked, **options)
        wait_until(lambda: session.state is ControlState.READY and len(pulses) > 5)
        silences.clear()
        first.kill()
        wait_until(lambda: silences and session.state is ControlState.SEEKING)
        second = robot()
        second.expect("ready")
        pulses.clear()
        wait_until(lambda: session.state is ControlState.READY and len(pulses) > 5)
        assert len(silences) == 1

    @pytest.mark.slow
    def test_three_processes_on_one_port(self, robot, operator):
        addresses = [JausAddress(3, 1, number) for number in (1, 2)]
        for address in addresses:
            robot("--jaus-id", str(address), "--discovery-scope", "component")
        sessions = [operator.control(address, authority=100) for address in addresses]
        wait_until(lambda: all(session.state is ControlState.READY for session in sessions), 20.0)

    @pytest.mark.slow
    def test_members_register_with_the_subsystem(self, robot, operator):
        robot("--jaus-id", "4.1.1").expect("initialize")
        robot("--jaus-id", "4.1.2", "--discovery-scope", "component").expect("initialize")
        found = []
        operator.discover(DISCOVERY, lambda provider: found.append(str(provider.address)))
        wait_until(lambda: {"4.1.1", "4.1.2"} <= set(found), 20.0)


class TestEnd:
    @pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
    def test_by_signal(self, robot, operator, number):
        tested = robot()
        session = operator.control(ROBOT, authority=100)
        statuses = reports_of(operator, ROBOT, QueryStatus(), ReportStatus)
        wait_until(lambda: session.state is ControlState.READY and statuses)
        assert tested.end(number) == 0
        tested.expect("not ready")
        tested.expect("shutdown")
        assert f"ends: {number.name}" in tested.log
        wait_until(lambda: statuses[-1].status == Status.SHUTDOWN)
        wait_until(lambda: session.state is ControlState.SEEKING)

    def test_by_jaus_shutdown(self, robot, operator):
        tested = robot()
        session = operator.control(ROBOT, authority=100)
        wait_until(lambda: session.state is ControlState.READY)
        operator.send(Shutdown(), ROBOT)
        assert tested.end() == 0
        tested.expect("shutdown")
        assert "ends: JAUS Shutdown" in tested.log

    @pytest.mark.parametrize(
        "arguments",
        [
            ("--jaus-id", "1.255.1"),
            ("--jaus-id", "x"),
            ("--jaus-multicast-ttl", "300"),
            ("--nothing",),
        ],
    )
    def test_wrong_command_line(self, robot, arguments):
        tested = robot(*arguments)
        assert tested.end() == 2
        assert "usage: robot" in tested.log
        assert "Traceback" not in tested.log

    def test_network_that_cannot_be_used(self, robot):
        tested = robot("--jaus-interface", "192.0.2.1")
        assert tested.end() == 1
        assert "cannot use the network" in tested.log
        assert "Traceback" not in tested.log

    def test_component_that_fails_to_start(self, free_port, caplog):
        def broken(*_):
            raise RuntimeError("user code")

        code = program.run_component(
            broken,
            program.ComponentProgram(
                name="broken",
                description="",
                address=ROBOT,
                transport=TransportSettings(port=free_port),
            ),
            [],
        )
        assert code == 1
        assert "user code" in caplog.text
        assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL

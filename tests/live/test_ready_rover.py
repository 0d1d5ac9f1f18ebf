"""The rover of the page on ready maps stops, whatever becomes of whoever drives it.

The model is the text of the page. Operators of `jausml ocu` drive the generated bridge; after each
loss the last Twist on cmd_vel is zero while efforts go on arriving, and /diagnostics tells why.
"""

import json
import re
import signal
import sys
import time
from types import SimpleNamespace

import needs
import pytest
import warm
from ports import free_port
from scripts import succeeded

needs.ask("rclpy")

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from workspaces import packages_of

from jausml.cli.shared.models import open_catalogue
from jausml.live.peers.network import make_network
from jausml.live.peers.operator import running_operator
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import ClearEmergency, Resume, SetEmergency, Shutdown, Standby
from jausml.runtime.services.definitions import Status

from .bridge_support import ROOT, Process, Repeater, RosPeer, wait_for

pytestmark = pytest.mark.live

FRAGILE = ROOT / "tests" / "live" / "fragile_rover.py"
PAGE = ROOT / "docs" / "how-to" / "ready-mappings.md"
HERE_DOCUMENT = re.compile(
    r"^\$ cat > rover\.ros2jaus <<'END'\n(.*?)^END$", re.MULTILINE | re.DOTALL
)
ROVER = JausAddress(100, 1, 10)
EFFORT = {"PropulsiveLinearEffortX": 50}
SPEED = 4.25
"""Half of what the page says that the rover can do, in m/s."""
PILOT, CHIEF = 205, 250
PATIENCE = 60.0
BOUND = 10.0
"""Seconds until the rover stands; what the machine is busy with included."""
AFTERWARDS = 0.5
SILENT = "the source is silent"


class Rover:
    """The bridge, what its topics carried, and two operators."""

    def __init__(self, workspace, logs, ros, pilot, chief, port):
        self.path, self.logs, self.port = packages_of(workspace), logs, str(port)
        self.ros, self.pilot, self.chief = ros, pilot, chief
        self.twists = ros.listen(Twist, "cmd_vel")
        self.reports = ros.listen(DiagnosticArray, "/diagnostics")
        self.started = 0
        self.process = None
        self.effort = pilot.message(pilot.find(ROVER, "SetWrenchEffort"), EFFORT)

    def start(self, *line):
        """Starts a process that logs into a file of its own."""
        self.started += 1
        return Process([*line], self.path, self.logs / f"{self.started}.log")

    def run(self, *program):
        """Starts the bridge unless it runs; as generated, unless a program is given."""
        if self.process is None:
            line = [*(program or ("-m", "rover.main")), "--jaus-port", self.port]
            more = ["--ros-args", "-p", "diagnostics_frequency:=20.0"]
            self.process = self.start(*line, *more)

    def take(self):
        """Gives the pilot control of the rover, and leads it to Ready."""
        self.pilot.control(ROVER, PILOT)
        assert self.pilot.change(ROVER, Resume(), Status.READY) is Status.READY

    def efforts(self):
        """The pilot's efforts, which come ten times a second whoever else says what."""
        sender = SimpleNamespace(publish=lambda effort: self.pilot.send(ROVER, effort))
        return Repeater(sender, self.effort, 0.1)

    def moves(self):
        """Waits until the rover drives as commanded from now on."""
        before = len(self.twists)
        wait_for(lambda: any(map(drives, self.twists[before:])), "motion", PATIENCE)

    def stops(self):
        """Waits for the zero on cmd_vel, and sees that nothing moves behind it."""
        wait_for(lambda: is_zero(self.twists[-1]), "stop", BOUND)
        before = len(self.twists)
        time.sleep(AFTERWARDS)
        assert all(map(is_zero, self.twists[before:]))

    def told(self):
        """The latest entries of the connection on /diagnostics."""
        for array in reversed(self.reports[-20:]):
            for status in array.status:
                if status.name == "/rover: drive":
                    return status.message, {value.key: value.value for value in status.values}
        return "", {}

    def tells(self, reason):
        """Waits until /diagnostics names the reason of the stop."""
        wait_for(lambda: reason in self.told()[0], f"'{reason}' on /diagnostics", PATIENCE)
        _, values = self.told()
        # A pilot that a busy computer silenced just before has stopped it: each stop counts once.
        counted = {f"stopped: {value}" for value in (reason, SILENT)}
        assert any(int(values.get(key, 0)) for key in counted), values
        assert values["when lost"] == "the stop is sent"

    def limit(self, speed):
        """Asks the node to change the parameter max_speed, without hearing of it."""
        value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=speed)
        request = SetParameters.Request(parameters=[Parameter(name="max_speed", value=value)])
        client = self.ros.node.create_client(SetParameters, "/rover/set_parameters")
        wait_for(client.service_is_ready, "service of parameters", PATIENCE)
        client.call_async(request)

    def ended(self):
        """Waits for the end of the bridge; returns its exit code."""
        process, self.process = self.process, None
        code = process.popen.wait(timeout=PATIENCE)
        process.close()
        return code

    def close(self):
        if self.process is not None:
            self.process.close()
        for log in sorted(self.logs.iterdir()):
            sys.stderr.write(f"{log.name}\n{log.read_text()}")


def drives(twist):
    return twist.linear.x == pytest.approx(SPEED, rel=1e-3)


def is_zero(twist):
    return twist == Twist()


@pytest.fixture(scope="module")
def workspace(tmp_path_factory):
    """The workspace that the commands of the page make."""
    folder = tmp_path_factory.mktemp("page")
    (text,) = HERE_DOCUMENT.findall(PAGE.read_text(encoding="utf-8"))
    (folder / "rover.ros2jaus").write_text(text, encoding="utf-8")
    command = [*warm.command(), "generate", "rover.ros2jaus", "-o", "rover-ws"]
    succeeded(command, cwd=folder, timeout=PATIENCE)
    return folder / "rover-ws"


@pytest.fixture(scope="module")
def world(workspace, tmp_path_factory):
    port = free_port()
    networks = [
        make_network(own, "127.0.0.1", port, "239.255.0.1", [])
        for own in ("65000.1.1", "65000.1.2")
    ]
    ros = RosPeer()
    catalogue = open_catalogue(())
    with (
        running_operator(networks[0], catalogue, PATIENCE) as pilot,
        running_operator(networks[1], catalogue, PATIENCE) as chief,
    ):
        made = Rover(workspace, tmp_path_factory.mktemp("logs"), ros, pilot, chief, port)
        yield made
        made.close()
    ros.close()


@pytest.fixture
def rover(world):
    """The rover in motion, as the pilot commands and goes on to command."""
    world.run()
    world.take()
    with world.efforts():
        world.moves()
        yield world
        if world.process is not None:
            world.pilot.release(ROVER)


def test_release_by_an_operator_that_keeps_sending(rover):
    assert rover.pilot.release(ROVER)
    rover.stops()
    rover.tells("control was released")


def test_take_over(rover):
    rover.chief.control(ROVER, CHIEF)
    rover.stops()
    rover.tells("another component took control")
    assert rover.chief.release(ROVER)


def test_emergency(rover):
    rover.chief.send(ROVER, SetEmergency(emergency_code=1))
    rover.stops()
    rover.tells("emergency")
    rover.chief.send(ROVER, ClearEmergency(emergency_code=1))
    wait_for(lambda: rover.chief.status(ROVER)[0] is not Status.EMERGENCY, "end", PATIENCE)


def test_standby(rover):
    assert rover.pilot.change(ROVER, Standby(), Status.STANDBY) is Status.STANDBY
    rover.stops()
    rover.tells("the bridge stands by")


@pytest.mark.slow
def test_operator_is_killed(world):
    """Control lapses later than the silence is noticed; the rover stands from then on."""
    world.run()
    tool = ["-m", "jausml", "ocu", "command", str(ROVER), "SetWrenchEffort", json.dumps(EFFORT)]
    course = ["--rate", "20", "--duration", "600", "--timeout", str(PATIENCE)]
    own = ["--id", "65000.1.3", "--port", world.port, "--authority", str(PILOT - 1)]
    operator = world.start(*tool, *course, *own)
    try:
        world.moves()
    finally:
        operator.kill()
    world.stops()
    world.tells(SILENT)


def test_operator_falls_silent_and_keeps_control(world):
    world.run()
    world.take()
    with world.efforts():
        world.moves()
    world.stops()
    world.tells(SILENT)
    status, _ = world.pilot.status(ROVER)
    assert (status, world.pilot.controls(ROVER)) == (Status.READY, True)
    with world.efforts():
        world.moves()  # nothing else is needed to go on
    assert world.pilot.release(ROVER)


@pytest.mark.slow
def test_interrupt_of_the_bridge(rover):
    rover.process.popen.send_signal(signal.SIGINT)
    assert rover.ended() == 0
    rover.stops()


@pytest.mark.slow
def test_shutdown(rover):
    rover.pilot.send(ROVER, Shutdown())
    assert rover.ended() == 0
    rover.stops()


@pytest.fixture
def fragile(world):
    """The rover of the owner who overrides too much, in motion."""
    if world.process is not None:  # the one as generated, of a test before
        world.process.stop()
        world.process = None
    world.run(str(FRAGILE))
    world.take()
    with world.efforts():
        world.moves()
        yield world


def test_error_of_a_request_is_counted_and_the_bridge_goes_on(fragile):
    """Whoever asks is a stranger, who must not be able to end it."""
    process = fragile.process
    fragile.limit(20.0)
    wait_for(lambda: "so fast no rover is" in process.log.read_text(), "the reason", BOUND)
    assert process.popen.poll() is None
    fragile.moves()


@pytest.mark.slow
def test_exit_in_a_translation_ends_the_bridge(fragile):
    """Translations run on the loop, without which nothing goes on."""
    process = fragile.process
    fragile.limit(25.0)
    assert fragile.ended() == 1
    fragile.stops()
    log = process.log.read_text()
    assert "the bridge ends: drive: the stop is sent" in log
    assert "the owner has left" in log


@pytest.mark.slow
def test_end_of_ros_ends_the_bridge(fragile):
    """What publishes is gone too, so that the stop cannot reach ROS; JAUS learns of the end."""
    process = fragile.process
    fragile.limit(30.0)
    assert fragile.ended() == 1
    assert "rover failed: ROS was shut down under the bridge" in process.log.read_text()
    wait_for(lambda: not fragile.pilot.controls(ROVER), "end of control", BOUND)

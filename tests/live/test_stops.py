"""Who dies, and what stops: two bridges with every ready map of a driver, in both directions.

A ROS node drives by the bridge `station`, whose commands the bridge `vehicle` publishes. Each
test loses something on the way; afterwards the topics of the vehicle carry a stop, and nothing
behind it.
"""

import os
import signal
import sys
import time
from pathlib import Path

import needs
import pytest
from guardians import guardian_of
from ports import free_port
from sweeps import sweep

needs.ask("rclpy")


from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.clients.control_state import ControlState
from jausml.runtime.component.component import JausComponent
from jausml.runtime.component.process import running_transport
from jausml.runtime.messages import ClearEmergency, SetEmergency, Shutdown, Standby

from .bridge_support import Process, RosPeer, generate, wait_for
from .stop_publisher import moving

pytestmark = pytest.mark.live

FOLDER = Path(__file__).resolve().parent
VEHICLE, STATION = JausAddress(10, 1, 1), JausAddress(10, 1, 2)
STREAMED = [
    "wrench_effort",
    "wrench_effort_stamped",
    "velocity_command",
    "velocity_command_stamped",
]
STREAMED += ["global_vector", "local_vector", "set_end_effector_velocity"]
OF_JOINTS = ["set_joint_velocities", "set_pan_tilt_velocities"]
STREAMED += [*OF_JOINTS, "skid_steer_wheels"]
SENT_ONCE = ["travel_speed", "local_travel_speed"]
MAPS = STREAMED + SENT_ONCE
PATIENCE = 60.0
AFTERWARDS = 1.0
"""Seconds in which nothing may move behind a stop."""


class Rival(JausComponent):
    """A component of the test that takes over, and sets emergencies."""

    def __init__(self, transport):
        super().__init__(transport, JausAddress(10, 1, 9), name="rival", services=())
        self.session = None

    def take(self, peer, *, resume):
        with self.loop.lock:
            self.session = self.control(peer, authority=250, resume=resume)
        states = (ControlState.READY,) if resume else (ControlState.READY, ControlState.CONTROLLED)
        wait_for(lambda: self.session.state in states, "control", PATIENCE)

    def leave(self):
        with self.loop.lock:
            if self.session is not None:
                self.session.release()
            self.session = None


class System:
    """Both bridges, the node that drives, and what the topics of the vehicle carried."""

    def __init__(self, path, logs, waiting):
        self.path, self.logs, self.port = path, logs, free_port()
        self.waiting = waiting
        self.running: dict[str, Process] = {}
        self.started = 0
        self.ros = RosPeer()
        self.heard = {name: self.ros.listen(type(moving(name)), f"out/{name}") for name in MAPS}

    def start(self, name):
        self.started += 1
        line = ["-m", f"{name}.main", "--jaus-port", str(self.port), "--ros-waiting", self.waiting]
        if name == "driver":
            line = [str(FOLDER / "stop_publisher.py"), *(f"in/{map_name}" for map_name in MAPS)]
        log = self.logs / f"{name}-{self.started}.log"
        self.running[name] = Process(line, self.path, log)

    def end(self, name, kind):
        """Sends a signal to a process; returns its exit code once it has ended."""
        process = self.running.pop(name)
        process.popen.send_signal(kind)
        process.popen.wait(timeout=PATIENCE)
        process.close()
        return process.popen.returncode

    def log(self, name):
        return self.running[name].log.read_text()

    def drive(self):
        """Starts what does not run, and waits until all topics carry motion."""
        for name in ("vehicle", "station", "driver"):
            if name not in self.running:
                self.start(name)
        before = self.counts()
        wait_for(lambda: self.moving_since(before) == set(MAPS), "motion", PATIENCE)

    def counts(self):
        return {name: len(heard) for name, heard in self.heard.items()}

    def moving_since(self, counts):
        return {name for name in MAPS if any(map(moves, self.heard[name][counts[name] :]))}

    def stands(self, maps=MAPS):
        return all(self.heard[name] and not moves(self.heard[name][-1]) for name in maps)

    def stops(self, maps=MAPS):
        """Waits for the stop on each topic, and sees that nothing moves behind it."""
        wait_for(lambda: self.stands(maps), "stop", PATIENCE)
        before = self.counts()
        time.sleep(AFTERWARDS)
        assert not self.moving_since(before) & set(maps)

    def close(self):
        for process in self.running.values():
            process.close()
        self.ros.close()
        for log in sorted(self.logs.iterdir()):
            sys.stderr.write(f"{log.name}\n{log.read_text()}")


def moves(message):
    twist = getattr(message, "twist", message)
    if hasattr(message, "velocity"):
        return any(abs(value) > 1e-3 for value in message.velocity)
    if hasattr(message, "layout"):
        return any(abs(value) > 1e-3 for value in message.data)
    if hasattr(message, "data"):
        return message.data != 0.0
    parts = (twist.linear, twist.angular)
    return any(abs(value) > 1e-3 for part in parts for value in (part.x, part.y, part.z))


@pytest.fixture(scope="module")
def system(tmp_path_factory, request):
    packages = generate(FOLDER / "stops.ros2jaus")
    waiting = getattr(request, "param", "automatic")
    started = System(packages, tmp_path_factory.mktemp("logs"), waiting)
    yield started
    started.close()


@pytest.fixture(scope="module")
def rival(system):
    with running_transport(TransportSettings(port=system.port)) as transport:
        component = Rival(transport)
        component.start()
        yield component
        component.stop()


@pytest.fixture
def driven(system):
    """The system in motion."""
    system.drive()
    return system


ENDS = [signal.SIGINT, signal.SIGTERM]

# Both directions at once: what kills the station loses its stops towards JAUS too.


@pytest.mark.slow
def test_driver_is_killed(driven):
    driven.end("driver", signal.SIGKILL)
    driven.stops(STREAMED)
    assert not driven.stands(SENT_ONCE)  # a speed is sent once, and stands while control does
    assert "velocity_command: the source is silent; the stop is sent" in driven.log("station")


@pytest.mark.slow
def test_station_is_killed(driven):
    driven.end("station", signal.SIGKILL)
    driven.stops()
    # The guardian of the station says its stops too, so that control need not lapse first.
    assert "velocity_command: the source is silent; the stop is sent" in driven.log("vehicle")


@pytest.mark.slow
@pytest.mark.parametrize("kind", sweep(ENDS, every=2, rest=0), ids=lambda kind: kind.name)
def test_station_ends(driven, kind):
    process = driven.running["station"]
    assert driven.end("station", kind) == 0
    driven.stops()
    assert "the bridge ends: wrench_effort: the stop is sent" in process.log.read_text()


@pytest.mark.slow
@pytest.mark.parametrize("kind", sweep(ENDS, every=2, rest=0), ids=lambda kind: kind.name)
def test_vehicle_ends(driven, kind):
    """The last word reaches ROS before the context goes down."""
    assert driven.end("vehicle", kind) == 0
    driven.stops()


def test_stamped_stops_say_when_and_in_which_frame(driven):
    driven.end("station", signal.SIGINT)
    driven.stops()
    for name in (
        "wrench_effort_stamped",
        "velocity_command_stamped",
        "global_vector",
        "local_vector",
    ):
        header = driven.heard[name][-1].header
        assert header.frame_id
        assert header.stamp.sec > 0


def test_the_stop_names_each_joint(driven):
    """A joint that a stop does not name would turn on."""
    driven.end("driver", signal.SIGKILL)
    driven.stops(STREAMED)
    arm, unit = (driven.heard[name][-1] for name in OF_JOINTS)
    assert list(arm.name) == [f"joint_{number}" for number in range(1, 7)]
    assert list(unit.name) == ["pan", "tilt"]
    assert (len(arm.velocity), len(unit.velocity)) == (6, 2)
    assert len(driven.heard["skid_steer_wheels"][-1].data) == 2


@pytest.mark.slow
def test_vehicle_that_starts_again_stops_first(driven):
    """A bridge that crashed left the robot in motion; the next one begins with a stop."""
    for name in ("station", "vehicle"):
        os.kill(guardian_of(driven.running[name].popen.pid), signal.SIGKILL)
        driven.end(name, signal.SIGKILL)
    assert not driven.stands(SENT_ONCE)
    before = driven.counts()
    driven.start("vehicle")
    driven.stops()
    assert not driven.moving_since(before)


def test_take_over_in_ready(driven, rival):
    rival.take(VEHICLE, resume=True)
    driven.stops()
    assert "another component took control: " in driven.log("vehicle")
    rival.leave()
    driven.drive()


def test_emergency_of_the_vehicle(driven, rival):
    rival.send(SetEmergency(emergency_code=1), VEHICLE)
    driven.stops()
    assert "emergency: wrench_effort: the stop is sent" in driven.log("vehicle")
    rival.send(ClearEmergency(emergency_code=1), VEHICLE)
    driven.drive()


def test_emergency_of_the_station_stops_what_it_commands(driven, rival):
    rival.send(SetEmergency(emergency_code=1), STATION)
    driven.stops()
    assert "emergency: wrench_effort: the stop is sent" in driven.log("station")
    rival.send(ClearEmergency(emergency_code=1), STATION)
    driven.drive()


def test_standby_of_the_station_stops_what_it_commands(driven, rival):
    rival.take(STATION, resume=True)
    driven.drive()
    with rival.loop.lock:
        rival.session.release()
        rival.session = rival.control(STATION, authority=250, resume=False)
    wait_for(lambda: rival.session.state is ControlState.CONTROLLED, "control", PATIENCE)
    driven.stops()
    assert "the bridge stands by: " in driven.log("station")
    rival.leave()
    driven.drive()


def test_standby_of_the_vehicle(driven, rival):
    rival.take(VEHICLE, resume=True)
    rival.send(Standby(), VEHICLE)
    driven.stops()
    rival.leave()
    driven.drive()


@pytest.mark.slow
def test_shutdown_of_the_vehicle(driven, rival):
    rival.take(VEHICLE, resume=True)
    process = driven.running.pop("vehicle")
    rival.send(Shutdown(), VEHICLE)
    assert process.popen.wait(timeout=PATIENCE) == 0
    process.close()
    driven.stops()
    rival.leave()


@pytest.mark.slow
@pytest.mark.parametrize("system", ["wait-set"], indirect=True)
@pytest.mark.parametrize(
    ("name", "maps"), [("driver", STREAMED), ("station", MAPS)], ids=["driver", "station"]
)
def test_bridges_that_wait_with_a_wait_set_stop_too(driven, name, maps):
    driven.end(name, signal.SIGKILL)
    driven.stops(maps)

"""A bridge beside a simulation, on a real `/clock` that is slow, fast, at rest, and that ends."""

import threading

import needs
import pytest

needs.ask("rclpy")

from .bridge_support import Repeater, generate, wait_for
from .test_bridge_live import System, commands, efforts, twist

pytestmark = pytest.mark.live

STEP = 0.01
SIMULATED = ("-m", "loop_bridge.main", "--ros-args", "-p", "use_sim_time:=true", "--")


class Simulation:
    """Says the time on `/clock`.

    Attributes:
        ratio: Simulated seconds in each real one; None says nothing.
        time: Present time in seconds.
    """

    def __init__(self, peer):
        from rosgraph_msgs.msg import Clock

        self.ratio = 1.0
        self.time = 100.0
        self._message = Clock()
        self._publisher = peer.publisher(Clock, "/clock")
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        while not self._end.wait(STEP):
            if self.ratio is None:
                continue
            self.time += self.ratio * STEP
            stamp = self._message.clock
            stamp.sec, stamp.nanosec = divmod(round(self.time * 1e9), 10**9)
            self._publisher.publish(self._message)

    def pass_time(self, seconds):
        """Waits until so much time of the simulation has passed."""
        end = self.time + seconds
        wait_for(lambda: self.time >= end, "time of the simulation")

    def close(self):
        self._end.set()
        self._thread.join()


@pytest.fixture(scope="module")
def system(tmp_path_factory):
    with System(generate(), tmp_path_factory.mktemp("logs"), bridge=SIMULATED) as started:
        yield started


@pytest.fixture
def simulation(system):
    made = Simulation(system.ros)
    yield made
    made.close()


def is_stopped(system):
    return efforts(system.vehicle)[-1]["rotational"] is None


def drive(system):
    """Sends commands until the vehicle has one, and none afterwards."""
    from geometry_msgs.msg import Twist

    known = len(commands(system.vehicle))
    with Repeater(system.ros.publisher(Twist, "cmd_vel", 1), twist(1.0, 0.5)):
        wait_for(lambda: len(commands(system.vehicle)) > known, "command")


@pytest.mark.parametrize("ratio", [0.5, 5.0])
def test_a_silent_source_is_stopped(system, simulation, ratio):
    simulation.ratio = ratio
    drive(system)
    wait_for(lambda: is_stopped(system), "safe value")


def test_commands_stand_while_the_simulation_rests(system, simulation):
    drive(system)
    simulation.ratio = 0.0
    count = len(commands(system.vehicle))
    drive(system)
    wait_for(lambda: len(commands(system.vehicle)) > count, "command during the pause")
    # Longer than the 0.4 s of the model, in which the report of the bridge comes again.
    system.ros.status("simulated time")
    reports = system.ros.received["/diagnostics"]
    known = len(reports)
    wait_for(lambda: len(reports) > known + 1, "reports during the pause")
    assert system.ros.status("simulated time").level == b"\x00"
    assert not is_stopped(system)
    simulation.ratio = 1.0
    wait_for(lambda: is_stopped(system), "safe value after the pause")


def test_a_jump_back_stops_nothing_for_ever(system, simulation):
    drive(system)
    simulation.time = 5.0
    wait_for(lambda: is_stopped(system), "safe value after the jump")
    drive(system)
    wait_for(lambda: is_stopped(system), "safe value")


def test_a_clock_that_ends_stops_commands(system, simulation):
    drive(system)
    simulation.ratio = None
    wait_for(lambda: is_stopped(system), "safe value without a clock")
    wait_for(
        lambda: system.ros.status("simulated time").level == b"\x03", "status STALE of the clock"
    )
    simulation.ratio = 1.0
    drive(system)


@pytest.mark.slow
def test_queries_keep_the_pace_of_the_simulation(system, simulation):
    from geometry_msgs.msg import PoseStamped

    found = system.ros.listen_to_publisher(PoseStamped, "pose")
    simulation.ratio = 0.5
    wait_for(lambda: found, "pose")
    count, start = len(found), simulation.time
    simulation.pass_time(3.0)
    passed, elapsed = len(found) - count, simulation.time - start
    # 20 each second of the simulation; by real time it would be twice as many.
    assert passed / elapsed == pytest.approx(20.0, rel=0.3)

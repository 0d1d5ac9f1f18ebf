"""A generated bridge whose peers are found by their services: they come, die, move."""

from pathlib import Path

import needs
import pytest
from ports import free_domain

needs.ask("rclpy")


from . import bridge_support
from .bridge_support import Repeater, generate, wait_for

pytestmark = pytest.mark.live

FOLDER = Path(__file__).resolve().parent
VEHICLE = str(FOLDER / "found_vehicle.py")


@pytest.fixture(scope="module")
def path():
    return generate(FOLDER / "found_peers.ros2jaus")


class System(bridge_support.System):
    """The bridge; vehicles come and go."""

    def bridge(self):
        return self.start("-m", "finder.main")

    def vehicle(self, address, speed):
        return self.start(VEHICLE, "--jaus-id", address, "--speed", str(speed))

    def speeds(self, topic):
        from nav_msgs.msg import Odometry

        found = self.ros.listen(Odometry, topic)
        return lambda since=0: [
            round(odometry.twist.twist.linear.x, 1) for odometry in found[since:]
        ]

    def diagnostics(self):
        def search_of(connection):
            status = self.ros.status(connection)
            return status.message, self.ros.values(connection).get("search", "")

        return search_of


@pytest.fixture
def system(path, tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    with System(path, tmp_path) as started:
        yield started


@pytest.mark.slow
def test_a_vehicle_that_starts_late_is_killed_and_comes_back_elsewhere(system):
    speeds, search_of = system.speeds("nearest"), system.diagnostics()
    system.bridge()
    lacking = "searching VelocityStateSensor"
    wait_for(lambda: search_of("nearest") == (lacking, lacking), "search in the diagnostics")
    assert speeds() == []

    first = system.vehicle("10.1.1", 1.0)
    wait_for(lambda: 1.0 in speeds(), "report of a vehicle that started after the bridge")
    wait_for(lambda: search_of("nearest")[1] == "bound to 10.1.1", "binding in the diagnostics")

    first.kill()
    wait_for(lambda: search_of("nearest")[1] == lacking, "loss in the diagnostics")
    assert search_of("asked")[1] == "searching VelocityStateSensor in subsystem 10"
    system.vehicle("200.3.4", 2.0)
    wait_for(lambda: 2.0 in speeds(), "report of the vehicle under another address")
    assert search_of("asked")[1] == "searching VelocityStateSensor in subsystem 10"


@pytest.mark.slow
def test_nearest_takes_one_of_several_and_all_takes_every_one(system):
    nearest, every, asked = map(system.speeds, ("nearest", "every", "asked"))
    started = [("200.1.1", 4.0), ("10.2.1", 3.0), ("10.1.7", 2.0)]
    vehicles = [system.vehicle(address, speed) for address, speed in started]
    for vehicle in vehicles:
        wait_for(lambda log=vehicle.log: " runs as " in log.read_text(), "start of a vehicle")
    system.bridge()
    wait_for(lambda: {2.0, 3.0, 4.0} <= set(every()), "reports of all")
    wait_for(lambda: nearest() and asked(), "reports of one")
    assert set(nearest()) == set(asked()) == {2.0}


def test_commands_go_to_whoever_is_found(system):
    from geometry_msgs.msg import Twist

    system.bridge()
    publisher = system.ros.publisher(Twist, "cmd_vel")
    with Repeater(publisher, Twist()):
        first = system.vehicle("10.1.1", 1.0)
        wait_for(lambda: first.of_kind("effort"), "command to the vehicle that was found")
        first.kill()
        second = system.vehicle("10.1.2", 1.0)
        wait_for(lambda: second.of_kind("effort"), "command to the vehicle that came instead")
    assert {fact["sender"] for fact in second.of_kind("effort")} == {"10.1.9"}


@pytest.mark.slow
def test_another_component_with_the_id_of_the_bridge_is_told_of(system):
    bridge = system.bridge()
    wait_for(lambda: system.ros.statuses("nearest"), "diagnostics")
    system.vehicle("10.1.9", 1.0)
    text = "another component has your id: 10.1.9 at 127.0.0.1:"

    (double, *_) = wait_for(lambda: system.ros.statuses("jaus id"), "double in the diagnostics")
    assert double.message.startswith(text)
    assert double.level == b"\x02"
    assert bridge.log.read_text().count(text) == 1

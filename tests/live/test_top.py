"""`jausml top` beside a generated bridge, a vehicle and a ROS node."""

import itertools
import subprocess
import sys
from pathlib import Path

import needs
import pytest
import warm

needs.ask("rclpy")

from jausml.cli.shared.models import open_catalogue, readable_model
from jausml.live.peers.network import make_network
from jausml.live.peers.operator import running_operator
from jausml.live.systems.declarations import components_of, declarations_of
from jausml.live.systems.folding import expected
from jausml.live.systems.inspection import Inspection
from jausml.live.systems.monitoring import Monitor, listening, polling
from jausml.runtime.base.address import JausAddress

from . import bridge_support
from .bridge_support import MODEL, generate, wait_for

pytestmark = pytest.mark.live

VEHICLE = str(Path(__file__).resolve().parent / "bridge_vehicle.py")
TARGET = JausAddress(10, 1, 1)
HIDDEN = "import sys; sys.modules['rclpy'] = None; from jausml.cli import main; main()"
EVIL = "\x1b[2J\x1b]0;title\x07[red]\u202e"


class System(bridge_support.System):
    """A bridge and a vehicle."""

    def __init__(self, path, logs):
        super().__init__(path, logs)
        self.start("-m", "loop_bridge.main")
        self.vehicle = self.start_vehicle()

    def start_vehicle(self):
        return self.start(VEHICLE, "--address", "10.1.1")

    def top(self, *arguments):
        """Starts `jausml top --json`."""
        words = ("-m", "jausml", "top", "--json", "--interval", "0.2", *map(str, arguments))
        return self.start(*words, option="--port")

    def once(self, *arguments, program=()):
        """Runs `jausml top --once` and returns how it ended."""
        words = ("top", "--once", *map(str, arguments), "--port", str(self.port))
        line = [*(program or warm.command()), *words]
        return subprocess.run(line, capture_output=True, text=True, timeout=60)

    def network(self):
        return make_network("65000.1.77", "127.0.0.1", self.port, "239.255.0.1", [])


@pytest.fixture(scope="module")
def system(tmp_path_factory):
    with System(generate(), tmp_path_factory.mktemp("logs")) as started:
        yield started


@pytest.fixture
def watched(system):
    """`jausml top --json` with the model."""
    process = system.top(MODEL)
    yield process
    assert process.stop() == 0


def latest(process, kind, name):
    """What was last told of a connection or component."""
    if not process.facts:
        return None
    label = "connection" if kind == "connections" else "id"
    return next((fact for fact in process.facts[-1][kind] if fact[label] == name), None)


def becomes(process, kind, name, *, present=(), **wanted):
    """Waits until a connection or component is told of with some values, and others not 0."""

    def told():
        found = latest(process, kind, name)
        is_told = found and wanted.items() <= found.items()
        return found if is_told and all(found[key] for key in present) else None

    return wait_for(told, f"{name} {wanted}", 40.0)


def test_rates_peers_states_controllers_and_a_hostile_status(system, watched):
    odometry = becomes(watched, "connections", "odometry", present=["rate"], reason="running")
    assert (odometry["level"], odometry["declared_rate"]) == ("ok", 20.0)
    assert odometry["history"][-1] == odometry["rate"]
    assert odometry["peers"] == {"peer 10.1.1": "confirmed"}
    assert odometry["model"]["message"] == "ReportVelocityState"
    wanted = {"state": "READY", "controller": "10.1.9"}
    vehicle = becomes(watched, "components", "10.1.1", present=["round_trip_ms"], **wanted)
    assert (vehicle["level"], vehicle["name"]) == ("ok", "vehicle")
    # Nobody commands, and the trailer and the operator of the model do not run.
    becomes(watched, "connections", "cruise", level="stale")
    becomes(watched, "components", "10.1.2", level="not heard")
    assert watched.facts[-1]["health"] == "error"
    judge_hostile_status(system, watched)


def judge_hostile_status(system, watched):
    from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

    values = [KeyValue(key="declared rate (Hz)", value="1e999"), KeyValue(key=EVIL, value=EVIL)]
    values += [KeyValue(key=f"dropped: {EVIL}", value="9" * 5000)] * 300
    hostile = DiagnosticStatus(
        level=b"\x2a", name=f"/{EVIL}: {EVIL}", message=EVIL * 9000, hardware_id="9.9.9"
    )
    hostile.values = values
    other = DiagnosticStatus(level=b"\x02", name="battery", message="low")
    becomes(watched, "connections", "odometry", level="ok")
    publisher = system.ros.node.create_publisher(DiagnosticArray, "/diagnostics", 10)
    wait_for(lambda: publisher.get_subscription_count() > 0, "top")
    publisher.publish(DiagnosticArray(status=[hostile, other]))
    told = becomes(watched, "connections", EVIL, level="error", jaus_id="9.9.9")
    assert len(told["values"]) < 300
    assert told["drops"] == {}
    assert told["declared_rate"] is None
    assert watched.popen.poll() is None
    bridges = [connection["bridge"] for connection in watched.facts[-1]["connections"]]
    assert not any("battery" in bridge for bridge in bridges)


@pytest.mark.slow
def test_lost_control_and_a_silent_source_are_shown(system, watched):
    becomes(watched, "components", "10.1.1", controller="10.1.9")
    with running_operator(system.network(), open_catalogue(())) as operator:
        operator.control(TARGET, 255)
        told = becomes(watched, "components", "10.1.1", controller="65000.1.77")
        assert told["authority"] == 255
        drive = wait_for(
            lambda: (
                (found := latest(watched, "connections", "drive"))
                and found["peers"].get("peer 10.1.1", "ready") != "ready"
                and found
            ),
            "loss of control",
        )
        assert drive["level"] == "stale"
    becomes(watched, "components", "10.1.1", controller="10.1.9", state="READY")
    # A source that falls silent comes back.
    becomes(watched, "connections", "odometry", level="ok")
    system.vehicle.kill()
    becomes(watched, "connections", "odometry", level="stale", reason="the source is silent")
    becomes(watched, "components", "10.1.1", level="not heard")
    system.vehicle = system.start_vehicle()
    becomes(watched, "components", "10.1.1", level="ok")
    becomes(watched, "connections", "odometry", level="ok")


@pytest.mark.slow
def test_one_table_for_ci(system):
    result = system.once(MODEL)
    assert result.returncode == 2, result.stderr  # the trailer does not run
    odometry = next(line for line in result.stdout.splitlines() if "odometry" in line)
    assert "10.1.1 confirmed" in odometry
    assert "something does not work" in result.stdout
    without_model = system.once()
    assert without_model.returncode == 1, without_model.stdout  # nobody commands: stale
    assert "look at the warnings" in without_model.stdout


@pytest.mark.slow
def test_with_rclpy_hidden_jaus_alone_is_shown(system):
    result = system.once(program=(sys.executable, "-c", HIDDEN))
    assert result.returncode == 0, result.stdout + result.stderr
    assert "no ROS here" in result.stdout
    assert "odometry" not in result.stdout
    assert "READY" in next(line for line in result.stdout.splitlines() if " 10.1.1 " in line)


@pytest.mark.slow
def test_without_a_network_for_jaus_ros_alone_is_shown(system):
    result = system.once(MODEL, "--interface", "203.0.113.7")
    assert result.returncode == 1, result.stdout + result.stderr
    assert "JAUS: the network cannot be used" in result.stdout
    assert "confirmed" in next(line for line in result.stdout.splitlines() if "odometry" in line)
    vehicle = next(line for line in result.stdout.splitlines() if " vehicle " in line)
    assert vehicle.split()[:2] == ["unknown", "10.1.1"]


def test_the_last_message_on_both_sides(system):
    model = readable_model([str(MODEL)], is_one=True)
    monitor = Monitor(expected(declarations_of(model), components_of(model), 0.0))
    catalogue = open_catalogue([str(MODEL)])
    before = system.ros.node.count_subscribers("/odometry")
    with (
        running_operator(system.network(), catalogue, timeout=1.0) as operator,
        listening(monitor) as ros,
        polling(monitor, operator),
    ):
        inspection = Inspection(operator, ros)

        def at(name):
            return inspection.at(monitor.state().connections["/loop_bridge", name])

        wait_for(lambda: monitor.state().connections["/loop_bridge", "odometry"].told, "status")
        wait_for(lambda: any("linear:" in line for line in at("odometry")[0]), "Odometry")
        wait_for(lambda: any("Velocity_X: 2" in line for line in at("odometry")[1]), "report")
        wait_for(lambda: system.ros.node.count_subscribers("/odometry") == before + 1, "the look")
        _, jaus = at("drive")
        assert "not observable" in jaus[0]
        wait_for(
            lambda: system.ros.node.count_subscribers("/odometry") == before, "end of the look"
        )
        inspection.close()


@pytest.mark.slow
def test_what_a_bridge_measures_is_shown_beside_what_is_measured_outside(system):
    def measure(wanted):
        assert system.ros.set_parameter("/loop_bridge", "latency", wanted).successful

    def rows(duration):
        """What the verb says of the connection, when diagnostics came while it looked."""
        words = ("latency", str(MODEL), "--duration", str(next(duration)), "--timeout", "0.5")
        line = [*warm.command(), *words, "--port", str(system.port)]
        result = subprocess.run(line, capture_output=True, text=True, timeout=100)
        bridges = result.stdout.partition("bridge ")[2]
        return [output for output in bridges.splitlines() if output.split()[1:2] == ["odometry"]]

    process = system.top()
    measure(wanted=True)
    becomes(process, "connections", "odometry", present=["latency_us"])
    longer = itertools.count(3, 3)  # a busy computer needs more time to begin
    (odometry,) = wait_for(lambda: rows(longer), "connection in the table", seconds=90)
    measure(wanted=False)
    process.stop()
    name, _, p50, p99, greatest, *_ = odometry.split()
    assert name == "/loop_bridge"
    assert 0 < float(p50) <= float(p99) <= float(greatest)

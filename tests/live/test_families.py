"""A generated bridge and peers of other makes: each gets what it needs, and is known for it."""

import shutil
import sys
from pathlib import Path

import jts_winch
import needs
import pytest
from ports import free_port
from sweeps import sweep

needs.ask("rclpy")

from jausml.live.peers.makes.vehicle import Place

from .bridge_support import Process, Repeater, generate_text, wait_for

pytestmark = pytest.mark.live

FOLDER = Path(__file__).resolve().parent
PEER = "152.1.1"
BRIDGE = """
import mappings.primitive_driver
import mappings.velocity_state_sensor
bridge tolerant {{
    address: 105.1.1
    {provides}
    connection drive {{
        map: wrench_effort {drive} topic cmd_vel
    }}
    connection speed {{
        map: velocity_state {speed} topic speed
    }}
}}
"""
KNOWN = """
component vehicle {
    address: 152.1.1 type: vehicle external: true
    provides: PrimitiveDriver, VelocityStateSensor
}
"""
EVENTS = "peers: vehicle exchange: periodicEvent rate: 20"
CHANGES = "peers: vehicle exchange: everyChangeEvent"
QUERIES = "peers: vehicle exchange: query rate: 20"
EFFORT, SPEED = 25, 0.5
"""Percent of its effort, and metres per second of which it reports then."""
FOUND = "search: { services: VelocityStateSensor } exchange: periodicEvent rate: 20"


@pytest.fixture
def start(tmp_path):
    """Starts processes beside a generated bridge."""
    processes = []

    def run(path, *line, **options):
        log = tmp_path / f"{len(processes)}.log"
        processes.append(Process(list(line), path, log, **options))
        return processes[-1]

    yield run
    for process in processes:
        process.close()
        sys.stderr.write(process.log.read_text())


def told_of(ros, peer):
    """Returns what `/diagnostics` says of a peer, as it is when it is asked for."""
    return lambda: ros.values(f"account of {peer}")


def effort_of(command):
    """Returns the effort of a command that a rover printed, in percent."""
    return round(command["fields"]["WrenchEffortRec"].get("PropulsiveLinearEffortX", 0))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("family", "speed", "quirks"),
    sweep(
        [
            ("jaus++", EVENTS, {"acknowledges without the version of JUDP"}),
            (
                "jaus++",
                FOUND,
                {"acknowledges without the version of JUDP", "knows no wildcards in QueryServices"},
            ),
            ("junior", EVENTS, set()),
            ("junior", CHANGES, {"makes another event of each CreateEvent"}),
            ("jts", QUERIES, set()),
        ],
        every=3,
        rest=2,
    ),
)
def test_a_vehicle_of_another_make_obeys_and_reports(ros, start, tmp_path, family, speed, quirks):
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry

    drive = "direction: rosToJaus peers: vehicle"
    text = KNOWN + BRIDGE.format(provides="", drive=drive, speed=speed)
    path, port = generate_text(tmp_path, "tolerant", text), str(free_port())
    reports, told = ros.listen(Odometry, "speed"), told_of(ros, PEER)
    line = ("-m", "jausml", "peer", family, "--id", PEER, "--port", port, "--format", "json")
    vehicle = start(path, *line)
    wait_for(lambda: "rover" in vehicle.log.read_text(), "start of the vehicle")
    bridge = start(path, "-m", "tolerant.main", "--jaus-port", port)
    publisher = ros.publisher(Twist, "cmd_vel")
    command = Twist()
    command.linear.x = 0.5
    with Repeater(publisher, command):
        wait_for(lambda: len(vehicle.facts) > 100, "commands that are obeyed", 40)
        wait_for(lambda: len(reports) > 60 or (speed is CHANGES and len(reports) > 4), "reports")
        wait_for(lambda: quirks <= set(told()), f"{quirks} in the diagnostics", 40)
    # It stands until it is told to drive, and the commands stop at the end.
    speeds = {round(report.twist.twist.linear.x, 1) for report in reports}
    assert {SPEED} <= speeds <= {0.0, SPEED}
    efforts = {effort_of(fact) for fact in vehicle.facts}
    assert {EFFORT} <= efforts <= {0, EFFORT}
    assert int(told()["not acknowledged"]) == 0
    for quirk in quirks:
        assert bridge.log.read_text().count(f"{PEER} {quirk}") == 1


WINCH = """
import "{service}"
speed {{
    JAUS SetWinchCommand
    ROS std_msgs/Float64
    stopJaus: {{ silenceTimeout: 0.5 values: {{ target: RopeSpeed value: 0 }} }}
    ROS->JAUS ( data -> RopeSpeed )
}}
length {{ JAUS ReportWinchState ROS std_msgs/Float64 JAUS->ROS ( RopeLength -> data ) }}
component winch {{ address: 126.1.1 provides: Winch external: true }}
bridge station {{
    address: 126.1.9
    uses: Winch
    connection speed {{ map: speed direction: rosToJaus peers: winch topic speed }}
    connection length {{ map: length exchange: periodicEvent rate: 10 peers: winch topic length }}
}}
"""


def test_what_the_jaus_tool_set_made_of_an_export_obeys_and_reports(ros, start, tmp_path):
    """It refuses the events by which a bridge watches control and status, without a code."""
    from std_msgs.msg import Float64

    shutil.copy(jts_winch.SERVICE, tmp_path / "service.xmi")
    service = tmp_path / "service.xmi"
    library = "http://www.jausml.org/library/"
    text = service.read_text(encoding="utf-8").replace("../../library/", library)
    service.write_text(text, encoding="utf-8")
    port = free_port()
    path = generate_text(tmp_path, "winch", WINCH.format(service=service.name))
    lengths = ros.listen(Float64, "length")
    with jts_winch.Winch(Place(port=port)) as winch:
        bridge = start(path, "-m", "station.main", "--jaus-port", str(port))
        with Repeater(ros.publisher(Float64, "speed"), Float64(data=1.0)):
            wait_for(lambda: len(winch.commands) > 5, "commands that are obeyed", 40)
        wait_for(lambda: winch.commands[-1].hex() == "01d10080", "the stop when ROS is silent")
        wait_for(lambda: lengths, "a report")
        bridge.close()
    assert {command.hex() for command in winch.commands} == {"01d1ffbf", "01d10080"}
    assert {round(length.data, 2) for length in lengths} == {6.25}


@pytest.mark.slow
def test_the_unit_of_the_judges_commands_a_bridge_in_each_of_its_tests(ros, start, tmp_path):
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry

    provides = "type: vehicle provides: PrimitiveDriver, VelocityStateSensor"
    ways = {"drive": "direction: jausToRos", "speed": "direction: rosToJaus exchange: query"}
    text = BRIDGE.format(provides=provides, **ways)
    path, port = generate_text(tmp_path, "tolerant", text), str(free_port())
    bridge = start(path, "-m", "tolerant.main", "--jaus-port", port)
    commands = ros.listen_to_publisher(Twist, "cmd_vel")
    unit = start(path, str(FOLDER / "judging_unit.py"), port, stdin=True)
    publisher = ros.publisher(Odometry, "speed")
    with Repeater(publisher, Odometry()):
        wait_for(lambda: "runs as" in bridge.log.read_text(), "start of the bridge")
        for number in range(4):
            unit.tell(str(10 + number))
            wait_for(lambda: len(unit.of_kind("tested")) > number, "end of a test")  # noqa: B023
    asked = {0x4B00, 0x000F, 0x4003, 0x4002, 0x4404, 0x0010}
    answers = [fact["code"] for fact in unit.of_kind("answer")]
    assert {code: answers.count(code) for code in asked} == dict.fromkeys(asked, 4)
    assert {fact["to"] for fact in unit.of_kind("answer")} == {"42.1.1"}
    # The bridge has them already; to this process they may still be under way.
    wait_for(lambda: len({round(x.linear.x, 2) for x in commands if x.linear.x}) == 4, "efforts")

"""Where the last messages of a connection are, and how they are shown."""

from pathlib import Path

import needs
import pytest
from generated import model_in, model_of

from jausml.language.metamodel.classes.bridge import Bridge
from jausml.live.systems.declarations import components_of, declarations_of
from jausml.live.systems.inspection import Inspection, reporters_of, topic_of
from jausml.live.systems.state import ConnectionState

ROOT = Path(__file__).resolve().parents[2]
MODEL = """\
import `jaus.mobility`
speed {
  JAUS ReportVelocityState
  ROS std_msgs/Float64
  JAUS->ROS ( Velocity_X -> data )
}
component rover { address: 100.1.1  provides: VelocityStateSensor }
bridge speeds {
  address: 100.1.2
  namespace: NAMESPACE
  connection near { map: speed  exchange: everyChangeEvent  peers: rover  topic speed {} }
  connection own { map: speed  exchange: everyChangeEvent  peers: rover  topic `~/speed` {} }
  connection far { map: speed  exchange: everyChangeEvent  peers: rover  topic /all/speed {} }
}
"""


def declarations(tmp_path, namespace):
    return list(declarations_of(model_in(tmp_path, MODEL.replace("NAMESPACE", namespace))))


@pytest.mark.parametrize(
    ("namespace", "bridge", "names"),
    [
        ("one", "/one/speeds", ["/one/speed", "/one/speeds/speed", "/all/speed"]),
        ("one", "/two/speeds", ["/two/speed", "/two/speeds/speed", "/all/speed"]),
        ("one", "/speeds", ["/speed", "/speeds/speed", "/all/speed"]),
        ('""', "/two/speeds", ["/two/speed", "/two/speeds/speed", "/all/speed"]),
    ],
)
def test_topics_are_in_the_namespace_that_the_bridge_runs_in(tmp_path, namespace, bridge, names):
    declared = declarations(tmp_path, namespace)
    found = [
        topic_of(ConnectionState(bridge, declaration.name), declaration) for declaration in declared
    ]
    assert [topic_name.name for topic_name in found] == names
    assert {topic_name.type for topic_name in found} == {"std_msgs/msg/Float64"}


def test_a_report_is_asked_of_peers_or_of_the_bridge_that_runs():
    model = model_of(ROOT / "tests" / "cases" / "bridge_loop" / "model.xmi")
    declared = {declaration.name: declaration for declaration in declarations_of(model)}
    assert components_of(model)["10.1.9"] == "loop_bridge"
    assert not declared["drive"].is_report
    assert declared["odometry"].rate == 20.0
    here = ConnectionState("/b", "c", "11.1.9", peers={"peer 10.1.5": "source", "search": "x"})
    assert reporters_of(here, declared["estimate"]) == ["11.1.9"]
    assert reporters_of(here, declared["odometry"]) == ["10.1.5"]
    assert reporters_of(ConnectionState("/b", "c"), declared["odometry"]) == ["10.1.1"]


@pytest.mark.parametrize("name", ["services", "waypoint_lists"])
def test_services_and_actions_are_declared_too(name):
    model = model_of(ROOT / "tests" / "live" / f"{name}.ros2jaus")
    owners = model.instances(Bridge, library=False)
    called = [
        connection for o in owners for connection in (*o.serviceConnections, *o.actionConnections)
    ]
    found = {declaration.key: declaration for declaration in declarations_of(model)}
    assert called
    for owner in called:
        node = f"/{owner.eContainer().name}"
        (declared,) = [
            one for (at, name), one in found.items() if name == owner.name and at.endswith(node)
        ]
        assert declared.message
        assert (declared.topics, declared.rate, declared.is_report) == ((), None, False)


def test_without_sources_it_says_so():
    inspection = Inspection(None, None)
    shown = inspection.at(ConnectionState("/b", "c"))
    assert shown == (["there is no ROS here"], ["there is no JAUS here"])
    inspection.close()


def test_ros_messages_as_lines():
    needs.ask("rclpy")
    from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
    from sensor_msgs.msg import LaserScan

    from jausml.live.systems.ros_diagnostics import message_lines

    scan = LaserScan(ranges=[1.5] * 1000)
    scan.header.frame_id = "f" * 1000
    lines = list(message_lines(scan))
    assert "ranges: [1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5, … (1000 in all)]" in lines
    assert "intensities: []" in lines
    assert lines[:2] == ["header:", "  stamp:"]
    assert max(map(len, lines)) < 250
    status = DiagnosticStatus(level=b"\x02", values=[KeyValue(key="a", value="b")] * 9)
    lines = list(message_lines(status))
    assert lines[0] == "level: b'\\x02'"
    assert lines[-3:] == ["  key: a", "  value: b", "values: … (9 in all)"]

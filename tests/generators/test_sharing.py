"""What connections of one map share is made once, and is what each would have alone."""

import sys
from collections import Counter
from pathlib import Path

import pytest
from generated import model_in
from sweeps import sweep

from jausml.generation.target import system_of
from jausml_generators.bridge.checks.module import TestModule as Tests
from jausml_generators.bridge.translation import maps
from jausml_generators.bridge.views import BridgeView, bridge_views
from jausml_generators.bringup import target as bringup
from jausml_generators.bringup.processes import ConfigView

EVERY_POLICY = Path(__file__).with_name("checked_bridge.ros2jaus").read_text(encoding="utf-8")
MESSAGES_IN_MESSAGES = """
import mappings.waypoint_lists
import mappings.global_pose_sensor

bridge lists {
  address: 10.1.1
  provides: GlobalPoseSensor
  connection there { map: local_waypoint_list direction: jausToRos onSilence: hold topic there }
  connection back { map: local_waypoint_list direction: rosToJaus peers: robot topic back }
  connection pose { map: global_pose direction: rosToJaus topic fix topic imu { join: imu } }
}

component robot { address: 10.1.2 }
"""
_BODY = """sequence Body {
    record Inner { fixed_field count { type: uint32 } }
    record Level { fixed_field level { type: float64 } }
  } }
"""
_CONNECTION = (
    "  connection {name} {{ map: of_{name} peers: peer exchange: message topic {name} {{}} }}\n"
)
_MAP = """
of_{name} {{
  JAUS {message}
  ROS geometry_msgs/PointStamped
  JAUS->ROS (
    "{name}" -> header.frame_id
    Inner.count -> point.x
    Level.level -> point.y
    ignore header.stamp
    ignore point.z
  )
}}
"""
_ALIKE = {"first": "ReportFirst", "other": "ReportOther", "inner": "Inner"}
"""Messages that are laid out alike, one with the name of a part of it."""


def _of_each(pattern):
    return "".join(
        pattern.format(name=name, message=message, code=f"0x{0x6000 + number:X}", body=_BODY)
        for number, (name, message) in enumerate(_ALIKE.items())
    )


MESSAGES_ALIKE = f"""
import `jaus.core-1.1`

service_set alike {{ service Alike {{
  urn: "urn:x-alike:s" version: "1.0" inherits: Management
{_of_each("  outputs: new message_def {message} {{ code: {code} {body}")}
}} }}

component peer {{ address: 10.1.2 provides: Alike external: true }}
{_of_each(_MAP)}
bridge alike {{
  address: 10.1.1
  uses: Alike
{_of_each(_CONNECTION)}}}
"""
# Names that are parts of each other, and of names that are made of them.
NAMES = ("{0}", "last_{0}", "{0}_2", "max_speed_{0}", "x_{0}")


def multiplied(text, names=NAMES):
    """Returns a model with each connection under several names, and all of these."""
    lines, found = [], []
    for line in text.splitlines():
        if line.startswith("  connection "):
            word, name, rest = line.split(maxsplit=2)
            several = [pattern.format(name) for pattern in names]
            lines += [f"  {word} {new_name} {rest}" for new_name in several]
            found += several
        else:
            lines.append(line)
    return "\n".join(lines), found


def only(text, name):
    """Returns a model with one of the connections."""
    lines = text.splitlines()
    return "\n".join(
        line for line in lines if "  connection " not in line or f" connection {name} " in line
    )


def assert_shared(checks, alone):
    """Checks that a bridge has those of a connection alone; one is of all connections at once."""
    for check in alone:
        if check.name == "times":
            assert set(check.lines) <= set(checks[check.name].lines)
        else:
            assert checks[check.name] == check


def viewed(text, folder):
    """Returns the view of the bridge of a model."""
    model = model_in(folder, text)
    return BridgeView(system_of(model).bridges[0], system_of(model), "shared.ros2jaus")


@pytest.mark.parametrize(
    "text", sweep([EVERY_POLICY, MESSAGES_IN_MESSAGES, MESSAGES_ALIKE], every=2)
)
def test_connections_share_what_each_has_alone(text, tmp_path):
    text, names = multiplied(text)
    whole = viewed(text, tmp_path)
    translated = {connection.name: connection for connection in whole.translations.connections}
    checks = {check.name: check for check in Tests(whole).checks}

    assert len(translated) == len(names)
    # Of each connection some names are enough, and of each kind of name some connections.
    for name in names[::2]:
        alone = viewed(only(text, name), tmp_path)
        (expected,) = alone.translations.connections
        assert translated[name].lines == expected.lines
        assert translated[name].safe_lines == expected.safe_lines
        assert_shared(checks, Tests(alone).checks)


def test_frames_and_memories_are_those_of_each_connection(tmp_path):
    text, _ = multiplied(EVERY_POLICY, ("{0}", "b_{0}", "c_{0}"))
    uses = viewed(text, tmp_path).translations.uses

    frames = {frame.name for frame in uses.frames.values()}
    assert frames >= {f"{prefix}speed_frame_id" for prefix in ("", "b_", "c_")}
    assert {memory.name for memory in uses.memories} == {
        f"last_{prefix}speed_twist_twist_angular_z" for prefix in ("", "b_", "c_")
    }


def test_a_name_that_is_taken_is_told_apart(tmp_path):
    text, _ = multiplied(EVERY_POLICY, ("{0}", "b", "b_frame_id"))
    text = only(text, "speed").replace("  connection speed", "  connection b_frame_id", 1)
    line = next(line for line in text.splitlines() if "connection b_frame_id" in line)
    lines = [line.replace("b_frame_id", name) for name in ("b_frame_id", "a", "b")]
    view = viewed(text.replace(line, "\n".join(lines)), tmp_path)

    assert "target.header.frame_id = self.b_frame_id_2" in view.translations.connections[2].lines


def test_a_map_is_translated_once(tmp_path):
    text, names = multiplied(EVERY_POLICY, [f"{{0}}_{number}" for number in range(30)])
    view = viewed(text, tmp_path)
    called = Counter()
    wanted = {maps.to_ros.__code__, maps.to_jaus.__code__}

    def counted(frame, event, _argument):
        if event == "call" and frame.f_code in wanted:
            called[frame.f_locals["connection"].map.name, frame.f_code] += 1

    sys.setprofile(counted)
    try:
        assert len(view.translations.connections) == len(names) == 180
    finally:
        sys.setprofile(None)
    assert set(called.values()) == {1}


NUMBERS = """
import ros.std_msgs

plain { JAUS ReportVelocityState ROS std_msgs/Float64 JAUS->ROS ( Velocity_X -> data ) }

again {
  JAUS ReportVelocityState
  ROS std_msgs/Float64
  JAUS->ROS ( Velocity_X -> data )
}

other { JAUS ReportVelocityState ROS std_msgs/Float64 JAUS->ROS ( Velocity_X -> data : scale(2) ) }

bridge numbers {
  address: 10.1.1
  connection plain { map: plain direction: jausToRos exchange: periodicEvent peers: robot topic a }
  connection again { map: again direction: jausToRos exchange: periodicEvent peers: robot topic b }
  connection other { map: other direction: jausToRos exchange: periodicEvent peers: robot topic c }
}

component robot { address: 10.1.2 provides: VelocityStateSensor }
"""


def test_maps_that_say_the_same_share_as_one_map_does(tmp_path):
    view = viewed(NUMBERS, tmp_path)
    plain, again, other = view.connections

    assert plain.connection.map is not again.connection.map
    assert plain.alike == again.alike != other.alike
    lines = {connection.name: connection.translated.lines for connection in view.connections}
    assert lines["plain"] == tuple(line.replace("again", "plain") for line in lines["again"])
    assert lines["plain"] != tuple(line.replace("other", "plain") for line in lines["other"])


@pytest.mark.parametrize(
    "words",
    ["{ whenAbsent: useDefault defaultValue: 1 }", "{ whenAbsent: dropMessage }", ": negate"],
)
def test_whatever_an_assignment_says_tells_maps_apart(words, tmp_path):
    text = NUMBERS.replace("Velocity_X -> data )\n}", f"Velocity_X -> data {words} )\n}}")
    plain, again, _ = viewed(text, tmp_path).connections

    assert plain.alike != again.alike
    assert plain.translated.lines != again.translated.lines


def test_maps_with_vectors_are_told_apart_by_their_names(tmp_path):
    vector = "vector one JAUS->ROS ( Velocity_X = 1 => data = 1 )"
    text = NUMBERS.replace("-> data )\n}", f"-> data )\n  {vector}\n}}")
    text = text.replace("-> data ) }\n\nagain", f"-> data ) {vector} }}\n\nagain")
    view = viewed(text, tmp_path)

    about = [check.documentation for check in Tests(view).checks]
    assert [documentation for documentation in about if "map plain" in documentation]
    assert [documentation for documentation in about if "map again" in documentation]


FRAMES = """
import ros.geometry_msgs
import ros.std_msgs

front {{
  JAUS ReportVelocityState
  ROS {type}
  JAUS->ROS ( "front \\"link\\"" -> {frame} {others} )
}}

rear {{
  JAUS ReportVelocityState
  ROS {type}
  JAUS->ROS ( "rear" -> {frame} {others} )
}}

left {{
  JAUS ReportVelocityState
  ROS {type}
  JAUS->ROS ( "left" -> {frame} {others} )
}}

bridge frames {{
  address: 10.1.1
  connection front {{ map: front exchange: periodicEvent peers: robot topic a }}
  connection rear {{ map: rear exchange: periodicEvent peers: robot topic b }}
  connection left {{ map: left exchange: periodicEvent peers: robot topic c }}
}}

component robot {{ address: 10.1.2 provides: VelocityStateSensor }}
"""
STAMPED = {
    "type": "geometry_msgs/TwistStamped",
    "frame": "header.frame_id",
    "others": "Velocity_X -> twist.linear.x",
}
UNSTAMPED = {"type": "std_msgs/String", "frame": "data", "others": ""}


def test_maps_that_differ_in_frames_share_and_have_their_own(tmp_path):
    text = FRAMES.format(**STAMPED)
    whole = viewed(text, tmp_path)

    assert len({connection.alike for connection in whole.connections}) == 1
    frames = {frame.name: frame.value for frame in whole.translations.uses.frames.values()}
    assert frames == {
        "front_frame_id": 'front "link"',
        "rear_frame_id": "rear",
        "left_frame_id": "left",
    }
    checks = {check.name: check for check in Tests(whole).checks}
    for view in whole.connections:
        alone = viewed(only(text, view.name), tmp_path)
        assert alone.connections[0].translated.lines == view.translated.lines
        assert_shared(checks, Tests(alone).checks)
    assert 'assert target.header.frame_id == "left"' in checks["left"].lines


def test_texts_that_name_no_frame_tell_maps_apart(tmp_path):
    views = viewed(FRAMES.format(**UNSTAMPED), tmp_path).connections

    assert len({view.alike for view in views}) == 3
    assert 'target.data = "left"' in views[2].translated.lines


def test_targets_share_the_views_of_a_model(tmp_path):
    model = model_in(tmp_path, NUMBERS)

    assert model.derived(bridge_views)[0] is model.derived(bridge_views)[0]
    views = [view for task in bringup.tasks(model) for view in task.views]
    (config,) = (view for view in views if isinstance(view, ConfigView))
    assert config.process.bridge is model.derived(bridge_views)[0]

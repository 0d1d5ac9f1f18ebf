"""Maps that are filled from what corresponds: as authors would, and never what a rule forbids."""

import os
from collections import Counter
from functools import cache
from pathlib import Path

from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from jausml.authoring.editing.project import Project
from jausml.authoring.proposals.elements import Scope
from jausml.authoring.proposals.mapping.assigning import assign
from jausml.authoring.proposals.mapping.filling import fill_map
from jausml.authoring.proposals.mapping.members import member
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.model.names import name_of
from jausml.language.project import library
from jausml.language.semantics.paths.ros_paths import ros_name
from jausml.language.validation.engine import check

EXAMPLES = int(os.environ.get("JAUSML_EXAMPLES", "12"))
FILE = "robot.ros2jaus"


class Map:
    """A project with one map, which begins with the lines that are given."""

    def __init__(self, folder: Path, message: str, kind: str, lines: str = "", head: str = ""):
        text = f"{head}\nfresh {{\n    JAUS {message}\n    ROS {kind}\n{lines}}}\n"
        (folder / FILE).write_text(text, encoding="utf-8")
        self.project = Project(folder)

    @property
    def scope(self) -> Scope:
        return Scope(self.project.model(FILE).model, self.project.root)

    @property
    def map(self) -> bridge.AttributeMap:
        maps = self.scope.model.instances(bridge.AttributeMap, library=False)
        return next(attribute_map for attribute_map in maps if attribute_map.name == "fresh")

    def fill(self):
        return fill_map(self.scope, self.map)

    def take(self):
        found = self.fill()
        if found.commands:
            self.project.do(found.commands, found.label)
        return found

    def errors(self):
        report = check(self.project.model(FILE))
        return [finding for finding in report.diagnostics if finding.severity.value == "error"]


GATES = """\
import `jaus.core-1.1`
interface_package gate_msgs {
    message_type Gate {
        primitive_field state { type: uint8 }
        constant CLOSED { type: uint8  value: 0 }
        constant OPEN { type: uint8  value: 1 }
        constant STUCK { type: uint8  value: 7 }
    }
}
service_set gates {
    service Gates {
        urn: "urn:example:Gates"
        inherits: Events
        inputs: new message_def QueryGate { code: 0xD201 }
        outputs: new message_def ReportGate {
            code: 0xD401
            record GateRec {
                fixed_field State {
                    values: {
                        enumerated_value open { value: 0 }
                        enumerated_value closed { value: 1 }
                    }
                }
            }
        }
    }
}"""


def test_values_of_one_name_are_filled_by_a_table_that_both_directions_share(tmp_path):
    used = Map(tmp_path, "ReportGate", "gate_msgs/Gate", head=GATES)
    found = used.take()
    assert found.statements == (
        "State -> state : look_up(state)",
        "state -> State : look_up(state)",
    )
    [table] = used.map.tables
    pairs = [(entry.jaus, entry.ros) for entry in table.entries]
    assert pairs == [("open", "OPEN"), ("closed", "CLOSED")]
    for [assignment] in (used.map.toRos, used.map.toJaus):
        assert [conversion.table for conversion in assignment.conversions] == [table]
    assert not used.errors()


def test_a_line_that_is_drawn_brings_the_same_table(tmp_path):
    used = Map(tmp_path, "ReportGate", "gate_msgs/Gate", head=GATES)
    for ends in (("State", "state"), ("state", "State")):
        is_jaus = ends[0] == "State"
        source = member(used.map, ends[0], is_jaus=is_jaus)
        target = member(used.map, ends[1], is_jaus=not is_jaus)
        [option] = assign(used.scope, used.map, source, target).options
        assert option.preview == f"{ends[0]} -> {ends[1]} : look_up(state)"
        assert "number what they name alike otherwise" in option.why
        assert option.is_best
        used.project.do(option.commands, option.label)
        # Drawn again, it takes the place of itself, and the table is there.
        [option] = assign(used.scope, used.map, source, target).options
        used.project.do(option.commands, option.label)
    [table] = used.map.tables
    for assignments in (used.map.toRos, used.map.toJaus):
        [assignment] = assignments
        assert [conversion.table for conversion in assignment.conversions] == [table]
    assert not used.errors()


def test_a_table_that_is_there_is_used(tmp_path):
    table = "    table states ( open <-> OPEN  closed <-> CLOSED )\n"
    used = Map(tmp_path, "ReportGate", "gate_msgs/Gate", lines=table, head=GATES)
    assert "State -> state : look_up(states)" in used.take().statements
    assert [value_table.name for value_table in used.map.tables] == ["states"]
    assert not used.errors()


def test_a_new_map_is_filled_in_both_directions_by_one_edit_and_tells_what_is_left(tmp_path):
    used = Map(tmp_path, "ReportVelocityState", "geometry_msgs/TwistStamped")
    before = (tmp_path / FILE).read_text()
    found = used.take()
    assert found.statements[:4] == (
        "TimeStamp -> header.stamp : timestamp_to_time { whenAbsent: receptionTime }",
        "Velocity_X -> twist.linear.x { whenAbsent: dropMessage }",
        "Velocity_Y -> twist.linear.y : negate { whenAbsent: dropMessage }",
        "Velocity_Z -> twist.linear.z : negate { whenAbsent: dropMessage }",
    )
    assert "twist.angular.z -> YawRate : negate" in found.statements
    assert found.left == {"to_ros": ("header.frame_id",), "to_jaus": ("Velocity_RMS", "Rate_RMS")}
    assert len(used.project.log) == 1
    again = used.fill()
    assert not again.commands
    assert "no further" in again.refusal
    used.project.undo()
    assert (tmp_path / FILE).read_text() == before


def test_what_the_author_wrote_stays_and_the_rest_is_filled(tmp_path):
    lines = "    JAUS->ROS ( 2 -> twist.linear.x )\n"
    used = Map(tmp_path, "ReportVelocityState", "geometry_msgs/TwistStamped", lines)
    found = used.take()
    assert not any(statement.endswith("-> twist.linear.x") for statement in found.statements)
    assert "2 -> twist.linear.x" in (tmp_path / FILE).read_text()
    assert used.errors() == []


def test_angles_become_an_orientation_together(tmp_path):
    used = Map(tmp_path, "ReportLocalPose", "geometry_msgs/PoseStamped")
    found = used.fill()
    assert [statement for statement in found.statements if "orientation" in statement] == [
        "Roll, Pitch, Yaw -> pose.orientation : frd_angles_to_flu_quaternion"
        " { whenAbsent: useDefault  defaultValue: 0 }",
        "pose.orientation -> Roll, Pitch, Yaw : flu_quaternion_to_frd_angles",
    ]


def test_nothing_is_filled_where_nothing_corresponds(tmp_path):
    found = Map(tmp_path, "ReportVelocityState", "std_msgs/String").fill()
    assert not found.commands
    assert found.refusal
    assert found.left["to_ros"] == ("data",)


@cache
def messages():
    """The messages of services that there are in one version, which need no import."""
    services = library().instances(jaus.Service)
    counts = Counter(service.name for service in services)
    return sorted(
        f"{name_of(service)}.{name_of(output)}"
        for service in services
        if counts[service.name] == 1
        for output in (*service.inputs, *service.outputs)
        if output.body is not None
    )


@cache
def kinds():
    """The ROS types with members."""
    return sorted(
        {
            ros_name(message)
            for message in library().instances(ros.MessageType)
            if isinstance(message.eContainer(), ros.InterfacePackage) and len(message.fields)
        }
    )


@settings(
    max_examples=EXAMPLES,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
    deadline=None,
)
@given(data=st.data())
def test_what_is_filled_never_has_an_error(tmp_path, data):
    message = data.draw(st.sampled_from(messages()))
    kind = data.draw(st.sampled_from(kinds()))
    used = Map(tmp_path, message, kind)
    assume(not used.errors())
    found = used.take()
    assert used.errors() == [], (message, kind, found.statements)

"""Edits of texts: in a formatted text the planned lines change, and all comments stay."""

import shutil
from pathlib import Path

import pytest
from editing_support import Edited

from jausml.authoring.editing.commands import Add, Child, EditError, Move, Remove, Rename, Set

MODEL = """\
// A robot, as we like it.

import "types.ros2jaus"

/** The robot. */
system robot {
    component arm { address: 100.1.1  uses: Management }  // left
    node driver  // drives

    /** The bridge. */
    bridge front {
        address: 100.1.2
        // what it says
        provides: VelocityStateSensor, Management

        // Maps

        /** Speed. */
        speed {
            JAUS ReportVelocityState
            ROS nav_msgs/Odometry
            table lamp ( OFF <-> false  ON <-> true )
            JAUS->ROS (
                // along
                Velocity_X -> twist.twist.linear.x { whenAbsent: dropMessage }
                Velocity_Y -> twist.twist.linear.y : negate  // across
                ignore pose
            )
            vector fast JAUS->ROS ( X = 1 => pose.pose.position.x = 1 ~ 0.1 )
        }

        connection speed {
            map: speed
            direction: rosToJaus
            topic odometry
        }
    }
}
"""
CATVEHICLE = Path(__file__).parents[3] / "models" / "examples" / "catvehicle"
FILE = "robot.ros2jaus"
BRIDGE = f"{FILE}#//@bridges.0"
MAP = f"{BRIDGE}/@maps.0"
TO_ROS = f"{MAP}/@toRos"


@pytest.fixture
def robot(tmp_path):
    (tmp_path / "types.ros2jaus").write_text("node logger\n")
    path = tmp_path / FILE
    path.write_text(MODEL)
    return Edited(path)


def lines(robot, *commands):
    before = robot.data
    assert robot.differences(*commands) == []
    found = robot.changed_lines(before)
    robot.project.undo()
    assert robot.data == before
    return [f"{line[0]}{line[1:].strip()}" for line in found]


def test_values_of_features(robot):
    assert lines(robot, Set(BRIDGE, "address", ("100.1.9",))) == [
        "-address: 100.1.2",
        "+address: 100.1.9",
    ]
    assert lines(robot, Set(BRIDGE, "controlTimeout", ("7",))) == ["+controlTimeout: 7"]
    refs = [robot.ref(provide) for provide in robot.root.bridges[0].provides]
    assert lines(robot, Set(BRIDGE, "provides", (refs[0],))) == [
        "-provides: VelocityStateSensor, Management",
        "+provides: VelocityStateSensor",
    ]
    assert lines(robot, Set(BRIDGE, "provides", ())) == [
        "-// what it says",
        "-provides: VelocityStateSensor, Management",
    ]
    arm = f"{FILE}#//@components.0"
    assert lines(robot, Set(arm, "uses", ())) == [
        "-component arm { address: 100.1.1  uses: Management }  // left",
        "+component arm { address: 100.1.1 }  // left",
    ]


def test_elements_without_a_block_get_one(robot):
    node = f"{FILE}#//@nodes.0"
    assert lines(robot, Set(node, "namespace", ("/arm",))) == [
        "-node driver  // drives",
        '+node driver { namespace: "/arm" }  // drives',
    ]


def test_assignments(robot):
    along, across = f"{TO_ROS}.0", f"{TO_ROS}.1"
    first = "Velocity_X -> twist.twist.linear.x { whenAbsent: dropMessage }"
    second = "Velocity_Y -> twist.twist.linear.y : negate  // across"
    assert lines(robot, Set(along, "whenAbsent", ())) == [
        f"-{first}",
        "+Velocity_X -> twist.twist.linear.x",
    ]
    assert lines(robot, Set(across, "outOfRange", ("dropMessage",))) == [
        f"-{second}",
        "+Velocity_Y -> twist.twist.linear.y : negate { outOfRange: dropMessage }  // across",
    ]
    assert lines(robot, Set(across, "source", ("Velocity_Z",))) == [
        f"-{second}",
        f"+{second.replace('Velocity_Y', 'Velocity_Z')}",
    ]
    scale = {"kind": ("scale",), "arguments": ("0.5",)}
    assert lines(robot, Add(along, "conversions", "bridge.Conversion", scale)) == [
        f"-{first}",
        f"+{first.replace(' {', ' : scale(0.5) {')}",
    ]
    assert lines(robot, Add(across, "conversions", "bridge.Conversion", scale, position=0)) == [
        f"-{second}",
        f"+{second.replace('negate', 'scale(0.5), negate')}",
    ]
    assert lines(robot, Remove(f"{across}/@conversions.0")) == [
        f"-{second}",
        f"+{second.replace(' : negate', '')}",
    ]
    negate = Child("conversions", "bridge.Conversion", {"kind": ("negate",)})
    values = {"source": ("YawRate",), "target": ("twist.twist.angular.z",)}
    assert lines(robot, Add(MAP, "toRos", "bridge.FieldAssignment", values, (negate,), 1)) == [
        "+YawRate -> twist.twist.angular.z : negate"
    ]
    assert lines(robot, Remove(along)) == ["-// along", f"-{first}"]
    assert lines(robot, Move(along, MAP, "toRos", 1)) == [f"+{second}", f"-{second}"]


def test_a_direction_comes_with_its_first_assignment_and_goes_with_its_last(robot):
    values = {"value": ("x",), "target": ("TimeStamp",)}
    command = Add(MAP, "toJaus", "bridge.ConstantAssignment", values)
    assert lines(robot, command) == ["+ROS->JAUS (", '+"x" -> TimeStamp', "+)"]
    robot.do(command)
    assert lines(robot, Remove(f"{MAP}/@toJaus.0")) == ["-ROS->JAUS (", '-"x" -> TimeStamp', "-)"]


def test_tables_and_vectors(robot):
    table, vector = f"{MAP}/@tables.0", f"{MAP}/@vectors.0"
    old = "table lamp ( OFF <-> false  ON <-> true )"
    assert lines(robot, Set(f"{table}/@entries.1", "ros", ("no word",))) == [
        f"-{old}",
        '+table lamp ( OFF <-> false  ON <-> "no word" )',
    ]
    pair = {"jaus": ("DIM",), "ros": ("0.5",)}
    assert lines(robot, Add(table, "entries", "bridge.TableEntry", pair, position=1)) == [
        f"-{old}",
        "+table lamp ( OFF <-> false  DIM <-> 0.5  ON <-> true )",
    ]
    assert lines(robot, Remove(f"{table}/@entries.0")) == [f"-{old}", "+table lamp ( ON <-> true )"]
    old = "vector fast JAUS->ROS ( X = 1 => pose.pose.position.x = 1 ~ 0.1 )"
    assert lines(robot, Set(f"{vector}/@expected.0", "tolerance", ())) == [
        f"-{old}",
        f"+{old.replace(' ~ 0.1', '')}",
    ]
    value = {"path": ("Y",), "value": ("0",)}
    assert lines(robot, Add(vector, "given", "bridge.VectorValue", value)) == [
        f"-{old}",
        f"+{old.replace(' =>', '  Y = 0 =>')}",
    ]


def test_documentation(robot):
    assert lines(robot, Set(BRIDGE, "documentation", ("In front.",))) == [
        "-/** The bridge. */",
        "+/** In front. */",
    ]
    assert lines(robot, Set(BRIDGE, "documentation", ())) == ["-/** The bridge. */"]
    assert lines(robot, Set(f"{TO_ROS}.1", "documentation", ("Sideways.",))) == [
        "+/** Sideways. */"
    ]


def test_new_elements_stand_beside_their_like(robot):
    values = {"name": ("rear",), "address": ("100.1.3",)}
    assert lines(robot, Add(f"{FILE}#/", "bridges", "bridge.Bridge", values)) == [
        "+",
        "+bridge rear { address: 100.1.3 }",
    ]


def test_a_name_is_followed_in_all_files(robot):
    other = robot.path.with_name("other.ros2jaus")
    other.write_text(f'import "{FILE}"\n\n// Watches.\ncomponent ocu {{ controls: front }}\n')
    again = Edited(robot.path)
    assert again.do(Rename(BRIDGE, "the front")) == MODEL.replace(
        "bridge front", "bridge `the front`"
    )
    assert "controls: `the front` }" in other.read_text()
    assert again.undo_all() == MODEL.encode()
    assert "controls: front }" in other.read_text()


def test_what_is_referred_to_is_imported(robot):
    ready = "library:/mappings/odometry.ros2jaus#//@maps.0"
    command = Set(f"{BRIDGE}/@bridgeConnections.0", "map", (ready,))
    before = robot.data
    robot.do(command)
    assert next(line.strip() for line in robot.changed_lines(before)) == "+import mappings.odometry"


@pytest.mark.parametrize("start", [b"", b"\xef\xbb\xbf"])
@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
def test_encoding_and_line_ends_stay(tmp_path, start, line_end):
    path = tmp_path / FILE
    text = MODEL.replace('import "types.ros2jaus"\n\n', "").replace("A robot", "Ein Röbötchen 𝔘")
    data = start + text.replace("\n", line_end).encode()
    path.write_bytes(data)
    robot = Edited(path)
    values = {"name": ("bäck",), "address": ("100.1.3",), "documentation": ("One.\n\nTwo.",)}
    assert robot.differences(Add(f"{FILE}#/", "components", "jaus.Component", values)) == []
    new = robot.data
    assert new.startswith(start)
    plain = new.decode("utf-8-sig").replace(line_end, "")
    assert "\n" not in plain
    assert "\r" not in plain
    assert robot.undo_all() == data


def test_what_the_text_implies_is_edited_in_the_text(tmp_path):
    path = tmp_path / FILE
    path.write_text("component arm { address: 1.1.1 }\n")
    robot = Edited(path)
    with pytest.raises(EditError, match="System 'robot' follows from the rest"):
        robot.do(Rename(f"{FILE}#/", "other"))
    robot.do(Remove(f"{FILE}#//@components.0"))
    assert robot.data == b"system robot\n"
    robot.undo_all()
    values = {"name": ("leg",)}
    assert robot.do(Add(f"{FILE}#/", "nodes", "ros.Node", values)).endswith("}\n\nnode leg\n")


def test_what_follows_may_follow_an_edit(tmp_path):
    shutil.copytree(CATVEHICLE, tmp_path / "car")
    car = Edited(tmp_path / "car" / "catvehicle.ros2jaus")
    [bridge] = car.root.bridges
    ref, cruise_speed = car.ref(bridge), next(e for e in bridge.maps if e.name == "cruise_speed")
    topic = Child("topics", "bridge.Topic", {"name": ("again",)})
    values = {"name": ("again",), "map": (car.ref(cruise_speed),)}
    text = car.do(Add(ref, "bridgeConnections", "bridge.Connection", values, (topic,)))
    block = ["connection again {", "    map: cruise_speed", "    topic again", "}"]
    assert "\n".join(f"{' ' * 8}{line}" for line in block) in text
    # Without its services the bridge carries what it carries in other ways.
    assert "provides:" not in car.do(Set(ref, "provides", ())).split("bridge bridge")[1]
    connection = f"{ref}/@bridgeConnections.5"
    assert "direction: rosToJaus" in car.do(Set(connection, "direction", ("rosToJaus",)))
    car.do(Set(connection, "direction", ()))
    assert car.undo_all() == car.first


def test_paths_through_a_join_follow_its_name(tmp_path):
    path = tmp_path / FILE
    path.write_text(
        "node n\n\nm {\n    JAUS SetVelocityCommand\n    ROS std_msgs/Float64\n"
        "    join lever { type: std_msgs/Float64 }\n"
        "    ROS->JAUS (\n        lever.data -> Velocity_X\n"
        "        leverage.data -> Velocity_Y\n    )\n"
        "    vector v ROS->JAUS ( lever.data = 1 => Velocity_X = 1 )\n}\n"
    )
    robot = Edited(path)
    [join] = (
        next(root for root in robot.model.roots if root.eClass.name == "MapLibrary").maps[0].joins
    )
    text = robot.do(Rename(robot.ref(join), "stick"))
    wanted = robot.first.decode().replace("lever ", "stick ").replace("lever.", "stick.")
    assert text == wanted


def test_the_first_edit_of_an_unformatted_text_formats_it_and_says_so(tmp_path):
    path = tmp_path / FILE
    path.write_text("// Ours.\nnode   logger // logs\n\n\nnode driver {}\n")
    project = Edited(path).project
    named = [Set(f"{FILE}#//@nodes.1", "namespace", ("a",))]
    assert project.do(named, "name").label == f"name, and format {FILE}"
    assert path.read_text() == ("// Ours.\nnode logger  // logs\n\nnode driver { namespace: a }\n")
    assert project.do([Rename(f"{FILE}#//@nodes.0", "log")], "rename").label == "rename"

"""Maps of joints: each robot has its own names, and those of the library are used by nobody."""

import re
import sys

import needs
import pytest
from scripts import ran
from sweeps import sweep

from jausml.language.metamodel.classes import bridge
from jausml.language.model import read_models
from jausml.language.model.names import name_of
from jausml.language.semantics.assignments.named_places import NamedPlaces, named_places
from jausml.language.text.notation import NOTATIONS

NOTATION = pytest.mark.parametrize("notation", sweep(["text", "xmi"], every=2))
STATES, GOALS = "joint_states:sensor_msgs/JointState", "arm/cmd:sensor_msgs/JointState"
JOINTS = ["shoulder", "elbow", "wrist"]
NAMED = ("--joints", "joint_states=shoulder,elbow,wrist", "--joints", "arm/cmd=elbow,shoulder")
KEPT = ("--hold", "arm/cmd=the arm holds its position by brakes")

TRANSLATED = """\
import sys
from types import SimpleNamespace

sys.path[:0] = sys.argv[1:]
from arm.arm import Arm
from jausml_runtime.bridge.messages.limits import AbsentFieldError
from sensor_msgs.msg import JointState

arm = Arm()
state = JointState(name=["wrist", "finger", "elbow", "shoulder"], position=[0.3, 9.0, 0.2, 0.1])
report = arm.translate_joint_states(state)
print([round(each.joint_position.value, 3) for each in report.joint_position_list])
try:
    arm.translate_joint_states(JointState(name=["elbow"], position=[0.2]))
except AbsentFieldError:
    print("dropped")
"""


def maps_in(model):
    read = read_models([model], project_root=model.parents[1], notations=NOTATIONS).model
    return {
        name_of(attribute_map): attribute_map
        for attribute_map in read.instances(bridge.AttributeMap, library=False)
    }


def names_of(used):
    ways = (*used.toRos, *used.toJaus)
    return [
        list(assignment.names)
        for assignment in ways
        if isinstance(assignment, bridge.ListAssignment)
    ]


@NOTATION
def test_a_bridge_has_the_joints_of_the_robot(rover, jausml, refused, notation):
    model = rover(notation)
    told = "state those of the robot by --joints joint_states=NAME,NAME"
    refused(told, model, "new", "bridge", "arm", STATES, GOALS, "--yes")
    done = jausml("new", "bridge", "arm", STATES, GOALS, "--yes", *NAMED, *KEPT)
    assert "to whoever asks; joints shoulder, elbow, wrist" in done.output
    made = maps_in(model)
    assert names_of(made["joint_states_joint_positions"]) == [JOINTS, JOINTS]
    assert names_of(made["arm_cmd_set_joint_positions"]) == [["elbow", "shoulder"]] * 2
    jausml("validate", "models", "--strict")
    jausml("generate", model, "-o", "src", "--target", "bridge")


def test_the_joints_of_a_command_have_no_stop_before_a_person_says_so(rover, jausml):
    rover("text")
    jausml("new", "bridge", "arm", GOALS, "--yes", *NAMED[2:])
    found = jausml("validate", "models", "--strict", status=1)
    assert "JML451" in found.output


@pytest.mark.slow
def test_its_messages_pass_by_name(rover, jausml, tmp_path):
    needs.ask("rclpy")
    model = rover("text")
    jausml("new", "bridge", "arm", STATES, "--yes", *NAMED[:2])
    jausml("generate", model, "-o", "src")
    script = tmp_path / "translate.py"
    script.write_text(TRANSLATED, "utf-8")
    folders = sorted({str(path.parents[1]) for path in (model.parents[1] / "src").rglob("*.py")})
    done = ran([sys.executable, script, *folders])
    assert done.stdout.splitlines() == ["[0.1, 0.2, 0.3]", "dropped"], done.stderr


@NOTATION
def test_a_copy_of_a_map_has_them_too(rover, jausml, notation):
    model = rover(notation)
    jausml("new", "bridge", "arm", STATES, "--yes", *NAMED[:2])
    goal = ("new", "map", "goal", "SetJointPositions", "sensor_msgs/JointState", "--yes")
    refused = jausml(*goal, status=2)
    assert "set_joint_positions knows joints by their names" in refused.output
    jausml(*goal, "--joints", "shoulder, elbow")
    assert names_of(maps_in(model)["goal"]) == [["shoulder", "elbow"]] * 2


@NOTATION
def test_the_stop_of_a_copy_has_each_joint_of_the_robot(rover, jausml, notation):
    model = rover(notation)
    velocities = f"{GOALS}:set_joint_velocities"
    jausml("new", "bridge", "arm", velocities, "--yes", *NAMED[2:])
    jausml("validate", "models", "--strict")
    (made,) = (used for name, used in maps_in(model).items() if "set_joint_vel" in name)
    stop = {str(value.target): str(value.value) for value in made.stopRos.values}
    expected = {"name[0]": "elbow", "velocity[0]": "0", "name[1]": "shoulder", "velocity[1]": "0"}
    assert stop == expected
    stop = [str(value.target) for value in made.stopJaus.values]
    assert stop == [f"JointVelocityList[{at}].JointVelocity.radianPerSecond" for at in range(2)]


def test_the_stop_of_a_copy_tells_each_stabilizer_by_its_number(rover, jausml):
    """The map numbers them by their places, and so does its stop: none may move on."""
    model = rover("text")
    flippers = "flip/cmd:sensor_msgs/JointState:set_stabilizer_efforts"
    joints = ("--joints", "flip/cmd=a,b,c,d,e")
    jausml("new", "bridge", "flip", flippers, "--yes", *joints)
    (made,) = (used for name, used in maps_in(model).items() if "set_stab" in name)
    stop = [(str(value.target), str(value.value)) for value in made.stopJaus.values]
    element = "StabilizerEffort[{}].{}".format
    assert stop == [
        pair
        for index in range(5)
        for pair in (
            (element(index, "StabilizerID"), str(index + 1)),
            (element(index, "Effort"), "0"),
        )
    ]


def test_the_stop_of_a_copy_has_the_values_of_each_element_in_whatever_order(rover, jausml):
    model = rover("text")
    jausml("new", "bridge", "arm", f"{GOALS}:set_joint_velocities", "--yes", *NAMED[2:])
    (own,) = (name for name in maps_in(model) if "set_joint_vel" in name)
    told = {"velocity[1]": 2, "velocity[0]": 1, "name[1]": '"shoulder"', "name[0]": '"elbow"'}
    values = ", ".join(f"{{ target: {path} value: {value} }}" for path, value in told.items())
    text, count = re.subn(
        r"(?<=stopRos: \{\n).*?(?=\n *\}\n)",
        f"values: {values}",
        model.read_text("utf-8"),
        count=1,
        flags=re.DOTALL,
    )
    assert count == 1
    model.write_text(text, "utf-8")
    again = ("new", "map", "goal", "SetJointVelocities", "sensor_msgs/JointState", "--yes")
    jausml(*again, "--copy", own, "--joints", "a,b,c")
    stop = maps_in(model)["goal"].stopRos
    names = {f"name[{at}]": name for at, name in enumerate("abc")}
    velocities = {f"velocity[{at}]": str(at + 1) for at in range(3)}
    told = {str(value.target): str(value.value) for value in stop.values}
    assert told == names | velocities


PAN_TILT = "ptu/cmd:sensor_msgs/JointState"


@NOTATION
def test_a_pan_tilt_unit_has_the_names_of_the_robot(rover, jausml, notation):
    model = rover(notation)
    joints = ("--joints", "ptu/cmd=ptu_tilt,ptu_pan")
    done = jausml("new", "bridge", "ptu", f"{PAN_TILT}:set_pan_tilt_velocities", "--yes", *joints)
    assert "joints ptu_pan, ptu_tilt" in done.output
    (made,) = (used for name, used in maps_in(model).items() if "set_pan_tilt" in name)
    assert named_places(made) == NamedPlaces("name", ("ptu_pan", "ptu_tilt"), ("velocity",))
    assert [str(value.target) for value in made.stopRos.values] == ["velocity[0]", "velocity[1]"]
    done = jausml("validate", "models", "--strict")


def test_joints_called_pan_and_tilt_are_those_of_a_pan_tilt_unit(rover, jausml):
    rover("text")
    joints = ("--joints", "ptu/cmd=ptu_pan,ptu_tilt")
    done = jausml("new", "bridge", "ptu", PAN_TILT, "--yes", *joints)
    assert "JAUS -> ROS, set_pan_tilt_positions: " in done.output
    refused = jausml(
        "new", "bridge", "arm", f"{PAN_TILT}:set_pan_tilt_positions", "--yes", status=2
    )
    assert "set_pan_tilt_positions knows the joints of ptu/cmd by their names" in refused.output


def test_no_joint_stands_in_two_places(rover, jausml):
    """One that says pan and tilt says nothing: both are taken as they come."""
    model = rover("text")
    joints = ("--joints", "ptu/cmd=ptu_pan_tilt,wheel")
    jausml("new", "bridge", "ptu", f"{PAN_TILT}:set_pan_tilt_velocities", "--yes", *joints)
    (made,) = (used for name, used in maps_in(model).items() if "set_pan_tilt" in name)
    assert named_places(made).names == ("ptu_pan_tilt", "wheel")


def test_a_copy_of_a_map_of_a_pan_tilt_unit_has_its_two_names(rover, jausml):
    model = rover("text")
    jausml("new", "bridge", "arm", STATES, "--yes", *NAMED[:2])
    copy = ("new", "map", "goal", "SetPanTiltJointPositions", "sensor_msgs/JointState")
    copy += ("--copy", "set_pan_tilt_positions", "--joints")
    refused = jausml(*copy, "pan,tilt,roll", status=2)
    assert "set_pan_tilt_positions has one for each of pan, tilt" in refused.output
    jausml(*copy, "head_yaw,head_pitch")
    assert named_places(maps_in(model)["goal"]).names == ("head_yaw", "head_pitch")


@pytest.mark.parametrize(
    ("joints", "told"),
    [
        ("arms=a,b", "there is no topic 'arms' here"),
        ("joint_states=a,,b", "should be like shoulder,elbow,wrist"),
        ("joint_states=a,a", "should be like shoulder,elbow,wrist"),
        ("odom=a,b", "no map of it knows joints by names"),
    ],
)
def test_bad_joints_change_nothing(rover, refused, joints, told):
    topics = (f"{STATES}:joint_positions", "odom:nav_msgs/Odometry:local_pose")
    refused(told, rover("xmi"), "new", "bridge", "arm", *topics, "--joints", joints)

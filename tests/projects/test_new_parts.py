"""`jausml new component`, `node`, `map` and `service`, in both notations."""

import re
import shlex

import emf_check
import pytest
from sweeps import sweep

NOTATION = pytest.mark.parametrize("notation", sweep(["xmi", "text"], every=2))


@NOTATION
def test_parts_of_a_system(rover, jausml, notation):
    model = rover(notation)
    for words in (
        "service Lamp --urn urn:example:light:Lamp --inherits Management",
        "component lamp --provides Lamp --provides VelocityStateSensor",
        "node driver --publishes cmd_vel:geometry_msgs/Twist"
        " --subscribes odom:nav_msgs/msg/Odometry --subscribes /odom/valid:std_msgs/Bool",
        "bridge ears odom:nav_msgs/Odometry --side operator --yes",
        "map speed ReportVelocityState std_msgs/Float64 --to-ros data=Velocity_X:",
    ):
        jausml("new", *words.split())
    jausml("validate", "models")
    text = model.read_text("utf-8")
    assert text.count("100.1.1") == 1
    assert text.count("100.1.2") == 1


@pytest.mark.parametrize("name", ["a&b<c.xmi", "a&b<c.ros2jaus", "my robot.xmi", "2-fast.xmi"])
def test_a_new_file_has_a_valid_system_whatever_it_is_called(rover, jausml, name):
    model = rover("xmi").with_name(name)
    done = jausml("new", "component", "arm", "--model", model)
    assert f"next: {shlex.join(['jausml', 'validate', f'models/{name}'])}" in done.output
    jausml("validate", model)


@NOTATION
def test_again_it_would_write_the_same(rover, jausml, notation):
    """What is written is what the writers of the notations write, so Eclipse changes nothing."""
    model = rover(notation)
    jausml("new", "component", "a", "--provides", "PrimitiveDriver")
    if notation == "text":
        jausml("format", model, "--check")
    else:
        assert '<components name="a" address="100.1.1">' in model.read_text("utf-8")


@NOTATION
def test_a_file_of_another_layout_is_formatted_and_that_is_told(rover, jausml, notation):
    model = rover(notation)
    assert f"{model.name} written\n" in jausml("new", "node", "a").output
    data = model.read_bytes().replace(b"<nodes ", b"<nodes   ").replace(b"node a", b"node   a")
    model.write_bytes(data)
    assert f"{model.name} written and formatted\n" in jausml("new", "node", "b").output


@pytest.mark.parametrize(
    ("notation", "told"), [("xmi", "rover.xmi:3:1: not well-formed XML"), ("text", "ros2jaus:1:")]
)
def test_a_model_that_cannot_be_read_is_left_alone(rover, jausml, notation, told):
    model = rover(notation)
    data = model.read_bytes().replace(b"/>", b">").replace(b"system rover", b"system rover {")
    model.write_bytes(data)
    done = jausml("new", "node", "a", status=2)
    assert told in done.output, done.output
    assert model.read_bytes() == data


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("component", "a", "--provides", "PrimitivDriver"), "did you mean 'PrimitiveDriver'?"),
        (("component", "a", "--uses", "ListManager"), "say which (urn:jaus:jss:"),
        (("component", "a b"), "is no name"),
        (("component", "a", "--address", "1.2"), "address"),
        (("component", "a", "--address", "9.1.1"), "first has the address 9.1.1; 9.1.2 is free"),
        (
            ("bridge", "a", "odom:nav_msgs/Odometry", "--yes", "--address", "9.1.1"),
            "first has the address 9.1.1; 9.1.2 is free",
        ),
        (("node", "a", "--publishes", "x"), "should be like cmd_vel:geometry_msgs/Twist"),
        (("node", "a", "--publishes", "x:geometry_msgs/Twits"), "did you mean"),
        (("service", "A", "--urn", "urn:jaus:jss:core:Time"), "already"),
        (
            ("map", "a", "ReportVelocityState", "nav_msgs/Odometry"),
            "has no bridge; `jausml new bridge` makes one",
        ),
    ],
)
def test_bad_words_change_nothing(rover, jausml, words, told):
    model = rover("xmi")
    jausml("new", "component", "first", "--address", "9.1.1")
    before = model.read_bytes()
    done = jausml("new", *words, status=2)
    assert told in done.output, done.output
    assert model.read_bytes() == before


def test_eclipse_knows_where_each_metamodel_is_that_is_needed(rover, jausml):
    """EMF lists those that a file uses, and opens no file with a namespace that has no place."""
    model = rover("xmi")
    assert _places(model) == ["system"]
    jausml("new", "bridge", "face", "odom:nav_msgs/Odometry", "--yes")
    words = "new map speed ReportVelocityState std_msgs/Float64 --to-ros data=Velocity_X"
    jausml(*words.split())
    assert _places(model) == ["bridge", "system"]
    before = model.read_bytes()
    again = "new map again ReportVelocityState std_msgs/Float64 --to-ros data=Velocity_Y"
    jausml(*again.split())
    assert _places(model) == ["bridge", "system"]
    assert model.read_bytes().count(b"\n") == before.count(b"\n") + 6


def _places(model):
    """Returns the languages whose metamodels a model places beside its folder."""
    written = re.search(r'xsi:schemaLocation="([^"]*)"', model.read_text("utf-8"))[1].split()
    names = [re.fullmatch(r"\.\./metamodels/(\w+)\.ecore", value)[1] for value in written[1::2]]
    assert written[::2] == [f"http://www.jausml.org/{name}/1.0" for name in names]
    return names


@pytest.mark.slow
@pytest.mark.needs("emf")
def test_eclipse_opens_what_grew_and_would_save_it_as_it_is(rover, jausml):
    model = rover("xmi")
    for words in (
        "new bridge face odom:nav_msgs/Odometry:local_pose cmd:geometry_msgs/Twist --yes",
        "new map speed ReportVelocityState std_msgs/Float64 --to-ros data=Velocity_X",
        "new service-connection status:std_srvs/Trigger QueryStatus --side operator",
        "new action-connection follow_waypoints:nav2_msgs/FollowWaypoints",
        "new map own SetVelocityCommand geometry_msgs/Twist --fill",
        "new component ocu --uses LocalPoseSensor",
        "new node planner --publishes goal:geometry_msgs/Pose",
        "new service Sonar --message SetDepth",
    ):
        jausml(*words.split())
    others = sorted({*model.parent.rglob("*.xmi")} - {model})
    assert len(others) > 1
    saved = model.with_name("saved.xmi")
    done = emf_check.ask("--resave", saved, *others, model)
    assert (done.returncode, done.stdout) == (0, "")
    assert model.read_text("utf-8") == saved.read_text("utf-8")


def test_a_bridge_that_eclipse_put_into_a_file_of_its_own(rover, jausml):
    """Control... in the tree editor leaves an href in the system."""
    model = rover("xmi", origin="example")
    text = model.read_text("utf-8")
    start, end = text.index("  <bridges"), text.index("</system:System>")
    head = text[text.index(" xmi:version") : text.index(" xmi:id")]
    inner = text[start:end].strip().replace(' peers="sensor"', "")
    inner = inner.replace("<topics", '<peers href="rover.xmi#sensor"/>\n      <topics')
    part = inner.replace("<bridges", f"<bridge:Bridge{head}").replace(
        "</bridges", "</bridge:Bridge"
    )
    model.with_name("part.xmi").write_text(f"{text[:start].splitlines()[0]}\n{part}\n", "utf-8")
    model.write_text(
        f'{text[:start]}  <bridges href="part.xmi#sensor_bridge"/>\n{text[end:]}', "utf-8"
    )
    before = model.read_bytes()
    words = "new map speed ReportVelocityState std_msgs/Float64 --to-ros data=Velocity_X"
    done = jausml(*words.split(), "--model", model)
    assert "models/part.xmi written" in done.output
    assert model.read_bytes() == before
    assert '<maps name="speed"' in model.with_name("part.xmi").read_text("utf-8")

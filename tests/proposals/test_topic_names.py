"""What topics are proposed as: by what their names say, where a type alone says nothing."""

import re
from collections import defaultdict

from for_each import for_each
from sources import ROOT

from jausml.authoring.proposals.new_elements import free_name
from jausml.authoring.proposals.topics import (
    TopicEnd,
    clashes,
    crossings,
    joins_of,
    robots_in,
    within,
)
from jausml.language.metamodel.classes import bridge
from jausml.language.model.names import name_of
from jausml.language.project import library

SIDES = ("vehicle", "operator")
REPORTS = ("odometer", "local_pose_stamped", "end_effector_pose")


def ways(name, kind, side="vehicle", **known):
    maps = library().instances(bridge.AttributeMap)
    return crossings(TopicEnd(name, kind, **known), maps, side)


def first(name, kind, side="vehicle", **known):
    return next((name_of(crossing.map) for crossing in ways(name, kind, side, **known)), None)


@for_each(
    ("name", "kind"),
    [
        ("e_stop/set", "std_msgs/Bool"),
        ("brake/cmd", "std_msgs/Bool"),
        ("set", "std_msgs/Bool"),
        ("motor_temperature", "std_msgs/Float64"),
        ("arm/torque", "std_msgs/Float64"),
        ("set_fan_speed", "std_msgs/Float64"),
        ("gripper/command", "std_msgs/Float64"),
        ("cmd_winch", "std_msgs/Float32"),
        ("battery_level", "std_msgs/Float32"),
    ],
)
def test_a_bare_value_whose_name_says_nothing_is_proposed_as_nothing(name, kind):
    assert not any(ways(name, kind, side) for side in SIDES)
    assert ways(name, kind, maps=("a map that a person names",))


@for_each(
    ("name", "kind", "used"),
    [
        ("headlights", "std_msgs/Bool", "set_headlights"),
        ("parking_brake", "std_msgs/Float32", "parking_brake"),
        ("speed", "std_msgs/Float64", "travel_speed"),
        ("odometer", "std_msgs/Float64", "odometer"),
        ("pose", "geometry_msgs/PoseStamped", "local_pose_stamped"),
        ("tool_pose", "geometry_msgs/PoseStamped", "end_effector_pose"),
        ("goal_pose", "geometry_msgs/PoseStamped", "local_waypoint"),
    ],
)
def test_what_a_name_says_is_proposed(name, kind, used):
    assert first(name, kind, to_ros=used not in REPORTS) == used


OTHERS = {"headlights", "odometry/global", "wheels/efforts", "joy", "path", "global_path", "video"}
OTHERS |= {"e_stop", "emergency"}
"""Suggestions that the name alone does not say, or that are for lists and calls."""


def suggested():
    """The topics that the list of ready maps suggests, with their types, and the maps of each."""
    found = defaultdict(set)
    for line in (ROOT / "models/library/mappings/README.md").read_text("utf-8").splitlines():
        cells = [word.strip() for word in line.split("|")[1:-1]]
        kind = re.match(r"\w+_msgs/\w+\b(?!\.)", cells[1]) if len(cells) == 5 else None
        for topic in re.findall(r"`([^`]+)`", cells[2]) if kind else ():
            found[topic, kind[0]] |= {*re.findall(r"`([^`]+)`", cells[3])}
    return found


def test_a_suggested_topic_is_proposed_by_its_map():
    known = suggested()
    assert len(known) > 50
    wrong = {}
    for (topic, kind), maps in known.items():
        found = {first(topic, kind, side, to_ros=way) for side in SIDES for way in (True, False)}
        if not found & maps and any(ways(topic, kind, side, maps=("",)) for side in SIDES):
            wrong[topic] = found
    assert wrong.keys() <= OTHERS, wrong


def test_a_join_is_fed_by_what_it_is_named_after():
    """Of what nodes publish: nothing comes by topics to which nodes listen alone."""
    [lamps] = ways("headlights", "std_msgs/Bool", maps=("report_lamps",), to_ros=False)[:1]
    topics = [TopicEnd(name, "std_msgs/Bool") for name in ("e_stop", "brake_lights", "armed")]
    assert name_of(lamps.map) == "report_lamps"
    assert joins_of(lamps, topics, set()) == {"brake_lights": "brake_lights"}
    pose = next(crossing for crossing in ways("fix", "sensor_msgs/NavSatFix") if crossing.map.joins)
    imus = [TopicEnd(topic_name, "sensor_msgs/Imu") for topic_name in ("camera/accel", "imu/data")]
    assert joins_of(pose, imus, set()) == {"imu": "imu/data"}
    assert joins_of(pose, imus[:1], set()) == {"imu": "camera/accel"}
    heard_imu = TopicEnd("imu/desired", "sensor_msgs/Imu", to_ros=True)
    assert joins_of(pose, [heard_imu, imus[0]], set()) == {"imu": "camera/accel"}


def test_one_message_is_not_that_of_two_topics():
    twists = [way for name in ("left", "right") for way in ways(name, "nav_msgs/Odometry")[:1]]
    assert clashes(twists) == [(twists[1], twists[0])]
    lamps = [ways(topic_name, "std_msgs/Bool")[0] for topic_name in ("headlights", "brake_lights")]
    assert clashes(lamps) == []


@for_each(
    ("names", "robots"),
    [
        (["cmd_vel", "odom"], []),
        (["car/cmd_vel", "car/odom"], []),
        (["joint_states", "ptu/joint_states"], []),
        (["a/cmd_vel", "b/cmd_vel"], ["a", "b"]),
        (["fleet/a/odom", "fleet/b/odom", "fleet/a/fix", "fleet/b/fix"], ["fleet/a", "fleet/b"]),
        (["a/cmd_vel", "cmd_vel", "scan"], ["", "a"]),
    ],
)
def test_several_robots_are_seen_by_their_namespaces(names, robots):
    topics = [TopicEnd(name, "x_msgs/X", to_ros=name.endswith("cmd_vel")) for name in names]
    assert robots_in(topics) == robots
    for robot in robots:
        assert robots_in(within(topics, robot)) == []
    if "" in robots:
        assert [end.name for end in within(topics, "/")] == ["cmd_vel", "scan"]
        assert [end.name for end in within(topics, "/a")] == ["cmd_vel"]


# -- names that are free ---------------------------------------------------------------------------


def test_a_name_of_any_length_can_be_made_unique():
    taken = ["x" * 2000]
    for _ in range(3):
        name = free_name("x" * 2000, taken)
        assert name not in taken
        taken.append(name)
    assert taken[2] != taken[3]

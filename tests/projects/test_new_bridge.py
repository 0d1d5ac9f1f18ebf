"""`jausml new bridge`: bridges of topics by ready maps, in both notations."""

import re

import click
import pytest
import warm
from sweeps import sweep
from terminal import at_terminal

from jausml.authoring.proposals.topics import TopicEnd
from jausml.cli.authoring.running import of_one_robot
from jausml.language.metamodel.classes import bridge
from jausml.language.model import read_models
from jausml.language.model.names import name_of
from jausml.language.text.notation import NOTATIONS
from jausml.live.ros.running import RosEndpoint, Running, RunningCall, RunningGraph, RunningTopic

NOTATION = pytest.mark.parametrize("notation", sweep(["text", "xmi"], every=2))
DRIVE, ODOM = "cmd_vel:geometry_msgs/Twist", "odom:nav_msgs/Odometry"


def the_bridge(model):
    read = read_models([model], project_root=model.parents[1], notations=NOTATIONS)
    [found] = read.model.instances(bridge.Bridge, library=False)
    return found


def ways(model):
    """What each connection carries: topics, map, direction and exchange."""
    return [
        ([topic.name for topic in one.topics], one.map.name, one.direction.name, one.exchange.name)
        for one in the_bridge(model).bridgeConnections
    ]


@NOTATION
def test_it_validates_and_generates(rover, jausml, notation):
    model = rover(notation)
    done = jausml("new", "bridge", "rover", "--topics", DRIVE, ODOM, "--yes")
    assert (
        "cmd_vel: JAUS -> ROS, velocity_command: SetVelocityCommand of VelocityStateDriver is taken"
        in done.output
    )
    assert "odom: ROS -> JAUS, local_pose: reported as ReportLocalPose of" in done.output
    jausml("validate", "models", "--strict")
    jausml("generate", model, "-o", "src", "--target", "bridge")
    assert ways(model) == [
        (["cmd_vel"], "velocity_command", "jausToRos", "message"),
        (["odom"], "local_pose", "rosToJaus", "periodicEvent"),
    ]
    made = the_bridge(model)
    assert sorted(map(name_of, made.provides)) == ["LocalPoseSensor", "VelocityStateDriver"]
    drive, odometry = (connection.topics[0].qos for connection in made.bridgeConnections)
    assert (drive.reliability.name, drive.depth) == ("reliable", 1)
    assert (odometry.reliability.name, odometry.depth) == ("best_effort", 5)


@NOTATION
def test_what_stands_in_the_file_stays(rover, jausml, notation):
    model = rover(notation)
    before = model.read_text("utf-8")
    comment = "<!-- Mine. -->\n" if notation == "xmi" else "// Mine.\n"
    model.write_text(before + comment, "utf-8")
    jausml("new", "bridge", "rover", DRIVE, "--yes")
    assert comment in model.read_text("utf-8")


def test_the_other_side_commands_and_asks(rover, jausml):
    model = rover("text")
    jausml("new", "bridge", "base", DRIVE, ODOM, "--side", "operator", "--yes")
    assert ways(model) == [
        (["cmd_vel"], "velocity_command", "rosToJaus", "message"),
        (["odom"], "local_pose", "jausToRos", "periodicEvent"),
    ]
    assert list(the_bridge(model).provides) == []
    jausml("validate", "models", "--strict")


@pytest.mark.slow
def test_one_topic_may_have_several_maps(rover, jausml):
    model = rover("xmi")
    word = f"{ODOM}:local_pose,velocity_state"
    jausml("new", "bridge", "rover", word)
    pairs = [(topics, used) for topics, used, *_ in ways(model)]
    assert pairs == [(["odom"], "local_pose"), (["odom"], "velocity_state")]
    jausml("validate", "models", "--strict")


@NOTATION
def test_a_topic_may_feed_the_join_of_another(rover, jausml, notation):
    model = rover(notation)
    line = ("new", "bridge", "rover", "fix:sensor_msgs/NavSatFix", "imu/data:sensor_msgs/Imu")
    jausml(*line, status=2)
    done = jausml(*line, "--yes")
    assert "imu/data: ROS -> JAUS, global_pose: read as imu with fix" in done.output
    assert "fix: global_pose is used; global_waypoint_fix would fit too" in done.output
    [(topics, used, *_)] = ways(model)
    assert (topics, used) == (["fix", "imu/data"], "global_pose")
    jausml("validate", "models", "--strict")


def test_a_join_that_nothing_feeds_is_subscribed_to_nothing(rover, jausml):
    model = rover("text")
    jausml("new", "bridge", "rover", "fix:sensor_msgs/NavSatFix:global_pose")
    [(topics, *_)] = ways(model)
    assert topics == ["fix"]
    jausml("validate", "models", "--strict")
    jausml("generate", model, "-o", "src", "--target", "bridge")


WASHING = """\
system rover {
    service_set Wash {
        service Wash {
            urn: "urn:example:rover:Wash"
            inputs: new message_def SetWash {
                code: 0xD101
                isCommand: true
                record WashRec { fixed_field Power { type: float64 } }
            }
        }
    }
    bridge washer {
        address: 100.1.1
        wash {
            JAUS SetWash
            ROS std_msgs/Float64
            stopJaus: { values: { target: Power  value: 0 } }
            ROS->JAUS ( data -> Power )
        }
    }
}
"""


def test_who_is_found_by_a_service_without_control_is_not_asked_for_it(rover, jausml):
    model = rover("text")
    model.write_text(WASHING, encoding="utf-8")
    jausml("new", "connection", "wash:std_msgs/Float64:wash", "--side", "operator")
    [connection] = the_bridge(model).bridgeConnections
    assert (len(connection.search.services), connection.control) == (1, False)
    jausml("validate", "models", "--strict")


STOP = "e_stop/set:std_msgs/Bool"


def test_a_type_alone_says_nothing(rover, jausml, refused):
    model = rover("text")
    done = jausml("new", "bridge", "rover", DRIVE, STOP, "fan:std_msgs/Float64", "--yes")
    assert "left out: e_stop/set is an emergency stop: a person states what presses" in done.output
    assert "left out: nothing in the name fan says what its std_msgs/Float64 means" in done.output
    assert [topics for topics, *_ in ways(model)] == [["cmd_vel"]]
    refused("no topic is left", model, "new", "connection", STOP, "--yes")
    done = jausml("new", "connection", "switch:std_msgs/Bool:set_headlights")


def test_of_several_robots_somebody_says_which_one():
    topics = [TopicEnd(f"{robot}/cmd_vel", "geometry_msgs/Twist", to_ros=True) for robot in "ab"]
    with pytest.raises(click.UsageError, match="a bridge of its own:\n  --namespace a\n"):
        of_one_robot(topics, None)
    assert [end.name for end in of_one_robot(topics, "/b")] == ["cmd_vel"]
    assert of_one_robot(topics[:1], None) == topics[:1]
    with pytest.raises(click.UsageError, match="no topic runs in the namespace 'c'"):
        of_one_robot(topics, "c")


def test_what_comes_next_is_told_of_the_robot_that_is_meant(rover, jausml, monkeypatch):
    """Its names are relative to the namespace that the bridge has then."""
    end = RosEndpoint("/driver", "reliable", "volatile")
    drive = [RunningTopic(f"/{r}/cmd_vel", ("geometry_msgs/msg/Twist",), (), (end,)) for r in "ab"]
    calls = [RunningCall(f"/{r}/reset", ("std_srvs/srv/Trigger",), ("/n",), ()) for r in "ab"]
    graph = RunningGraph(tuple(drive), tuple(calls))
    monkeypatch.setattr("jausml.cli.authoring.running.what_runs", lambda *_: Running(graph))
    rover("text")
    done = jausml("new", "bridge", "rover", "--from-graph", "--namespace", "a", "--yes")
    following = re.findall(r"jausml new service-connection (\S+)", done.output)
    assert following == ["reset:std_srvs/Trigger"]


def test_a_namespace_is_for_what_runs(rover, jausml):
    rover("text")
    done = jausml("new", "bridge", "rover", DRIVE, "--namespace", "a", status=2)
    assert "--namespace goes with --from-graph" in done.output


def test_a_second_topic_of_one_report_is_left_out(rover, jausml):
    model = rover("text")
    done = jausml("new", "bridge", "rover", ODOM, "wheels/odom:nav_msgs/Odometry", "--yes")
    assert "left out: wheels/odom: odom makes ReportLocalPose already" in done.output
    assert [topics for topics, *_ in ways(model)] == [["odom"]]


def test_it_says_which_numbers_a_map_assumes_and_which_queries_nothing_answers(rover, jausml):
    rover("text")
    done = jausml("new", "bridge", "rover", DRIVE, ODOM, "--yes")
    assert "max_speed of velocity_command is 2 m/s unless a quantity of the bridge" in done.output
    # The last command is told by itself.
    line = "VelocityStateDriver: no connection answers QueryAccelerationLimit\n"
    assert line in done.output
    # The local pose is all that its sensor can be asked for.
    assert "LocalPoseSensor: no connection" not in done.output
    report = f"{DRIVE}:velocity_command,velocity_command_report"
    done = jausml("new", "bridge", "other", report)
    assert "VelocityStateDriver: no connection answers QueryAccelerationLimit\n" in done.output


def test_ways_that_say_the_same_are_told_apart(rover, jausml):
    rover("text")
    done = jausml("new", "bridge", "rover", ODOM, status=2)
    same = "reported as ReportLocalPose of LocalPoseSensor to whoever asks"
    assert f"{ODOM}:local_pose: {same}. Pose in odom." in done.output
    assert f"{ODOM}:local_pose_enu: {same}. Pose in a map frame of ROS with x east" in done.output


def test_what_nothing_stops_says_so(rover, jausml):
    rover("text")
    done = jausml("new", "bridge", "rover", "goal_pose:geometry_msgs/PoseStamped", "--yes")
    assert "You have to decide what happens when the source of a command is lost" in done.output
    assert "goal_pose: nothing stops what SetLocalWaypoint sets in motion" in done.output
    found = jausml("validate", "models", "--strict", status=1)
    assert "JML451" in found.output


def test_a_person_says_why_a_command_may_stand(rover, jausml):
    model = rover("text")
    goal = "goal_pose:geometry_msgs/PoseStamped"
    reason = "the planner of the rover drives to its goal by itself"
    done = jausml("new", "bridge", "rover", goal, "--yes", "--hold", f"goal_pose={reason}")
    assert "You have to decide" not in done.output
    assert f'holdReason: "{reason}"' in model.read_text(encoding="utf-8")
    jausml("validate", "models", "--strict")


def test_a_reason_for_what_needs_none_is_refused(rover, refused):
    line = ("new", "bridge", "rover", ODOM, "goal_pose:geometry_msgs/PoseStamped", "--yes")
    hold = ("--hold", "odom=the motor brakes by itself")
    refused("--hold odom: no map of it needs a reason", rover("text"), *line, *hold)


@pytest.mark.parametrize(
    ("hold", "says"),
    [
        ("goal=x y", "there is no topic 'goal' here"),
        ("goal_pose=", "say what you know about the receiver"),
        (
            "goal_pose=It stands until the next one; see that something stops the "
            "vehicle on its way",
            "say what you know about the receiver",
        ),
        (
            "goal_pose=It stands until the next one: see that something stops the rover on its way",
            "say what you know about the receiver",
        ),
        ("goal_pose=it stands until the next one", "say what you know about the receiver"),
    ],
)
def test_what_a_tool_could_have_written_is_no_reason(rover, refused, hold, says):
    line = ("new", "bridge", "rover", "goal_pose:geometry_msgs/PoseStamped", "--yes")
    refused(says, rover("text"), *line, "--hold", hold)


@pytest.mark.slow
def test_a_bridge_gets_further_topics(rover, jausml):
    model = rover("text")
    jausml("new", "bridge", "rover", DRIVE, ODOM, "--yes")
    done = jausml("new", "connection", f"{ODOM}:velocity_state", "scan:sensor_msgs/LaserScan")
    assert "odom: ROS -> JAUS, velocity_state: reported as ReportVelocityState" in done.output
    # Its message belongs to a service that the bridge provides already.
    done = jausml("new", "connection", "report:geometry_msgs/Twist:velocity_command_report")
    assert [(topics, used) for topics, used, *_ in ways(model)] == [
        (["cmd_vel"], "velocity_command"),
        (["odom"], "local_pose"),
        (["odom"], "velocity_state"),
        (["scan"], "laser_scan"),
        (["report"], "velocity_command_report"),
    ]
    made = the_bridge(model)
    names = [connection.name for connection in made.bridgeConnections]
    assert names[1:3] == ["odom", "velocity_state"]
    provided = ["VelocityStateDriver", "LocalPoseSensor", "VelocityStateSensor", "RangeSensor"]
    assert list(map(name_of, made.provides)) == provided
    done = jausml("validate", "models", "--strict")
    jausml("generate", model, "-o", "src", "--target", "bridge")


def test_a_copy_of_a_ready_map_stands_for_it(rover, jausml):
    rover("xmi")
    jausml("new", "bridge", "front", "scan:sensor_msgs/LaserScan")
    jausml("new", "bridge", "rear", "scan:sensor_msgs/LaserScan")
    done = jausml("validate", "models")
    # Ready maps do not all say yet what becomes of what is absent.
    assert {*re.findall(r"warning: (JML\d+)", done.output)} <= {"JML459"}, done.output


@pytest.mark.slow
def test_of_several_bridges_one_gets_the_topics(rover, jausml, refused):
    model = rover("text")
    done = jausml("new", "connection", DRIVE, "--yes", status=2)
    assert "has no bridge; `jausml new bridge` makes one" in done.output
    for name, topic in (("front", DRIVE), ("rear", "scan:sensor_msgs/LaserScan")):
        jausml("new", "bridge", name, topic, "--yes")
    for words, told in [
        ((ODOM,), "has not one bridge; there are: front, rear"),
        ((ODOM, "--bridge", "middle"), "no bridge 'middle'; there are: front, rear"),
        ((DRIVE, "--bridge", "front"), "front carries cmd_vel by velocity_command already"),
        ((), "Missing argument"),
    ]:
        refused(told, model, "new", "connection", *words, "--yes")
    told = "jausml new connection --bridge front adds topics to it"
    refused(told, model, "new", "bridge", "front", ODOM, "--yes")
    jausml("new", "connection", ODOM, "--bridge", "rear", "--yes")
    jausml("validate", "models", "--strict")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ((), "name topics"),
        (("cmd_vel",), "is no TOPIC:TYPE"),
        (("wheels:Odometry",), "is no TOPIC:TYPE[:MAP,...] such as wheels:nav_msgs/Odometry"),
        (("cmd vel:geometry_msgs/Twist",), "the name of the topic has characters"),
        ((DRIVE, DRIVE), "is there twice"),
        (("a:geometry_msgs/Twits",), "did you mean 'geometry_msgs/Twist'?"),
        (("a:std_msgs/String",), "no ready map carries std_msgs/String"),
        ((f"{DRIVE}:nothing",), "no ready map 'nothing'; there are skid_steer_effort, velocity_c"),
        ((f"{DRIVE}:local_pose",), "the map 'local_pose' is for nav_msgs/Odometry, not geometry_"),
        (("lamps:std_msgs/Bool:set_lamps",), "is for the other side: add --side operator"),
        ((ODOM,), "\n  odom:nav_msgs/Odometry:velocity_state: reported as"),
    ],
)
def test_bad_words_change_nothing(rover, refused, words, told):
    refused(told, rover("xmi"), "new", "bridge", "rover", *words)


@pytest.mark.parametrize(
    ("name", "told"),
    [("2nd", "is no name"), ("os", "standard library"), ("rover", "something of the name rover")],
)
def test_bad_names_change_nothing(rover, jausml, refused, name, told):
    model = rover("xmi")
    jausml("new", "bridge", "rover", ODOM, "--yes")
    refused(told, model, "new", "bridge", name, DRIVE, "--yes")


@pytest.mark.slow
def test_a_model_that_is_missing_is_made(tmp_path, monkeypatch, jausml):
    monkeypatch.chdir(tmp_path)
    (tmp_path / ".git").mkdir()
    done = jausml("new", "bridge", "base", DRIVE, "--yes", status=2)
    assert "no model in" in done.output
    done = jausml("new", "bridge", "base", DRIVE, "--yes", "--model", "car.ros2jaus")
    assert (tmp_path / "car.ros2jaus").read_text("utf-8").count("import mappings.") == 1
    jausml("validate", "car.ros2jaus", "--strict")
    jausml("new", "bridge", "a", DRIVE, "--yes", "--model", "b.xmi")
    jausml("validate", "b.xmi", "mappings", "--strict")
    done = jausml("new", "bridge", "other", DRIVE, "--yes", status=2)
    assert "several models have a system: name one by --model (b.xmi, car.ros2jaus)" in done.output


@pytest.mark.slow
def test_it_asks_on_a_terminal(rover):
    model = rover("text")
    words = ("new", "bridge", "rover", ODOM)
    with at_terminal(*warm.command(), *words, cwd=model.parents[1]) as terminal:
        terminal.wait_for("Which (numbers)")
        assert "2  velocity_state: reported as ReportVelocityState" in terminal.shown
        terminal.type("7 x\n")
        terminal.wait_for("give numbers from 1 to")
        terminal.type("1, 2\n")
        terminal.wait_for("next: jausml validate")
        assert terminal.status() == 0
    assert [used for _, used, *_ in ways(model)] == ["local_pose", "velocity_state"]


@pytest.mark.slow
def test_none_of_several_ways_adds_nothing(rover):
    ends = ("LocalWaypointListDriver.SetLocalWaypoint", "geometry_msgs/PoseStamped")
    copy = ("new", "map", "own_waypoint", *ends, "--copy", "local_waypoint")
    model = rover("text", ("new", "bridge", "face", "odom:nav_msgs/Odometry:local_pose"), copy)
    before = model.read_bytes()
    words = ("new", "action-connection", "survey:nav2_msgs/FollowWaypoints")
    with at_terminal(*warm.command(), *words, cwd=model.parents[1]) as terminal:
        terminal.wait_for("Which (number)")
        terminal.type("0\n")
        terminal.wait_for("survey: none of them is taken")
        assert terminal.status() == 2
    assert model.read_bytes() == before

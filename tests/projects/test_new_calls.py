"""`jausml new service-connection` and `new action-connection`, in both notations."""

import pytest
from sweeps import sweep

from jausml.authoring.editing.commands import Remove
from jausml.authoring.editing.project import Project
from jausml.language.metamodel.classes import bridge
from jausml.language.model import read_models
from jausml.language.model.names import name_of
from jausml.language.model.refs import ref_of
from jausml.language.text.notation import NOTATIONS

# What is written in XMI, test_new_parts has.
NOTATION = pytest.mark.parametrize("notation", sweep(["text", "xmi"], every=2, rest=0))
OFF_ON = "values: { enumerated_value off { value: 0 } enumerated_value on { value: 1 } }"
DROPPER = f"""import `jaus.core-1.1`
service_set own {{ service Dropper {{
    urn: "urn:example:Dropper"  inherits: Management
    inputs: new message_def DropWeight {{ code: 0xD101  isCommand: true }}
    inputs: new message_def SetLamp {{
        code: 0xD102  isCommand: true  record LampRec {{ fixed_field Lit {{ {OFF_ON} }} }}
    }}
    outputs: new message_def ConfirmDrop {{ code: 0xD403 }}
    outputs: new message_def RejectDrop {{
        code: 0xD404  record DropRec {{ fixed_field Reason {{ {OFF_ON} }} }}
    }}
}} }}
"""
LENGTH = 'type: uint16  units: "m"  scale: { lower: 0  upper: 50 }'
WINCH = f"""import `jaus.core-1.1`
service_set own {{ service Winch {{
    urn: "urn:example:Winch"  inherits: Management
    inputs: new message_def PullWinch {{
        code: 0xD111  isCommand: true  record PullRec {{ fixed_field Length {{ {LENGTH} }} }}
    }}
    outputs: new message_def ConfirmWinch {{
        code: 0xD412  record ConfirmRec {{ fixed_field Left {{ {LENGTH} }} }}
    }}
}} }}
"""
TRIGGER, LAMP = ("drop_weight:std_srvs/Trigger", "DropWeight"), ("lamp:std_srvs/SetBool", "SetLamp")
WAYPOINTS = "follow_waypoints:nav2_msgs/FollowWaypoints"


ROBOT = ("new", "bridge", "face", "odom:nav_msgs/Odometry:local_pose")
FILES = (("models/dropper.ros2jaus", DROPPER),)


@pytest.fixture
def robot(rover):
    """Makes a project with a bridge and a service of its own; returns its model."""
    return lambda notation: rover(notation, ROBOT, files=FILES)


def the_bridge(model):
    read = read_models([model], project_root=model.parents[1], notations=NOTATIONS)
    [found] = read.model.instances(bridge.Bridge, library=False)
    return found


def sound(jausml, model):
    """Sees to it that a model is valid and its bridge generates."""
    jausml("validate", "models", "--strict")
    jausml("generate", model, "-o", "src", "--target", "bridge")


def decide(model):
    """Removes what is open from a model, as a person does who has decided it."""
    project = Project(model.parent)
    read = project.model(model.name).model
    for open_decision in reversed(read.instances(bridge.OpenDecision, library=False)):
        project.do([Remove(ref_of(open_decision, read, project.root))], "decided")


@NOTATION
def test_services_of_a_vehicle_are_asked_by_jaus(robot, jausml, notation):
    model = robot(notation)
    done = jausml("new", "service-connection", *TRIGGER)
    assert "DropWeight calls it; answered by ConfirmDrop or RejectDrop" in done.output
    done = jausml("new", "service-connection", *LAMP, "--request", "data=Lit")
    assert "SetLamp has no confirmation: who asks learns of no failure" in done.output
    made = the_bridge(model)
    drop, lamp = made.serviceConnections
    assert (drop.direction.name, drop.request) == ("jausToRos", None)
    assert name_of(drop.message) == "DropWeight"
    assert name_of(drop.answer) == "ConfirmDrop"
    assert [*map(name_of, drop.rejections)] == ["RejectDrop"]
    assert (drop.successMember, drop.reasonMember) == ("success", "message")
    assert (lamp.message, name_of(lamp.request)) == (None, "lamp_request")
    # The service is so; nobody has to decide it.
    assert not [*lamp.openDecisions, *drop.openDecisions]
    assert "Dropper" in map(name_of, made.provides)
    sound(jausml, model)


@NOTATION
def test_services_of_an_operator_ask_jaus(robot, jausml, notation):
    model = robot(notation)
    operator = ("--side", "operator")
    words = ("status:std_srvs/Trigger", "QueryStatus")
    jausml("new", "service-connection", *words, *operator)
    words = ("stop:std_srvs/Trigger", "Management.SetEmergency")
    jausml("new", "service-connection", *words, *operator)
    jausml("new", "component", "weights", "--provides", "Dropper")
    jausml("new", "service-connection", *TRIGGER, *operator)
    made = the_bridge(model)
    status, stop, drop = made.serviceConnections
    assert name_of(status.response) == "management_status"
    assert name_of(status.message) == "QueryStatus"
    assert [name_of(service) for service in status.search.services] == ["Management"]
    # Anybody may set an emergency: it does not wait for control.
    assert (name_of(stop.request), stop.control) == ("set_emergency", False)
    assert ([*map(name_of, drop.peers)], drop.search, drop.control) == (["weights"], None, True)
    sound(jausml, model)


def test_what_no_tool_knows_stays_an_error(robot, jausml):
    robot("text")
    done = jausml("new", "service-connection", *LAMP)
    assert "nothing is assigned to data of std_srvs/SetBool.request" in done.output
    found = jausml("validate", "models", status=1)
    assert "JML467" in found.output


@NOTATION
def test_a_list_driver_gives_its_goals(robot, jausml, notation):
    model = robot(notation)
    done = jausml("new", "action-connection", WAYPOINTS)
    assert "local_waypoint: SetLocalWaypoint of LocalWaypointListDriver is poses" in done.output
    [made] = the_bridge(model).actionConnections
    assert (made.direction.name, name_of(made.driver)) == ("jausToRos", "LocalWaypointListDriver")
    assert (name_of(made.element), made.goalMember) == ("local_waypoint", "poses")
    assert (made.progressMember, made.progress.name) == ("current_waypoint", "index")
    assert made.reasonMember == "error_msg"
    assert [open_decision.text.partition(" of")[0] for open_decision in made.openDecisions] == [
        "defaults are sent in number_of_loops, goal_index"
    ]
    decide(model)
    sound(jausml, model)


@NOTATION
def test_a_waypoint_driver_gives_its_goal(robot, jausml, notation):
    model = robot(notation)
    done = jausml("new", "action-connection", "navigate_to_pose:nav2_msgs/NavigateToPose")
    assert "local_waypoint: SetLocalWaypoint of LocalWaypointDriver is pose" in done.output
    assert "which element is active" not in done.output
    jausml("validate", "models")
    jausml("generate", model, "-o", "src", "--target", "bridge")
    jausml("new", "action-connection", "gps:nav2_msgs/FollowGPSWaypoints", "--yes")
    found = jausml("validate", "models", status=1)
    assert "JML488 a bridge executes lists, missions or one kind of waypoints" in found.output


def test_the_waypoint_of_an_action_is_for_no_topic(robot, jausml):
    robot("text")
    jausml("new", "action-connection", "navigate_to_pose:nav2_msgs/NavigateToPose")
    topic = "goal_pose:geometry_msgs/PoseStamped:local_waypoint"
    jausml("new", "connection", topic, "--hold", "goal_pose=the planner holds the goal")
    found = jausml("validate", "models", status=1)
    assert "JML488 'goal_pose' has SetLocalWaypoint, which is of an action here" in found.output


def test_goals_of_a_tool_are_for_those_who_say_so(robot, jausml):
    model = robot("text")
    arm = ("--driver", "ManipulatorEndEffectorPoseListDriver")
    jausml("new", "action-connection", WAYPOINTS, *arm)
    [made] = the_bridge(model).actionConnections
    assert name_of(made.element) == "set_end_effector_pose"


@pytest.mark.slow
@NOTATION
def test_own_types_of_the_project_are_carried(robot, jausml, notation):
    model = robot(notation)
    package = model.parents[2] / "winch_msgs"
    for name, text in (
        ("srv/Pull.srv", "float64 length # [m]\n---\nbool finished\nfloat64 left # [m]\n"),
        ("action/Survey.action", "nav_msgs/Path path\nfloat64 depth\n---\n---\nuint32 leg\n"),
    ):
        (package / name).parent.mkdir(parents=True)
        (package / name).write_text(text, "utf-8")
    jausml("import", "ros", package, "-o", "models/")
    model.with_name("winch.ros2jaus").write_text(WINCH, "utf-8")
    done = jausml("new", "service-connection", "pull:winch_msgs/Pull", "PullWinch")
    assert "successMember (finished)" in done.output
    done = jausml("new", "action-connection", "survey:winch_msgs/Survey")
    assert "nothing tells which element is active: progressMember (leg)" in done.output
    made = the_bridge(model)
    [pull] = made.serviceConnections
    [survey] = made.actionConnections
    assert (name_of(pull.request), name_of(pull.response)) == ("pull_request", "pull_response")
    assert (pull.successMember, survey.progressMember) == (None, None)
    assert survey.goalMember == "path.poses"
    defaults = [
        (decision.text.split(":")[0], decision.blocking) for decision in survey.openDecisions
    ]
    assert defaults[0] == ("nothing tells which element is active", False)
    assert defaults[1][0].startswith("defaults are sent in depth of the goal")
    done = jausml("validate", "models", "--strict", status=1)
    assert "JML473 a call of 'pull' that fails counts as done" in done.output
    text = model.read_text("utf-8")
    for old, new in (
        ("service_connection pull {", "service_connection pull { successMember: finished"),
        (
            '<serviceConnections name="pull"',
            '<serviceConnections name="pull" successMember="finished"',
        ),
    ):
        text = text.replace(old, new)
    model.write_text(text, "utf-8")
    decide(model)
    sound(jausml, model)


@pytest.mark.slow
@NOTATION
def test_goals_of_an_operator_need_a_speed_that_a_person_states(robot, jausml, notation):
    model = robot(notation)
    words = ("poses:nav2_msgs/NavigateThroughPoses", "--side", "operator")
    before = model.read_bytes()
    done = jausml("new", "action-connection", *words)
    assert "state the speed at which peers execute lists" in done.output
    found = jausml("validate", "models", status=1)
    assert "JML486" in found.output
    model.write_bytes(before)
    jausml("new", "action-connection", *words, "--speed", "1.5")
    [made] = the_bridge(model).actionConnections
    assert (made.speed, made.progressMember) == (1.5, "number_of_poses_remaining")
    assert made.progress.name == "remaining"
    sound(jausml, model)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("service-connection", "drop:std_srvs", "DropWeight"), "should be like"),
        (("service-connection", "a b:std_srvs/Trigger", "DropWeight"), "has characters"),
        (("service-connection", "a:std_srvs/Triger", "DropWeight"), "'std_srvs/Trigger'?"),
        (("service-connection", "a:own_msgs/Drop", "DropWeight"), "jausml import ros own_msgs"),
        (("service-connection", "a:std_srvs/Trigger", "DropWait"), "'DropWeight'?"),
        (("service-connection", "a:std_srvs/Trigger", "ConfirmDrop"), "nobody asks by it"),
        (("service-connection", *TRIGGER, "--request", "data=Lit"), "nothing has to be carried"),
        (("service-connection", *TRIGGER, "--answer", "ReportLocalPose"), "does not send"),
        (
            ("action-connection", "a:nav2_msgs/NavigateToPose", "--side", "operator"),
            "has no list of messages, which list drivers have; a single pose goes to a topic, if "
            "its planner takes one: jausml new connection goal_pose:geometry_msgs/PoseStamped",
        ),
        (("action-connection", WAYPOINTS, "--element", "own"), "no such driver and map"),
        (("action-connection", WAYPOINTS, "--speed", "1"), "--speed is for --side operator"),
    ],
)
def test_bad_words_change_nothing(robot, refused, words, told):
    refused(told, robot("text"), "new", *words)


def test_nothing_is_carried_twice(robot, jausml, refused):
    model = robot("text")
    line = ("new", "service-connection", *TRIGGER)
    jausml(*line)
    refused("face carries drop_weight already", model, *line)

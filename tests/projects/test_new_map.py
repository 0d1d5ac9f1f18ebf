"""`jausml new map`: maps that are filled, and copies of ready ones, in both notations."""

import json
import re
from pathlib import Path

import pytest
import warm
from sweeps import sweep
from terminal import at_terminal

from jausml.language.metamodel.classes import bridge
from jausml.language.model import read_models
from jausml.language.model.names import name_of
from jausml.language.text.notation import NOTATIONS
from jausml.language.validation.rules import all_rules

ROOT = Path(__file__).resolve().parents[2]
NOTATION = pytest.mark.parametrize("notation", sweep(["text", "xmi"], every=2))
STATE = ("ReportVelocityState", "nav_msgs/Odometry")
HINT = "decide it, then remove the open decision"
COMMAND = ("SetVelocityCommand", "geometry_msgs/Twist")
SUPPLY = """import `jaus.core-1.1`
service_set own { service Supply {
    urn: "urn:example:Supply"  inherits: Events
    outputs: new message_def ReportSupply { code: 0xD401  record SupplyRec {
        fixed_field Supply {
            values: { enumerated_value full { value: 0 } enumerated_value charging { value: 1 } }
        }
    } }
} }
"""


TEXT = """\
import jaus.mobility
import mappings.local_pose_sensor

system rover {
    bridge ears {
        address: 100.1.1
        provides: LocalPoseSensor

        connection odom {
            map: local_pose
            topic odom
        }
    }
}
"""
LIBRARY = "http://www.jausml.org/library"
XMI = f"""\
<?xml version="1.0" encoding="UTF-8"?>
<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"\
 xmlns:system="http://www.jausml.org/system/1.0" name="rover">
  <bridges name="ears" address="100.1.1">
    <provides href="{LIBRARY}/jaus/mobility.xmi#LocalPoseSensor"/>
    <bridgeConnections name="odom" direction="rosToJaus" exchange="periodicEvent">
      <map href="{LIBRARY}/mappings/local_pose_sensor.ros2jaus#//@maps.0"/>
      <topics name="odom"/>
    </bridgeConnections>
  </bridges>
</system:System>
"""


@pytest.fixture
def ears(tmp_path, monkeypatch):
    """Makes a model with an empty bridge in a notation, and works beside it; returns it."""

    def make(notation):
        (tmp_path / ".git").mkdir()
        (tmp_path / "models").mkdir()
        model = tmp_path / "models" / f"rover.{'xmi' if notation == 'xmi' else 'ros2jaus'}"
        model.write_text(XMI if notation == "xmi" else TEXT, "utf-8")
        monkeypatch.chdir(tmp_path)
        return model

    return make


def map_in(model, name):
    read = read_models([model], project_root=model.parents[1], notations=NOTATIONS).model
    maps = read.instances(bridge.AttributeMap, library=False)
    return next(attribute_map for attribute_map in maps if name_of(attribute_map) == name)


def rules_in(output):
    """The rules, without those about connections by the map."""
    return {*re.findall(r"JML\d+", output)} - {"JML421", "JML451", "JML455"}


def opens_in(model, name):
    """What is open in a map, by whether it is an error."""
    found = map_in(model, name).openDecisions
    return {
        way: [decision.text for decision in found if decision.blocking is way]
        for way in (True, False)
    }


@pytest.mark.parametrize(
    ("notation", "message", "kind", "rules", "status"),
    [
        ("text", *COMMAND, {"JML416"}, 0),
        ("text", "ReportLocalPose", "geometry_msgs/QuaternionStamped", {"JML498"}, 0),
        ("xmi", "ReportStatus", "geometry_msgs/PolygonStamped", {"JML460", "JML498"}, 1),
        ("xmi", "ReportLocalPose", "std_msgs/String", set(), 0),
    ],
)
def test_it_validates_or_says_which_rule_needs_the_user(
    ears, jausml, notation, message, kind, rules, status
):
    ears(notation)
    done = jausml("new", "map", "own", message, kind, "--fill")
    assert rules_in(done.output) == rules, done.output
    checked = jausml("validate", "models", status=status)
    assert rules_in(checked.output) == rules, checked.output


def test_what_it_says_stands_in_the_file(ears, jausml):
    model = ears("text")
    done = jausml("new", "map", "own", *STATE, "--fill", "--direction", "to-ros")
    text = " ".join(model.read_text("utf-8").replace("*", "").split())
    assignments, _, rest = done.stdout.partition("open\n")
    decisions, _, _ = rest.partition("remarks\n")
    for line in assignments.splitlines():
        assert line.startswith("JAUS") or " ".join(line.split()) in text, line
    for line in decisions.splitlines():
        assert line.endswith(" (JML498)"), line
        said = line.strip().removesuffix(" (JML498)").replace('"', '\\"')
        assert f'openDecisions: {{ text: "{said}" blocking: false }}' in text, line
    assert "  ignored: pose of " in decisions
    assert not map_in(model, "own").documentation
    for statement in (
        "Velocity_Y -> twist.twist.linear.y : negate { whenAbsent: dropMessage }",
        "Velocity_RMS -> twist.covariance[7] : square { whenAbsent: leave }",
        '"odom" -> header.frame_id',
        "ignore pose",
    ):
        assert statement in text
    assert not map_in(model, "own").toJaus


@NOTATION
def test_a_ready_map_is_offered_and_copied_with_its_vectors(ears, jausml, refused, notation):
    model = ears(notation)
    told = "--copy velocity_state copies it, --fill fills a new one"
    refused(told, model, "new", "map", "own", *STATE)
    for name, option in (("own", ("--yes",)), ("second", ("--copy", "velocity_state"))):
        done = jausml("new", "map", name, *STATE, *option)
        assert len(map_in(model, name).vectors) > 2
    done = jausml("validate", "models", "--strict")
    # Ready maps do not all say yet what becomes of what is absent.
    assert {*re.findall(r"JML\d+", done.output)} <= {"JML459"}, done.output


def test_a_map_of_the_project_stands_for_that_of_the_library(ears, jausml):
    ears("text")
    jausml("new", "map", "velocity_state", *STATE, "--copy", "velocity_state")
    done = jausml("new", "map", "own", *STATE, status=2)
    assert done.output.count("velocity_state,") == 0, done.output


def test_a_copy_has_its_own_tables(ears, jausml):
    model = ears("xmi")
    ends = ("SetIlluminationState", "std_msgs/Bool")
    jausml("new", "map", "lights", *ends, "--copy", "set_headlights")
    used = map_in(model, "lights")
    assert used.toRos[0].conversions[0].table in used.tables
    jausml("validate", "models", "--strict")


def test_the_author_says_what_fills_and_how(ears, jausml):
    model = ears("xmi")
    done = jausml(
        *("new", "map", "own", "ReportVelocityState", "geometry_msgs/TwistStamped"),
        *("--to-ros", "twist.linear.x=Velocity_X : scale(2)", "--to-ros", "twist.linear.y=0.5"),
        *("--to-ros", "header.frame_id=ignore", "--to-ros", "twist.linear.z=Velocity_Z"),
        *("--to-ros", "header.stamp=clock", "--direction", "to-ros"),
    )
    for statement in (
        "Velocity_X -> twist.linear.x : scale(2)",
        "0.5 -> twist.linear.y",
        "ignore header.frame_id",
        "clock -> header.stamp",
        "Velocity_Z -> twist.linear.z : negate { whenAbsent: dropMessage }",
        "YawRate -> twist.angular.z : negate { whenAbsent: dropMessage }",
    ):
        assert f"  {statement}\n" in done.stdout
    jausml("validate", model)


def test_conversions_that_are_said_keep_what_absence_asks_for(ears, jausml):
    model = ears("text")
    words = "pose.orientation=Roll, Pitch, Yaw : frd_angles_to_flu_quaternion"
    ends = ("ReportLocalPose", "geometry_msgs/PoseStamped", "--to-ros", words)
    jausml("new", "map", "own", *ends, "--to-ros", "pose.position.y=Y : negate")
    own = {
        assignment.target: assignment.whenAbsent.name
        for assignment in map_in(model, "own").toRos
        if hasattr(assignment, "whenAbsent")
    }
    assert own["pose.orientation"] == "useDefault"
    assert own["pose.position.y"] == "dropMessage"
    jausml("validate", model)


def test_yes_takes_the_first_and_says_so(ears, jausml):
    model = ears("text")
    done = jausml("new", "map", "own", *COMMAND, "--fill", "--yes")
    told = 'CommandType takes "Set current command", the first of 4 that fit'
    assert f"{told} (JML498, blocking)" in done.output
    assert opens_in(model, "own")[True] == [told]
    found = jausml("validate", "models", status=1)
    assert f"error: JML498 open in 'own': {told}" in found.output


def test_a_decision_is_open_until_a_person_removes_it(ears, jausml):
    model = ears("text")
    ends = ("SetVelocityCommand", "geometry_msgs/Twist", "--direction", "to-jaus")
    jausml("new", "map", "own", *ends, "--fill", "--yes")
    done = jausml("generate", model, "-o", "src", status=1)
    assert "nothing generated" in done.output, done.output
    lines = model.read_text("utf-8").splitlines(keepends=True)
    [line] = [text_line for text_line in lines if "openDecisions" in text_line]
    lines.remove(line)
    model.write_text("".join(lines), "utf-8")
    jausml("generate", model, "-o", "src", "--target", "bridge")
    assert "nothing is open" in jausml("new", "--open").output


@pytest.mark.parametrize("output_format", sweep(["text", "json"], every=2))
def test_what_is_open_is_listed_with_its_place(ears, jausml, output_format):
    model = ears("text")
    jausml("new", "map", "own", *COMMAND, "--fill", "--yes")
    jausml("new", "connection", "cmd_vel:geometry_msgs/Twist:own")
    done = jausml("new", "--open", "--format", output_format)
    lines = model.read_text("utf-8").splitlines()
    at = 1 + next(n for n, line in enumerate(lines) if "the first of 4" in line)
    text = 'CommandType takes "Set current command", the first of 4 that fit'
    if output_format == "json":
        told = json.loads(done.stdout)["diagnostics"]
        assert {diagnostic["rule"] for diagnostic in told} == {"JML451", "JML498"}
        [found] = [e for e in told if (e["rule"], e["severity"]) == ("JML498", "error")]
        assert (found["file"], found["line"]) == ("models/rover.ros2jaus", at)
        assert (found["message"], found["hint"]) == (f"open in 'own': {text}", HINT)
    else:
        assert f"models/rover.ros2jaus:{at}:" in done.stdout
        assert f"error: JML498 open in 'own': {text} ({HINT})" in done.stdout
        assert "JML367" not in done.output


def test_a_model_that_cannot_be_read_is_not_taken_for_one_without_decisions(ears, jausml):
    model = ears("text")
    model.write_text(model.read_text("utf-8") + "}", "utf-8")
    done = jausml("new", "--open")
    assert "1 error besides, which may hide what is open: jausml validate" in done.output


def test_the_page_has_the_rules_of_what_is_listed():
    text = (ROOT / "docs/how-to/map-a-message.md").read_text("utf-8")
    section = text.partition("## What stays open\n")[2].partition("\n## ")[0]
    asking = {rule.id for rule in all_rules() if rule.is_decision}
    assert {*re.findall(r"JML\d+", section)} == asking


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--open", "map", "own", *COMMAND), "--open adds no map"),
        (("--format", "json"), "--format: only with --open"),
        (("--open",), "no project is here"),
    ],
)
def test_a_list_of_what_is_open_adds_nothing(jausml, monkeypatch, tmp_path, words, told):
    monkeypatch.chdir(tmp_path)
    done = jausml("new", *words, status=2)
    assert told in done.output, done.output
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ((*STATE, "--copy", "local_pose"), "there are: velocity_state"),
        ((*STATE, "--copy", "velocity_state", "--fill"), "--fill: not with --copy"),
        ((*COMMAND, "--direction", "to-ros", "--yes"), "has assignments to JAUS"),
        ((*COMMAND, "--direction", "to-jaus", "--yes"), "has assignments to ROS"),
        ((*COMMAND, "--to-ros", "linear.x"), "should be like"),
        ((*COMMAND, "--to-ros", "linear.q=Velocity_X"), "has no"),
        ((*COMMAND, "--to-ros", "linear.x=YawRate"), "linear.x"),
        ((*COMMAND, "--to-ros", "linear.x=Velocity_X : negat"), "did you mean 'negate'?"),
        ((*COMMAND, "--to-jaus", 'CommandType="now"'), "now"),
    ],
)
def test_bad_words_change_nothing(ears, refused, words, told):
    refused(told, ears("xmi"), "new", "map", "own", *words)


def test_its_name_is_one_that_is_free(ears, jausml, refused):
    model = ears("text")
    jausml("new", "map", "own", *STATE, "--copy", "velocity_state")
    for name, told in (("own", "ears has a map own already"), ("o n", "'o n' is no name")):
        refused(told, model, "new", "map", name, *STATE, "--yes")


@pytest.mark.slow
def test_it_asks_on_a_terminal(ears):
    model = ears("text")
    command = (*warm.command(), "new", "map", "own", *COMMAND)
    with at_terminal(*command, cwd=model.parents[1]) as terminal:
        terminal.wait_for("Which (number)")
        assert "Ready maps have both ends" in terminal.shown
        begin = len(terminal.shown)
        terminal.type("0\n")
        terminal.wait_for("Which (number)", begin)
        assert "What fills CommandType?" in terminal.shown
        terminal.type("1,2\n")
        terminal.wait_for("give a number from 1 to 4, or 0 for none")
        terminal.type("2\n")
        terminal.wait_for("Do zeros stop what it moves, when its source is lost? [y/N]")
        terminal.type("\n")
        terminal.wait_for("next: jausml validate")
    made = map_in(model, "own")
    filled = {assignment.target: getattr(assignment, "value", "") for assignment in made.toJaus}
    assert filled["CommandType"] == "Set maximum allowed values"
    assert (made.stopRos, made.stopJaus) == (None, None)


@pytest.mark.slow
def test_a_yes_on_a_terminal_lets_zeros_stop_a_command(ears):
    model = ears("text")
    command = (*warm.command(), "new", "map", "own", *COMMAND, "--fill")
    command += ("--direction", "to-ros")
    with at_terminal(*command, cwd=model.parents[1]) as terminal:
        terminal.wait_for("Do zeros stop what it moves")
        terminal.type("y\n")
        terminal.wait_for("next: jausml validate")
        assert "JML451" not in terminal.shown
    assert map_in(model, "own").stopRos is not None


@pytest.mark.slow
def test_only_a_word_of_its_own_lets_zeros_stop_a_command(ears, jausml):
    model = ears("text")
    done = jausml("new", "map", "undecided", *COMMAND, "--fill", "--yes")
    assert "state what stops the command: stopRos and stopJaus; all of" in done.output
    undecided = map_in(model, "undecided")
    assert not any("stops" in open_decision.text for open_decision in undecided.openDecisions)
    assert (undecided.stopRos, undecided.stopJaus) == (None, None)
    done = jausml("new", "map", "decided", *COMMAND, "--fill", "--yes", "--zeros-stop")
    assert "JML451" not in done.output
    made = map_in(model, "decided")
    assert (made.stopRos is not None, list(made.stopRos.values)) == (True, [])
    zeros = {value.target: value.value for value in made.stopJaus.values}
    assert zeros["Velocity_X"] == zeros["YawRate"] == "0"
    assert "CommandType" not in zeros


@NOTATION
def test_values_of_one_name_are_mapped_by_a_table(ears, jausml, notation):
    model = ears(notation)
    model.with_name("supply.ros2jaus").write_text(SUPPLY, "utf-8")
    words = ("--to-ros", "power_supply_status=Supply", "--to-jaus", "Supply=power_supply_status")
    ends = ("ReportSupply", "sensor_msgs/BatteryState")
    done = jausml("new", "map", "supply", *ends, *words, "--yes")
    full, charging = "POWER_SUPPLY_STATUS_FULL", "POWER_SUPPLY_STATUS_CHARGING"
    assert f"table supply ( full <-> {full}  charging <-> {charging} )" in done.output
    assert "Supply -> power_supply_status : look_up(supply)" in done.output
    # UNKNOWN says that there is none, and is not looked up.
    assert "JML440 table 'supply' lacks POWER_SUPPLY_STATUS_DISCHARGING, " in done.output
    own = map_in(model, "supply")
    [table] = own.tables
    values = {entry.jaus: entry.ros for entry in table.entries}
    assert values == {"full": full, "charging": charging}
    for assignments in (own.toRos, own.toJaus):
        steps = [
            step for assignment in assignments for step in getattr(assignment, "conversions", ())
        ]
        assert [step.table for step in steps] == [table]


def test_zeros_stop_no_command_of_positions(ears, refused):
    ends = ("LocalWaypointDriver.SetLocalWaypoint", "geometry_msgs/PoseStamped")
    line = ("new", "map", "goal", *ends, "--yes", "--zeros-stop")
    refused("zeros stop only a command that moves something", ears("text"), *line)


ALONE = """\
service Switch { urn: "urn:example:Switch"
  inputs: new message_def QuerySwitch { code: 0xD402 }
  outputs: new message_def ReportSwitch { code: 0xD602
    record SwitchRec { fixed_field Pressed { type: uint8 } } } }
system plant { bridge front { address: 100.1.1  provides: Switch } }
"""


def test_the_only_fields_of_two_ends_are_for_each_other(jausml, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("plant.ros2jaus").write_text(ALONE, "utf-8")
    done = jausml("new", "map", "switch", "ReportSwitch", "std_msgs/Bool", "-m", "plant.ros2jaus")
    assert "  Pressed -> data\nROS->JAUS\n  data -> Pressed\n" in done.output
    empty = ("new", "map", "other", "ReportSwitch", "geometry_msgs/Point", "-m", "plant.ros2jaus")
    assert "nothing corresponds" in jausml(*empty, "--yes").output
    words = ("new", "connection", "p:geometry_msgs/Point:other", "-m", "plant.ros2jaus")
    done = jausml(*words, status=2)
    assert "the map 'other' assigns nothing yet: fill it in" in done.output

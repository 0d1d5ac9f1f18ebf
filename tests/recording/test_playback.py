"""A recording at any moment is the fold of all before, and what was dropped is explained."""

import struct
from functools import cache, reduce

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from recorded_systems import BRIDGE, MODEL, OPERATOR, VEHICLE, Drive, recorded, recorded_traffic

from jausml.authoring.studio.live import live_values
from jausml.authoring.studio.live_places import places_of
from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml.live.messages import load_catalogue
from jausml.live.recording.mcap_files import RecordingError
from jausml.live.recording.ros_values import RosReader
from jausml.live.systems import playback
from jausml.live.systems.declarations import components_of, declarations_of
from jausml.live.systems.explaining import MEANINGS, explained, meaning
from jausml.live.systems.folding import expected, fold_answer, fold_statuses, fold_time
from jausml.live.systems.playback import NO_ROS, indexed
from jausml.live.systems.state import SystemState
from jausml.runtime.bridge.ends.actions import Outcome

DRIVE = ("/loop_bridge", "drive")
LONG = Drive(seconds=40.0, dropped=(3.5, 21.5, 21.7), silent=9.0, taken=12.0)


@cache
def model():
    return read_models([MODEL], allow_outside=True).model


@pytest.fixture(scope="module")
def opened(tmp_path_factory):
    """Returns a function that indexes a drive, once."""
    folder, known = tmp_path_factory.mktemp("recordings"), {}

    def open_(drive):
        if drive not in known:
            path = folder / f"{len(known)}.mcap"
            path.write_bytes(recorded(drive))
            known[drive] = indexed(str(path))
        return known[drive]

    return open_


@pytest.fixture(scope="module")
def many_blocks(tmp_path_factory):
    """A recording in many small blocks, of which few have their states yet."""
    path = tmp_path_factory.mktemp("blocks") / "long.mcap"
    path.write_bytes(recorded(LONG))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(playback, "BLOCK", 3)
        patch.setattr(playback, "MOST_STATES", 8)
        return indexed(str(path))


def as_live_folds(system, at):
    """The state as the live view folds it, fact by fact, on what the model promises."""
    state = expected(declarations_of(model()), components_of(model()), 0.0)
    for fact in system.facts():
        if fact.time <= at:
            if fact.answer is None:
                state = fold_statuses(state, fact.statuses, fact.time)
            else:
                state = fold_answer(state, fact.answer, fact.time)
    return fold_time(state, at)


@settings(max_examples=60, deadline=None)
@given(at=st.floats(-1.0, 90.0))
def test_a_moment_is_the_fold_of_all_before_it(many_blocks, at):
    places = places_of(model())
    found, wanted = (
        live_values(state, places)
        for state in (many_blocks.state(at, model()), as_live_folds(many_blocks, max(at, 0.0)))
    )
    assert found["edges"] == wanted["edges"]
    assert found["boxes"] == wanted["boxes"]
    by_name = [
        {
            (connection["bridge"], connection["connection"]): connection
            for connection in values["connections"]
        }
        for values in (found, wanted)
    ]
    assert by_name[0] == by_name[1]


@given(at=st.floats(0.0, 50.0))
@settings(max_examples=30, deadline=None)
def test_states_that_are_let_go_change_nothing(many_blocks, at):
    kept = sum(block.before is not None for block in many_blocks._blocks)
    assert kept <= 8 < len(many_blocks._blocks)
    facts = (fact for fact in many_blocks.facts() if fact.time <= at)
    state = reduce(playback.fold_fact, facts, SystemState())
    assert many_blocks.state(at).connections == fold_time(state, max(at, state.now)).connections


def test_a_drop_is_explained_word_for_word(opened):
    found = explained(opened(Drive()), model(), DRIVE, 11.0)
    assert found.at == 4.0
    assert found.counter == (
        "Between 3.0 s and 4.0 s, loop_bridge drive did not pass on 1 message: its counter "
        "\u201cout_of_range\u201d rose from 0 to 1.",
        "A message is counted there because a value did not fit its field, and the map drops such "
        "a message.",
    )
    assert found.state == (
        "At 4.0 s, the connection was failed: values out of range.",
        "The bridge 10.1.9 was active and in READY, controlled by nobody.",
        "To the bridge, its peer 10.1.1 was ready; it was in READY.",
        "When its source is lost: the stop is sent.",
    )


ROOT = MODEL.parents[3]
LAMPS = ROOT / "tests" / "live" / "services.ros2jaus"
LISTS = ROOT / "models" / "examples" / "nav2" / "nav2.ros2jaus"
CATVEHICLE = ROOT / "models" / "catvehicle" / "catvehicle.xmi"
CALLER = "20.1.1"


def explained_traffic(path, file, bridge, connection, messages, *counts):
    """Explains what a connection of a bridge counted in the second status, and not in the first."""
    told = {
        float(second): [(connection, "running", (("translation", "light classes"), *values))]
        for second, values in enumerate(counts)
    }
    catalogue = load_catalogue([file], project_root=ROOT, notations=NOTATIONS)
    node, address = bridge
    path.write_bytes(recorded_traffic(catalogue, node, address, messages, told))
    found = read_models([file], notations=NOTATIONS, allow_outside=True).model
    system = indexed(str(path))
    return explained(system, found, (node, connection), 9.0)


def test_a_command_that_did_not_come_as_far_as_its_connection(tmp_path):
    messages = [
        (0.3, "200.1.1", "100.1.2", "SetVelocityCommand", {"CommandType": 0, "Velocity_X": 6.0})
    ]
    told = "cruise_speed", (("not taken: refused", "2"),), (("not taken: refused", "3"),)
    found = explained_traffic(
        tmp_path / "refused.mcap", CATVEHICLE, ("/bridge", "100.1.2"), told[0], messages, *told[1:]
    )
    assert found.counter[0].endswith("its counter “refused” rose from 2 to 3.")
    assert "its sender might not command, or not in that state" in found.counter[1]


def test_an_override_is_told_of(tmp_path):
    messages = [(0.3, CALLER, "100.1.20", "SetLamp", {"Brightness": 7})]
    override = ("override", "translate_switch_robot_request")
    found = explained_traffic(
        tmp_path / "calls.mcap", LAMPS, ("/front", "100.1.20"), "switch_robot", messages,
        (override,), (override, ("failed: not_translated", "1")),
    )  # fmt: skip
    assert any("code of yours decides" in line and override[1] in line for line in found.state)


def test_a_rejection_is_of_the_controller_that_it_goes_to(tmp_path):
    confirmed, rejected = (
        {f"{kind}ControlRec": {"ResponseCode": 0}} for kind in ("Confirm", "Reject")
    )
    other = "30.1.1"
    messages = [
        (1.0, VEHICLE, OPERATOR, "ConfirmControl", confirmed),
        (2.0, VEHICLE, OPERATOR, "RejectControl", rejected),
        (2.1, VEHICLE, other, "ConfirmControl", confirmed),
        (2.2, VEHICLE, OPERATOR, "RejectControl", rejected),
        (3.0, VEHICLE, other, "RejectControl", rejected),
    ]
    path = tmp_path / "control.mcap"
    path.write_bytes(recorded_traffic(load_catalogue(), "/bridge", "10.1.9", messages, {}))
    system = indexed(str(path))
    found = [system.state(at).components[VEHICLE].controller for at in (0.5, 1.05, 1.5, 2.0)]
    assert found == [OPERATOR, "", other, ""]


def test_before_the_first_drop_nothing_is_explained(opened):
    found = explained(opened(Drive()), model(), DRIVE, 2.5)
    assert found.counter == (
        "Up to 2.5 s, no counter of loop_bridge drive rose while it was recorded.",
    )


def test_several_that_were_dropped_are_counted(opened):
    found = explained(opened(LONG), model(), DRIVE, 30.0)
    assert "did not pass on 2 messages" in found.counter[0]
    unlike = explained(opened(Drive(dropped=(3.5,), has_ros=False)), model(), DRIVE, 30.0)
    assert unlike.counter == (
        f"The recording cannot tell what drive of /loop_bridge did not pass on: {NO_ROS}. "
        "Record with ROS and the model of the system.",
    )


def test_marks_are_drops_states_and_controllers_in_their_order(opened):
    marks = opened(Drive()).marks
    assert [(mark.kind, mark.time, mark.subject, mark.before, mark.after) for mark in marks] == [
        ("drop", 4.0, DRIVE, "0", "1"),
        ("state", 4.0, DRIVE, "active", "failed"),
        ("state", 5.0, DRIVE, "failed", "active"),
        ("control", 6.5, (BRIDGE, ""), "", OPERATOR),
    ]
    assert opened(Drive()).state(7.0).components[BRIDGE].controller == OPERATOR


def test_who_is_asked_and_says_nothing_is_gone(opened):
    system = opened(LONG)
    assert system.state(8.5, model()).components[VEHICLE].state == "READY"
    gone = system.state(14.0, model()).components[VEHICLE]
    assert (gone.is_gone, gone.state) == (True, "")
    assert gone.reason == "does not answer any more; was in READY"


def test_the_model_may_be_another_one_meanwhile(opened):
    known = opened(Drive()).state(5.0).connections[DRIVE]
    assert known.declaration is None
    assert opened(Drive()).state(5.0, model()).connections[DRIVE].declaration is not None
    alone = explained(opened(Drive()), None, DRIVE, 5.0)
    assert "rose from 0 to 1" in alone.counter[0]


# ---- damage -----------------------------------------------------------------------------------


@settings(max_examples=40, deadline=None)
@given(data=st.data())
def test_what_can_be_read_of_a_damaged_file_is_shown(tmp_path_factory, data):
    whole = recorded(Drive())
    if data.draw(st.booleans()):
        broken = whole[: data.draw(st.integers(0, len(whole) - 1))]
    else:
        at = data.draw(st.integers(0, len(whole) - 1))
        broken = whole[:at] + bytes([whole[at] ^ data.draw(st.integers(1, 255))]) + whole[at + 1 :]
    path = tmp_path_factory.mktemp("damaged") / "run.mcap"
    path.write_bytes(broken)
    try:
        system = indexed(str(path))
    except RecordingError as error:
        fault = error
    else:
        fault = shown_faults(system)
    assert fault is None or str(path) in str(fault)


def shown_faults(system):
    """Looks at the end of a recording; returns what cannot be read there."""
    try:
        if system.damage:
            assert f"it was read up to {system.duration:.3f} s" in system.damage
        system.state(system.duration, model())
        explained(system, model(), DRIVE, system.duration)
    except RecordingError as error:
        return error
    return None


def test_a_file_that_was_cut_off_is_searched_like_a_whole_one(tmp_path, opened):
    path = tmp_path / "cut.mcap"
    path.write_bytes(recorded(Drive())[:-20])
    system = indexed(str(path))
    assert "the file is damaged: it ends in the midst of a record" in system.damage
    whole = explained(opened(Drive()), model(), DRIVE, 11.0)
    assert explained(system, model(), DRIVE, 11.0) == whole


# ---- messages of ROS --------------------------------------------------------------------------

DEFINITION = """uint8 kind
float64 value
int16[] few
Inner[2] inner
string name
wstring wide
================================================================================
MSG: own_msgs/Inner
uint8 x
"""


def test_a_message_is_read_by_its_definition():
    body = struct.pack("<B7xdI2hBBxxI3s", 7, 2.5, 2, -1, 5, 3, 4, 3, b"ab\0")
    body += b"\0" + struct.pack("<4I", 3, 0xE4, 0xD83D, 0xDE00)
    value = RosReader("own_msgs/msg/Outer", DEFINITION).read(b"\0\1\0\0" + body)
    assert value == {
        "kind": 7, "value": 2.5, "few": (-1, 5), "inner": [{"x": 3}, {"x": 4}], "name": "ab",
        "wide": "\u00e4\U0001f600",
    }  # fmt: skip


@given(st.binary(max_size=30))
def test_other_bytes_are_a_located_error(data):
    with pytest.raises(RecordingError, match="own_msgs/msg/Outer"):
        RosReader("own_msgs/msg/Outer", DEFINITION).read(data)


@pytest.mark.parametrize("text", ["time stamp\n", "Missing it\n", "Outer again\n"])
def test_a_definition_that_cannot_be_followed_is_refused(text):
    with pytest.raises(RecordingError):
        RosReader("own_msgs/msg/Outer", text)


def test_a_definition_whose_types_hold_each_the_next_one_twice_is_read_at_once():
    depth = 30
    parts = [f"T{number + 1} a\nT{number + 1} b\n" for number in range(depth)]
    text = "".join(
        f"{'=' * 80}\nMSG: own_msgs/T{number}\n{part}"
        for number, part in enumerate([*parts, "uint8 x\n"])
    )
    with pytest.raises(RecordingError, match="own_msgs/msg/Outer"):
        RosReader("own_msgs/msg/Outer", f"T0 whole\n{text}").read(b"\0\1\0\0")


def test_all_counters_of_the_runtime_have_a_meaning():
    assert meaning("stale_join_velocity").endswith("fresh: velocity")
    assert meaning("lost on the way, at most") == MEANINGS["lost on the way"]
    assert meaning("refused SetWrenchEffort") == MEANINGS["refused"]
    assert meaning("of another make") == ""
    assert all(meaning(each.value) for each in Outcome if each is not Outcome.SUCCEEDED)

"""What the page is told of a running system, by ids of its system view."""

import json
from pathlib import Path

import pytest
from generated import model_in
from large_systems import large_system
from recorded_systems import recorded_machines

from jausml.authoring.studio.live import live_values
from jausml.authoring.studio.live_places import Places, places_of
from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml.live.systems.declarations import components_of, declarations_of
from jausml.live.systems.folding import (
    AnswerSource,
    ComponentAnswer,
    DiagnosticStatus,
    expected,
    fold_answer,
    fold_model,
    fold_source,
    fold_statuses,
    fold_time,
)
from jausml.live.systems.machines import MachineState, StateTime
from jausml.live.systems.playback import indexed
from jausml.live.systems.state import SystemState
from jausml.views.diagrams.views import graph_of

ROOT = Path(__file__).resolve().parents[2]
MODEL = ROOT / "tests" / "cases" / "bridge_loop" / "model.xmi"
VALUES = (
    ("rate (Hz)", "19.50"),
    ("declared rate (Hz)", "20.00"),
    ("age (s)", "0.031"),
    ("dropped: no_value.Velocity_X", "3"),
    ("in the bridge p50 (us)", "87.0"),
)
LOOP = "10.1.9"


@pytest.fixture(scope="module")
def model():
    return read_models([MODEL], allow_outside=True).model


@pytest.fixture(scope="module")
def places(model):
    return places_of(model)


@pytest.fixture
def silent(model):
    return expected(declarations_of(model), components_of(model), 0.0)


def status(name="odometry", level=0, values=VALUES, message="running"):
    return DiagnosticStatus(level, f"/loop_bridge: {name}", message, LOOP, values)


def edges_of(model, row):
    found = graph_of(model, "system").edges
    return [edge.id for edge in found if row in (edge.source.port, edge.target.port)]


def listed(values, row):
    """What the table has of the connection of a row."""
    (told,) = (connection for connection in values["connections"] if connection["row"] == row)
    return told


def test_a_connection_is_told_at_its_row_and_at_each_of_its_edges(model, places, silent):
    row = places.rows["/loop_bridge", "odometry"]
    values = live_values(fold_statuses(silent, [status()], 7.0), places)
    assert values["edges"][row] == {"level": "ok", "gone": False, "text": "19.5 of 20 Hz"}
    edges = edges_of(model, row)
    assert len(edges) == 3
    told = listed(values, row)
    assert (told["rate"], told["declared_rate"], told["age"]) == (19.5, 20.0, 0.031)
    assert told["latency_us"] == {"in the bridge p50": 87.0}
    assert told["drops"] == {"no_value.Velocity_X": 3}
    assert all(values["edges"][edge] == values["edges"][row] for edge in edges)
    json.dumps(values, allow_nan=False)


def test_every_row_and_edge_of_bridges_is_told_of_before_anybody_is_heard(model, places, silent):
    values = live_values(silent, places)
    graph = graph_of(model, "system")
    assert values["edges"].keys() >= {edge.id for edge in graph.edges}
    assert values["boxes"].keys() == {
        node.id for node in graph.nodes if node.kind in ("component", "bridge")
    }
    assert values["edges"][places.rows["/loop_bridge", "drive"]]["level"] == "not heard"
    without_ros = live_values(fold_source(silent, "ROS", "no ROS here"), places)
    told = without_ros["edges"][places.rows["/loop_bridge", "drive"]]
    assert (told["level"], told["text"]) == ("unknown", "unknown")


def test_silence_and_failure_are_told_in_a_word(places, silent):
    stale = status("odometry", 3, message="the source is silent", values=(*VALUES, ("state", "s")))
    failed = status("drive", 2, message="nobody obeys")
    values = live_values(fold_statuses(silent, [stale, failed], 1.0), places)
    told = [values["edges"][places.rows["/loop_bridge", name]] for name in ("odometry", "drive")]
    assert [(edge["level"], edge["text"]) for edge in told] == [("stale", "s"), ("error", "error")]


def test_control_is_told_at_its_edge_and_in_the_box(places, silent):
    (edge,) = places.controls

    def told(*answers):
        state = silent
        for answer in answers:
            state = fold_answer(state, ComponentAnswer(LOOP, **answer), 1.0)
        values = live_values(state, places)
        return values["edges"][edge], values["boxes"]["loop_bridge"]

    assert told()[0]["text"] == "nobody tells"
    edge_of_owner, box = told({"state": "READY"}, {"controller": "20.1.1", "authority": 200})
    assert (edge_of_owner["level"], edge_of_owner["text"]) == ("ok", "in control")
    assert (box["level"], box["text"]) == ("ok", "READY")
    assert told({"controller": "9.9.9"})[0]["text"] == "controlled by 9.9.9"
    assert told({"controller": ""})[0]["level"] == "stale"
    assert told({"controller": "20.1.1", "state": "EMERGENCY"})[0]["level"] == "ok"


def test_what_a_bridge_says_of_itself_is_told_in_its_box(places, silent):
    of_bridge = status("jaus socket", 1, message="datagrams are lost", values=())
    state = fold_answer(silent, ComponentAnswer(LOOP, state="READY"), 1.0)
    box = live_values(fold_statuses(state, [of_bridge], 1.0), places)["boxes"]["loop_bridge"]
    assert box["level"] == "warning"
    assert box["text"] == "READY; jaus socket: datagrams are lost"


def test_little_is_told_of_much(places, silent):
    values = live_values(fold_statuses(silent, [status()], 1.0), places)
    for connection in values["connections"]:
        assert connection.keys().isdisjoint({"values", "history"})


def test_a_changed_model_keeps_what_was_heard(model, places, silent):
    heard = fold_statuses(silent, [status()], 1.0)
    heard = fold_answer(heard, ComponentAnswer(LOOP, state="READY"), 1.0)
    declared = [
        declaration for declaration in declarations_of(model) if declaration.name != "odometry"
    ]
    state = fold_model(heard, declared, {"10.1.77": "new"}, 2.0)
    assert state.connections["/loop_bridge", "odometry"].declaration is None
    assert state.connections["/loop_bridge", "odometry"].rate == 19.5
    assert {address for address, told in state.components.items() if told.is_declared} == {
        "10.1.77"
    }
    assert state.components[LOOP].state == "READY"
    assert "10.1.2" not in state.components  # nobody ever heard of it, and the model lost it
    again = fold_model(state, declarations_of(model), components_of(model), 3.0)
    later = fold_time(heard, 3.0)
    assert live_values(again, places)["edges"] == live_values(later, places)["edges"]


def test_a_death_is_told_as_one_and_ages_go_on(places, silent):
    row = places.rows["/loop_bridge", "odometry"]
    alive = fold_answer(
        fold_statuses(silent, [status()], 1.0),
        ComponentAnswer(LOOP, state="READY", controller="100.1.5", round_trip=0.0025),
        1.0,
    )
    values = live_values(fold_time(alive, 4.0), places)
    assert not values["edges"][row]["gone"]
    assert listed(values, row)["age"] == pytest.approx(3.031)
    dead = fold_time(alive, 60.0)
    for number in range(3):
        dead = fold_answer(dead, ComponentAnswer(LOOP, source=AnswerSource.NOBODY), 60.0 + number)
    values = live_values(fold_time(dead, 63.0), places)
    edge = values["edges"][row]
    assert (edge["gone"], edge["text"]) == (True, "gone")
    told = listed(values, row)
    assert (told["rate"], told["latency_us"], told["age"]) == (None, {}, pytest.approx(62.031))
    # What it told of itself holds no longer, and is no more than history.
    (component,) = (shown for shown in values["components"] if shown["id"] == LOOP)
    assert [component[name] for name in ("state", "controller", "round_trip_ms")] == [None] * 3
    assert component["reason"] == "does not answer any more; was in READY"
    box = values["boxes"]["loop_bridge"]
    assert box["gone"]
    assert box["text"].startswith("gone: does not answer any more")
    # It stays so however often it is looked at, and lives again with its first answer.
    again = fold_time(dead, 70.0).components[LOOP]
    assert again.reason == "does not answer any more; was in READY"
    back = fold_answer(dead, ComponentAnswer(LOOP, state="STANDBY"), 71.0).components[LOOP]
    assert (back.state, back.is_gone) == ("STANDBY", False)


BROKEN = """\
import `jaus.mobility`
component rover { address: 100.1.1 }
bridge b {
  connection one { map: nowhere  topic speed {} }
  connection two { topic speed {} }
}
"""


def test_a_model_with_errors_is_watched_as_far_as_it_goes(tmp_path):
    path = tmp_path / "broken.ros2jaus"
    path.write_text(BROKEN)
    model = read_models([path], notations=NOTATIONS).model
    places = places_of(model)
    values = live_values(expected(declarations_of(model), components_of(model), 0.0), places)
    assert list(values["boxes"]) == [places.boxes["100.1.1"]]
    assert values["edges"] == {}


def test_a_model_without_a_system_shows_nothing(tmp_path):
    path = tmp_path / "empty.ros2jaus"
    path.write_text("")
    model = read_models([path], notations=NOTATIONS).model
    assert places_of(model) == Places()
    assert live_values(SystemState(), Places())["boxes"] == {}


def test_a_closed_frame_is_told_as_the_worst_that_is_in_it(tmp_path):
    model = model_in(tmp_path, large_system(30, 2), "large.ros2jaus")
    places = places_of(model)
    bridge, host = places.frames[places.rows["/bridge0", "velocity0"]]
    state = expected(declarations_of(model), components_of(model), 0.0)
    heard = DiagnosticStatus(0, "/bridge0: velocity0", "running", "100.1.200", VALUES)
    boxes = live_values(fold_statuses(state, [heard], 7.0), places)["boxes"]
    assert boxes[bridge]["level"] != "ok"
    assert "1 ok" in boxes[bridge]["text"]
    assert "1 ok" in boxes[host]["text"]
    assert "ok" not in boxes[next(f for f in boxes if f.endswith("@bridges.1!frame"))]["text"]
    assert boxes[host]["gone"] is False


def test_no_frames_are_told_of_a_system_that_is_not_large(places):
    assert places.frames == {}


WINCH = ROOT / "models" / "examples" / "winch" / "winch.xmi"
WINCH_READY = "Receiving.Ready.Controlled.Available.Ready"
OUT, IDLE = f"{WINCH_READY}.Moving.PayingOut", f"{WINCH_READY}.Idle"
KEY = ("urn:jausml:examples:Winch", "ReceiveFSM")


@pytest.fixture(scope="module")
def winch():
    return read_models([WINCH], allow_outside=True).model


def machine(state=OUT, *times):
    return MachineState(
        *KEY, state, 2.5, times or (StateTime(IDLE, 2, 7.5), StateTime(OUT, 1, 2.5))
    )


def watched(winch, *machines):
    """The values of the winch model, whose components have these machines, one each."""
    state = expected(declarations_of(winch), components_of(winch), 0.0)
    for number, state_machine in enumerate(machines, 1):
        answer = ComponentAnswer(f"120.1.{number}", state="READY", machines=(state_machine,))
        state = fold_answer(state, answer, 1.0)
    return state, live_values(state, places_of(winch))


def states_of(winch, values):
    """What is told at boxes and frames of the view of the machine, by paths."""
    graph = graph_of(winch, "machine:Winch.ReceiveFSM")
    ids = {node.id: node.id.rpartition("!")[2] for node in (*graph.nodes, *graph.groups)}
    return {ids[box_id]: told for box_id, told in values["boxes"].items() if box_id in ids}


def test_states_are_told_at_their_boxes_in_the_view_of_the_machine(winch):
    told = states_of(winch, watched(winch, machine())[1])
    assert told[OUT] == {
        "level": "active",
        "gone": False,
        "text": "2.5 s; 25% of the time; entered 1×",
    }
    assert (told[IDLE]["level"], told[IDLE]["text"]) == ("left", "75% of the time; entered 2×")
    around = told[f"{WINCH_READY}.Moving"]
    assert (around["level"], around["text"]) == ("around", "25% of the time")
    assert f"{WINCH_READY}.Locked" not in told


def test_a_moment_of_a_recording_has_the_states_that_were_told_by_then(winch, tmp_path):
    path = tmp_path / "winch.mcap"
    path.write_bytes(recorded_machines("120.1.1", *KEY, {1.0: IDLE, 3.0: OUT}))
    recorded = indexed(str(path))
    shown = {
        at: states_of(winch, live_values(recorded.state(at, winch), places_of(winch)))
        for at in (1.0, 2.5)  # seconds since the first message
    }
    assert recorded.unreadable == 0
    assert shown[1.0][IDLE]["level"] == "active"
    assert OUT not in shown[1.0]
    assert (shown[2.5][OUT]["level"], shown[2.5][OUT]["text"][:5]) == ("active", "2.5 s")
    assert IDLE not in shown[2.5]


def test_several_components_are_counted_in_each_state(winch):
    told = states_of(winch, watched(winch, machine(), machine(IDLE))[1])
    assert told[OUT]["text"].startswith("1 of 2: winch; 25% of the time")
    assert told[IDLE]["text"].startswith("1 of 2: winch_operator; 75% of the time")
    assert told[f"{WINCH_READY}.Moving"]["level"] == "around"


def test_what_the_model_does_not_have_is_told_as_unknown(winch):
    elsewhere = MachineState("urn:other", "M", "A", 1.0)
    unknown = machine(f"{WINCH_READY}.Nowhere\x1b", StateTime("Nowhere", 1, 0.0))
    _, values = watched(winch, unknown, elsewhere)
    found = [state for component in values["components"] for state in component["machines"]]
    assert [state_machine["known"] for state_machine in found] == [False, False]
    told = states_of(winch, values)
    assert told[WINCH_READY]["level"] == "around"
    assert json.loads(json.dumps(values)) == values


def test_a_component_that_is_lost_is_in_no_state(winch):
    state, _ = watched(winch, machine())
    for _ in range(3):
        state = fold_answer(state, ComponentAnswer("120.1.1", source=AnswerSource.NOBODY), 2.0)
    values = live_values(state, places_of(winch))
    assert states_of(winch, values) == {}
    assert [component["machines"] for component in values["components"]] == [[], []]

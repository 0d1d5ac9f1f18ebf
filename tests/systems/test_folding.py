"""The state of a running system, folded from what is told of it."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.live.systems.folding import (
    FORGOTTEN,
    LONGEST_TEXT,
    MOST_COMPONENTS,
    MOST_CONNECTIONS,
    MOST_VALUES,
    AnswerSource,
    ComponentAnswer,
    DiagnosticStatus,
    connection_of,
    expected,
    fold_answer,
    fold_model,
    fold_source,
    fold_statuses,
    fold_time,
)
from jausml.live.systems.state import (
    HISTORY,
    SILENCE,
    ConnectionState,
    DeclaredConnection,
    Level,
    SystemState,
    TopicName,
    state_as_json,
)
from jausml.live.systems.tables import (
    COLUMNS,
    LONGEST_CELL,
    arranged,
    component_row,
    row,
    sparkline,
    summary,
)

VALUES = (
    ("translation", "light classes"),
    ("messages taken", "40"),
    ("rate (Hz)", "19.50"),
    ("declared rate (Hz)", "20.00"),
    ("age (s)", "0.031"),
    ("dropped: no_value.Velocity_X", "3"),
    ("lost in queue", "4"),
    ("unheard", "9"),
    ("in the bridge p50 (us)", "87.0"),
    ("in the bridge p99 (us)", "140.5"),
    ("peer 10.1.1", "confirmed"),
    ("search", "bound to 10.1.2"),
)
DECLARED = DeclaredConnection(
    "/robot/bridge",
    "odometry",
    "10.1.9",
    20.0,
    "to ROS",
    (TopicName("/robot/odometry", "nav_msgs/msg/Odometry"),),
    "ReportVelocityState",
    is_report=True,
    peers=("10.1.1",),
)


def status(name="odometry", node="/robot/bridge", level=0, values=VALUES, **others):
    fields = {"message": "running", "hardware_id": "10.1.9", **others}
    return DiagnosticStatus(level, f"{node}: {name}", values=values, **fields)


def only(state: SystemState) -> ConnectionState:
    (found,) = state.connections.values()
    return found


def test_nothing_is_said_that_was_not_observed():
    state = fold_source(fold_source(expected((), {"10.1.1": "base"}, 0.0), "JAUS", ""), "ROS", "")
    silent = state.components["10.1.1"]
    assert (silent.level, silent.reason) == (Level.UNKNOWN, "was not asked")
    assert set(state_as_json(state)["sources"].values()) == {"nothing heard"}
    nobody = ComponentAnswer("10.1.1", source=AnswerSource.NOBODY)
    asked = fold_answer(state, nobody, 1.0).components["10.1.1"]
    assert (asked.level, asked.reason) == (Level.NOT_HEARD, "does not answer")
    told = fold_answer(state, ComponentAnswer("10.1.1", source=AnswerSource.ITSELF), 1.0)
    assert state_as_json(told)["sources"] == {"JAUS": "heard", "ROS": "nothing heard"}


def test_who_spoke_before_the_model_was_known_gets_its_name():
    heard = fold_answer(SystemState(), ComponentAnswer("10.1.1", source=AnswerSource.ITSELF), 1.0)
    assert fold_model(heard, (), {"10.1.1": "base"}, 2.0).components["10.1.1"].name == "base"


def test_a_status_of_a_bridge_becomes_a_connection():
    told = only(fold_statuses(SystemState(), [status()], 7.0))
    assert told.key == ("/robot/bridge", "odometry")
    assert (told.level, told.reason, told.jaus_id) == (Level.OK, "running", "10.1.9")
    assert (told.rate, told.declared_rate, told.age) == (19.5, 20.0, 0.031)
    assert told.drops == {"no_value.Velocity_X": 3, "lost in queue": 4}  # unheard is no loss
    assert told.dropped == 7
    assert told.latency == {"in the bridge p50": 87.0, "in the bridge p99": 140.5}
    assert told.peers == {"peer 10.1.1": "confirmed", "search": "bound to 10.1.2"}
    assert told.values == VALUES
    assert told.history == (19.5,)


@pytest.mark.parametrize(
    ("level", "expected_level"),
    [(0, Level.OK), (1, Level.WARNING), (2, Level.ERROR), (3, Level.STALE), (77, Level.ERROR)],
)
def test_levels_of_ros(level, expected_level):
    assert only(fold_statuses(SystemState(), [status(level=level)], 0.0)).level is expected_level


@pytest.mark.parametrize(
    "foreign",
    [
        DiagnosticStatus(2, "battery: voltage", "low", "pack 7", (("volts", "3"),)),
        DiagnosticStatus(2, "no colon", "", "10.1.9", VALUES),
        DiagnosticStatus(2, "/a: b", "", "10.1.9", (("rate (Hz)", "3"),)),
        DiagnosticStatus(2, "/a: b", "", "a.b.c", VALUES),
        DiagnosticStatus(2, "", "", "", ()),
    ],
)
def test_statuses_of_other_makers_are_passed_over(foreign):
    assert not fold_statuses(SystemState(), [foreign], 0.0).connections


def test_values_that_are_no_numbers_are_left_out_and_kept_as_text():
    odd = (
        ("declared rate (Hz)", "1e999"),
        ("rate (Hz)", "nan"),
        ("age (s)", "never"),
        ("dropped: a", "-1"),
        ("dropped: b", "9" * 400),
        ("dropped: c", "²"),
        ("in the bridge p50 (us)", "inf"),
        ("declared rate (Hz)", "twice"),
    )
    told = connection_of(status(values=odd), 1.0)
    assert (told.rate, told.declared_rate, told.age) == (None, None, None)
    assert (told.drops, told.latency) == ({}, {})
    assert told.values == odd


def test_history_is_bounded():
    state = SystemState()
    for second in range(HISTORY + 10):
        values = (("declared rate (Hz)", "1"), ("rate (Hz)", str(second)))
        state = fold_statuses(state, [status(values=values)], float(second))
    assert only(state).history == tuple(map(float, range(10, HISTORY + 10)))


def test_a_bridge_that_says_nothing_any_more_is_not_heard():
    state = fold_statuses(SystemState(), [status()], 0.0)
    assert only(fold_time(state, SILENCE)).level is Level.OK
    gone = only(fold_time(state, SILENCE + 0.1))
    assert (gone.level, gone.rate) == (Level.NOT_HEARD, None)
    assert only(fold_statuses(fold_time(state, 60.0), [status()], 61.0)).level is Level.OK


def test_a_bridge_that_speaks_seldom_is_waited_for():
    state = fold_statuses(SystemState(), [status()], 0.0)
    state = fold_statuses(state, [status()], 10.0)
    assert only(fold_time(state, 39.0)).level is Level.OK
    assert only(fold_time(state, 41.0)).level is Level.NOT_HEARD


def test_what_concerns_a_bridge_is_told_only_while_it_lasts():
    told = status("jaus id", level=2, values=(("place", "10.0.0.1"),), message="a double")
    state = fold_statuses(SystemState(), [told], 0.0)
    assert (only(state).level, only(state).reason) == (Level.ERROR, "a double")
    assert not fold_time(state, SILENCE + 1).connections


def test_a_declared_connection_that_nobody_tells_of():
    state = expected([DECLARED], {"10.1.1": "vehicle"}, 0.0)
    assert (only(state).level, only(state).declared_rate) == (Level.NOT_HEARD, 20.0)
    assert state.weight == 2
    assert not state.is_heard


@pytest.mark.parametrize(
    ("node", "jaus_id"),
    [("/robot/bridge", "10.1.9"), ("/second/bridge", "10.2.9"), ("/renamed", "10.1.9")],
)
def test_a_declared_connection_is_found_by_node_or_id(node, jaus_id):
    state = fold_statuses(
        expected([DECLARED], {}, 0.0), [status(node=node, hardware_id=jaus_id)], 1.0
    )
    assert only(state).declaration == DECLARED
    assert only(state).level is Level.OK


def test_two_bridges_of_one_declaration():
    state = expected([DECLARED], {}, 0.0)
    for node, jaus_id in (("/one/bridge", "10.1.9"), ("/two/bridge", "11.1.9")):
        state = fold_statuses(state, [status(node=node, hardware_id=jaus_id)], 1.0)
    bridges = [connection.bridge for connection in state.connections.values()]
    assert bridges == ["/one/bridge", "/two/bridge"]
    assert all(connection.declaration == DECLARED for connection in state.connections.values())


def test_without_ros_a_connection_is_unknown_and_no_error():
    state = fold_source(expected([DECLARED], {}, 0.0), "ROS", "no ROS here")
    assert (only(state).level, only(state).reason) == (Level.UNKNOWN, "no ROS here")
    assert fold_answer(state, ComponentAnswer("10.1.1", state="READY"), 1.0).weight == 1
    assert only(fold_source(state, "ROS", "")).level is Level.NOT_HEARD


def test_answers_of_a_component_come_together():
    state = SystemState()
    for answer in (
        ComponentAnswer(
            "10.1.1", name="rover", services=("urn/1.0",), source=AnswerSource.DISCOVERY
        ),
        ComponentAnswer("10.1.1", state="READY", round_trip=0.002),
        ComponentAnswer("10.1.1", controller="20.1.1", authority=127),
    ):
        state = fold_answer(state, answer, 3.0)
    told = state.components["10.1.1"]
    assert (told.name, told.state, told.controller) == ("rover", "READY", "20.1.1")
    assert (told.authority, told.round_trip, told.services) == (127, 0.002, ("urn/1.0",))
    assert (told.level, told.told) == (Level.OK, 3.0)
    state = fold_answer(state, ComponentAnswer("10.1.1", control_timeout=5), 3.0)
    assert "20.1.1 (authority 127, lapses after 5 s)" in component_row(state.components["10.1.1"])
    state = fold_answer(state, ComponentAnswer("10.1.1", control_timeout=0), 3.0)
    assert "20.1.1 (authority 127, never lapses)" in component_row(state.components["10.1.1"])
    released = fold_answer(state, ComponentAnswer("10.1.1", controller="", authority=1), 4.0)
    assert released.components["10.1.1"].controller == ""


@pytest.mark.parametrize(
    ("name", "weight"), [("READY", 0), ("STANDBY", 0), ("INITIALIZE", 1), ("EMERGENCY", 2)]
)
def test_management_states(name, weight):
    assert fold_answer(SystemState(), ComponentAnswer("10.1.1", state=name), 0.0).weight == weight


def test_a_component_that_answers_no_more():
    state = expected([], {"10.1.1": "vehicle"}, 0.0)
    for address in ("10.1.1", "10.1.2"):
        state = fold_answer(state, ComponentAnswer(address, state="READY"), 0.0)
    for _ in range(3):
        assert state.weight == 0
        for address in ("10.1.1", "10.1.2"):
            state = fold_answer(state, ComponentAnswer(address, source=AnswerSource.NOBODY), 3.0)
    levels = {address: component.level for address, component in state.components.items()}
    # Whom the model has must be there; others come and go, and are forgotten.
    assert levels == {"10.1.1": Level.NOT_HEARD, "10.1.2": Level.STALE}
    assert list(fold_time(state, FORGOTTEN + 1).components) == ["10.1.1"]
    back = fold_answer(state, ComponentAnswer("10.1.1", state="READY"), 4.0)
    assert back.components["10.1.1"].level is Level.OK


def test_whom_only_discovery_names_is_no_error():
    state = fold_answer(
        SystemState(), ComponentAnswer("10.1.1", name="x", source=AnswerSource.DISCOVERY), 0.0
    )
    assert state.components["10.1.1"].level is Level.STALE
    assert not state.is_heard


def test_there_is_a_bound_to_what_is_kept():
    many = [status(f"c{index}", values=VALUES[:4]) for index in range(MOST_CONNECTIONS + 3)]
    state = fold_statuses(SystemState(), many, 0.0)
    assert (len(state.connections), state.ignored) == (MOST_CONNECTIONS, 3)
    assert not fold_statuses(state, many[:1], 1.0).ignored - 3
    state = SystemState()
    for number in range(MOST_COMPONENTS + 2):
        state = fold_answer(state, ComponentAnswer(f"{number + 1}.1.1"), 0.0)
    assert (len(state.components), state.ignored) == (MOST_COMPONENTS, 2)
    huge = status(values=(*VALUES, *(("k" * 10_000, "v" * 10_000) for _ in range(1000))))
    values = only(fold_statuses(SystemState(), [huge], 0.0)).values
    assert len(values) == MOST_VALUES
    assert max(len(text) for pair in values for text in pair) == LONGEST_TEXT


# ------------------------------------------------------------------ anything at all

TEXTS = st.one_of(
    st.text(max_size=30),
    st.sampled_from(
        [
            "declared rate (Hz)",
            "rate (Hz)",
            "age (s)",
            "dropped: x",
            "10.1.9",
            "/b: c",
            "/b: jaus id",
        ]
    ),
    st.floats().map(str),
    st.just("\x1b[2J[red]\u202e\ud800" + "x" * 1000),
)
STATUSES = st.builds(
    DiagnosticStatus,
    st.integers(0, 255),
    TEXTS,
    TEXTS,
    st.one_of(st.just("10.1.9"), TEXTS),
    st.lists(st.tuples(TEXTS, TEXTS), max_size=8).map(tuple),
)
ANSWERS = st.builds(
    ComponentAnswer,
    st.sampled_from(["10.1.1", "10.1.9", "20.1.1"]),
    st.none() | TEXTS,
    st.none() | TEXTS,
    st.none() | TEXTS,
    st.sampled_from([None, "", "1.1.1"]),
    st.none() | st.integers(0, 255),
    source=st.sampled_from(AnswerSource),
)
EVENTS = st.lists(
    st.tuples(st.floats(0, 100), st.lists(STATUSES, max_size=3) | ANSWERS), max_size=12
)


@given(EVENTS)
def test_whatever_is_told_the_state_can_be_shown(events):
    state = expected([DECLARED], {"10.1.1": "vehicle"}, 0.0)
    for now, event in events:
        before = state
        fold = fold_answer if isinstance(event, ComponentAnswer) else fold_statuses
        state = fold(state, event, now)
        assert state.now == max(before.now, now)
        assert "10.1.1" in state.components
        assert any(connection.name == "odometry" for connection in state.connections.values())
    assert json.loads(json.dumps(state_as_json(state), allow_nan=False))["health"]
    for index in range(len(COLUMNS)):
        shown = arranged(state, index)
        assert {connection.key for connection in shown} == state.connections.keys()
        assert len(shown) == len(state.connections)
        assert len(arranged(state, index, is_reversed=True)) == len(shown)
    cells = [text for connection in state.connections.values() for text in row(connection)]
    cells += [text for component in state.components.values() for text in component_row(component)]
    assert all(text.isprintable() and len(text) <= LONGEST_CELL for text in cells)
    assert summary(state).isprintable()


@given(EVENTS)
def test_time_alone_changes_nothing_twice(events):
    state = SystemState()
    for now, event in events:
        fold = fold_answer if isinstance(event, ComponentAnswer) else fold_statuses
        state = fold(state, event, now)
    once = fold_time(state, state.now)
    assert fold_time(once, once.now) == once


# ------------------------------------------------------------------ tables


def states(**rates):
    values = {
        name: (("declared rate (Hz)", "5"), *((("rate (Hz)", rate),) if rate else ()))
        for name, rate in rates.items()
    }
    told = [status(name, values=pairs) for name, pairs in values.items()]
    return fold_statuses(SystemState(), told, 0.0)


def names(connections):
    return [connection.name for connection in connections]


def test_order_by_a_number_has_the_greatest_first_and_the_unknown_last():
    state = states(slow="1", fast="30", mute="")
    assert names(arranged(state, 2)) == ["fast", "slow", "mute"]
    assert names(arranged(state, 2, is_reversed=True)) == ["slow", "fast", "mute"]
    assert names(arranged(state, 1)) == ["fast", "mute", "slow"]


def test_ages_in_tables_grow_while_the_bridge_says_nothing():
    mute = status("mute", values=(("declared rate (Hz)", "5"),))
    state = fold_time(fold_statuses(SystemState(), [status(), mute], 10.0), 12.0)
    ages = {connection.name: connection.age for connection in arranged(state, 0)}
    assert ages == {"odometry": 2.031, "mute": None}


def test_filter_takes_parts_of_names_in_any_case():
    state = states(odometry="1", odd="2", pose="3")
    assert names(arranged(state, 1, "OD")) == ["odd", "odometry"]
    assert names(arranged(state, 1, "bridge metry")) == ["odometry"]
    assert names(arranged(state, 1, "[")) == []


def test_what_does_not_work_comes_first():
    told = [status(f"c{level}", level=level) for level in (0, 1, 2)]
    state = fold_statuses(SystemState(), told, 0.0)
    assert names(arranged(state, 0)) == ["c2", "c1", "c0"]


def test_sparklines_are_relative_to_the_declared_rate():
    assert sparkline((0.0, 5.0, 10.0), 10.0) == "▁▄█"
    assert sparkline((5.0,), 10.0) == "▄"
    assert sparkline((0.0, 0.0), None) == "▁▁"
    assert sparkline((), 10.0) == ""
    assert len(sparkline((1.0,) * 50, None, 12)) == 12
    assert sparkline((-3.0, 1.0), None) == "▁█"


# ------------------------------------------------------------------ states of connections


def test_a_connection_has_the_state_that_its_bridge_says():
    told = status(level=3, message="emergency", values=(("state", "refused"), *VALUES))
    state = fold_statuses(SystemState(), [told], 0.0)
    assert (only(state).phase, only(state).level) == ("refused", Level.STALE)
    assert row(only(state))[0] == "refused"
    assert state_as_json(state)["connections"][0]["state"] == "refused"
    gone = fold_time(state, SILENCE + 1.0)
    assert row(only(gone))[0] == "not heard"
    assert state_as_json(gone)["connections"][0]["state"] is None


def test_a_bridge_that_says_no_state_is_shown_by_its_level():
    assert row(only(fold_statuses(SystemState(), [status()], 0.0)))[0] == "ok"

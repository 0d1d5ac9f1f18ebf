"""Names: valid, free of collisions, the same each time, whatever the model says."""

import builtins
import keyword
import sys

from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st

from jausml.language.semantics.names import LONGEST
from jausml_generators.python import names


@for_each(
    ("name", "expected"),
    [
        ("PropulsiveLinearEffortX", "propulsive_linear_effort_x"),
        ("Velocity_X", "velocity_x"),
        ("Velocity_RMS", "velocity_rms"),
        ("RequestID", "request_id"),
        ("ElementUID", "element_uid"),
        ("URI", "uri"),
        ("P1_Latitude", "p1_latitude"),
        ("powerPlantID", "power_plant_id"),
        ("QueryMessage", "query_message"),
        ("TimeStamp", "time_stamp"),
        ("class", "class_"),
        ("Type", "type_"),
        ("__init__", "init"),
        ("CostMap2D", "cost_map2d"),
        ("Joint1Offset", "joint1_offset"),
        ("3D Point", "n3d_point"),
        ("", "unnamed"),
        ("§", "unnamed"),
    ],
)
def test_snake_case(name, expected):
    assert names.snake_case(name) == expected


@for_each(
    ("name", "expected"),
    [
        ("NodeSeq", "NodeSeq"),
        ("powerPlantID", "PowerPlantID"),
        ("Roll_Rate", "RollRate"),
        ("None", "JausNone"),
        ("Exception", "JausException"),
        ("3D", "N3D"),
        ("", "Unnamed"),
    ],
)
def test_class_name(name, expected):
    assert names.class_name(name) == expected


@for_each(
    ("name", "expected"),
    [
        ("Periodic (SC)", "PERIODIC_SC"),
        ("TIMEOUT_FEATURE _DISABLED", "TIMEOUT_FEATURE_DISABLED"),
        ("4WD", "N4WD"),
        ("!", "UNNAMED"),
    ],
)
def test_constant_name(name, expected):
    assert names.constant_name(name) == expected


@for_each(
    "name", ["operator", "json", "rclpy", "test", "tomllib", "imp", "class", "main", "messages"]
)
def test_a_package_hides_no_module(name):
    assert names.package_name(name) == f"{name}_jaus"


def test_the_builtins_of_this_python_are_known():
    shadowed = [name for name in dir(builtins) if not name.startswith("_")]
    for name in shadowed:
        assert names.snake_case(name) != name
        assert names.class_name(name) != name


@given(st.text())
def test_every_text_gives_valid_names(text):
    for function in (names.snake_case, names.class_name, names.constant_name, names.package_name):
        name = function(text)
        assert name.isascii()
        assert name.isidentifier()
        assert not keyword.iskeyword(name)
        assert not name.startswith("_")
        assert not hasattr(builtins, name)
        assert len(name) <= LONGEST + 6
    assert names.package_name(text) not in sys.stdlib_module_names


@given(st.lists(st.text(max_size=3), max_size=30))
def test_names_side_by_side_differ(texts):
    scope = names.Scope(frozenset(["offset", "x"]))
    claimed = [scope.claim(names.snake_case(text)) for text in texts]
    assert len(set(claimed)) == len(claimed)
    assert not {"offset", "x"} & set(claimed)
    again = names.Scope(frozenset(["offset", "x"]))
    assert [again.claim(names.snake_case(text)) for text in texts] == claimed


def test_a_claimed_number_may_be_a_name_of_its_own():
    scope = names.Scope()
    assert [scope.claim(name) for name in ("x", "x_2", "x", "x")] == ["x", "x_2", "x_3", "x_4"]

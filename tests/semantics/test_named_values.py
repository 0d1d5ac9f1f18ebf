"""Enumerations of both sides are compared by their names."""

from dataclasses import replace

import pytest

from jausml.language.semantics.paths.attributes import (
    BOOL,
    NUMBER,
    Attribute,
    compared,
    named_values,
    table_text,
)


def number(label: str, *, is_ros: bool = True, **values: int) -> Attribute:
    constants = tuple((name, str(value)) for name, value in values.items())
    return Attribute(
        NUMBER, "a number", integral=True, label=label, is_ros=is_ros, constants=constants
    )


def test_constants_that_begin_with_the_field_are_its_own():
    constants = {"POWER_SUPPLY_STATUS_FULL": 4, "POWER_SUPPLY_HEALTH_GOOD": 1}
    assert list(named_values(number("power_supply_status", **constants))) == ["full"]
    assert list(named_values(number("percentage", **constants))) == ["statusfull", "healthgood"]


def test_constants_of_other_fields_are_left_out():
    constants = {"GATE_OPEN": 1, "GATE_CLOSED": 0, "MOTOR_ON": 1, "OPEN_LIMIT": 5}
    assert list(named_values(number("gate_state", **constants))) == ["open", "closed"]
    assert list(named_values(number("gate", **constants))) == ["open", "closed"]


def test_what_all_names_begin_with_is_no_part_of_them():
    ros = number("state", BOOM_FOLDED=0, BOOM_UNFOLDED=1, BOOM_Z=2)
    jaus = number("Position", is_ros=False, StateFolded=1, StateUnfolded=0)
    found = compared(ros, jaus)
    assert found is not None
    pairs = [(one.name, other.name) for one, other in found.renumbered]
    assert pairs == [("BOOM_FOLDED", "StateFolded"), ("BOOM_UNFOLDED", "StateUnfolded")]


def test_a_name_that_others_begin_with_stays_whole():
    assert list(named_values(number("x", OPEN=0, OPEN_SLOWLY=1))) == ["open", "openslowly"]


def test_a_single_name_has_no_common_beginning():
    assert list(named_values(number("state", BOOM_FOLDED=0))) == ["boomfolded"]


def test_names_are_compared_without_case_and_separators():
    ros = number("mode", MODE_STAND_BY=1, MODE_READY=2, MODE_LOST=9)
    jaus = number("Mode", is_ros=False, **{"Stand By": 1, "ready": 3})
    found = compared(ros, jaus)
    assert found is not None
    assert [(one.name, other.name) for one, other in found.renumbered] == [("MODE_READY", "ready")]
    assert [value.name for value in found.unmatched] == ["MODE_LOST"]
    assert found.is_of_one_enumeration
    assert table_text(found, to_ros=False) == '"Stand By" <-> MODE_STAND_BY  ready <-> MODE_READY'


@pytest.mark.parametrize(
    ("label", "names", "true"),
    [
        ("data", "off on", "on"),
        ("lamp_state", "Off On", "On"),
        ("is_enabled", "OFF ON", "ON"),
        ("engine_off", "OFF ON", "OFF"),
        ("disabled", "Disabled Enabled", "Disabled"),
        ("gate_open", "Closed Open", "Open"),
        ("gate_closed", "Closed Open", "Closed"),
        ("gate", "Closed Open", None),
        ("stopped", "Off On", None),
        ("not_on", "Off On", None),
        ("on_hold", "Off On", None),
        ("data", "Off Standby", None),
    ],
)
def test_a_flag_has_the_names_that_mean_true_and_false_to_it(label, names, true):
    values = {name: at for at, name in enumerate(names.split())}
    jaus = number("LampState" if "lamp" in label else "State", is_ros=False, **values)
    found = compared(jaus, replace(number(label), kind=BOOL, integral=False))
    meant = [] if found is None else [one.name for one, other in found.common if other.number]
    assert meant == ([] if true is None else [true])


def test_what_has_no_names_is_not_compared():
    ros = number("state", OPEN=1)
    assert compared(ros, number("State", is_ros=False)) is None
    assert compared(ros, replace(ros, kind="text")) is None
    assert compared(ros, number("State", is_ros=False, shut=1)) is None

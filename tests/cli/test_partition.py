"""`jausml partition`: what it proposes, and the model that it writes."""

from __future__ import annotations

from pathlib import Path

import pytest

from jausml.generation import load_targets, render
from jausml.language.text.notation import NOTATIONS
from jausml.language.validation.engine import validate

ROOT = Path(__file__).resolve().parents[2]
MODELS = [
    ROOT / "models" / "catvehicle" / "catvehicle.xmi",
    ROOT / "models" / "examples" / "catvehicle" / "catvehicle.ros2jaus",
    ROOT / "models" / "examples" / "fleet" / "fleet.ros2jaus",
    ROOT / "models" / "examples" / "waypoints" / "waypoints.ros2jaus",
    ROOT / "tests" / "cases" / "bridge_loop" / "model.xmi",
]


ALLOWED = {"JML367", "JML803"}
"""What an example allows stays allowed at the bridge of its name, and is told of the others."""


def problems(report):
    return sorted(
        (each.rule, each.severity.name, each.message.split(" in ")[0])
        for each in report.diagnostics
        if each.rule not in ALLOWED
    )


@pytest.mark.parametrize("number", ["2", "auto"])
@pytest.mark.parametrize("model", MODELS, ids=lambda path: path.parent.name + path.suffix)
def test_what_is_written_is_as_good_as_before(jausml, tmp_path, model, number):
    output = tmp_path / model.name
    result = jausml("partition", model, "--bridges", number, "-o", output, "--allow-outside")
    assert result.exit_code == 0, result.output
    before = validate([model], notations=NOTATIONS, allow_outside=True)
    after = validate([output], notations=NOTATIONS, allow_outside=True)
    assert problems(after) == problems(before)
    targets = [each for each in load_targets().values() if each.name == "bridge"]
    packages = {each.path.split("/")[0] for each in render(after.model, targets)}
    assert len(packages) == (1 if number == "auto" else 2)


def test_one_bridge_stays_as_it_is(jausml, tmp_path):
    same, converted = tmp_path / "fleet.ros2jaus", tmp_path / "fleet.xmi"
    result = jausml("partition", MODELS[2], "--bridges", "1", "-o", same)
    assert result.exit_code == 0, result.output
    assert result.stdout.startswith("1 bridge: one was asked for\n")
    # What the conversion there and back writes.
    assert jausml("convert", MODELS[2], converted).exit_code == 0
    (tmp_path / "back").mkdir()
    back = tmp_path / "back" / "fleet.ros2jaus"
    assert jausml("convert", converted, back).exit_code == 0
    assert same.read_bytes() == back.read_bytes()


def test_without_output_nothing_is_written(jausml, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = jausml("partition", MODELS[0], "--bridges", "3")
    assert result.exit_code == 0
    assert result.stdout.startswith("3 bridges: 3 were asked for\n")
    assert list(tmp_path.iterdir()) == []


def test_no_such_split(jausml):
    result = jausml("partition", MODELS[2], "--bridges", "5")
    assert result.exit_code == 1
    assert "no more than 2 bridges are possible, 5 were asked for" in result.output


def test_the_reason_names_what_stays_together(jausml):
    result = jausml("partition", MODELS[3], "--bridges", "9")
    assert "travel_speed stay together: " in result.output
    assert "whoever controls waypoint_vehicle commands all of them" in result.output


@pytest.mark.parametrize("number", ["0", "-1", "many", "2.5", "9" * 5000])
def test_wrong_numbers(jausml, number):
    result = jausml("partition", MODELS[0], "--bridges", number)
    assert result.exit_code == 2
    assert "neither a number of bridges nor 'auto'" in result.output


def test_the_notation_stays(jausml, tmp_path):
    result = jausml("partition", MODELS[0], "-o", tmp_path / "car.ros2jaus")
    assert result.exit_code == 2
    assert "FILE must end with .xmi" in result.output


def test_a_file_is_not_overwritten_unasked(jausml, tmp_path):
    output = tmp_path / "car.xmi"
    output.write_text("mine", encoding="utf-8")
    result = jausml("partition", MODELS[0], "-o", output)
    assert result.exit_code == 2
    assert "--force overwrites it" in result.output
    assert output.read_text(encoding="utf-8") == "mine"
    result = jausml("partition", MODELS[0], "-o", output, "--force")
    assert result.exit_code == 0

"""`jausml diagram`: what it writes, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import pytest

from jausml.diagrams.layout import graphviz

CAR = Path(__file__).resolve().parents[2] / "models" / "catvehicle" / "catvehicle.xmi"


@pytest.mark.parametrize(
    ("name", "start"), [("car.mmd", "flowchart LR\n"), ("car.dot", "digraph {\n")]
)
def test_the_ending_says_what_is_written(jausml, tmp_path, name, start):
    output = tmp_path / name
    result = jausml("diagram", CAR, "-o", output)
    assert result.exit_code == 0, result.output
    first = output.read_bytes()
    assert first.decode().startswith(start)
    assert b"odometry" in first
    jausml("diagram", CAR, "-o", output)
    assert output.read_bytes() == first


def test_without_the_engine_one_line_says_how_to_get_it(jausml, tmp_path, monkeypatch):
    monkeypatch.setattr(graphviz, "find_spec", lambda _: None)
    result = jausml("diagram", CAR, "-o", tmp_path / "x.svg")
    assert result.exit_code == 2
    assert result.output == "Error: pictures need pygraphviz: pip install 'jausml[diagram]'\n"
    assert not (tmp_path / "x.svg").exists()


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (["-o", "x.gif"], "ends in none of"),
        (["-o", "x.mmd", "--view", "map:velocity"], "did you mean map:velocity_state?"),
        (["-o", "/nowhere/x.mmd"], "cannot write"),
        ([], "Missing option"),
    ],
)
def test_what_cannot_be(jausml, options, complaint):
    result = jausml("diagram", CAR, *options)
    assert result.exit_code == 2
    assert complaint in result.output


def test_a_broken_model_is_drawn_and_told(jausml, folder):
    result = jausml("diagram", folder / "bad.xmi", "-o", folder / "bad.mmd")
    assert result.exit_code == 1
    assert "1 error" in result.output
    assert "error: " in (folder / "bad.mmd").read_text(encoding="utf-8")

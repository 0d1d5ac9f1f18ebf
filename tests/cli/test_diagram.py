"""`jausml diagram`: what it writes, and what it refuses."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from jausml.views.diagrams.layout import graphviz
from jausml.views.diagrams.writers import svg

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


def test_a_picture_of_dots(jausml, tmp_path):
    sizes = {}
    for theme in ("auto", "light", "dark"):
        output = tmp_path / f"{theme}.png"
        result = jausml("diagram", CAR, "-o", output, "--theme", theme)
        assert result.exit_code == 0, result.output
        data = output.read_bytes()
        assert data.startswith(b"\x89PNG")
        sizes[theme] = struct.unpack(">II", data[16:24])
    assert (tmp_path / "auto.png").read_bytes() == (tmp_path / "light.png").read_bytes()
    assert (tmp_path / "dark.png").read_bytes() != (tmp_path / "light.png").read_bytes()
    assert len(set(sizes.values())) == 1
    assert min(sizes["light"]) > 1000


def test_without_a_font_no_picture_lacks_its_texts(jausml, tmp_path, monkeypatch):
    monkeypatch.setattr(svg, "FONTS", ("No Such Font",))
    svg._font.cache_clear()
    result = jausml("diagram", CAR, "-o", tmp_path / "x.png")
    svg._font.cache_clear()
    assert result.exit_code == 2
    assert "needs one of these fonts on this machine: No Such Font" in result.output
    assert not (tmp_path / "x.png").exists()


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

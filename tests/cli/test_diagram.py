"""`jausml diagram`: what it writes, and what it refuses."""

import struct
from pathlib import Path

import pytest

from jausml import installing
from jausml.views.diagrams.layout import graphviz
from jausml.views.diagrams.writers import svg

MODELS = Path(__file__).resolve().parents[2] / "models"
CAR = MODELS / "catvehicle" / "catvehicle.xmi"
SMALL = MODELS / "minimal" / "minimal.xmi"
MACHINE = (MODELS / "examples" / "winch" / "service.xmi", "--view", "machine:ReceiveFSM")
"""What is placed by Graphviz."""


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


@pytest.mark.needs("fonts")
def test_a_picture_of_dots(jausml, tmp_path):
    sizes = {}
    for theme in ("auto", "light", "dark"):
        output = tmp_path / f"{theme}.png"
        result = jausml("diagram", SMALL, "-o", output, "--theme", theme)
        assert result.exit_code == 0, result.output
        data = output.read_bytes()
        assert data.startswith(b"\x89PNG")
        sizes[theme] = struct.unpack(">II", data[16:24])
    assert (tmp_path / "auto.png").read_bytes() == (tmp_path / "light.png").read_bytes()
    assert (tmp_path / "dark.png").read_bytes() != (tmp_path / "light.png").read_bytes()
    assert len(set(sizes.values())) == 1
    assert max(sizes["light"]) > 1000


def test_without_a_font_no_picture_lacks_its_texts(jausml, tmp_path, monkeypatch):
    monkeypatch.setattr(svg, "FONTS", ("No Such Font",))
    svg.installed_font.cache_clear()
    result = jausml("diagram", CAR, "-o", tmp_path / "x.png")
    svg.installed_font.cache_clear()
    assert result.exit_code == 2
    assert "fonts on this machine: No Such Font (apt install fonts-liberation)" in result.output
    assert not (tmp_path / "x.png").exists()


def test_without_the_engine_one_line_says_how_to_get_it(jausml, refused, tmp_path, monkeypatch):
    monkeypatch.setattr(graphviz, "program", lambda: None)
    result = jausml("diagram", *MACHINE, "-o", tmp_path / "x.svg")
    assert result.exit_code == 2
    assert result.output == f"Error: pictures need graphviz-pure: {installing.command('diagram')}\n"
    assert not (tmp_path / "x.svg").exists()
    told = f"pictures need graphviz-pure: {installing.command('diagram')}"
    refused(told, "case", CAR, "-o", tmp_path / "case")
    result = jausml("studio", "--no-browser", tmp_path)
    assert result.exit_code == 2
    assert (
        result.output == f"Error: the studio needs graphviz-pure: {installing.command('studio')}\n"
    )


@pytest.mark.parametrize(
    ("script", "complaint"),
    [
        ("exec sleep 60", "Graphviz found no layout within 0.2 s"),
        ("kill -SEGV $$", "Graphviz failed: exit -11"),
        ("echo 'out of memory' >&2; exit 1", "Graphviz failed: out of memory"),
        ("echo '{\"bb\":'", "Graphviz failed: its answer is no JSON"),
    ],
)
def test_an_engine_that_hangs_or_crashes_is_an_error(
    jausml, tmp_path, monkeypatch, script, complaint
):
    engine = tmp_path / "engine"
    engine.write_text(f"#!/bin/sh\n{script}\n", encoding="utf-8")
    engine.chmod(0o755)
    monkeypatch.setattr(graphviz, "program", lambda: engine)
    monkeypatch.setattr(graphviz, "LONGEST", 0.2 if "sleep" in script else 60)
    result = jausml("diagram", *MACHINE, "-o", tmp_path / "x.svg")
    assert (result.exit_code, result.output) == (2, f"Error: {complaint}\n")
    assert not (tmp_path / "x.svg").exists()


def test_an_engine_that_does_not_start_is_an_error(jausml, tmp_path, monkeypatch):
    engine = tmp_path / "engine"
    engine.touch(0o644)
    monkeypatch.setattr(graphviz, "program", lambda: engine)
    result = jausml("diagram", *MACHINE, "-o", tmp_path / "x.svg")
    assert result.exit_code == 2
    assert result.output == f"Error: Graphviz does not start: {engine}: Permission denied\n"


def test_the_engine_is_found_where_it_is_installed(monkeypatch):
    monkeypatch.setenv("PATH", "")
    assert graphviz.program().is_file()
    monkeypatch.setattr(graphviz, "PACKAGE", "no-such-package")
    assert graphviz.program() is None


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (["-o", "x.gif"], "ends in none of"),
        (["-o", "x.mmd", "--view", "map:velocity"], "did you mean map:velocity_state?"),
        (["-o", "/nowhere/x.mmd"], "cannot write"),
        ([], "Missing option"),
    ],
)
def test_what_cannot_be(refused, options, complaint):
    refused(complaint, "diagram", CAR, *options)


def test_a_broken_model_is_drawn_and_told(jausml, folder):
    result = jausml("diagram", folder / "bad.xmi", "-o", folder / "bad.mmd")
    assert result.exit_code == 1
    assert "1 error" in result.output
    assert "error: " in (folder / "bad.mmd").read_text(encoding="utf-8")


def test_bodies_of_messages_are_for_services(jausml, refused, tmp_path):
    output = tmp_path / "winch.dot"
    model = MACHINE[0]
    for bodies in ((), ("--bodies",)):
        result = jausml("diagram", model, "--view", "service:Winch", *bodies, "-o", output)
        assert result.exit_code == 0, result.output
        assert ("RopeSpeed" in output.read_text(encoding="utf-8")) == bool(bodies)
    told = "--bodies is for views of services, and not for 'system'"
    refused(told, "diagram", model, "--bodies", "-o", output)

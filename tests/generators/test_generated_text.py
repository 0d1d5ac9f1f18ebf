"""Generated codecs as text: formatted, linted, typed, deterministic, and safe from model text."""

import ast
import os
import sys
from pathlib import Path

import pytest
from codec_support import (
    LIBRARY,
    LIBRARY_FILES,
    ROOT,
    library,
    load,
    read_messages,
    render,
    shipped_sets,
)
from scripts import succeeded

HERE = Path(__file__).parent
EVERY_KIND = HERE / "every_kind.xmi"
HOSTILE = HERE / "hostile_messages.xmi"


def run(*command: str, cwd: Path) -> None:
    succeeded(
        [sys.executable, "-m", *command],
        cwd=cwd,
        env={**os.environ, "MYPYPATH": str(ROOT)},
        timeout=110,
    )


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a module for each service set of the library and for odd models."""
    folder = tmp_path_factory.mktemp("generated")
    texts = {LIBRARY_FILES[name].split(".xmi")[0]: library(name)[1] for name in shipped_sets()}
    texts |= {path.stem: render(read_messages(path)) for path in (EVERY_KIND, HOSTILE)}
    for name, text in texts.items():
        (folder / f"{name.replace('-', '_').replace('.', '_')}.py").write_text(text, "utf-8")
    return folder


def test_ruff_would_format_nothing(generated):
    run("ruff", "format", "--check", "--config", str(ROOT / "pyproject.toml"), ".", cwd=generated)


def test_ruff_finds_nothing(generated):
    run("ruff", "check", "--config", str(ROOT / "pyproject.toml"), ".", cwd=generated)


@pytest.mark.slow
def test_mypy_finds_nothing(generated):
    # What generated code imports of jausml is judged as it is by `make lint`.
    options = (
        "--config-file", str(ROOT / "pyproject.toml"), "--cache-dir", str(ROOT / ".mypy_cache"),
        "--explicit-package-bases",
    )  # fmt: skip
    run("mypy", *options, ".", cwd=generated)


def test_it_is_python_3_10(generated):
    for path in generated.glob("*.py"):
        ast.parse(path.read_text("utf-8"), feature_version=(3, 10))


def test_the_same_model_gives_the_same_bytes():
    for path in (EVERY_KIND, LIBRARY / "mobility.xmi"):
        assert render(read_messages(path)) == render(read_messages(path))


def test_text_of_the_model_is_data():
    text = render(read_messages(HOSTILE))
    calls = {ast.unparse(node.func) for node in ast.walk(ast.parse(text)) if type(node) is ast.Call}
    assert not {"exec", "eval", "print", "__import__", "os.system"} & calls
    module = load(text, "hostile_messages")
    views = read_messages(HOSTILE)
    assert len({view.class_name for view in views}) == len(views)
    for view in views:
        message = getattr(module, view.class_name)()
        data = message.encode()
        assert type(message).decode(data).encode() == data
        assert view.jaus_name == message.NAME


def test_struct_formats_are_shared_and_merged():
    views, text, _ = library("mobility")
    waypoint = next(view for view in views if view.jaus_name == "SetGlobalWaypoint")
    assert [segment.kind for segment in waypoint.body.segments] == ["run", *["single"] * 6]
    assert waypoint.body.segments[0].size == 9
    assert text.count('= struct.Struct("<BII")') == 1


def test_members_are_found_by_their_path():
    views, _, _ = library("mobility")
    report = next(view for view in views if view.jaus_name == "ReportVelocityState")
    found = report.find("TimeStamp.Hour")
    assert [member.attribute for member in found] == ["time_stamp", "hour"]
    assert report.find("Velocity_X")[0].value.scale == (-327.68, 327.67)
    assert report.find("Velocity_X.Hour") == ()
    assert report.find("nothing") == ()

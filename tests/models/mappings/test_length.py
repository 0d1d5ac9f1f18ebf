"""Translations of ready maps and shipped models stay short enough to be read."""

import ast
from pathlib import Path

import pytest
from mapping_support import ROOT, generated, read

SHIPPED = (
    "catvehicle/catvehicle.xmi",
    "examples/catvehicle/catvehicle.ros2jaus",
    "examples/waypoints/waypoints.ros2jaus",
    "examples/winch/winch.xmi",
    "minimal/minimal.xmi",
)
MOST = 40
MOST_JOINED = 60
SIX_AXES = {"translate_analog_action_to_ros": 50}
"""Each axis comes as one of three types, or not at all."""
WIDEST = 100


def too_long(folder: Path) -> dict[str, int]:
    """Returns the translations of bridges with more statements than one reads at once."""
    found = {}
    for path in folder.rglob("*_base.py"):
        for syntax in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(syntax, ast.FunctionDef) and syntax.name.startswith("translate_"):
                body = syntax.body[1:]
                count = sum(isinstance(p, ast.stmt) for s in body for p in ast.walk(s))
                # A join brings the members of another message.
                if count > (MOST_JOINED if len(syntax.args.args) > 2 else MOST):
                    found[syntax.name] = count
    return found


def too_wide(folder: Path) -> list[str]:
    """Returns the lines of bridges that are wider than the line length of generated code.

    A single word cannot be cut.
    """
    return [
        f"{path.name}:{number}"
        for path in folder.rglob("*_base.py")
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if len(line) > WIDEST and " " in line.strip()
    ]


def test_translations_of_ready_maps_are_short_and_narrow(workspace):
    assert too_long(workspace) == SIX_AXES
    assert too_wide(workspace) == []


@pytest.mark.parametrize("model", SHIPPED)
def test_translations_of_shipped_models_are_short(model):
    assert too_long(generated(read(ROOT / "models" / model))) == {}

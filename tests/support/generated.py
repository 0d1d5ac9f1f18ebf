"""Models of tests, and what is generated of them."""

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from scripts import succeeded
from workspaces import python_path

from jausml.generation.rendering import render
from jausml.generation.target import Target
from jausml.language.model import Model, Severity, read_models
from jausml.language.text.notation import NOTATIONS

WITHOUT_PLUGINS = {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "PYTEST_ADDOPTS": "--assert=plain"}
"""Tests of packages need none of pytest's, and those are half of what it takes to begin; options of
these, which `make test-random` gives in the environment, are unknown without them. Nor do they need
to say with which values they fail, for which each would be compiled anew."""
STRICT = ("--strict", "--follow-imports=silent", "--python-version=3.10")
"""How mypy judges generated code: what it knows of one set of options serves all who have it."""


def model_of(*paths: Path, **options: Any) -> Model:
    """Returns the model of documents, of which nothing worse is said than an info."""
    result = read_models(paths, notations=NOTATIONS, **options)
    faults = [fault for fault in result.diagnostics if fault.severity is not Severity.INFO]
    assert not faults, faults
    return result.model


def model_in(folder: Path, text: str, name: str = "model.ros2jaus") -> Model:
    """Returns the model of a text, which stands in a folder then."""
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return model_of(path)


def texts_of(model: Model, targets: Sequence[Target[Any]]) -> dict[str, str]:
    """Returns what is generated of a model, by path."""
    return {artifact.path: artifact.text for artifact in render(model, targets)}


def text_of(model: Model, targets: Sequence[Target[Any]], end: str = "_base.py") -> str:
    """Returns the only generated text whose path ends so."""
    (text,) = (text for path, text in texts_of(model, targets).items() if path.endswith(end))
    return text


def run_in(workspace: Path, *command: str | Path, cwd: Path | None = None, **more: str) -> str:
    """Runs Python with the packages of a workspace, by default in it; returns what it printed."""
    path = python_path(workspace)
    done = succeeded(
        [sys.executable, *command],
        cwd=cwd or workspace,
        env={**os.environ, **WITHOUT_PLUGINS, "PYTHONPATH": path, "MYPYPATH": path, **more},
        timeout=110,
    )
    return done.stdout + done.stderr

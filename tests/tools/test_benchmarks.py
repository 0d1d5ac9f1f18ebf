"""Benchmarks: no test runs them, so what they import is looked up."""

from __future__ import annotations

import ast
import importlib
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[2] / "benchmarks"


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.py")), ids=lambda path: path.stem)
def test_what_it_imports_is_there(path):
    lost = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("jausml"):
            # The copy of the runtime in a workspace is the runtime.
            module = importlib.import_module(
                node.module.replace("jausml_runtime", "jausml.runtime")
            )
            lost += [each.name for each in node.names if not hasattr(module, each.name)]
    assert lost == []

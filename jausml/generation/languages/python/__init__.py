"""Rendered Python: its imports, and how its statements are laid out."""

from __future__ import annotations

from jausml.generation.languages.python.imports import (
    Imports,
    Origin,
    UnknownNameError,
    offered,
    statements,
    with_imports,
)
from jausml.generation.languages.python.layout import layout

__all__ = [
    "Imports",
    "Origin",
    "UnknownNameError",
    "layout",
    "offered",
    "statements",
    "with_imports",
]

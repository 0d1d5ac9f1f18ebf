"""Rendered Python: its imports, and how its statements are laid out."""

from __future__ import annotations

from jausml.generation.languages.python.imports import (
    Imports,
    Origin,
    UnknownNameError,
    offered,
    statements,
)
from jausml.generation.languages.python.layout import layout
from jausml.generation.languages.python.modules import Modules

__all__ = [
    "Imports",
    "Modules",
    "Origin",
    "UnknownNameError",
    "layout",
    "offered",
    "statements",
]

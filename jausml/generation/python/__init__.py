"""Rendered Python: its imports, and how its statements are laid out."""

from __future__ import annotations

from jausml.generation.python.layout import layout
from jausml.generation.python.modules import (
    Imports,
    Modules,
    Origin,
    UnknownNameError,
    offered,
    statements,
)

__all__ = ["Imports", "Modules", "Origin", "UnknownNameError", "layout", "offered", "statements"]

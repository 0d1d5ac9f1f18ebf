"""Rendered Python: how its statements are laid out."""

from __future__ import annotations

from jausml.generation.languages.python.layout import layout

__all__ = ["layout"]

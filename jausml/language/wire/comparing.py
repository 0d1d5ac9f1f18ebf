"""Comparison of layouts by what matters to the one who compares."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection


def comparable(layout: object, leaving_out: Collection[str]) -> object:
    """Returns a value that is equal for layouts which differ in nothing that matters.

    Args:
        layout: A message, a field, a kind, or a tuple of them.
        leaving_out: Attributes of layouts that do not matter, e.g. `documentation`.
    """
    if isinstance(layout, tuple):
        return tuple(comparable(each, leaving_out) for each in layout)
    if not is_dataclass(layout):
        return layout
    kept = (each.name for each in fields(layout) if each.name not in leaving_out)
    values = (comparable(getattr(layout, each), leaving_out) for each in kept)
    return (type(layout).__name__, *values)

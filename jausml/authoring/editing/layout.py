"""The layout file: where boxes stand that a user has moved, beside the model and never in it.

It is written to be read in differences: keys in order, whole numbers, one box a line.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from pathlib import PurePosixPath
from typing import Any, TypeAlias

from jausml.authoring.editing.commands import LayoutKey
from jausml.authoring.editing.working_copy import WorkingCopy
from jausml.language.model.library import SUFFIXES as MODEL_SUFFIXES
from jausml.language.model.model import Model
from jausml.language.model.refs import Keys
from jausml.language.text.notation import SUFFIX as TEXT_SUFFIX
from jausml.views.diagrams.views import view_names

SUFFIX = ".layout.json"
SUFFIXES = (*MODEL_SUFFIXES, SUFFIX)
"""The endings of models and of their layouts."""

Positions: TypeAlias = "dict[LayoutKey, tuple[int, int]]"
"""Upper left corners of boxes, in pixels."""

Layout: TypeAlias = "dict[str, Positions]"
"""Positions by the name of the view."""

_FARTHEST = 1_000_000
_LONGEST = 16 * 1024 * 1024
_VIEWS = "views"
_HOW = re.compile("(?:with|also) ")


def layout_file(file: str) -> str:
    """Returns the layout file of a model file: `robot.layout.json` beside `robot.xmi`."""
    suffix = TEXT_SUFFIX if file.endswith(TEXT_SUFFIX) else PurePosixPath(file).suffix
    return file.removesuffix(suffix) + SUFFIX


def is_layout(file: str) -> bool:
    """Tells whether a file holds positions."""
    return file.endswith(SUFFIX)


def read_layout(data: bytes) -> Layout:
    """Returns the positions of a layout file; other content is ignored."""
    try:
        content = json.loads(data) if len(data) <= _LONGEST else None
    except (ValueError, RecursionError):
        content = None
    views = content.get(_VIEWS) if isinstance(content, dict) else None
    if not isinstance(views, dict):
        return {}
    read = {view: _positions(boxes) for view, boxes in views.items() if isinstance(boxes, dict)}
    return {view: boxes for view, boxes in read.items() if boxes}


def write_layout(layout: Mapping[str, Mapping[LayoutKey, tuple[int, int]]]) -> bytes:
    """Returns a layout file; empty when it need not be there."""
    views = []
    for view, boxes in sorted(layout.items()):
        lines = [f"      {_text(key)}: [{x}, {y}]" for key, (x, y) in sorted(boxes.items())]
        if lines:
            views.append(f"    {_text(view)}: {{\n" + ",\n".join(lines) + "\n    }")
    if not views:
        return b""
    text = f'{{\n  "{_VIEWS}": {{\n' + ",\n".join(views) + "\n  }\n}\n"
    return text.encode("utf-8", "backslashreplace")


def placed(
    layout: Layout, view: str, positions: Mapping[LayoutKey, tuple[int, int] | None]
) -> Layout:
    """Returns a layout with some boxes placed, or left to the layout engine again."""
    boxes = {**layout.get(view, {}), **positions}
    kept = {key: position for key, position in boxes.items() if position is not None}
    return {**layout, view: {key: _within(position) for key, position in kept.items()}}


def renamed(layout: Layout, new_name: Callable[[LayoutKey], LayoutKey | None]) -> Layout:
    """Returns a layout whose boxes have other keys.

    `new_name`: returns the new key of an element, None for one that is gone.
    """
    return {view: _renamed(boxes, new_name) for view, boxes in layout.items()}


def _renamed(boxes: Positions, new_name: Callable[[LayoutKey], LayoutKey | None]) -> Positions:
    positions: Positions = {}
    for key, position in boxes.items():
        # A box may be named by several elements, or by one and what it shows of it.
        parts = [_renamed_part(word, new_name) for word in key.split("!")]
        if None not in parts:
            positions["!".join(map(str, parts))] = position
    return positions


def _renamed_part(part: str, new_name: Callable[[LayoutKey], LayoutKey | None]) -> LayoutKey | None:
    """Follows the key of an element, before which may stand how a box shows it."""
    how = _HOW.match(part)
    before = how.group() if how is not None else ""
    name = new_name(part.removeprefix(before))
    return None if name is None else before + name


def _positions(boxes: Mapping[str, Any]) -> Positions:
    return {
        key: (position[0], position[1]) for key, position in boxes.items() if _is_position(position)
    }


def _is_position(value: Any) -> bool:
    return (
        isinstance(value, list)
        and len(value) == 2
        and all(type(coordinate) is int and abs(coordinate) <= _FARTHEST for coordinate in value)
    )


def _within(position: tuple[int, int]) -> tuple[int, int]:
    x, y = (max(-_FARTHEST, min(_FARTHEST, coordinate)) for coordinate in position)
    return x, y


def _text(key: str) -> str:
    return json.dumps(key, ensure_ascii=False)


def followed(layout: Layout, file: str, before: WorkingCopy, after: WorkingCopy) -> Layout:
    """Returns the layout of a file after an edit: renamed elements keep their places."""
    old, new = before.models[file], after.models[file]
    elements = {after.copies[obj]: obj for obj in new.elements() if obj in after.copies}
    old_keys, new_keys = old.derived(Keys), new.derived(Keys)
    names: dict[str, str | None] = {}
    for obj in old.elements():
        copy = before.copies.get(obj)
        if copy is not None:
            element = elements.get(copy)
            names[old_keys.of(obj)] = new_keys.of(element) if element is not None else None
    views = _views(old, new)
    moved = {views.get(view, view): boxes for view, boxes in layout.items()}
    return renamed(moved, lambda key: names.get(key, key))


def _views(old: Model, new: Model) -> dict[str, str]:
    """Returns the new names of views by the old ones, which change when an element is renamed."""
    before, after = (view_names(model) for model in (old, new))
    if len(before) != len(after):
        return {}
    return dict(zip(before, after, strict=True))

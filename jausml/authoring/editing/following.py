"""Layouts that follow the elements whose boxes they place."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.authoring.editing.layout import renamed
from jausml.language.model.keys import Keys
from jausml.views.diagrams.views import view_names

if TYPE_CHECKING:
    from jausml.authoring.editing.forest import Forest
    from jausml.authoring.editing.layout import Layout
    from jausml.language.model.model import Model


def followed(layout: Layout, file: str, before: Forest, after: Forest) -> Layout:
    """Returns the layout of a file after an edit: what was renamed keeps its place."""
    old, new = before.models[file], after.models[file]
    elements = {after.things[obj]: obj for obj in new.elements() if obj in after.things}
    old_keys, new_keys = old.made(Keys), new.made(Keys)
    names: dict[str, str | None] = {}
    for obj in old.elements():
        thing = before.things.get(obj)
        if thing is not None:
            element = elements.get(thing)
            names[old_keys.of(obj)] = new_keys.of(element) if element is not None else None
    views = _views(old, new)
    moved = {views.get(view, view): boxes for view, boxes in layout.items()}
    return renamed(moved, lambda key: names.get(key, key))


def _views(old: Model, new: Model) -> dict[str, str]:
    """Returns the new names of views by the old ones, which change when an element is renamed."""
    before, after = (view_names(each) for each in (old, new))
    if len(before) != len(after):
        return {}
    return dict(zip(before, after, strict=True))

"""Paths that begin with the name of a join: they follow when it gets another one."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.authoring.editing.forest import Thing

_DIRECTIONS = {"joins": ("toJaus", "rosToJaus"), "reportJoins": ("toRos", "jausToRos")}
"""Where the paths may begin with a join: the assignments of a map, and the way of its vectors."""
_SOURCE, _PATH = "source", "path"


def paths_through(join: Thing, name: str) -> Iterator[tuple[Thing, str, str]]:
    """Yields what has paths through a join, the feature, and the paths with another name for it."""
    if join.owner is None or join.feature not in _DIRECTIONS or not join.name:
        return
    feature, way = _DIRECTIONS[join.feature]
    for each in join.owner.owned.get(feature, ()):
        for thing in each.everything():
            yield from _changed(thing, _SOURCE, join.name, name, is_nested=thing is not each)
    for vector in join.owner.owned.get("vectors", ()):
        if vector.values.get("direction", ("jausToRos",)) == (way,):
            for given in vector.owned.get("given", ()):
                yield from _changed(given, _PATH, join.name, name, is_nested=False)


def _changed(
    thing: Thing, feature: str, old: str, new: str, *, is_nested: bool
) -> Iterator[tuple[Thing, str, str]]:
    text = next(iter(thing.values.get(feature, ())), None)
    if not text:
        return
    # Within a list only paths from outside of it begin with a join.
    lead = "/" if is_nested else ""
    paths = text.split(", ")
    found = [
        f"{lead}{new}{path[len(lead + old) :]}"
        if path == lead + old or path.startswith(f"{lead}{old}.")
        else path
        for path in paths
    ]
    if found != paths:
        yield thing, feature, ", ".join(found)

"""Members of the two sides of a map: what an assignment can name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.authoring.proposals.elements import AnswerError
from jausml.language.semantics.paths.jaus_paths import JausPlace
from jausml.language.semantics.paths.ros_paths import RosPlace
from jausml.language.semantics.paths.scopes import is_many, outer_scope

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.metamodel.classes import bridge
    from jausml.language.semantics.paths.attributes import Attribute
    from jausml.language.semantics.paths.scopes import PathPlace

_DEEPEST = 8


@dataclass(frozen=True)
class Member:
    """A member of one side of a map.

    Attributes:
        outer: Path of the list or array that it lies in; empty for none.
        inner: Its path from an element of that; the whole path without one.
    """

    is_jaus: bool
    path: str
    outer: str
    inner: str
    attribute: Attribute


def member(used: bridge.AttributeMap, path: str, *, is_jaus: bool) -> Member:
    """Returns a member of a map.

    Args:
        path: Its path as the map view has it: names, without indices.
    """
    if used.message is None or used.type is None:
        raise AnswerError("the map has no message or no type yet")
    scope = outer_scope(used, to_ros=is_jaus)
    place = scope.find_source(path)
    if isinstance(place, JausPlace | RosPlace):
        return Member(is_jaus, path, "", path, place.attribute())
    steps = path.split(".")
    for count in range(1, len(steps) + 1):
        outer = ".".join(steps[:count])
        around = scope.find_source(outer)
        if is_many(around):
            inner = ".".join(steps[count:]) or "."
            found = _within(around, inner)
            if found is not None:
                return Member(is_jaus, path, outer, inner, found.attribute())
            break
    raise AnswerError(f"there is no member {path!a} that can be assigned by itself")


def _within(around: PathPlace, path: str) -> PathPlace | None:
    element = around.element()
    found = element.follow(path) if element is not None else None
    return found if isinstance(found, JausPlace | RosPlace) else None


def leaves(used: bridge.AttributeMap, *, is_jaus: bool) -> list[Member]:
    """Returns the members of a side that hold values: numbers, texts, times, orientations."""
    if used.message is None or used.type is None:
        return []
    scope = outer_scope(used, to_ros=is_jaus)
    found = []
    for path in _paths(scope.source, "", 0):
        try:
            each = member(used, path, is_jaus=is_jaus)
        except AnswerError:
            continue
        if each.attribute.kind:
            found.append(each)
    return found


def _paths(place: PathPlace, before: str, depth: int) -> Iterator[str]:
    """Yields the paths of what a place holds, elements of lists included."""
    inner = place.element() if is_many(place) else place
    if inner is None or depth > _DEEPEST:
        return
    if isinstance(inner, JausPlace):
        names = [str(each.name) for each in inner.members() or () if each.name]
    else:
        names = [str(each.name) for each in inner.type.fields] if inner.type is not None else []
    for name in names:
        found = inner.step(name)
        if isinstance(found, JausPlace | RosPlace):
            path = f"{before}.{name}" if before else name
            yield path
            yield from _paths(found, path, depth + 1)

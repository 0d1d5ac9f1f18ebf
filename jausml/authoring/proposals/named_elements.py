"""Maps with names that are others in each robot: of joints, which are elements, and of frames."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TypeGuard

from jausml.authoring.editing.commands import Add, AddedT, Command
from jausml.authoring.proposals.bridging import copied
from jausml.authoring.proposals.elements import Scope
from jausml.language.metamodel.classes import bridge
from jausml.language.model.names import name_of
from jausml.language.project import library
from jausml.language.semantics.assignments.named_places import NamedPlaces, named_by, named_places
from jausml.language.semantics.names import words

_ELEMENT = re.compile(r"\[[0-9]+\]")

FRAME_IDS = ("frame_id", "child_frame_id")
"""The fields that name a frame."""


def names_in(used: bridge.AttributeMap) -> list[str]:
    """Returns the names by which a map knows the elements of lists; none for most maps."""
    names = (name for assignment in (*used.toRos, *used.toJaus) for name in _names(assignment))
    places = named_places(used)
    return list(dict.fromkeys(names if places is None else places.names))


def _names(assignment: bridge.Assignment) -> Iterator[str]:
    if isinstance(assignment, bridge.ListAssignment):
        yield from assignment.names
        for inner_assignment in assignment.assignments:
            yield from _names(inner_assignment)


def names_for(used: bridge.AttributeMap, known: Sequence[str]) -> tuple[str, ...]:
    """Returns which of the names of a robot stand for those of a map, in the order of the map.

    A list has all of them. The places of a pan-tilt unit have those that say what theirs do, as
    `ptu_pan` says pan, else as many as there are; none where nobody can tell.
    """
    places = named_places(used)
    if places is None:
        return tuple(known)
    bearers = _bearers(places, known)
    if all(len(name_list) == 1 for name_list in bearers):
        return tuple(name for (name,) in bearers)
    return tuple(known) if len(known) == len(places.names) else ()


def are_named(used: bridge.AttributeMap, known: Sequence[str]) -> bool:
    """Tells whether the names of a robot say that they are those of the places of a map."""
    places = named_places(used)
    if places is None or len(known) != len(places.names):
        return False
    return all(len(bearer) == 1 for bearer in _bearers(places, known))


def _bearers(places: NamedPlaces, known: Sequence[str]) -> list[list[str]]:
    """Returns for each place the names of a robot that have its name as a word."""
    words_by_name = {
        robot_name: [word.lower() for word in words(robot_name)] for robot_name in known
    }
    return [
        [robot_name for robot_name, own in words_by_name.items() if name in own]
        for name in places.names
    ]


def are_examples(used: bridge.AttributeMap) -> bool:
    """Tells whether the names of a map are invented: with them, it would drop every message."""
    return bool(names_in(used)) and library().document_of(used) is not None


def frames_in(used: bridge.AttributeMap) -> list[str]:
    """Returns the frames that a map names in what it publishes."""
    frames = (name for assignment in used.toRos for name in _frames(assignment))
    return list(dict.fromkeys(frames))


def _frames(assignment: bridge.Assignment) -> Iterator[str]:
    if isinstance(assignment, bridge.ConstantAssignment) and _is_frame(assignment.target or ""):
        yield assignment.value or ""
    if isinstance(assignment, bridge.ListAssignment):
        for inner_assignment in assignment.assignments:
            yield from _frames(inner_assignment)


def _is_frame(path: str) -> bool:
    return path.rpartition(".")[2] in FRAME_IDS


def copied_with_names(
    scope: Scope,
    place: str,
    used: bridge.AttributeMap,
    name: str,
    names: Sequence[str],
    frames: Mapping[str, str],
    *,
    first: int,
) -> list[Command]:
    """Returns what makes a copy of a map with other names of elements or of frames.

    Test vectors have the names of elements of the original, so that such a copy is without.
    `frames`: new names by those of the original. `first`: the number of elements that are made
    before.
    """
    joints = [f"{', '.join(names)}: by these names in ROS, in this order in JAUS."] if names else []
    said = [f"The frame {old} is {new} here." for old, new in frames.items()]
    about = "\n\n".join((*joints, *said, f"Made of the ready map {name_of(used)}."))
    commands = copied(scope, place, used, name, first=first)
    if names:
        commands = [
            _with_names(change, names) if _is_map(change) else change for change in commands
        ]
    commands = [
        _with_frames(change, frames) if isinstance(change, Add) else change for change in commands
    ]
    return [
        replace(change, values={**change.values, "documentation": (about,)})
        if _is_map(change)
        else change
        for change in commands
    ]


def _is_map(command: Command) -> TypeGuard[Add]:
    return isinstance(command, Add) and command.kind == "bridge.AttributeMap"


def _with_frames(addition: AddedT, frames: Mapping[str, str]) -> AddedT:
    values = dict(addition.values)
    (path,) = values.get("target") or values.get("path") or ("",)
    if _is_frame(path) and "value" in values:
        values["value"] = tuple(frames.get(frame, frame) for frame in values["value"])
    children = tuple(_with_frames(child, frames) for child in addition.children)
    return replace(addition, values=values, children=children)


def _with_names(addition: AddedT, names: Sequence[str]) -> AddedT:
    values = dict(addition.values)
    if "names" in values:
        values["names"] = tuple(names)
    place = named_by(*values.get("target", ("",)))
    if place is not None and "value" in values:
        values["value"] = (names[place],)
    kept = [child for child in addition.children if child.feature != "vectors"]
    if addition.kind == "bridge.Stop":
        return replace(addition, children=tuple(_stopping(kept, names)))
    children = tuple(_with_names(child, names) for child in kept)
    return replace(addition, values=values, children=children)


def _stopping(values: Sequence[AddedT], names: Sequence[str]) -> Iterator[AddedT]:
    """Yields the values of a stop with an element for each of the names.

    What the original says of its first element, the copy says of each, by its name.
    """
    for value in values:
        (path,) = value.values["target"]
        before, is_element, behind = path.partition("[0]")
        if is_element:
            is_name = not _is_number(*value.values["value"])
            for at, name in enumerate(names):
                overrides = {"target": (f"{before}[{at}]{behind}",)}
                overrides |= {"value": (name,)} if is_name else {}
                yield replace(value, values={**value.values, **overrides})
        elif not _ELEMENT.search(path):
            yield value


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True

"""Copies of maps with the names of a robot: of its joints, and of its frames."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from jausml.authoring.editing.commands import Add, AddedT, Command
from jausml.authoring.proposals.bridging import copied
from jausml.authoring.proposals.elements import Scope
from jausml.language.metamodel.classes import bridge
from jausml.language.model.names import name_of
from jausml.language.project import library
from jausml.language.semantics.assignments.named_places import NamedPlaces, named_by, named_places
from jausml.language.semantics.names import words

_ELEMENT = re.compile(r"(?P<list>.*)\[(?P<index>[0-9]+)\](?P<member>.*)")
"""Path of a list element or of a member of it; of lists in lists, the inner one."""

FRAME_IDS = ("frame_id", "child_frame_id")
"""The fields that name a frame."""


def names_in(map_: bridge.AttributeMap) -> list[str]:
    """Returns the names by which a map knows the elements of lists; none for most maps."""
    names = (name for assignment in (*map_.toRos, *map_.toJaus) for name in _names(assignment))
    places = named_places(map_)
    return list(dict.fromkeys(names if places is None else places.names))


def _names(assignment: bridge.Assignment) -> Iterator[str]:
    if isinstance(assignment, bridge.ListAssignment):
        yield from assignment.names
        for inner_assignment in assignment.assignments:
            yield from _names(inner_assignment)


def names_for(map_: bridge.AttributeMap, robot_names: Sequence[str]) -> tuple[str, ...]:
    """Returns which of the names of a robot stand for those of a map, in the order of the map.

    A list takes all of them. Places such as those of a pan-tilt unit take the names with the same
    words, as `ptu_pan` for `pan`, else all names if there are as many; none if that is undecided.
    """
    places = named_places(map_)
    if places is None:
        return tuple(robot_names)
    matched = _by_words(places, robot_names)
    return matched or (tuple(robot_names) if len(robot_names) == len(places.names) else ())


def are_named(map_: bridge.AttributeMap, robot_names: Sequence[str]) -> bool:
    """Tells whether the names of a robot belong to the places of a map by their words."""
    places = named_places(map_)
    if places is None or len(robot_names) != len(places.names):
        return False
    return bool(_by_words(places, robot_names))


def _by_words(places: NamedPlaces, robot_names: Sequence[str]) -> tuple[str, ...]:
    """Returns the name for each place that has its words; none if one is in doubt."""
    words_of = {
        name: {word.lower() for word in words(name)} for name in (*robot_names, *places.names)
    }
    candidates = [
        [robot_name for robot_name in robot_names if words_of[name] <= words_of[robot_name]]
        for name in places.names
    ]
    names = tuple(name_list[0] for name_list in candidates if len(name_list) == 1)
    return names if len(set(names)) == len(places.names) else ()


def are_examples(map_: bridge.AttributeMap) -> bool:
    """Tells whether a map is of the library and names elements.

    Its names are examples: with them, every message of a robot would be dropped.
    """
    return bool(names_in(map_)) and library().document_of(map_) is not None


def frames_in(map_: bridge.AttributeMap) -> list[str]:
    """Returns the frames that a map publishes."""
    frames = (name for assignment in map_.toRos for name in _frames(assignment))
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
    map_: bridge.AttributeMap,
    name: str,
    names: Sequence[str],
    frames: Mapping[str, str],
    *,
    first: int,
) -> list[Command]:
    """Returns the commands that copy a map with other names of elements or of frames.

    Test vectors have the names of elements of the original, so that such a copy is without.
    `frames`: new names by those of the original. `first`: the number of elements that are made
    before.
    """
    joint_notes = (
        [f"{', '.join(names)}: by these names in ROS, in this order in JAUS."] if names else []
    )
    frame_notes = [f"The frame {old} is {new} here." for old, new in frames.items()]
    about = "\n\n".join((*joint_notes, *frame_notes, f"Made of the ready map {name_of(map_)}."))
    return [
        _of_robot(command, names, frames, about) if isinstance(command, Add) else command
        for command in copied(scope, place, map_, name, first=first)
    ]


def _of_robot(addition: Add, names: Sequence[str], frames: Mapping[str, str], about: str) -> Add:
    """Returns an addition with names and frames of the robot; a map gets a remark on its source."""
    is_map = addition.kind == "bridge.AttributeMap"
    if is_map and names:
        addition = _with_names(addition, names)
    addition = _with_frames(addition, frames)
    if not is_map:
        return addition
    return replace(addition, values={**addition.values, "documentation": (about,)})


def _with_frames(addition: AddedT, frames: Mapping[str, str]) -> AddedT:
    values = dict(addition.values)
    # Assignments have a target, values of vectors a path.
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
    """Yields the values of a stop, those of list elements for each of the names."""
    elements: dict[tuple[str, str], dict[int, AddedT]] = {}
    for value in values:
        (path,) = value.values["target"]
        element = _ELEMENT.fullmatch(path)
        if element is None:
            yield value
        else:
            known = elements.setdefault((element["list"], element["member"]), {})
            known[int(element["index"])] = value
    for index, name in enumerate(names):
        for (list_path, member), originals in elements.items():
            path = f"{list_path}[{index}]{member}"
            texts = {at: original.values["value"][0] for at, original in originals.items()}
            text = _text_at(index, texts) if named_by(path) is None else name
            original = next(iter(originals.values()))
            overrides = {"target": (path,), "value": (text,)}
            yield replace(original, values={**original.values, **overrides})


def _text_at(index: int, texts: Mapping[int, str]) -> str:
    """Returns the value of an element in the stop of a copy, by the texts of the original.

    A copy may have more elements: numbers that count them, as StabilizerID does, go on, and else
    the last one has the value of all further ones.
    """
    if index in texts:
        return texts[index]
    end = max(texts)
    first = int(texts[end]) - end if texts[end].isdecimal() else 0
    counts = len(texts) > 1 and all(text == str(first + at) for at, text in texts.items())
    return str(first + index) if counts else texts[end]

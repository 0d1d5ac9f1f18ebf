"""What completes a new map: the time and the frames of a header, and what is ignored on purpose."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import Child
from jausml.authoring.proposals.mapping.filling import FEATURES, filled_paths, is_filled
from jausml.authoring.proposals.mapping.members import leaves
from jausml.authoring.proposals.mapping.trial import judge
from jausml.language.metamodel.classes import jaus
from jausml.language.semantics.frame_names import FLU, UP
from jausml.language.semantics.jaus_paths import JausPlace
from jausml.language.semantics.paths import outer_scope, parse_path

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from jausml.authoring.proposals.elements import Scope
    from jausml.authoring.proposals.mapping.members import Member
    from jausml.language.metamodel.classes import bridge

_STAMP = "header.stamp"
_FRAME_ID, _CHILD_FRAME_ID = "header.frame_id", "child_frame_id"
_FRAMES = {UP: "odom", FLU: "base_link"}
"""Frames of REP 105 by what the axes of a ROS type are; the outer one comes first."""


@dataclass(frozen=True)
class Bare:
    """A part of the target message that nothing fills, as large as can be."""

    path: str
    leaves: tuple[Member, ...]
    is_required: bool


def completed(
    scope: Scope, used: bridge.AttributeMap, *, to_ros: bool, ignores: bool
) -> list[Child]:
    """Returns what completes a direction of a map."""
    feature = FEATURES[to_ros]
    made = list(_header(used)) if to_ros else []
    named = {parse_path(each.values["target"][0]) for each in made}
    ignored = [
        Child(feature, "bridge.Ignore", {"target": (each.path,)})
        for each in bare(used, named, to_ros=to_ros)
        if ignores and not each.is_required
    ]
    judged = judge(scope.model.metamodels, used, [*made, *ignored])
    return [each.assignment for each in judged if each.is_possible]


def bare(
    used: bridge.AttributeMap, filled: Iterable[tuple[str, ...]] = (), *, to_ros: bool
) -> list[Bare]:
    """Returns what nothing fills in a direction, wholes without their parts.

    Options that are not chosen are left out.
    """
    taken = [*filled_paths(used, to_ros=to_ros), *filled]
    found: dict[str, list[Member]] = {}
    for each in leaves(used, is_jaus=not to_ros):
        if not is_filled(each.outer or each.path, taken):
            steps = parse_path(each.outer or each.path)
            found.setdefault(_widest(steps, taken), []).append(each)
    return list(_bare(used, found.items(), to_ros=to_ros))


def _bare(
    used: bridge.AttributeMap, found: Iterable[tuple[str, Sequence[Member]]], *, to_ros: bool
) -> Iterator[Bare]:
    target = outer_scope(used, to_ros=to_ros).target
    for path, inner in found:
        place, before = target.follow(path), target.follow(path.rpartition(".")[0] or ".")
        around = before.field if isinstance(before, JausPlace) else None
        if isinstance(around, jaus.Variant | jaus.VariableField):
            continue
        is_required = isinstance(place, JausPlace) and not place.optional
        is_bit = isinstance(around, jaus.BitField)
        yield Bare(path, tuple(inner), is_required and not is_bit)


def _widest(steps: Sequence[str], taken: Sequence[tuple[str, ...]]) -> str:
    """Returns the shortest beginning of a path below which nothing is filled."""
    for length in range(1, len(steps) + 1):
        if not any(each[:length] == tuple(steps[:length]) for each in taken):
            return ".".join(steps[:length])
    return ".".join(steps)


def _header(used: bridge.AttributeMap) -> Iterator[Child]:
    """Yields the time and the frames of a ROS message, as far as nothing fills them."""
    filled = filled_paths(used, to_ros=True)
    members = leaves(used, is_jaus=False)
    known = {each.path for each in members if not is_filled(each.path, filled)}
    if _STAMP in known:
        yield Child(FEATURES[True], "bridge.ClockAssignment", {"target": (_STAMP,)})
    frames = {each.attribute.frame for each in members}
    names = [name for frame, name in _FRAMES.items() if frame in frames]
    for path, name in zip((_FRAME_ID, _CHILD_FRAME_ID), names, strict=False):
        if path in known:
            values = {"target": (path,), "value": (name,)}
            yield Child(FEATURES[True], "bridge.ConstantAssignment", values)

"""Attribute paths of a text, followed to the fields of the library."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from jausml.language.metamodel.classes import jaus, ros
from jausml.language.semantics.paths.attributes import UNSTATED, Attribute
from jausml.language.semantics.paths.jaus_paths import JausPlace, message_place
from jausml.language.semantics.paths.ros_paths import RosPlace
from jausml.language.text.tree import Assignment, Direction, Element, Feature, Name, Vector

if TYPE_CHECKING:
    from pathlib import Path

    from jausml.authoring.editor.context import Context
    from jausml.authoring.editor.workbench import Workbench
    from jausml.language.semantics.paths.attributes import Part
    from jausml.language.semantics.paths.scopes import PathPlace


MessageT = TypeVar("MessageT", "jaus.MessageDef", "ros.MessageType")


@dataclass(frozen=True, slots=True)
class Sides:
    """Starts of the paths of assignments; None where a message is not known."""

    source: PathPlace | None
    target: PathPlace | None
    joins: dict[str, PathPlace]

    def follow(self, path: str, *, is_source: bool) -> PathPlace | None:
        """Returns where a path leads to; None when it leads nowhere."""
        first, _, rest = path.partition(".")
        if is_source and first in self.joins:
            return _follow(self.joins[first], rest or ".")
        return _follow(self.source if is_source else self.target, path)


def sides_at(bench: Workbench, path: Path, context: Context) -> Sides:
    """Returns where the paths at a place start."""
    message = _at_end(bench, path, context, jaus.MessageDef)
    kind = _at_end(bench, path, context, ros.MessageType)
    from_jaus = message_place(message) if message is not None else None
    from_ros = RosPlace(type=kind) if kind is not None else None
    way = context.around(Direction) or context.around(Vector)
    if isinstance(way, (Direction, Vector)) and way.to_ros:
        joins = _joins(bench, path, context, "report_join")
        return _nested(Sides(from_jaus, from_ros, joins), context)
    return _nested(Sides(from_ros, from_jaus, _joins(bench, path, context, "join")), context)


def _at_end(
    bench: Workbench, path: Path, context: Context, kind: type[MessageT]
) -> MessageT | None:
    end = context.end_of_map(is_jaus=kind is jaus.MessageDef)
    return None if end is None else bench.find(path, kind, end.type.text)


def fields_of(place: PathPlace | None) -> list[Part]:
    """Returns the fields that the next step of a path can name."""
    if isinstance(place, JausPlace):
        return [each for each in place.members() or [] if each.name]
    if place is not None and place.type is not None and not place.is_array:
        return list(place.type.fields)
    return []


def facts(attribute: Attribute) -> list[str]:
    """Returns what is known of an attribute: kind, unit, range, resolution, axes, presence."""
    found = [attribute.name]
    if attribute.units:
        found.append(f"unit {attribute.units}")
    if attribute.lower is not None and attribute.upper is not None:
        found.append(f"{attribute.lower:.12g} to {attribute.upper:.12g}")
    if attribute.step is not None and not attribute.integral:
        found.append(f"steps of {attribute.step:.3g}")
    if attribute.frame != UNSTATED:
        found.append(f"frame {attribute.frame}")
    if attribute.optional:
        found.append("may be left out")
    return found


def _nested(sides: Sides, context: Context) -> Sides:
    """Returns where paths start in the blocks of list assignments around a place."""
    for level in context.levels:
        if isinstance(level.item, Assignment):
            first = level.item.sources[0]
            source = _follow(sides.source, first.text) if isinstance(first, Name) else None
            target = _follow(sides.target, level.item.targets[0].text)
            sides = Sides(_element(source), _element(target), {})
    return sides


def _element(place: PathPlace | None) -> PathPlace | None:
    is_list = isinstance(place, RosPlace) and place.is_array
    is_list = is_list or (
        isinstance(place, JausPlace) and isinstance(place.field, (jaus.List, jaus.Array))
    )
    return place.element() if place is not None and is_list else None


def _follow(place: PathPlace | None, path: str) -> PathPlace | None:
    found = place.follow(path) if place is not None else None
    return found if isinstance(found, (JausPlace, RosPlace)) else None


def _joins(bench: Workbench, path: Path, context: Context, keyword: str) -> dict[str, PathPlace]:
    joins: dict[str, PathPlace] = {}
    for item in context.map.items if context.map is not None else []:
        if isinstance(item, Element) and item.name is not None and _keyword(item) == keyword:
            for feature in item.items:
                place = _joined(bench, path, feature) if isinstance(feature, Feature) else None
                if place is not None:
                    joins[item.name.text] = place
    return joins


def _joined(bench: Workbench, path: Path, feature: Feature) -> PathPlace | None:
    """Returns where the paths of a join start, if a feature says it."""
    value = feature.values[0]
    name = value.text if isinstance(value, Name) else ""
    if name and feature.name.text == "type":
        type_ = bench.find(path, ros.MessageType, name)
        return RosPlace(type=type_) if type_ is not None else None
    if name and feature.name.text == "message":
        message = bench.find(path, jaus.MessageDef, name)
        return message_place(message) if message is not None else None
    return None


def _keyword(element: Element) -> str:
    return element.keyword.text if element.keyword is not None else ""

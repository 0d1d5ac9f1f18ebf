"""Members of messages as rows: names, types, units, ranges and axes, as far as maps use them."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from jausml.language.metamodel.classes import jaus, ros
from jausml.language.semantics.paths.attributes import UNSTATED, Attribute, Part
from jausml.language.semantics.paths.jaus_paths import JausPlace, message_place
from jausml.language.semantics.paths.markers import in_words
from jausml.language.semantics.paths.ros_paths import RosPlace, ros_name
from jausml.views.diagrams.graph import Port
from jausml.views.diagrams.views.context import Context, details, number

DEEPEST = 12
"""Members around each other; types that hold themselves end here."""

_MANY_VALUES = 1e15  # limits from here on are those of the type, and say nothing


@dataclass(frozen=True)
class Member:
    """A member of a message.

    `path`: names joined by dots; an element of a list has the path of the list.
    """

    path: str
    port: Port
    inner: tuple[Member, ...] = ()


def plain(path: str) -> str:
    """Returns a path of an assignment as members have it: without indices."""
    return re.sub(r"(\[\d*\])+", "", path)


def jaus_members(context: Context, message: jaus.MessageDef) -> tuple[Member, ...]:
    """Returns the members of a JAUS message."""
    return tuple(_members(context, message_place(message), "", 0))


def ros_members(context: Context, kind: ros.MessageType) -> tuple[Member, ...]:
    """Returns the members of a ROS message."""
    return tuple(_members(context, RosPlace(type=kind), "", 0))


def rows(members: tuple[Member, ...], marks: Mapping[str, str]) -> Iterator[Port]:
    """Yields the rows of members; of what no assignment fills or reads only the outermost."""
    outer = {path[:at] for path in marks for at, sign in enumerate(path) if sign == "."}
    yield from _rows(members, marks, outer)


def _rows(
    members: tuple[Member, ...], marks: Mapping[str, str], outer: Collection[str]
) -> Iterator[Port]:
    for member in members:
        within = member.path in outer
        if member.path in marks:
            yield replace(member.port, mark=marks[member.path] or member.port.mark)
        elif not within:
            mark = "required, unmapped" if member.port.mark == "required" else "unmapped"
            yield replace(member.port, mark=mark)
        else:
            yield member.port
        if within:
            yield from _rows(member.inner, marks, outer)


def paths_of(members: tuple[Member, ...]) -> Iterator[str]:
    """Yields the paths of members and of what they hold."""
    for member in members:
        yield member.path
        yield from paths_of(member.inner)


def _members(
    context: Context, place: JausPlace | RosPlace, before: str, depth: int
) -> Iterator[Member]:
    element: JausPlace | RosPlace | None
    named: Sequence[Part]
    if isinstance(place, JausPlace):
        element, named = place.element(), place.members() or ()
    else:
        element = place.element() if place.is_array else None
        named = place.type.fields if place.type is not None else ()
    if element is not None:
        yield from _members(context, element, before, depth)
        return
    for part in named if depth < DEEPEST else ():
        member_place = place.step(part.name) if part.name else None
        if not isinstance(member_place, JausPlace | RosPlace):
            continue
        path = f"{before}.{part.name}" if before else str(part.name)
        attribute = member_place.attribute()
        # What nothing holds around it must be there, unless a presence vector tells.
        is_needed = isinstance(place, JausPlace) and depth == 0
        mark = "optional" if attribute.optional else "required" if is_needed else ""
        port = Port(
            path,
            str(part.name),
            _note(_type(member_place.field), attribute),
            mark,
            depth,
            details=_details(part, attribute),
            findings=context.findings(part),
            element=context.reference(part),
        )
        yield Member(path, port, tuple(_members(context, member_place, path, depth + 1)))


def _note(kind: str, attribute: Attribute) -> str:
    unit = attribute.units if attribute.units != "one" else ""
    return " · ".join(part for part in (kind, unit, _range(attribute), _axes(attribute)) if part)


def _details(part: Part, attribute: Attribute) -> tuple[tuple[str, str], ...]:
    return details(
        part,
        unit=attribute.units,
        range=_range(attribute),
        axes=_axes(attribute),
        values=", ".join(f"{value} {name}" for name, value in attribute.constants),
        markers="; ".join(in_words(marker) for marker in getattr(part, "markers", ())),
    )


def _axes(attribute: Attribute) -> str:
    return attribute.frame if attribute.frame != UNSTATED and attribute.units else ""


def _range(attribute: Attribute) -> str:
    lower, upper = attribute.lower, attribute.upper
    if attribute.integral and isinstance(attribute.field, ros.PrimitiveField):
        return ""
    if lower is None or upper is None or max(-lower, upper) > _MANY_VALUES:
        return ""
    if attribute.named or attribute.kind != "number":
        return ""
    return f"{number(float(f'{lower:.7g}'))}..{number(float(f'{upper:.7g}'))}"


def _type(field: Part | None) -> str:
    match field:
        case ros.Field():
            return _ros_type(field)
        case jaus.FixedField():
            scaled = "scaled " if field.scale is not None else ""
            return f"{scaled}{field.type.name}"
        case jaus.Alternative():
            return str(field.type.name)
        case jaus.BitField():
            return f"bits of {field.type.name}"
        case jaus.SubField():
            return f"bits {field.lowBit}-{field.highBit}"
        case jaus.Array():
            return "array " + "x".join(map(str, field.dimensions))
        case jaus.FixedLengthString() | jaus.VariableLengthString():
            return "text"
        case None:
            return ""
        case _:
            return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", field.eClass.name).lower()


def _ros_type(field: ros.Field) -> str:
    kind = "?"
    if isinstance(field, ros.PrimitiveField):
        kind = str(field.type.name)
    elif isinstance(field, ros.MessageField) and field.messageType is not None:
        kind = ros_name(field.messageType).rpartition("/")[2]
    match field.arrayKind.name:
        case "single":
            return kind
        case "fixedArray":
            return f"{kind}[{field.arraySize}]"
        case _:
            return f"{kind}[]"

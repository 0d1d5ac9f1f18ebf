"""Attribute paths through the bodies of JAUS messages."""

from __future__ import annotations

import math
import re
from collections.abc import Container, Sequence
from dataclasses import dataclass, replace

from jausml.language import wire
from jausml.language.metamodel.classes import jaus
from jausml.language.semantics.jaus.fields import attributes, class_name, is_group
from jausml.language.semantics.paths.attributes import (
    COUNT,
    EMPTY,
    LIST,
    NUMBER,
    OCTETS,
    TEXT,
    TIME_STAMP,
    UNSTATED,
    Attribute,
    JausPart,
    PathFault,
    count_of_elements,
    nearest_name,
)
from jausml.language.semantics.subject import remembered

_MOST_BITS = wire.UNSIGNED["uint64"].bits
_NAMES = {"BitField": "bit field", "VariableField": "variable field"}


@dataclass(frozen=True, slots=True)
class JausPlace:
    """A place in a JAUS message, from which paths go on.

    Attributes:
        where: The place in words, with which errors begin, e.g. `'Latitude'`.
        message: The message, at the start of its paths alone; `field` is None there.
        field: What stands there, references resolved: a field, a sub-field, an alternative or a
            format.
        may_lack: Whether a message may have no value here: a field on the way is left out, a list
            is shorter, or another option or alternative was chosen.
        is_count: Whether it is the number of elements of the list.
        label: Name of the field, or of the nearest one around it that has one.
    """

    where: str
    message: jaus.MessageDef | None = None
    field: JausPart | None = None
    is_count: bool = False
    units: str = ""
    frame: str = UNSTATED
    label: str = ""
    optional: bool = False
    may_lack: bool = False

    def __hash__(self) -> int:
        return hash((self.message, self.field, self.label))

    def follow(self, path: str) -> JausPlace | PathFault | None:
        """Returns the place that a path leads to; None when a part of it was not read."""
        place: JausPlace | PathFault | None = self
        for step in [] if path == "." else path.split("."):
            if not isinstance(place, JausPlace):
                return place
            place = place.step(step)
        return place

    def element(self) -> JausPlace | None:
        """Returns an element of the list or array at this place."""
        if not isinstance(self.field, jaus.List | jaus.Array):
            return None
        element = self._inside(self.field.element, f"an element of {self.where}")
        return replace(element, may_lack=False) if element is not None else None

    def members(self) -> Sequence[JausPart] | None:
        """Returns the members that can be named here; None for a place without members."""
        return _members(self._holder())

    def attribute(self) -> Attribute:
        """Returns the attribute of the place."""
        if self.field is None:
            return Attribute("", "a message")
        if self.is_count:
            return count_of_elements(self.label)
        value = _value(self.field)
        return replace(
            value,
            optional=self.optional,
            may_lack=self.may_lack,
            says_unknown=self.optional or (value.kind in EMPTY and value.count is None),
            units=self.units,
            frame=self.frame,
            label=self.label,
            field=self.field,
        )

    def step(self, step: str) -> JausPlace | PathFault | None:
        """Returns the place behind one name, indices included."""
        fields = self.members()
        if step == COUNT and self._is_many() and not self.is_count:
            return replace(self, is_count=True)
        if fields is None:
            hint = f"name one element: {self.label}[0]" if self._is_many() else ""
            return PathFault(f"{self.where} has no attributes", hint)
        named = _by_name(self._holder())
        name, indices = _split(step, named)
        field = named.get(name)
        if field is None:
            message = f"{self.where} has no attribute '{step}'"
            return PathFault(message, nearest_name(name, fields))
        place = self._inside(field, f"'{step}'")
        return place.indexed(indices) if place is not None else None

    def indexed(self, indices: list[int]) -> JausPlace | PathFault | None:
        """Returns the element that indices name."""
        if not indices:
            return self
        if isinstance(self.field, jaus.List):
            if len(indices) > 1:
                return PathFault(f"{self.where} has one dimension")
            limits = [_most_elements(self.field)]
        elif isinstance(self.field, jaus.Array):
            limits = list(self.field.dimensions)
            if len(indices) != len(limits):
                return PathFault(f"{self.where} has {len(limits)} dimensions")
        else:
            return PathFault(f"{self.where} is no list and no array")
        for index, limit in zip(indices, limits, strict=True):
            if index >= limit:
                message = f"'{self.label}' has at most {limit} elements, counted from 0"
                return PathFault(f"{message}: no [{index}]")
        element = self.element()
        if element is None:
            return None
        may_lack = self.may_lack or isinstance(self.field, jaus.List)
        return replace(element, where=self.where, optional=False, may_lack=may_lack)

    def _inside(self, part: JausPart | None, where: str) -> JausPlace | None:
        if isinstance(part, jaus.SubField):
            return replace(self._part(part, where), label=part.name or self.label)
        if isinstance(part, jaus.Alternative | jaus.Format):
            return replace(self._part(part, where), optional=self.optional, may_lack=True)
        target = wire.target_of(part)
        if part is None or target is None:
            return None
        is_choice = isinstance(self.field, jaus.Variant) and len(self.field.options) > 1
        frames = (part.frame.name, target.frame.name, self.frame)
        return JausPlace(
            where,
            field=target,
            units=_own_units(target) or self.units,
            frame=next((frame for frame in frames if frame != UNSTATED), UNSTATED),
            label=part.name or self.label,
            optional=part.optional,
            may_lack=self.may_lack or part.optional or is_choice,
        )

    def _part(self, part: JausPart, where: str) -> JausPlace:
        return JausPlace(
            where,
            field=part,
            units=_own_units(part) or self.units,
            frame=self.frame,
            label=self.label,
            may_lack=self.may_lack,
        )

    def _holder(self) -> jaus.MessageDef | JausPart | None:
        return self.field if self.message is None else self.message

    def _is_many(self) -> bool:
        return isinstance(self.field, (jaus.List, jaus.Array))


def _own_units(part: JausPart) -> str | None:
    return part.units if isinstance(part, (jaus.FixedField, jaus.Alternative)) else None


@remembered
def message_place(message: jaus.MessageDef) -> JausPlace:
    """Returns the place from which the paths of a JAUS message start."""
    frame = UNSTATED
    body = wire.target_of(message.body)
    if is_group(body):
        stated = [field.frame.name for field in (message.body, body) if field is not None]
        frame = next((name for name in stated if name != UNSTATED), UNSTATED)
    return JausPlace(f"message {message.name}", message=message, frame=frame)


def _members(holder: jaus.MessageDef | JausPart | None) -> Sequence[JausPart] | None:
    match holder:
        case jaus.MessageDef():
            return attributes(holder)
        case jaus.BitField():
            return holder.subFields
        case jaus.VariableField():
            return holder.alternatives
        case jaus.VariableFormatField():
            return holder.formats
        case jaus.Variant():
            return holder.options
        case jaus.Record() | jaus.Sequence():
            return holder.fields
    return None


@remembered
def _by_name(holder: jaus.MessageDef | JausPart | None) -> dict[str | None, JausPart]:
    """Returns the members of a message or field, of several with one name the first."""
    return {member.name: member for member in reversed(_members(holder) or ())}


def _split(step: str, known: Container[str | None]) -> tuple[str, list[int]]:
    """Splits `name[3]`; a name that holds brackets itself wins."""
    match = re.fullmatch(r"(.*?)((?:\[[0-9]{1,9}\])+)", step, re.DOTALL)
    if match is None or step in known:
        return step, []
    return match[1], [int(index) for index in re.findall("[0-9]+", match[2])]


def _most_elements(field: jaus.List) -> int:
    count = wire.INTEGERS.get(field.countType.name)
    return field.maximumCount or (count.upper if count else 0)


def _value(part: JausPart) -> Attribute:
    try:
        return _number(part) if isinstance(part, jaus.SubField) else _field(part)
    except wire.LayoutError:  # which a rule tells
        return Attribute(NUMBER, "a number")


def _number(part: jaus.SubField) -> Attribute:
    low, high = part.lowBit, part.highBit
    mask = (1 << high - low + 1) - 1 if 0 <= low <= high < _MOST_BITS else 0
    return _integer(wire.legal_integers(part.values, 0, mask), 0, mask)


def _field(part: jaus.Field | jaus.Alternative | jaus.Format) -> Attribute:
    match part:
        case jaus.Format():
            return Attribute(OCTETS, "octets of a format")
        case jaus.List():
            return Attribute(LIST, "a list")
        case jaus.Array():
            return Attribute(LIST, "an array", count=math.prod(part.dimensions))
    return _leaf(part)


def _leaf(part: jaus.Field | jaus.Alternative) -> Attribute:
    match wire.leaf_of(part):
        case wire.Integer() as number:
            return _integer(number.legal, number.type.lower, number.type.upper)
        case wire.Scaled() as number:
            lower, upper = number.lower, number.upper
            return Attribute(NUMBER, "a number", lower=lower, upper=upper, step=number.step)
        case wire.Real() as number:
            legal = tuple((interval.lower, interval.upper) for interval in number.legal.intervals)
            is_single = number.type.name == "float32"
            return Attribute(NUMBER, "a number", values=legal, is_single=is_single)
        case wire.BitField(is_time_stamp=True):
            return Attribute(TIME_STAMP, "a JAUS TimeStamp")
        case wire.FixedText(length=length):
            return Attribute(TEXT, "text", length=length, encoding="latin-1")
        case wire.Text(count=count):
            return Attribute(TEXT, "text", length=count.upper, encoding="latin-1")
        case wire.Octets():
            return Attribute(OCTETS, "a field of octets", carries=True)
        case wire.FormattedOctets() as octets:
            carries = any(map(octets.holds_message, octets.names))
            return Attribute("", "a variable format field", carries=carries)
    kind = class_name(part)
    name = _NAMES.get(kind, re.sub("(?<=[a-z])(?=[A-Z])", " ", kind).lower())
    return Attribute("", f"a {name}")


def _integer(legal: wire.LegalIntegers, lower: int, upper: int) -> Attribute:
    return Attribute(
        NUMBER,
        "a number",
        integral=True,
        lower=lower + legal.offset,
        upper=upper + legal.offset,
        step=1,
        values=legal.ranges if legal.is_stated else (),
        named=bool(legal.listed),
        constants=tuple((value.name, str(value.value)) for value in legal.listed if value.name),
    )

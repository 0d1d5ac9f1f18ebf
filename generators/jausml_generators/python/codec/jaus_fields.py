"""Paths into JAUS messages: what stands at the end of `Velocity_X` or `TimeStamp.Day`.

A path starts at the flattened body of a message or at an element of a list. It goes on by the names
of members, of the options of variants and of the alternatives of variable fields; `[2]` behind a
name is an element of a list or array.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass
from typing import Any

from jausml.language.wire import JAUS_MESSAGE
from jausml_generators.bridge.translation.expressions import (
    BITS,
    FORMAT,
    INTEGER,
    LIST,
    OCTETS,
    OTHER,
    REAL,
    TEXT,
    Constant,
    Expression,
    New,
    NewList,
)
from jausml_generators.bridge.translation.places import (
    Chosen,
    Equal,
    IsOption,
    Local,
    Longer,
    Named,
    PathError,
    Place,
    Requirement,
    There,
)
from jausml_generators.python.codec.classes import (
    Alternative,
    BitFieldClass,
    ContainerClass,
    Format,
    SubField,
    VariableFieldClass,
)
from jausml_generators.python.codec.members import (
    ArrayValue,
    ListValue,
    Member,
    PartValue,
    VariantValue,
)
from jausml_generators.python.codec.messages import MessageView
from jausml_generators.python.codec.scalars import Bits, Blob, Fixed

Limits = tuple[float, float]
Value = Fixed | Blob | PartValue | VariantValue | ListValue | ArrayValue
_KINDS = {"float": REAL, "int": INTEGER, "str": TEXT, "bytes": OCTETS}
_UNLIMITED = (-math.inf, math.inf)
_INDEXED = re.compile(r"(?P<name>.*?)(?P<indices>(?:\[[0-9]{1,9}\])+)", re.DOTALL)


@dataclass(frozen=True)
class JausStart:
    """Where paths start.

    Attributes:
        root: The message or element.
        names: Gives the variable for an element of a list at a place; None for none.
        value: The element of a list; None for the body of the message.
        label: Path of the list in the message, for counters.
    """

    root: str | Local
    value: Value | None = None
    label: str = ""
    names: Callable[[Place], Local] | None = None


@dataclass(frozen=True)
class JausField:
    """The end of a path.

    Attributes:
        path: The path as counters and errors name it.
        place: Where it stands, by attributes of Python; of a variable field, the whole.
        conditions: What must hold for the value to be there.
        containers: Place and value of each container and element on the way that a message lacks as
            it is made.
        kind: `real`, `integer`, `text`, `octets`, `bits`, `list`, `format` or `other`.
        limits: Least and greatest value of a number, fewest and most characters of a text, bytes
            of octets or elements of a list; infinite when nothing limits it.
        brought: Least and greatest integer that the wire can bring, legal or not.
        values: Legal ranges of an integer with named values or gaps; empty for others.
        listed: Names and values of single legal integers, names and indices of formats.
        is_float: Whether a number is a float in Python, which integers in variable fields may be.
        is_scaled: Whether a real stands on the wire as an integer, and so is finite.
        is_optional: Whether the end itself may be left out.
        units: Unit of the value; empty when the model has none.
        class_name: Class of a bit field, variable field or variable format field.
        sub_fields: Python names of the parts of a bit field.
        index: Index that chooses the alternative of a variable field, or the format of a variable
            format field; None for others.
        element: What a list holds; None for others.
    """

    path: str
    place: Place
    conditions: tuple[Requirement, ...]
    containers: tuple[tuple[Place, Expression], ...]
    kind: str
    limits: Limits = _UNLIMITED
    brought: Limits | None = None
    values: tuple[tuple[int, int], ...] = ()
    listed: tuple[tuple[str, int], ...] = ()
    is_float: bool = False
    is_scaled: bool = False
    is_optional: bool = False
    units: str = ""
    class_name: str = ""
    sub_fields: tuple[str, ...] = ()
    index: int | None = None
    element: Value | None = None

    @property
    def is_identifier(self) -> bool:
        """Whether its numbers identify or count: integers without a scale and without a unit."""
        return self.kind == INTEGER and not self.units

    @property
    def message_format(self) -> int:
        """Index of the format that is a JAUS message, of a variable format field with such."""
        return dict(self.listed)[JAUS_MESSAGE]

    @property
    def value(self) -> Place:
        """Where the value itself stands, which is within a variable field or format field."""
        if self.index is None:
            return self.place
        return self.place.at("data" if self.kind == OCTETS else "value")


def jaus_field(message: MessageView, path: str, start: JausStart | None = None) -> JausField:
    """Follows a path through the body of a message.

    Args:
        message: The message.
        path: JAUS names joined by dots, relative to the start; `.` for the start itself.
        start: Where the path starts; the body of the message `source` when it is not given.
    """
    walk = _Walk(message, start or JausStart("source"), path)
    for step in [] if path == "." else path.split("."):
        walk.step(step)
    return walk.end()


class _Walk:
    """A walk along one path."""

    def __init__(self, message: MessageView, start: JausStart, path: str) -> None:
        self._message = message
        self._path = path
        self._start = start
        self._place = Place(start.root)
        self._at: Value | None = start.value
        self._end: Member | SubField | Alternative | Format | None = None
        self._holder = ""
        self._is_optional = False
        self._conditions: list[Requirement] = []
        self._containers: list[tuple[Place, Expression]] = []
        self._is_made = True
        self._unwrap()

    # -- steps -----------------------------------------------------------------------------------

    def step(self, step: str) -> None:
        """Goes on by one step."""
        name, indices = self._split(step)
        if isinstance(self._at, VariantValue):
            self._choose(self._at, name)
        else:
            self._enter(name)
        self._unwrap()
        for index in self._flat(indices):
            self._index(index)
            self._unwrap()

    def _split(self, step: str) -> tuple[str, list[int]]:
        step_match = _INDEXED.fullmatch(step)
        if step_match is None or step in self._names():
            return step, []
        return step_match["name"], [
            int(match) for match in re.findall("[0-9]+", step_match["indices"])
        ]

    def _names(self) -> Container[str]:
        if isinstance(self._at, VariantValue):
            return {option.part.jaus_name for option in self._at.options}
        return self._members()

    def _members(self) -> Mapping[str, Member | SubField | Alternative | Format]:
        at = self._at
        if at is None and self._end is None:
            return self._message.body.by_jaus_name
        if isinstance(at, Bits):
            return {sub_field.jaus_name: sub_field for sub_field in self._sub_fields(at)}
        if isinstance(at, PartValue) and isinstance(at.part, VariableFieldClass):
            return {alternative.jaus_name: alternative for alternative in at.part.alternatives}
        if isinstance(at, PartValue) and isinstance(at.part, ContainerClass):
            if at.part.formats:
                return {data_format.jaus_name: data_format for data_format in at.part.formats}
            return at.part.by_jaus_name
        return {}

    def _sub_fields(self, bits: Bits) -> tuple[SubField, ...]:
        return next(
            item.sub_fields
            for item in self._message.nested
            if isinstance(item, BitFieldClass) and item.path == bits.python_type
        )

    def _enter(self, name: str) -> None:
        """Goes on to a member, a part of a bit field, an alternative or a format."""
        member = self._members().get(name)
        if member is None:
            raise PathError(f"{self._message.jaus_name} has no field '{self._path}'")
        if isinstance(member, Alternative | Format):
            is_format = isinstance(member, Format)
            index = self._place.at("format_index")
            self._conditions.append(
                Equal(index, member.index) if is_format else Chosen(self._place, member.index)
            )
            self._holder = getattr(self._at, "python_type", "")
            self._end, self._at = member, member.value
            return
        self._make()
        self._place = self._place.at(member.attribute)
        if isinstance(member, Member) and member.is_optional:
            self._conditions.append(There(self._place))
        self._end, self._at = member, member.value
        self._is_optional = isinstance(member, Member) and member.is_optional
        self._is_made = not self._is_optional

    def _choose(self, variant: VariantValue, name: str) -> None:
        """Goes on to an option of a variant, whose members then follow."""
        option = next(
            (part_value for part_value in variant.options if part_value.part.jaus_name == name),
            None,
        )
        if option is None:
            raise PathError(f"{self._message.jaus_name} has no field '{self._path}'")
        if len(variant.options) > 1:
            self._conditions.append(IsOption(self._place, option.python_type))
            self._is_made = False
        self._at = option

    def _flat(self, indices: list[int]) -> list[int]:
        """Returns the indices of an array as the one of its list."""
        if not isinstance(self._at, ArrayValue) or len(indices) != len(self._at.dimensions):
            return indices
        flat = 0
        for index, size in zip(indices, self._at.dimensions, strict=True):
            flat = flat * size + index
        return [flat]

    def _index(self, index: int) -> None:
        at = self._at
        if isinstance(at, ListValue):
            self._conditions.append(Longer(self._place, index))
            if self._is_optional:
                self._containers.append((self._place, NewList()))
        elif not isinstance(at, ArrayValue) or index >= at.count:
            raise PathError(f"{self._message.jaus_name} has no field '{self._path}'")
        elif self._is_optional:
            self._containers.append((self._place, NewList(_element_of(at), at.count)))
        self._at, self._place = at.element, self._place.at(index)
        if isinstance(at, ListValue) and self._start.names is not None:
            local = self._start.names(self._place)
            self._conditions.append(Named(local, self._place))
            self._place = Place(local)
        self._is_made, self._is_optional = isinstance(at, ArrayValue), False

    def _unwrap(self) -> None:
        """Goes through classes that only give a class to a list, array, variant or field."""
        at = self._at
        while isinstance(at, PartValue):
            if not isinstance(at.part, ContainerClass) or not at.part.is_wrapper:
                return
            self._make()
            (member,) = at.part.members
            self._place = self._place.at(member.attribute)
            self._end, at = member, member.value
            self._at, self._is_made = at, True

    def _make(self) -> None:
        """Notes that the value at the present place must be made before its parts."""
        if not self._is_made and isinstance(self._at, Bits | PartValue):
            self._containers.append((self._place, New(self._at.python_type)))
            self._is_made = True

    def _make_last(self) -> None:
        """Notes that the element at the end must be made before it gets its value."""
        steps = self._place.steps
        if not (steps and isinstance(steps[-1], int)) or self._is_made:
            return
        if isinstance(self._at, Fixed | Blob) and not isinstance(self._at, Bits):
            self._containers.append((self._place, default_of(self._at)))
        else:
            self._make()

    # -- the end ---------------------------------------------------------------------------------

    def end(self) -> JausField:
        """Returns where the walk has led."""
        self._make_last()
        end = self._end
        label = ".".join(
            segment for segment in (self._start.label, self._path) if segment not in ("", ".")
        )
        return JausField(
            label,
            self._place,
            tuple(self._conditions),
            tuple(self._containers),
            is_optional=self._is_optional,
            units=end.units if isinstance(end, Member | Alternative) else "",
            **self._facts(),
        )

    def _facts(self) -> dict[str, Any]:
        at = self._at
        if isinstance(at, Bits):
            sub_fields = tuple(sub.attribute for sub in self._sub_fields(at))
            return {"kind": BITS, "class_name": at.python_type, "sub_fields": sub_fields}
        if isinstance(at, Fixed):
            return self._number(at)
        if isinstance(at, Blob):
            facts: dict[str, Any] = {"kind": TEXT if at.is_text else OCTETS}
            if isinstance(self._end, Format):
                facts |= {"index": self._end.index, "class_name": self._holder}
            return facts | {"limits": (at.lower, at.upper)}
        if isinstance(at, ListValue):
            return {"kind": LIST, "limits": (0, at.upper), "element": at.element}
        if isinstance(at, ArrayValue):
            return {"kind": LIST, "limits": (at.count, at.count), "element": at.element}
        if isinstance(at, PartValue) and isinstance(at.part, ContainerClass) and at.part.formats:
            formats = tuple((known.jaus_name, known.index) for known in at.part.formats)
            return {"kind": FORMAT, "class_name": at.python_type, "listed": formats}
        return {"kind": OTHER}

    def _number(self, value: Fixed) -> dict[str, Any]:
        end = self._end
        kind = _KINDS[value.python_type]
        facts: dict[str, Any] = {}
        if isinstance(end, Alternative):
            facts = {"index": end.index, "class_name": self._holder}
            # The number of a variable field is a float when another alternative is one.
            kind = INTEGER if value.check.startswith(("whole", "integer", "one_of")) else kind
        brought = value.reach if kind == INTEGER and not facts else None
        return {
            **facts,
            "kind": kind,
            "limits": _limits(value, kind, brought),
            "brought": brought,
            "values": value.ranges if value.listed or len(value.ranges) > 1 else (),
            "listed": value.listed,
            "is_float": value.python_type == "float",
            "is_scaled": value.scale is not None,
        }


def _element_of(array: ArrayValue) -> Constant | New:
    """Returns an element of an array in a message as it is made."""
    element = array.element
    if isinstance(element, Fixed | Blob) and not isinstance(element, Bits):
        return default_of(element)
    return New(element.python_type)


def default_of(value: Fixed | Blob) -> Constant:
    """Returns the value of a number, text or octets in a message as it is made."""
    kind = _KINDS[value.python_type]
    return Constant(ast.literal_eval(value.default), kind)


def _limits(value: Fixed, kind: str, brought: Limits | None) -> Limits:
    if value.scale is not None:
        return value.scale
    if len(value.ranges) == 1:
        return value.ranges[0]
    if value.check == "real":
        return float(value.limits[0]), float(value.limits[1])
    if brought is not None:
        return brought
    return (0, value.size) if kind == TEXT else _UNLIMITED

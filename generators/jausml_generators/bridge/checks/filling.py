"""Statements that put values into a message, path by path, and that ask for them."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Container, Mapping
from dataclasses import dataclass, replace
from itertools import islice, product
from typing import TypeAlias

from jausml.generation.literals import python_literal, python_string
from jausml.language.attributes import expressions as authored
from jausml.language.interfaces.definitions import INTEGER_RANGES
from jausml.language.metamodel.classes import jaus, ros
from jausml.language.semantics.paths.attributes import octets_of
from jausml.language.semantics.paths.jaus_paths import JausPlace, message_place
from jausml.language.semantics.paths.markers import is_said, number_as_made, unknown
from jausml_generators.bridge.checks.check import close_to, equals, holds, store
from jausml_generators.bridge.translation import places
from jausml_generators.bridge.translation.expressions import (
    BOOLEAN,
    INTEGER,
    OCTETS,
    REAL,
    TEXT,
    Expression,
)
from jausml_generators.bridge.translation.places import HasValue, only_conditions
from jausml_generators.bridge.translation.printing import (
    condition_text,
    expression_text,
    place_text,
)
from jausml_generators.bridge.translation.ros_fields import RosField, RosStart, ros_field
from jausml_generators.bridge.translation.targets import marked_paths
from jausml_generators.bridge.translation.values import ros_kind
from jausml_generators.python.codec.jaus_fields import JausField, JausStart, jaus_field
from jausml_generators.python.codec.messages import MessageView
from jausml_generators.python.names import snake_case
from jausml_generators.python.statements import call

_ELEMENT = re.compile(r"(?P<list>.*)\[(?P<index>[0-9]+)\]")
# A shorter last step, such as x, says little alone.
_SHORT = 8
_ZEROS = {REAL: "0.0", INTEGER: "0", BOOLEAN: "False", TEXT: '""'}
Scalar = float | int | bool | str | bytes
PRESENT = "\0present"
"""Stands for a bit field as it is made."""


def short_name(path: str) -> str:
    """Returns a word for an attribute, made of the last steps of its path."""
    steps = [step for step in re.split(r"[^A-Za-z0-9_]+", path) if step and not step.isdigit()]
    return snake_case("_".join(steps[-2:] if len(steps[-1]) < _SHORT else steps[-1:]))


class Code(str):
    """Python text that stands for a value."""

    __slots__ = ()


class ValueTextError(ValueError):
    """A text of the model that is no value of the attribute that it is meant for."""


@dataclass(frozen=True)
class Place:
    """An attribute of a message of either side.

    Attributes:
        code: The attribute, as Python text.
        ranges: Legal ranges of integers where they have gaps or names; else empty.
        step: Smallest difference of two numbers that it can tell apart; 0 when that is tiny.
        conditions: What must hold for it to be there, as Python text.
    """

    path: str
    code: str
    kind: str
    limits: tuple[float, float] = (-math.inf, math.inf)
    ranges: tuple[tuple[int, int], ...] = ()
    step: float = 0.0
    names: tuple[tuple[str, str], ...] = ()
    conditions: tuple[str, ...] = ()

    @property
    def is_number(self) -> bool:
        """Whether it holds numbers."""
        return self.kind in {REAL, INTEGER}

    def can_hold(self, value: float) -> bool:
        """Whether it can hold a number."""
        if not self.is_number:
            return False
        if self.ranges:
            return any(low <= value <= high for low, high in self.ranges)
        return self.limits[0] <= value <= self.limits[1]

    def parse(self, text: str) -> Scalar:
        """Returns the value that a text of the model stands for.

        Raises:
            ValueTextError: It stands for none.
        """
        known = dict(reversed(self.names)).get(text, text)
        try:
            if self.kind == REAL:
                return float(known)
            if self.kind == INTEGER:
                return int(known in {"true"}) if known in {"true", "false"} else int(known, 0)
        except ValueError:
            raise ValueTextError(f"{text!r} is no number ({self.path})") from None
        if self.kind == BOOLEAN and known in {"true", "false", "0", "1"}:
            return known in {"true", "1"}
        if self.kind == TEXT:
            return text
        octets = octets_of(text) if self.kind == OCTETS else None
        if octets is not None:
            return octets
        raise ValueTextError(f"{self.path} takes no value in a test vector")


@dataclass(frozen=True)
class JausMessage:
    """A JAUS message."""

    element: jaus.MessageDef
    message: MessageView
    name: str

    def field(self, path: str) -> JausField:
        """Returns the field at the end of a path."""
        return jaus_field(self.message, path, JausStart(self.name))

    def place(self, path: str) -> Place:
        """Returns the attribute at the end of a path."""
        field = self.field(path)
        limited = field.kind in {REAL, INTEGER, OCTETS}
        low, high = field.limits if limited else (-math.inf, math.inf)
        return Place(
            path,
            place_text(field.value),
            field.kind,
            (low, high),
            field.values,
            self._step(path),
            tuple((name, str(value)) for name, value in field.listed),
            tuple(map(condition_text, only_conditions(field.conditions))),
        )

    def unknown(self, path: str) -> str:
        """Returns an empty text: a field without a value is left out."""
        del path
        return ""

    def is_told_unset(self, path: str) -> bool:
        """Returns False: a field of JAUS that is not set is left out."""
        del path
        return False

    def around(self, path: str) -> set[tuple[places.Place, Expression]]:
        """Returns the containers that a new message lacks on a path, with elements before."""
        return {
            (outer_place, value)
            for place, value in self.field(path).containers
            for outer_place in _up_to(place)
        }

    def _step(self, path: str) -> float:
        place = message_place(self.element).follow(path)
        return place.attribute().step or 0.0 if isinstance(place, JausPlace) else 0.0

    def fill(self, values: Mapping[str, Scalar | None]) -> list[str]:
        """Returns the statements that make the message with some values.

        Args:
            values: The values by path; None for what stays as it is made, where it stands.
        """
        lines = [f"{self.name} = {self.message.class_name}()"]
        made_places: set[places.Place] = set()
        for path, value in values.items():
            field = self.field(path)
            for place, container in field.containers:
                lines += _creation(place, container, made_places)
            if value is not None:
                lines.append(self.set(field, value))
        return lines

    def set(self, field: JausField, value: Scalar) -> str:
        """Returns the statement that gives a field a value."""
        place = place_text(field.place)
        if value is PRESENT:
            return store(place, f"{field.class_name}()")
        is_number = not isinstance(value, str | bytes)
        number = float(value) if field.is_float and is_number else value
        code = value if isinstance(value, Code) else python_literal(number)
        if field.index is None:
            return store(place, code)
        return store(place, call(field.class_name, str(field.index), code))


_TRIED = (0.0, 1.0, -1.0, 2.0, -2.0, math.nan, math.inf)
_MOST_TRIALS = 500


@dataclass(frozen=True)
class Marker:
    """A marker on the way to a path of a ROS message.

    Attributes:
        places: Where the numbers stand that it asks for, by its names.
    """

    type: ros.MessageType
    condition: authored.Expression
    places: Mapping[str, Place]

    def holds(self, values: Mapping[str, Scalar | None]) -> bool:
        """Tells whether the marker holds for the values of a message, by path."""
        numbers = {name: self._number(values, place.path) for name, place in self.places.items()}
        return is_said(self.condition, numbers)

    def _number(self, values: Mapping[str, Scalar | None], path: str) -> float:
        value = values.get(path)
        if value is None or isinstance(value, str | bytes):
            return number_as_made(self.type, path) or 0.0
        return float(value)

    def settled(
        self, values: Mapping[str, Scalar | None], free: Container[str] | None = None
    ) -> dict[str, Scalar] | None:
        """Returns numbers with which it holds instead of some values; None where none is known.

        Args:
            free: Paths whose values stay; with them, numbers with which it does not hold.
        """
        places = {place.path: place for place in self.places.values()}
        changed = [place for path, place in places.items() if free is None or path not in free]
        trials = product(
            *([number for number in _TRIED if _may_be(place, number)] for place in changed)
        )
        for numbers in islice(trials, _MOST_TRIALS):
            pairs = zip(changed, numbers, strict=True)
            trial = {
                place.path: int(number) if place.kind == INTEGER else number
                for place, number in pairs
            }
            if self.holds({**values, **trial}) is (free is None):
                return dict(trial)
        return None


def _may_be(place: Place, number: float) -> bool:
    return place.kind == REAL or (math.isfinite(number) and place.can_hold(number))


@dataclass(frozen=True)
class RosMessage:
    """A ROS message."""

    type: ros.MessageType
    name: str
    type_name: Callable[[ros.MessageType], str]

    def field(self, path: str) -> RosField:
        """Returns the field at the end of a path."""
        return ros_field(self.type, path, RosStart(self.name, self.type))

    def place(self, path: str) -> Place:
        """Returns the attribute at the end of a path."""
        field = self.field(path)
        limits = INTEGER_RANGES.get(field.type, (-math.inf, math.inf))
        return Place(path, place_text(field.place), ros_kind(field), limits, names=field.constants)

    def unknown(self, path: str) -> str:
        """Returns the value of a field that has none; empty where a new message has it."""
        field = self.field(path).field
        return "" if field is None else unknown(field) or ""

    def is_told_unset(self, path: str) -> bool:
        """Tells whether a part at a path has a marker for no value where no assignment sets it."""
        end = self.field(path)
        if end.field is None or end.is_array or "[" in path:
            return False
        if isinstance(end.field, ros.MessageField):
            return any(marked_paths(end.field.messageType))
        return bool(unknown(end.field))

    def markers(self, path: str) -> list[Marker]:
        """Returns the markers by which a message says that it has no value at a path.

        Those that ask for the number of elements are left out: a path gives its list enough.
        """
        marks = (
            condition
            for condition in self.field(path).conditions
            if isinstance(condition, HasValue)
        )
        typed_marks = (mark for mark in marks if all(operand.type for _, operand in mark.operands))
        return [
            Marker(
                self.type,
                mark.marker,
                {name: self.place(_path(operand.place)) for name, operand in mark.operands},
            )
            for mark in typed_marks
        ]

    def around(self, path: str) -> set[places.Place]:
        """Returns the elements of sequences on the way to a path, and those before each."""
        elements = self.field(path).elements
        return {place for end, _ in elements for place in _up_to(end.place.at(end.than))}

    def fill(self, values: Mapping[str, Scalar | None]) -> list[str]:
        """Returns the statements that make the message with some values.

        Args:
            values: The values by path; None for what stays as it is made, where it stands.
        """
        lines = [f"{self.name} = {self.type_name(self.type)}()"]
        sizes: dict[str, int] = {}
        for path in values:
            for prefix, index in self._sequences(path):
                sizes[prefix] = max(sizes.get(prefix, 0), index + 1)
        made_prefixes: set[str] = set()
        for path, value in values.items():
            for prefix, _ in self._sequences(path):
                if prefix not in made_prefixes:
                    made_prefixes.add(prefix)
                    lines.append(self._elements(prefix, sizes[prefix]))
            if value is not None:
                lines.append(self.set(path, value))
        return lines

    def set(self, path: str, value: Scalar) -> str:
        """Returns the statement that gives a field a value."""
        field = self.field(path)
        if isinstance(value, Code):
            return store(place_text(field.place), value)
        is_real = ros_kind(field) == REAL and not isinstance(value, str | bytes)
        return store(place_text(field.place), python_literal(float(value) if is_real else value))

    def _sequences(self, path: str) -> list[tuple[str, int]]:
        """The sequences on a path, which are empty in a new message, with the index in each."""
        sequences = []
        steps = path.split(".")
        for number, step in enumerate(steps, 1):
            element = _ELEMENT.fullmatch(step)
            if element is None:
                continue
            prefix = ".".join([*steps[: number - 1], element["list"]])
            array = self.field(prefix).field
            if array is None or array.arrayKind.name != "fixedArray":
                sequences.append((prefix, int(element["index"])))
        return sequences

    def _elements(self, prefix: str, count: int) -> str:
        field = self.field(prefix)
        if field.message_type is None:
            zero = _ZEROS.get(ros_kind(replace(field, is_array=False)), "0")
            return f"{place_text(field.place)} = [{zero}] * {count}"
        name = self.type_name(field.message_type)
        return f"{place_text(field.place)} = [{', '.join([f'{name}()'] * count)}]"


def _path(place: places.Place) -> str:
    """The path of a place in a message."""
    steps = place.steps
    return "".join(
        f"[{step}]" if isinstance(step, int) else f".{step}" for step in steps
    ).removeprefix(".")


def _up_to(place: places.Place) -> list[places.Place]:
    """Returns a place, and those of the elements before it where it is an element itself."""
    last = place.steps[-1]
    if isinstance(last, str):
        return [place]
    held = replace(place, steps=place.steps[:-1])
    return [held.at(index) for index in range(last + 1)]


def _creation(place: places.Place, value: Expression, made_places: set[places.Place]) -> list[str]:
    """The statements that make a container or an element that is not there yet."""
    if place in made_places:
        return []
    made_places.add(place)
    text = expression_text(value)
    if isinstance(place.steps[-1], str):
        return [store(place_text(place), text)]
    missing = [outer_place for outer_place in _up_to(place)[:-1] if outer_place not in made_places]
    made_places.update(missing)
    held = replace(place, steps=place.steps[:-1])
    return [call(f"{place_text(held)}.append", text)] * (len(missing) + 1)


SINGLE = 1e-6
"""More than the relative error of single precision."""


def has_value(place: Place, value: Scalar, tolerance: float = 0.0) -> list[str]:
    """Returns the assertions that an attribute is there and has a value.

    Args:
        tolerance: Largest difference of a number; 0 means what single precision may lose.
    """
    lines = is_there(place)
    if isinstance(value, str):
        code = value if isinstance(value, Code) else python_string(value)
        return [*lines, equals(place.code, code)]
    if isinstance(value, bytes):
        return [*lines, equals(f"bytes({place.code})", python_literal(value))]
    if place.kind == BOOLEAN:
        return [*lines, holds(place.code if value else f"not {place.code}")]
    if place.kind == INTEGER and float(value).is_integer() and tolerance < 0.5:
        return [*lines, equals(place.code, str(int(value)))]
    if place.kind == INTEGER:
        return [*lines, close_to(place.code, float(value), max(tolerance, 0.501))]
    if math.isinf(value):
        return [*lines, equals(place.code, python_literal(float(value)))]
    return [*lines, close_to(place.code, float(value), tolerance)]


def is_absent(place: Place) -> list[str]:
    """Returns the assertion that an optional attribute, or one around it, is left out."""
    around = _around(place)
    if not around:
        return [holds(f"{place.code} is None")]
    return [holds(f"not ({' and '.join([*around, _own(place)])})")]


def is_there(place: Place) -> list[str]:
    """Returns the assertions that an attribute is there."""
    return [holds(condition) for condition in place.conditions]


def has_place(place: Place) -> list[str]:
    """Returns the assertions that the containers of an attribute exist."""
    return [holds(expression) for expression in _around(place)]


def _around(place: Place) -> list[str]:
    return [condition for condition in place.conditions if condition != _own(place)]


def _own(place: Place) -> str:
    return f"{place.code} is not None"


Message: TypeAlias = JausMessage | RosMessage
"""A message of either side under a name of the generated test."""

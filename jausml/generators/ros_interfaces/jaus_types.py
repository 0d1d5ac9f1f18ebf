"""JAUS messages as ROS messages.

A record becomes a message type of its own, a list a bounded sequence, a variant a tag and one field
for each option, a bit field one unsigned integer for each of its parts. An optional field has a
field `has_<name>` before it. Scaled integers become the real numbers that they stand for.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from jausml.generation.errors import GenerationError
from jausml.generators.python import names as common_names
from jausml.generators.python.codec.fields import integer_limits, name_of
from jausml.generators.python.codec.nesting import Resolved, resolve
from jausml.generators.ros_interfaces.definitions import (
    ConstantLine,
    DefinitionFile,
    DefinitionSection,
    FieldLine,
)
from jausml.generators.ros_interfaces.names import constant_name, field_name, type_name
from jausml.generators.ros_interfaces.ros_types import described
from jausml.interfaces.definitions import BOUNDED, FIXED, SINGLE, UNBOUNDED, FieldType

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

_LONGEST_SEQUENCE = 2**16 - 1
"""A sequence that may be longer is not bounded: nobody would reserve the memory."""


class MessagesPackage:
    """The messages of one package, and the types nested in them.

    Args:
        package: Name of the package.
        source: Model file.
    """

    def __init__(self, package: str, source: str) -> None:
        self._package = package
        self._source = source
        self._names = common_names.Scope(separator="")
        self._open: list[Any] = []
        self.files: list[DefinitionFile] = []

    def add(self, message: Any) -> None:
        """Adds a message.

        Args:
            message: The `jaus.MessageDef`.

        Raises:
            GenerationError: A type of it contains itself or refers to nothing.
        """
        name = self._names.claim(type_name(str(message.name)))
        section = DefinitionSection(f"JAUS message {message.name} ({message.code}).")
        if message.documentation:
            section.comment += f"\n\n{message.documentation}"
        if message.body is not None:
            body = resolve(message.body)
            fields = _Fields(self, name, section)
            if body.kind in ("Record", "Sequence"):
                self._open.append(body.type)
                fields.add_members(body)
                self._open.pop()
            else:
                fields.add(body)
        self._file(name, section, f"message:{message.code}:{message.name}")

    def nested(self, name: str, field: Resolved, fill: Callable[[_Fields], None]) -> FieldType:
        """Adds a type that is nested in another one.

        Args:
            name: The name that it would have.
            field: The field of the model that it is made of.
            fill: Adds its fields.

        Raises:
            GenerationError: The field contains itself.
        """
        if field.type in self._open:
            raise GenerationError(f"'{field.name}' contains itself")
        claimed = self._names.claim(type_name(name))
        section = DefinitionSection(field.documentation)
        self._open.append(field.type)
        fill(_Fields(self, claimed, section))
        self._open.pop()
        self._file(claimed, section, f"type:{claimed}")
        return FieldType(claimed)

    def _file(self, name: str, section: DefinitionSection, identity: str) -> None:
        file = DefinitionFile(self._package, name, "msg", (section,), identity, self._source)
        self.files.append(file)


class _Fields:
    """The fields of one message type while it is built."""

    def __init__(self, package: MessagesPackage, owner: str, section: DefinitionSection) -> None:
        self._package = package
        self._owner = owner
        self._section = section
        self._fields = common_names.Scope()
        self._constants = common_names.Scope()

    def add_members(self, record: Resolved) -> None:
        """Adds the members of a record or sequence."""
        has_presence = name_of(record.type.presenceVector) != "none"
        for element in record.type.fields:
            self.add(resolve(element), may_be_absent=has_presence)

    def add(self, field: Resolved, *, may_be_absent: bool = False) -> None:
        """Adds a field of the model."""
        name = self._fields.claim(field_name(field.name))
        if may_be_absent and field.optional:
            flag = self._fields.claim(field_name(f"has_{name}"))
            self._put(flag, FieldType("bool"), f"Whether {name} is there.")
        if field.kind == "FixedField":
            self._number(name, field.type, field.documentation)
        else:
            kind = self._type(field)
            self._put(name, kind, "" if self._is_nested(kind) else field.documentation)

    def _is_nested(self, kind: FieldType) -> bool:
        return not kind.is_primitive

    def _put(self, name: str, kind: FieldType, comment: str = "") -> None:
        self._section.fields.append(FieldLine(name, kind, comment))

    # -- types -----------------------------------------------------------------------------------

    def _type(self, field: Resolved) -> FieldType:
        """Returns the type of a field; nested types are added to the package."""
        element = field.type
        if field.kind == "FixedField":
            return FieldType(_numeric(element))
        if field.kind == "FixedLengthString":
            return FieldType("string", "", int(element.length))
        if field.kind == "VariableLengthString":
            return FieldType("string", "", _bound(element.countType, element.maximumLength))
        if field.kind == "VariableLengthField":
            return _sequence("uint8", _bound(element.countType, element.maximumLength))
        if field.kind in ("List", "Array"):
            return self._repeated(field)
        fill = {
            "Record": lambda fields: fields.add_members(field),
            "Sequence": lambda fields: fields.add_members(field),
            "BitField": lambda fields: fields.add_bits(element),
            "VariableField": lambda fields: fields.add_alternatives(element),
            "VariableFormatField": lambda fields: fields.add_format(element),
            "Variant": lambda fields: fields.add_options(element),
        }[field.kind]
        return self._package.nested(self._owner + type_name(field.name), field, fill)

    def _repeated(self, field: Resolved) -> FieldType:
        element = resolve(field.type.element)
        if element.type is field.type:
            raise GenerationError(f"'{field.name}' contains itself")
        kind = self._type(element)
        if kind.array != SINGLE:
            # A sequence of sequences is not possible: the inner one becomes a type.
            name = self._owner + type_name(element.name)
            kind = self._package.nested(name, element, lambda fields: fields.add(element))
        if field.kind == "List":
            size = _bound(field.type.countType, field.type.maximumCount)
            return _sequence(kind.name, size, kind.string_bound)
        size = math.prod(int(each) for each in field.type.dimensions)
        return FieldType(kind.name, "", kind.string_bound, FIXED, size)

    # -- parts of nested types -------------------------------------------------------------------

    def add_bits(self, element: Any) -> None:
        """Adds the parts of a bit field."""
        for part in element.subFields:
            name = self._fields.claim(field_name(str(part.name)))
            width = int(part.highBit) - int(part.lowBit) + 1
            kind = next(f"uint{bits}" for bits in (8, 16, 32, 64) if bits >= width)
            self._named(name, kind, part.values)
            noun = "bit" if width == 1 else "bits"
            self._put(name, FieldType(kind), f"{width} {noun}.")

    def add_alternatives(self, element: Any) -> None:
        """Adds the choice of a variable field and its alternatives."""
        choice = self._fields.claim("choice")
        for each in element.alternatives:
            self._constant(choice, str(each.name), "uint8", int(each.index))
        self._put(choice, FieldType("uint8"), "Which of the fields below counts.")
        for each in element.alternatives:
            name = self._fields.claim(field_name(str(each.name)))
            self._number(name, each, str(each.documentation or ""))

    def add_format(self, element: Any) -> None:
        """Adds the format of bytes, and the bytes."""
        for each in element.formats:
            self._constant("format", str(each.name), "uint8", int(each.index))
        self._put("format", FieldType("uint8"), "What the bytes are.")
        self._put("data", _sequence("uint8", _bound(element.countType, element.maximumLength)))

    def add_options(self, element: Any) -> None:
        """Adds the tag of a variant and its options."""
        tag = self._fields.claim("tag")
        options = [resolve(each) for each in element.options]
        kind = name_of(element.tagType)
        for index, each in enumerate(options):
            self._constant(tag, each.name, kind, index)
        self._put(tag, FieldType(kind), "Which of the fields below counts.")
        for each in options:
            self.add(each)

    # -- numbers ---------------------------------------------------------------------------------

    def _number(self, name: str, element: Any, documentation: str) -> None:
        """Adds a FixedField or an Alternative."""
        kind = _numeric(element)
        if not kind.startswith("float"):
            self._named(name, kind, element.values)
        comment = described(documentation, _unit(element.units), _limits(element))
        self._put(name, FieldType(kind), comment)

    def _named(self, field: str, kind: str, value_set: Any) -> None:
        low, high = integer_limits(kind)
        for value in _values(value_set, "EnumeratedValue"):
            if low <= int(value.value) <= high:
                text = str(value.documentation or "")
                self._constant(field, str(value.name), kind, int(value.value), text)

    def _constant(self, field: str, name: str, kind: str, value: int, text: str = "") -> None:
        claimed = self._constants.claim(constant_name(field, name))
        self._section.constants.append(ConstantLine(claimed, kind, str(value), text))


def _numeric(element: Any) -> str:
    return "float64" if element.scale is not None else name_of(element.type)


def _unit(units: Any) -> str:
    return "" if str(units or "one") in ("one", "1") else str(units)


def _limits(element: Any) -> str:
    if element.scale is not None:
        return f"{float(element.scale.lower):.15g} to {float(element.scale.upper):.15g}"
    ranges = _values(element.values, "ValueRange")
    return ", ".join(f"{_number_text(each.lower)} to {_number_text(each.upper)}" for each in ranges)


def _number_text(value: Any) -> str:
    return f"{float(value):.15g}"


def _values(value_set: Any, kind: str) -> Iterable[Any]:
    values = value_set.values if value_set is not None else ()
    return [each for each in values if each.eClass.name == kind]


def _bound(count_type: Any, maximum: int) -> int:
    """Returns the largest number of elements, 0 for any."""
    size = int(maximum) or integer_limits(name_of(count_type))[1]
    return size if size <= _LONGEST_SEQUENCE else 0


def _sequence(name: str, size: int, string_bound: int = 0) -> FieldType:
    return FieldType(name, "", string_bound, BOUNDED if size else UNBOUNDED, size)

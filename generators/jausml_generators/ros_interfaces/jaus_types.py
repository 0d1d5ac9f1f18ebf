"""JAUS messages as ROS messages.

A record becomes a message type of its own, a list a bounded sequence, a variant a tag and one field
for each option, a bit field one unsigned integer for each of its parts. An optional field has a
field `has_<name>` before it. Scaled integers become the real numbers that they stand for.
"""

from __future__ import annotations

import keyword
import re
from collections.abc import Callable, Iterable

from jausml.generation.errors import GenerationError
from jausml.language import wire
from jausml.language.interfaces.definitions import (
    BOUNDED,
    FIXED,
    RESERVED,
    SINGLE,
    UNBOUNDED,
    ConstantDefinition,
    FieldDefinition,
    FieldType,
)
from jausml.language.metamodel.classes import jaus
from jausml.language.semantics import names as words
from jausml_generators.python import names
from jausml_generators.ros_interfaces.definitions import (
    DefinitionFile,
    DefinitionSection,
    described,
)

_LONGEST_SEQUENCE = 2**16 - 1
"""A sequence that may be longer is not bounded: nobody would reserve the memory."""


class MessagesPackage:
    """The messages of one package, and the types nested in them."""

    def __init__(self, package: str, source: str) -> None:
        self._package = package
        self._source = source
        self._names = names.Scope(separator="")
        self.files: list[DefinitionFile] = []

    def add(self, message: jaus.MessageDef) -> None:
        """Adds a message."""
        try:
            layout = wire.resolve(message)
        except wire.LayoutError as error:
            raise GenerationError(str(error)) from None
        name = self._names.claim(type_name(layout.name))
        section = DefinitionSection(comment=f"JAUS message {layout.name} ({message.code}).")
        if layout.documentation:
            section.comment += f"\n\n{layout.documentation}"
        fields = _Fields(self, name, section)
        for member in layout.members:
            fields.add(member)
        self._file(name, section, f"message:{message.code}:{layout.name}")

    def nested(self, name: str, documentation: str, fill: Callable[[_Fields], None]) -> FieldType:
        """Adds a type that is nested in another one."""
        claimed = self._names.claim(type_name(name))
        section = DefinitionSection(comment=documentation)
        fill(_Fields(self, claimed, section))
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
        self._fields = names.Scope()
        self._constants = names.Scope()

    def add(self, field: wire.Field) -> None:
        """Adds a field."""
        name = self._fields.claim(field_name(field.name))
        if field.is_optional:
            flag = self._fields.claim(field_name(f"has_{name}"))
            self._put(flag, FieldType("bool"), f"Whether {name} is there.")
        if isinstance(field.kind, wire.Number):
            self._number(name, field.kind, field.documentation)
        else:
            kind = self._type(field)
            self._put(name, kind, field.documentation if kind.is_primitive else "")

    def _put(self, name: str, kind: FieldType, comment: str = "") -> None:
        self._section.fields.append(FieldDefinition(name, kind, comment=comment))

    # -- types -----------------------------------------------------------------------------------

    def _type(self, field: wire.Field) -> FieldType:
        """Returns the type of a field; nested types are added to the package."""
        match field.kind:
            case wire.Integer() | wire.Real() | wire.Scaled():
                return FieldType(_numeric(field.kind))
            case wire.FixedText(length=length):
                return FieldType("string", "", length)
            case wire.Text(count=count):
                return FieldType("string", "", _bound(count))
            case wire.Octets(count=count):
                return _sequence("uint8", _bound(count))
            case wire.List(element=element, count=count):
                kind = self._element(element)
                return _sequence(kind.name, _bound(count), kind.string_bound)
            case wire.Array(element=element):
                kind = self._element(element)
                return FieldType(kind.name, "", kind.string_bound, FIXED, field.kind.length)
        name = self._owner + type_name(field.name)
        return self._package.nested(
            name, field.documentation, lambda fields: fields.add_parts(field.kind)
        )

    def _element(self, element: wire.Field) -> FieldType:
        kind = self._type(element)
        if kind.array == SINGLE:
            return kind
        # A sequence of sequences is not possible: the inner one becomes a type.
        name = self._owner + type_name(element.name)
        return self._package.nested(name, element.documentation, lambda fields: fields.add(element))

    # -- parts of nested types -------------------------------------------------------------------

    def add_parts(self, kind: wire.Kind) -> None:
        """Adds the members of a nested type."""
        match kind:
            case wire.Record():
                for member in kind.members:
                    self.add(member)
            case wire.BitField():
                self._bits(kind)
            case wire.VariableNumber():
                self._alternatives(kind)
            case wire.FormattedOctets():
                self._formats(kind)
            case wire.Variant():
                self._options(kind)

    def _bits(self, field: wire.BitField) -> None:
        for part in field.groups:
            name = self._fields.claim(field_name(part.name))
            kind = _holding(part.reach)
            self._named(name, kind, part.legal.listed)
            noun = "bit" if part.width == 1 else "bits"
            self._put(name, FieldType(kind), f"{part.width} {noun}.")

    def _alternatives(self, field: wire.VariableNumber) -> None:
        choice = self._fields.claim("choice")
        for alternative in field.alternatives:
            self._constant(choice, alternative.name, "uint8", alternative.index)
        self._put(choice, FieldType("uint8"), "Which of the fields below counts.")
        for alternative in field.alternatives:
            name = self._fields.claim(field_name(alternative.name))
            self._number(name, alternative.number, alternative.documentation)

    def _formats(self, field: wire.FormattedOctets) -> None:
        for data_format in field.formats:
            self._constant("format", data_format.name, "uint8", data_format.index)
        self._put("format", FieldType("uint8"), "What the bytes are.")
        self._put("data", _sequence("uint8", _bound(field.count)))

    def _options(self, field: wire.Variant) -> None:
        tag = self._fields.claim("tag")
        for index, option in enumerate(field.options):
            self._constant(tag, option.name, field.tag.name, index)
        self._put(tag, FieldType(field.tag.name), "Which of the fields below counts.")
        for option in field.options:
            self.add(option)

    # -- numbers ---------------------------------------------------------------------------------

    def _number(self, name: str, number: wire.Number, documentation: str) -> None:
        if isinstance(number, wire.Integer):
            self._named(name, _numeric(number), number.legal.listed)
        units = "" if number.units in ("one", "1") else number.units
        comment = described(documentation, units, _limits(number))
        self._put(name, FieldType(_numeric(number)), comment)

    def _named(self, field: str, kind: str, listed: Iterable[wire.Listed]) -> None:
        limits = wire.INTEGERS[kind]
        for value in listed:
            if limits.lower <= value.value <= limits.upper:
                self._constant(field, value.name, kind, value.value, value.documentation)

    def _constant(self, field: str, name: str, kind: str, value: int, text: str = "") -> None:
        claimed = self._constants.claim(constant_name(field, name))
        self._section.constants.append(ConstantDefinition(claimed, kind, str(value), text))


def _numeric(number: wire.Number) -> str:
    if isinstance(number, wire.Integer) and number.legal.offset:
        return _holding(number.reach)
    return "float64" if isinstance(number, wire.Scaled) else number.type.name


def _holding(reach: tuple[int, int]) -> str:
    """Returns the smallest type for all numbers on the wire, or the largest of its sign."""
    lower, upper = reach
    kinds = wire.UNSIGNED if lower >= 0 else wire.INTEGERS
    fitting = (
        name for name, integer in kinds.items() if integer.lower <= lower and upper <= integer.upper
    )
    return next(fitting, "uint64" if lower >= 0 else "int64")


def _limits(number: wire.Number) -> str:
    if isinstance(number, wire.Scaled):
        return f"{number.lower:.15g} to {number.upper:.15g}"
    stated = number.legal.intervals
    return ", ".join(f"{interval.lower:.15g} to {interval.upper:.15g}" for interval in stated)


def _bound(count: wire.Count) -> int:
    """Returns the largest number of elements, 0 for any."""
    return count.upper if count.upper <= _LONGEST_SEQUENCE else 0


def _sequence(name: str, size: int, string_bound: int = 0) -> FieldType:
    return FieldType(name, "", string_bound, BOUNDED if size else UNBOUNDED, size)


# Words of later versions of C++, besides.
_LATER = ("concept", "consteval", "constinit", "co_await", "co_return", "co_yield", "requires")


def type_name(name: str) -> str:
    """Returns the name of a message type, e.g. `ReportVelocityState`."""
    text = names.class_name(name)
    return text[0].upper() + text[1:]


def field_name(name: str) -> str:
    """Returns the name of a field, e.g. `velocity_x`."""
    text = re.sub("__+", "_", words.snake_case(name)).strip("_") or "unnamed"
    text = f"n{text}" if text[0].isdigit() else text
    is_reserved = text in RESERVED or text in _LATER or keyword.iskeyword(text)
    return f"{text}_value" if is_reserved else text


def constant_name(*parts: str) -> str:
    """Returns the name of a constant, e.g. `GEAR_PARK`."""
    text = "_".join(word for part in parts for word in words.words(part)).upper()
    text = re.sub("__+", "_", text).strip("_") or "UNNAMED"
    return f"N{text}" if text[0].isdigit() else text

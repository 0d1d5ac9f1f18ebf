"""Elements of JSIDL for fields and containers."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from typing import cast
from xml.etree.ElementTree import Element

from jausml.language.exporters.jsidl.elements import element, explained
from jausml.language.importers.jsidl.vocabulary import NUMERIC_TYPES, largest
from jausml.language.metamodel.classes import jaus
from jausml.language.semantics.names import snake_case

TYPE_NAMES: Mapping[str, str] = {ours: theirs for theirs, ours in NUMERIC_TYPES.items()}
"""The numeric types of JSIDL by those of the model."""

# AS5684 writes the bounds of counts as unsigned integers of 32 bits.
_LARGEST_COUNT = 2**32 - 1


class FieldWriter:
    """Writes the fields of one service, and the declared types that they refer to."""

    def __init__(self) -> None:
        self._names: dict[jaus.Field, str] = {}
        self._unwritten: deque[jaus.Field] = deque()

    def field(self, field: jaus.Field) -> Element:
        """Returns a field or container."""
        return self._named(field, str(field.name))

    def declared_types(self) -> list[Element]:
        """Returns the declared types that were referred to, by these types too.

        To be called when all fields are written, once.
        """
        elements: list[Element] = []
        while self._unwritten:
            target = self._unwritten.popleft()
            elements.append(self._named(target, self._names[target]))
        return elements

    def _named(self, field: jaus.Field, name: str) -> Element:
        attributes = {"name": name, "optional": bool(field.optional), **self._attributes(field)}
        return explained(element(_tag(field), self._children(field), **attributes), field)

    def _declare(self, target: jaus.Field) -> str:
        """Returns the name by which a declared type is known in the service."""
        if target not in self._names:
            name = base = str(target.name)
            number = 1
            while name in self._names.values():
                number += 1
                name = f"{base}_{number}"
            self._names[target] = name
            self._unwritten.append(target)
        return self._names[target]

    def _attributes(self, field: jaus.Field) -> dict[str, str | int]:
        """Returns the attributes that a kind of field has alone."""
        match field:
            case jaus.TypeReference():
                return {"declared_type_ref": self._declare(field.target)}
            case jaus.FixedField():
                return _number(field)
            case jaus.BitField():
                return {"field_type_unsigned": TYPE_NAMES[field.type.name]}
            case jaus.FixedLengthString():
                return {"string_length": field.length}
            case jaus.VariableLengthField():
                return {"field_format": field.format}
        return {}

    def _children(self, field: jaus.Field) -> list[Element]:
        match field:
            case jaus.Record() | jaus.Sequence():
                vector = field.presenceVector.name
                first = [] if vector == "none" else [_typed("presence_vector", vector)]
                return [*first, *map(self.field, field.fields)]
            case jaus.List():
                count = _count(field.countType.name, field.minimumCount, field.maximumCount)
                return [count, self.field(field.element)]
            case jaus.Variant():
                last = len(field.options) - 1 if field.options else None
                tag = _typed("vtag_field", field.tagType.name, 0, last)
                return [tag, *map(self.field, field.options)]
            case jaus.Array():
                sizes = enumerate(field.dimensions, 1)
                dimensions = (
                    element("dimension", name=f"Dimension{number}", size=size)
                    for number, size in sizes
                )
                return [self.field(field.element), *dimensions]
        return _leaf_children(field)


def _leaf_children(field: jaus.Field) -> list[Element]:
    """Returns the elements inside a field that has no fields inside."""
    elements: list[Element] = []
    match field:
        case jaus.FixedField():
            elements = _legal(field)
        case jaus.VariableField():
            elements = [element("type_and_units_field", map(_alternative, field.alternatives))]
        case jaus.BitField():
            elements = list(map(_sub_field, field.subFields))
        case jaus.VariableFormatField():
            known = (
                element("format_enum", index=format_.index, field_format=format_.name)
                for format_ in field.formats
            )
            elements = [element("format_field", known)]
    match field:
        case jaus.VariableLengthString() | jaus.VariableLengthField() | jaus.VariableFormatField():
            kind = field.countType.name
            elements.append(_count(kind, field.minimumLength, field.maximumLength))
    return elements


def _tag(field: jaus.Field) -> str:
    """Returns the tag of a field; of a reference, that of its final target."""
    prefix = ""
    while isinstance(field, jaus.TypeReference):
        prefix, field = "declared_", field.target
    return prefix + snake_case(field.eClass.name)


def _typed(
    tag: str, unsigned: str, lowest: int | None = None, highest: int | None = None
) -> Element:
    kind = TYPE_NAMES[unsigned]
    return element(tag, field_type_unsigned=kind, min_count=lowest, max_count=highest)


def _count(unsigned: str, minimum: int, maximum: int) -> Element:
    bound = maximum or largest(unsigned)
    highest = bound if bound <= _LARGEST_COUNT else None
    return _typed("count_field", unsigned, minimum, highest)


def _number(field: jaus.FixedField | jaus.Alternative) -> dict[str, str | int]:
    return {"field_type": TYPE_NAMES[field.type.name], "field_units": field.units or "one"}


def _legal(field: jaus.FixedField | jaus.Alternative) -> list[Element]:
    """Returns the elements of the scale or of the legal values of a number."""
    scale, values = field.scale, field.values
    elements = [] if values is None else [_value_set(values)]
    if scale is not None:
        limits = {"real_lower_limit": scale.lower, "real_upper_limit": scale.upper}
        elements.append(element("scale_range", **limits, integer_function=scale.rounding.name))
    return elements


def _value_set(values: jaus.ValueSet) -> Element:
    is_offset = bool(values.offsetToLowerLimit)
    return element("value_set", map(_value, values.values), offset_to_lower_limit=is_offset)


def _value(value: jaus.Value) -> Element:
    if isinstance(value, jaus.ValueRange):
        kinds = ("exclusive", "inclusive")
        lower, upper = kinds[value.lowerInclusive], kinds[value.upperInclusive]
        bounds = {"lower_limit_type": lower, "upper_limit_type": upper}
        limits = {"lower_limit": value.lower, "upper_limit": value.upper}
        return explained(element("value_range", **limits, **bounds), value)
    named = cast("jaus.EnumeratedValue", value)
    return explained(element("value_enum", enum_index=named.value, enum_const=named.name), value)


def _alternative(choice: jaus.Alternative) -> Element:
    attributes = {"name": choice.name, "index": choice.index, **_number(choice)}
    return explained(element("type_and_units_enum", _legal(choice), **attributes), choice)


def _sub_field(part: jaus.SubField) -> Element:
    bits = element("bit_range", from_index=part.lowBit, to_index=part.highBit)
    values = [_value_set(part.values)] if part.values is not None else []
    return explained(element("sub_field", [bits, *values], name=part.name), part)

"""Layouts of JAUS message bodies (AS5684): what stands on the wire, and what codecs expose."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.metamodel.classes import jaus
from jausml.metamodel.classes.ecore import EEnumLiteral, EObject

if TYPE_CHECKING:
    from typing import TypeAlias

    from typing_extensions import TypeIs

    Group: TypeAlias = jaus.Record | jaus.Sequence
    Container: TypeAlias = Group | jaus.List | jaus.Variant

UNSIGNED_BITS = {"uint8": 8, "uint16": 16, "uint32": 32, "uint64": 64}
SIGNED_BITS = {"int8": 8, "int16": 16, "int32": 32, "int64": 64}

_TIME_STAMP = ((0, 9), (10, 15), (16, 21), (22, 26), (27, 31))
_UNNAMED = frozenset({"name", "documentation", "units"})


def class_name(element: EObject) -> str:
    """Returns the name of the metamodel class of an element."""
    return str(element.eClass.name)


def resolve(field: jaus.Field | None) -> jaus.Field | None:
    """Returns the field that a reference stands for; None for a dangling one or a cycle."""
    seen = set()
    while isinstance(field, jaus.TypeReference):
        if field in seen:
            return None
        seen.add(field)
        field = field.target
    return field


def members(container: jaus.Field | None) -> list[jaus.Field]:
    """Returns the fields of a record or sequence, none for other fields."""
    return list(container.fields) if is_group(container) else []


def is_group(field: EObject | None) -> TypeIs[Group]:
    """Tells whether a field is a record or a sequence."""
    return isinstance(field, (jaus.Record, jaus.Sequence))


def is_container(field: EObject | None) -> TypeIs[Container]:
    """Tells whether a field is a record, sequence, list or variant (JSIDL's containers)."""
    return isinstance(field, (jaus.Record, jaus.Sequence, jaus.List, jaus.Variant))


def attributes(message: jaus.MessageDef) -> list[jaus.Field]:
    """Returns the fields that a codec exposes as attributes of the message.

    The top record or sequence is flattened; a list or variant is one attribute.
    """
    body = resolve(message.body)
    if body is None or message.body is None:
        return []
    return members(body) if is_group(body) else [message.body]


def integer_range(type_name: str) -> tuple[int, int] | None:
    """Returns the limits of an integer type, None for floating point."""
    if type_name in UNSIGNED_BITS:
        return 0, 2 ** UNSIGNED_BITS[type_name] - 1
    if type_name in SIGNED_BITS:
        bits = SIGNED_BITS[type_name]
        return -(2 ** (bits - 1)), 2 ** (bits - 1) - 1
    return None


def is_time_stamp(field: EObject) -> bool:
    """Tells whether a bit field is a JAUS TimeStamp (AS5710: milliseconds, ..., day of month)."""
    if not isinstance(field, jaus.BitField) or field.type.name != "uint32":
        return False
    return tuple(sorted((s.lowBit, s.highBit) for s in field.subFields)) == _TIME_STAMP


def signature(message: jaus.MessageDef) -> object:
    """Returns a comparable description of what a message body puts on the wire."""
    return _signature(message.body, ())


def _signature(field: jaus.Field | None, above: tuple[jaus.Field, ...]) -> object:
    target = resolve(field)
    if field is None or target is None or target in above:
        return None
    # A reference overrides the optionality of its target.
    return (bool(field.optional), *_content(target, (*above, target)))


def _content(element: EObject, above: tuple[jaus.Field, ...]) -> tuple[object, ...]:
    parts: list[object] = [class_name(element)]
    for feature in element.eClass.eAllStructuralFeatures():
        if feature.name in _UNNAMED or feature.name == "optional":
            continue
        value = getattr(element, feature.name)
        values = list(value) if feature.many else [value]
        parts.append(tuple(_part(each, above) for each in values))
    return tuple(parts)


def _part(value: Any, above: tuple[jaus.Field, ...]) -> object:
    if not isinstance(value, EObject) or isinstance(value, EEnumLiteral):
        return str(value)
    if isinstance(value, (jaus.ValueSet, jaus.Value)):
        return None  # the legal values do not change the layout
    return _signature(value, above) if isinstance(value, jaus.Field) else _content(value, above)

"""Fields of JAUS messages: which contain others, and which a codec exposes."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

from jausml.language import wire
from jausml.language.metamodel.classes import jaus
from jausml.language.metamodel.classes.ecore import EObject

if TYPE_CHECKING:
    from typing_extensions import TypeIs

Group: TypeAlias = "jaus.Record | jaus.Sequence"
Container: TypeAlias = "Group | jaus.List | jaus.Variant"


def class_name(element: EObject) -> str:
    """Returns the name of the metamodel class of an element."""
    return str(element.eClass.name)


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
    body = wire.target_of(message.body)
    if body is None or message.body is None:
        return []
    return members(body) if is_group(body) else [message.body]

"""What a ROS message consists of that is written as CDR, with its usual values."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from jausml.generation.literals import python_literal
from jausml.language.metamodel.classes import ros
from jausml_generators.bridge.flat.cdr_layout import LETTERS
from jausml_generators.bridge.flat.errors import NotFlatError

if TYPE_CHECKING:
    from collections.abc import Iterator


@dataclass(frozen=True)
class NumberLeaf:
    """A number, or several in a row.

    Attributes:
        path: Its path; that of the array for several.
        letter: Its letter in struct formats.
        defaults: Its value in a message as it is made; as many as there are.
    """

    path: str
    letter: str
    defaults: tuple[str, ...]


@dataclass(frozen=True)
class TextLeaf:
    """A string.

    Attributes:
        path: Its path.
        bound: Most characters; 0 when nothing limits it.
        default: Its value in a message as it is made.
    """

    path: str
    bound: int
    default: str


@dataclass(frozen=True)
class ManyLeaf:
    """A sequence, or an array of what is no number.

    Attributes:
        path: Its path.
        field: The field, whose elements these are.
        bound: Most elements; 0 when nothing limits them.
    """

    path: str
    field: ros.Field
    bound: int


WrittenLeaf: TypeAlias = "NumberLeaf | TextLeaf | ManyLeaf"


def written_leaves(message_type: ros.MessageType, prefix: str = "") -> Iterator[WrittenLeaf]:
    """Yields what a message consists of, in the order of the bytes."""
    if not message_type.fields:
        yield NumberLeaf(f"{prefix}structure_needs_at_least_one_member", "B", ("0",))
    for each in message_type.fields:
        yield from _field(each, f"{prefix}{each.name}")


def _field(each: ros.Field, path: str) -> Iterator[WrittenLeaf]:
    kind, size = each.arrayKind.name, int(each.arraySize)
    if kind in {"boundedSequence", "unboundedSequence"}:
        yield ManyLeaf(path, each, size if kind == "boundedSequence" else 0)
    elif kind == "single":
        yield from single_leaves(each, path, default_of(each))
    elif isinstance(each, ros.PrimitiveField) and each.type.name in LETTERS:
        letter = LETTERS[each.type.name]
        given = default_of(each)
        values = given if isinstance(given, list) else [None] * size
        yield NumberLeaf(path, letter, tuple(_number(letter, value) for value in values))
    else:
        given = default_of(each)
        for index in range(size):
            default = given[index] if isinstance(given, list) else None
            yield from single_leaves(each, f"{path}[{index}]", default)


def single_leaves(each: ros.Field, path: str, default: object) -> Iterator[WrittenLeaf]:
    """Yields what one value of a field consists of; `default` is its own, or None."""
    if isinstance(each, ros.MessageField):
        yield from written_leaves(each.messageType, f"{path}." if path else "")
    elif isinstance(each, ros.PrimitiveField) and each.type.name == "string":
        yield TextLeaf(path, int(each.stringBound), str(default or ""))
    elif isinstance(each, ros.PrimitiveField) and each.type.name in LETTERS:
        letter = LETTERS[each.type.name]
        yield NumberLeaf(path, letter, (_number(letter, default),))
    else:
        raise NotFlatError(f"{path} is a wide string")


def default_of(each: ros.Field) -> object:
    """The default value of a field in Python; None when it has none."""
    text = getattr(each, "defaultValue", None)
    if not text or not isinstance(each, ros.PrimitiveField):
        return None
    is_text = each.type.name == "string" and each.arrayKind.name == "single"
    return text if is_text else json.loads(text)


def _number(letter: str, value: object) -> str:
    if letter == "?":
        return python_literal(bool(value))
    if letter in "fd":
        return python_literal(float(value or 0.0))  # type: ignore[arg-type]
    return python_literal(int(value or 0))  # type: ignore[call-overload]

"""Tables of JAUS and ROS values as constants of the generated module."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml_generators.bridge.translation.expressions import BOOLEAN, INTEGER, Constant
from jausml_generators.bridge.translation.printing import literal
from jausml_generators.bridge.translation.values import (
    PYTHON_TYPES,
    UNLIMITED,
    AssignmentError,
    constant,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.language.metamodel.classes import bridge
    from jausml_generators.bridge.translation.values import Value


@dataclass(frozen=True)
class Table:
    """A table in one direction.

    Attributes:
        known: All integers that it yields; empty when it yields others.
    """

    constant: tuple[str, str, Sequence[str], str, str]
    known: tuple[int, ...]


def look_up(
    table: bridge.ValueTable,
    value: Value,
    kind: str,
    listed: Sequence[tuple[str, str]],
    *,
    to_ros: bool,
) -> Table:
    """Returns a table as the dictionary that a look_up needs.

    Args:
        value: What is looked up; its kind is that of the keys.
        listed: Names and values of what is found, as its field names them.

    Raises:
        AssignmentError: An entry is no value of its side.
    """
    pairs: dict[str, Constant] = {}
    for entry in table.entries:
        texts = (entry.jaus, entry.ros) if to_ros else (entry.ros, entry.jaus)
        key = _constant(str(texts[0] or ""), value.kind, value.listed, table.name)
        found = _constant(str(texts[1] or ""), kind, listed, table.name)
        pairs.setdefault(literal(key), found)
    ends = "JAUS to ROS" if to_ros else "ROS to JAUS"
    about = f"Table {table.name}, {ends}."
    annotation = f"dict[{_type(value.kind)}, {_type(kind)}]"
    items = [f"{text}: {literal(found)}" for text, found in pairs.items()]
    name = f"{table.name} to {'ros' if to_ros else 'jaus'}"
    known: tuple[int, ...] = ()
    if kind == INTEGER:
        known = tuple(sorted({int(found.value or 0) for found in pairs.values()}))
    return Table((name, annotation, items, "{}", about), known)


def _constant(text: str, kind: str, listed: Sequence[tuple[str, str]], table: str) -> Constant:
    """A value of a table; names of values come before the values themselves."""
    try:
        return constant(kind, text, UNLIMITED, f"table {table}", listed)
    except AssignmentError:
        # true and false are 1 and 0 where JAUS has no bool.
        if kind == INTEGER and text in {"true", "false"}:
            return Constant(int(text == "true"), kind)
        if kind == BOOLEAN and text in {"0", "1"}:
            return Constant(text == "1", kind)
        raise


def _type(kind: str) -> str:
    return PYTHON_TYPES.get(kind, "Any")

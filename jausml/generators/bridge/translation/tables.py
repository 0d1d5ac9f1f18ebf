"""Tables of JAUS and ROS values as constants of the generated module."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generators.bridge.translation.values import (
    BOOLEAN,
    PYTHON_TYPES,
    UNLIMITED,
    AssignmentError,
    constant,
)
from jausml.generators.python.codec.jaus_fields import INTEGER

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.generators.bridge.translation.values import Value
    from jausml.metamodel.classes import bridge


@dataclass(frozen=True)
class Table:
    """A table in one direction.

    Attributes:
        constant: Name, type, items, brackets and description of the constant.
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
        table: The table.
        value: What is looked up; its kind is that of the keys.
        kind: Kind of what is found.
        listed: Names and values of what is found, as its field names them.
        to_ros: Whether JAUS values are looked up.

    Raises:
        AssignmentError: An entry is no value of its side.
    """
    pairs: dict[str, str] = {}
    for entry in table.entries:
        texts = (entry.jaus, entry.ros) if to_ros else (entry.ros, entry.jaus)
        key = _literal(str(texts[0] or ""), value.kind, value.listed, table.name)
        pairs.setdefault(key, _literal(str(texts[1] or ""), kind, listed, table.name))
    ends = "JAUS to ROS" if to_ros else "ROS to JAUS"
    about = f"Table {table.name}, {ends}."
    annotation = f"dict[{_type(value.kind)}, {_type(kind)}]"
    items = [f"{key}: {found}" for key, found in pairs.items()]
    name = f"{table.name} to {'ros' if to_ros else 'jaus'}"
    known = tuple(sorted({int(found) for found in pairs.values()})) if kind == INTEGER else ()
    return Table((name, annotation, items, "{}", about), known)


def _literal(text: str, kind: str, listed: Sequence[tuple[str, str]], table: str) -> str:
    """A value of a table as a literal; names of values come before the values themselves."""
    try:
        return constant(kind, text, UNLIMITED, f"table {table}", listed)
    except AssignmentError:
        # true and false are 1 and 0 where JAUS has no bool.
        if kind == INTEGER and text in {"true", "false"}:
            return str(int(text == "true"))
        if kind == BOOLEAN and text in {"0", "1"}:
            return str(text == "1")
        raise


def _type(kind: str) -> str:
    return PYTHON_TYPES.get(kind, "Any")

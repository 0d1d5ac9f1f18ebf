"""Statements of Python as objects, until they are rendered.

Expressions are text on one line: what is too long is broken when the whole module is laid out.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeAlias

from jausml.generation.literals import printable, python_string
from jausml.language.metamodel.classes import jaus

_STEP = " " * 4
# Characters of a string that stands on a line of its own, wherever that begins.
_PIECE = 70


@dataclass(frozen=True)
class Assign:
    """An assignment.

    Attributes:
        place: What gets the value.
        value: The value, as Python text.
        remark: A comment behind it, any text; nothing when it is empty.
    """

    place: str
    value: str
    remark: str = ""


@dataclass(frozen=True)
class Do:
    """An expression for its effect, such as a call.

    Attributes:
        expression: The expression, as Python text.
        remark: A comment behind it, any text; nothing when it is empty.
    """

    expression: str
    remark: str = ""


@dataclass(frozen=True)
class Raise:
    """The raise of an error.

    Attributes:
        error: The error, as Python text.
    """

    error: str


@dataclass(frozen=True)
class If:
    """Statements under a condition, and those for the other case.

    Attributes:
        test: The condition, as Python text.
        body: What is done when it holds.
        otherwise: What is done when it does not.
    """

    test: str
    body: tuple[Statement, ...]
    otherwise: tuple[Statement, ...] = ()


@dataclass(frozen=True)
class For:
    """A loop.

    Attributes:
        variables: What is given the elements.
        elements: What is gone through, as Python text.
        body: What is done with each.
    """

    variables: str
    elements: str
    body: tuple[Statement, ...]


Statement: TypeAlias = "Assign | Do | Raise | If | For"


def call(function: str, *arguments: str) -> str:
    """Returns a call as Python text.

    Args:
        function: What is called.
        *arguments: Its arguments.
    """
    return f"{function}({', '.join(arguments)})"


def tuple_of(*items: str) -> str:
    """Returns a tuple as Python text.

    Args:
        *items: Its items.
    """
    return f"({', '.join(items)}{',' if len(items) == 1 else ''})"


def long_string(text: str) -> str:
    """Returns a string as Python text, in pieces within parentheses when it is long.

    Args:
        text: The string.
    """
    literal = python_string(text)
    if len(literal) <= _PIECE:
        return literal
    # Others than those of ASCII become escapes of up to ten characters.
    width = _PIECE if text.isascii() else _PIECE // 10
    pieces = textwrap.wrap(text, width, drop_whitespace=False, break_on_hyphens=False)
    return f"({' '.join(map(python_string, pieces))})"


def rendered(statements: Iterable[Statement], depth: int = 0) -> list[str]:
    """Returns the lines of statements.

    Args:
        statements: The statements.
        depth: In how many blocks they stand.
    """
    margin = _STEP * depth
    lines: list[str] = []
    for statement in statements:
        if isinstance(statement, If):
            lines += [f"{margin}if {statement.test}:", *rendered(statement.body, depth + 1)]
            if statement.otherwise:
                lines += [f"{margin}else:", *rendered(statement.otherwise, depth + 1)]
        elif isinstance(statement, For):
            lines.append(f"{margin}for {statement.variables} in {statement.elements}:")
            lines += rendered(statement.body, depth + 1)
        else:
            lines.append(margin + _line(statement))
    return lines


def _line(statement: Assign | Do | Raise) -> str:
    if isinstance(statement, Raise):
        return f"raise {statement.error}"
    remark = " ".join(printable(statement.remark).split())
    comment = f"  # {remark}" if remark else ""
    if isinstance(statement, Assign):
        return f"{statement.place} = {statement.value}{comment}"
    return statement.expression + comment


_VELOCITY_DRIVER = "urn:jaus:jss:mobility:VelocityStateDriver"

CURRENT_COMMAND = 0
"""CommandType of a SetVelocityCommand that moves; the others set limits and the default."""


def condition(message: jaus.MessageDef, guard: str) -> str:
    """Returns the expression that says whom to obey: a guard, or a function of the message."""
    # Limits may be set in Standby, the current command in Ready alone (AS6009, 0415h).
    if guard == "READY" and may_set_limits(message):
        current = f"message.command_type == {CURRENT_COMMAND}"
        return f"lambda message: Guard.READY if {current} else Guard.CONTROLLED"
    return f"Guard.{guard}"


def may_set_limits(message: jaus.MessageDef) -> bool:
    """Tells whether a message moves the component or sets limits, by its CommandType."""
    owner = message.eContainer()
    is_of_driver = owner is not None and owner.urn == _VELOCITY_DRIVER
    return is_of_driver and message.name == "SetVelocityCommand"

"""One function of the generated tests."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generation.literals import LINE_WIDTH, python_literal
from jausml.generators.python.layout import Call, statement

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

MARGIN = 4
_CALL = re.compile(r"(\w+)\(([^()]*)\)")
HOLDER = "holder"
"""Handy name for what holds an attribute with a long path."""
_HANDY = f"{HOLDER} = "
_WHOLE_MESSAGE = re.compile(r"\w+ = ")
# Lines that nearly fill the width are split by formatters in ways that nobody likes to read.
_ROOM = 4
_LEAST_TOLERANCE = 1e-9
_DEFAULT_OF_APPROX = 1e-6


@dataclass(frozen=True)
class Check:
    """A test of one translation.

    Attributes:
        name: Name of the function behind `test_`, unique in the module.
        documentation: What the test shows, one sentence.
        lines: Its statements.
        decorators: Lines above the function.
        parameters: Its parameters with their types.
    """

    name: str
    documentation: str
    lines: tuple[str, ...]
    decorators: tuple[str, ...] = ()
    parameters: tuple[str, ...] = ()

    @property
    def body(self) -> tuple[str, ...]:
        """The statements as single lines."""
        return tuple(line for text in self.lines for line in text.split("\n"))

    @property
    def text(self) -> str:
        """All that stands in the function and above it, for a search of names."""
        return "\n".join((*self.decorators, *self.parameters, *self.lines))


def tidy(statements: Iterable[str]) -> tuple[str, ...]:
    """Returns statements without assertions and handy names that are there already.

    Args:
        statements: Statements as the functions below make them.
    """
    return tuple(_tidied(_one_by_one(statements)))


def _one_by_one(statements: Iterable[str]) -> Iterator[str]:
    for each in statements:
        if each.startswith(_HANDY) and "\n" in each:
            yield from each.split("\n", 1)
        else:
            yield each


def _tidied(statements: Iterable[str]) -> Iterator[str]:
    known: set[str] = set()
    holder = ""
    for each in statements:
        if each.startswith(_HANDY):
            if each == holder:
                continue
            holder = each
            known = {other for other in known if f"{HOLDER}." not in other}
        elif each.startswith("assert "):
            if each in known:
                continue
            known.add(each)
        elif _WHOLE_MESSAGE.match(each):
            known, holder = set(), ""
        yield each


def store(place: str, code: str | Call, column: int = MARGIN) -> str:
    """Returns the statement that stores a value, laid out.

    Args:
        place: Where to; what holds it gets a handy name when it is long.
        code: The value, as Python text.
        column: Column at which it stands.
    """
    text = statement(code, f"{place} = ", column)
    prefix, _, last = place.rpartition(".")
    lines = [f"{place} = {code}"] if isinstance(code, str) else text.split("\n")
    if prefix and column + max(map(len, lines)) > LINE_WIDTH - _ROOM:
        return f"{_HANDY}{prefix}\n" + statement(code, f"{HOLDER}.{last} = ", column)
    return text


def equals(place: str, code: str, column: int = MARGIN) -> str:
    """Returns the assertion that a place holds a value.

    Args:
        place: The place.
        code: The value, as Python text.
        column: Column at which it stands.
    """
    return _fitted(f"assert {place} == {code}", place, f"== {code}", column)


def holds(condition: str) -> str:
    """Returns the assertion that a condition holds."""
    line = f"assert {condition}"
    found = _CALL.fullmatch(condition)
    if found is None or MARGIN + len(line) <= LINE_WIDTH:
        return line
    return statement(Call(found[1], tuple(found[2].split(", "))), "assert ", MARGIN)


def close_to(place: str, value: float, tolerance: float = 0.0, column: int = MARGIN) -> str:
    """Returns the assertion that a place holds a number.

    Args:
        place: The place.
        value: The number.
        tolerance: Largest difference; 0 means the default of pytest, a millionth of the number.
        column: Column at which it stands.
    """
    if math.isnan(value):
        return holds(f"math.isnan({place})")
    arguments = [python_literal(float(value))]
    if tolerance > _DEFAULT_OF_APPROX * abs(value) or value == 0.0:
        arguments.append(f"abs={python_literal(float(max(tolerance, _LEAST_TOLERANCE)))}")
    elif tolerance > 0.0:
        arguments.append(f"rel=0.0, abs={python_literal(float(tolerance))}")
    return statement(Call("pytest.approx", tuple(arguments)), f"assert {place} == ", column)


def _fitted(line: str, place: str, rest: str, column: int) -> str:
    """A line, or two when it is too long for one."""
    if column + len(line) <= LINE_WIDTH:
        return line
    return f"found = {place}\nassert found {rest}"

"""One function of the generated tests."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jausml.generation.literals import python_literal, python_string
from jausml_generators.python.statements import call

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator


_WHOLE_MESSAGE = re.compile(r"\w+ = ")
_LEAST_TOLERANCE = 1e-9
_DEFAULT_OF_APPROX = 1e-6


NAME = "\1"
"""Stands for the name of a connection in checks that connections share."""


def frame_stand_in(number: int) -> str:
    """Returns what stands for the name of a frame of a map in checks that connections share."""
    return f"\2{number}\3"


@dataclass(frozen=True)
class Check:
    """A test of one translation.

    Attributes:
        name: Name of the function behind `test_`, unique in the module.
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

    def of(self, connection: str, frames: Iterable[str]) -> Check:
        """Returns the check with the name of a connection for NAME, and with its frames."""
        name = self.name.replace(NAME, connection)
        lines = tuple(line.replace(NAME, connection) for line in self.lines)
        for number, frame in enumerate(frames):
            stand_in, literal = frame_stand_in(number), python_string(frame)
            lines = tuple(line.replace(stand_in, literal) for line in lines)
        return replace(self, name=name, lines=lines)


def tidy(statements: Iterable[str]) -> tuple[str, ...]:
    """Returns statements without assertions that are there already."""
    return tuple(_tidied(statements))


def _tidied(statements: Iterable[str]) -> Iterator[str]:
    known: set[str] = set()
    for each in statements:
        if each.startswith("assert "):
            if each in known:
                continue
            known.add(each)
        elif _WHOLE_MESSAGE.match(each):
            known = set()
        yield each


def store(place: str, code: str) -> str:
    """Returns the statement that stores a value."""
    return f"{place} = {code}"


def equals(place: str, code: str) -> str:
    """Returns the assertion that a place holds a value."""
    return f"assert {place} == {code}"


def holds(condition: str) -> str:
    """Returns the assertion that a condition holds."""
    return f"assert {condition}"


def close_to(place: str, value: float, tolerance: float = 0.0) -> str:
    """Returns the assertion that a place holds a number.

    Args:
        tolerance: Largest difference; 0 means the default of pytest, a millionth of the number.
    """
    if math.isnan(value):
        return holds(f"math.isnan({place})")
    arguments = [python_literal(float(value))]
    if tolerance > _DEFAULT_OF_APPROX * abs(value) or value == 0.0:
        arguments.append(f"abs={python_literal(float(max(tolerance, _LEAST_TOLERANCE)))}")
    elif tolerance > 0.0:
        arguments.append(f"rel=0.0, abs={python_literal(float(tolerance))}")
    return f"assert {place} == {call('pytest.approx', *arguments)}"

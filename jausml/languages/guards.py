"""Guards of transitions: names of conditions, joined by &&, || and !, with parentheses.

Only this small grammar is read; a guard never becomes code as it stands:

    guard     = and { "||" and }
    and       = not { "&&" not }
    not       = "!" not | "(" guard ")" | condition
    condition = name { "." name } [ "(" arguments ")" ]

What stands before the last dot of a condition, and its arguments, are kept for the reader alone:
the condition is given the message and its sender.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

LONGEST = 1000
"""Characters of a guard; more is no guard that a person wrote."""
_DEEPEST = 30
_TOKEN = re.compile(
    r"\s*(?:(?P<name>[A-Za-z_][A-Za-z0-9_]*(?:\s*\.\s*[A-Za-z_][A-Za-z0-9_]*)*)"
    r"(?P<arguments>\s*\([^()|&!]*\))?|(?P<sign>&&|\|\||[!()]))"
)


class GuardError(ValueError):
    """A text is no guard.

    Attributes:
        column: Where it goes wrong, from 1.
    """

    def __init__(self, message: str, column: int) -> None:
        super().__init__(f"{message} at column {column}")
        self.column = column


@dataclass(frozen=True)
class Condition:
    """A condition by its name."""

    name: str


@dataclass(frozen=True)
class Negation:
    """What holds when another guard does not."""

    operand: Guard


@dataclass(frozen=True)
class AllOf:
    """What holds when all of some guards hold."""

    operands: tuple[Guard, ...]


@dataclass(frozen=True)
class AnyOf:
    """What holds when one of some guards holds."""

    operands: tuple[Guard, ...]


Guard = Condition | Negation | AllOf | AnyOf


def parse_guard(text: str | None) -> Guard | None:
    """Returns the guard that a text describes, None for an empty one.

    Args:
        text: Feature `guard` of a transition.

    Raises:
        GuardError: The text is no guard.
    """
    if text is None or not text.strip():
        return None
    if len(text) > LONGEST:
        raise GuardError(f"a guard has at most {LONGEST} characters", LONGEST)
    return _Parser(text).whole()


def conditions(guard: Guard | None) -> Iterator[str]:
    """Yields the names of the conditions of a guard, in its order.

    Args:
        guard: The guard, if any.
    """
    if isinstance(guard, Condition):
        yield guard.name
    elif isinstance(guard, Negation):
        yield from conditions(guard.operand)
    elif guard is not None:
        for operand in guard.operands:
            yield from conditions(operand)


class _Parser:
    def __init__(self, text: str) -> None:
        self._tokens = _tokens(text)
        self._next = 0
        self._depth = 0

    def whole(self) -> Guard:
        guard = self._any_of()
        kind, column = self._tokens[self._next]
        if kind:
            raise GuardError(f"'{kind}' where the guard should end", column)
        return guard

    def _any_of(self) -> Guard:
        operands = [self._all_of()]
        while self._takes("||"):
            operands.append(self._all_of())
        return operands[0] if len(operands) == 1 else AnyOf(tuple(operands))

    def _all_of(self) -> Guard:
        operands = [self._single()]
        while self._takes("&&"):
            operands.append(self._single())
        return operands[0] if len(operands) == 1 else AllOf(tuple(operands))

    def _single(self) -> Guard:
        text, column = self._tokens[self._next]
        self._depth += 1
        if self._depth > _DEEPEST:
            raise GuardError("too many parentheses", column)
        try:
            if self._takes("!"):
                return Negation(self._single())
            if self._takes("("):
                inner = self._any_of()
                if not self._takes(")"):
                    raise GuardError("a parenthesis is not closed", column)
                return inner
        finally:
            self._depth -= 1
        if not text or text in ("&&", "||", ")"):
            raise GuardError(f"a condition is missing before {text or 'the end'}", column)
        self._next += 1
        return Condition(text)

    def _takes(self, sign: str) -> bool:
        if self._tokens[self._next][0] != sign:
            return False
        self._next += 1
        return True


def _tokens(text: str) -> list[tuple[str, int]]:
    """Returns signs and names of conditions with their columns, and an empty text for the end."""
    found: list[tuple[str, int]] = []
    position, end = 0, len(text.rstrip())
    while position < end:
        match = _TOKEN.match(text, position)
        if match is None:
            start = position + len(text[position:]) - len(text[position:].lstrip())
            raise GuardError(f"{text[start]!a} belongs in no guard", start + 1)
        name, sign = match["name"], match["sign"]
        start = match.start("name") if name else match.start("sign")
        found.append((name.rpartition(".")[2].strip() if name else sign, start + 1))
        position = match.end()
    return [*found, ("", end + 1)]

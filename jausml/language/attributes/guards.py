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
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import chain, product
from math import prod

from jausml.language.attributes.cursor import Language, LanguageError, TokenCursor

LONGEST = 1000
"""Characters of a guard; more is no guard that a person wrote."""

MOST_ALTERNATIVES = 100
"""Alternatives of a guard without parentheses; more are no longer to be read."""


class GuardError(LanguageError):
    """A text is no guard."""


_LANGUAGE = Language(
    noun="guard",
    tokens=re.compile(
        r"\s*(?:(?P<name>[A-Za-z_][A-Za-z0-9_]*(?:\s*\.\s*[A-Za-z_][A-Za-z0-9_]*)*"
        r"(?:\s*\([^()|&!]*\))?)|(?P<sign>&&|\|\||[!()]))"
    ),
    error=GuardError,
    longest=LONGEST,
    deepest=30,
)


@dataclass(frozen=True)
class Condition:
    """A condition by its name.

    Attributes:
        written: The condition as it stands in the text, with its arguments.
    """

    name: str
    written: str = field(default="", compare=False, repr=False)


@dataclass(frozen=True)
class Negation:
    """A guard that holds when another one does not."""

    operand: Guard


@dataclass(frozen=True)
class AllOf:
    """A guard that holds when all of some guards hold."""

    operands: tuple[Guard, ...]


@dataclass(frozen=True)
class AnyOf:
    """A guard that holds when one of some guards holds."""

    operands: tuple[Guard, ...]


Guard = Condition | Negation | AllOf | AnyOf
Alternative = tuple[tuple[Condition, bool], ...]
"""Conditions, each with whether it has to hold."""


def parse_guard(text: str | None) -> Guard | None:
    """Returns the guard that a text describes, None for an empty one."""
    if text is None or not text.strip():
        return None
    return _Parser(text).whole()


def conditions(guard: Guard | None) -> Iterator[str]:
    """Yields the names of the conditions of a guard, in its order."""
    if isinstance(guard, Condition):
        yield guard.name
    elif isinstance(guard, Negation):
        yield from conditions(guard.operand)
    elif guard is not None:
        for operand in guard.operands:
            yield from conditions(operand)


def alternatives(guard: Guard, *, holds: bool = True) -> list[Alternative] | None:
    """Returns a guard without parentheses: it holds where one alternative does.

    `!(a || b) && (c || d)` are the alternatives `!a && !b && c` and `!a && !b && d`.

    Args:
        holds: False for the opposite of the guard.

    Returns:
        None where there are more than `MOST_ALTERNATIVES`.
    """
    if isinstance(guard, Condition):
        return [((guard, holds),)]
    if isinstance(guard, Negation):
        return alternatives(guard.operand, holds=not holds)
    inside = [alternatives(operand, holds=holds) for operand in guard.operands]
    known = [choice for choice in inside if choice is not None]
    is_choice = isinstance(guard, AnyOf) is holds
    number = sum(map(len, known)) if is_choice else prod(map(len, known))
    if len(known) < len(inside) or number > MOST_ALTERNATIVES:
        return None
    conjunctions = (
        chain(*known)
        if is_choice
        else (tuple(chain(*combination)) for combination in product(*known))
    )
    return list(dict.fromkeys(tuple(dict.fromkeys(alternative)) for alternative in conjunctions))


class _Parser:
    def __init__(self, text: str) -> None:
        self._cursor = TokenCursor(text, _LANGUAGE)

    def whole(self) -> Guard:
        guard = self._any_of()
        self._cursor.expect_end()
        return guard

    def _any_of(self) -> Guard:
        operands = [self._all_of()]
        while self._cursor.take("||"):
            operands.append(self._all_of())
        return operands[0] if len(operands) == 1 else AnyOf(tuple(operands))

    def _all_of(self) -> Guard:
        operands = [self._single()]
        while self._cursor.take("&&"):
            operands.append(self._single())
        return operands[0] if len(operands) == 1 else AllOf(tuple(operands))

    def _single(self) -> Guard:
        cursor = self._cursor
        if cursor.take("!"):
            return Negation(cursor.nested(self._single))
        if cursor.take("("):
            return cursor.parenthesized(self._any_of)
        if cursor.token.kind != "name":
            raise cursor.error(f"a condition is missing before {cursor.token}")
        written = cursor.advance().text
        return Condition(written.partition("(")[0].rpartition(".")[2].strip(), written)

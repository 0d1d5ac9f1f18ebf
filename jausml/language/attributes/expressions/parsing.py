"""Parser of the expressions of attribute maps.

    any_of     = all_of { "or" all_of }
    all_of     = negation { "and" negation }
    negation   = "not" negation | comparison
    comparison = sum [ ( "<" | "<=" | ">" | ">=" | "==" | "!=" ) sum ]
    sum        = product { ( "+" | "-" ) product }
    product    = signed { ( "*" | "/" ) signed }
    signed     = "-" signed | power
    power      = single [ "^" signed ]
    single     = number | "pi" | "inf" | "nan" | name [ arguments ] | "(" any_of ")"
    arguments  = "(" any_of { "," any_of } ")"

Comparisons and connectives yield 1 or 0, and whatever differs from 0 counts as true. A name is a
source, and its steps are joined by dots; back quotes hold names that the grammar would read
otherwise. `if(condition, a, b)` computes only the one of a and b that it yields.
"""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from jausml.language.attributes.cursor import Language, LanguageError, Token, TokenCursor

from .tree import FUNCTIONS, Call, Conditional, Expression, Number, Operation, Variable, operands_of

if TYPE_CHECKING:
    from collections.abc import Callable

LONGEST = 1000
"""Characters of an expression; more is none that a person wrote."""
DEEPEST = 60
"""Operations within each other; more could not be nested in generated code."""

COMPARISONS = frozenset({"<", "<=", ">", ">=", "==", "!="})
"""Operators that yield 1 or 0."""
CONSTANTS = {"pi": math.pi, "inf": math.inf, "nan": math.nan}
"""Numbers with a name; `nan` goes to the out-of-range policy of the target."""


class ExpressionError(LanguageError):
    """A text is no expression."""


_LANGUAGE = Language(
    noun="expression",
    tokens=re.compile(
        r"\s*(?:(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)"
        r"|(?P<name>[^\W\d]\w*(?:\[[0-9]+\])?(?:\.[^\W\d]\w*(?:\[[0-9]+\])?)*)"
        r"|`(?P<quoted>[^`]+)`"
        r"|(?P<sign><=|>=|==|!=|[-+*/^(),<>]))"
    ),
    error=ExpressionError,
    longest=LONGEST,
    deepest=DEEPEST,
)
_WORDS = {"and", "or", "not"}


def parse_expression(text: str) -> Expression:
    """Returns the expression that a text describes."""
    return _Parser(text).whole()


class _Parser:
    def __init__(self, text: str) -> None:
        self._cursor = TokenCursor(text, _LANGUAGE)

    def whole(self) -> Expression:
        expression = self._any_of()
        self._cursor.expect_end()
        _check_depth(expression)
        return expression

    def _any_of(self) -> Expression:
        return self._joined(self._all_of, "or")

    def _all_of(self) -> Expression:
        return self._joined(self._negation, "and")

    def _negation(self) -> Expression:
        if self._cursor.take("not"):
            return Operation("not", (self._cursor.nested(self._negation),))
        left = self._sum()
        if sign := self._cursor.take(*COMPARISONS):
            left = Operation(sign, (left, self._sum()))
            if self._cursor.token.text in COMPARISONS:
                raise self._cursor.error("comparisons are joined by 'and' or 'or'")
        return left

    def _sum(self) -> Expression:
        return self._joined(self._product, "+", "-")

    def _product(self) -> Expression:
        return self._joined(self._signed, "*", "/")

    def _joined(self, operand: Callable[[], Expression], *signs: str) -> Expression:
        left = operand()
        while sign := self._cursor.take(*signs):
            left = Operation(sign, (left, operand()))
        return left

    def _signed(self) -> Expression:
        if not self._cursor.take("-"):
            return self._power()
        operand = self._cursor.nested(self._signed)
        return Number(-operand.value) if isinstance(operand, Number) else Operation("-", (operand,))

    def _power(self) -> Expression:
        base = self._single()
        return (
            Operation("^", (base, self._cursor.nested(self._signed)))
            if self._cursor.take("^")
            else base
        )

    def _single(self) -> Expression:
        cursor = self._cursor
        if cursor.take("("):
            return cursor.parenthesized(self._any_of)
        token = cursor.token
        if token.kind in {"sign", "end"} or (token.kind == "name" and token.text in _WORDS):
            raise cursor.error(f"a value is missing before {token}")
        cursor.advance()
        if token.kind == "number":
            return _number(token)
        if token.kind == "name":
            if cursor.take("("):
                return self._call(token)
            if token.text in CONSTANTS:
                return Number(CONSTANTS[token.text])
        return Variable(token.text, token.column)

    def _call(self, name: Token) -> Expression:
        if name.text != "if" and name.text not in FUNCTIONS:
            known = ", ".join(["if", *FUNCTIONS])
            raise ExpressionError(f"'{name.text}' is no function; there are {known}", name.column)
        arguments = [self._cursor.nested(self._any_of)]
        while self._cursor.take(","):
            arguments.append(self._cursor.nested(self._any_of))
        self._cursor.expect(")", f"the arguments of {name.text} do not end")
        fewest, most = (3, 3) if name.text == "if" else FUNCTIONS[name.text][2:]
        if not fewest <= len(arguments) <= most:
            number = str(fewest) if fewest == most else f"{fewest} to {most}"
            raise ExpressionError(
                f"{name.text} takes {number} arguments, not {len(arguments)}", name.column
            )
        if name.text == "if":
            return Conditional(*arguments)
        return Call(name.text, tuple(arguments))


def _number(token: Token) -> Number:
    value = float(token.text)
    if math.isinf(value):
        raise ExpressionError(f"{token.text} is too large a number", token.column)
    return Number(value)


def _check_depth(expression: Expression) -> None:
    """Refuses long chains: their operations are within each other too."""
    level: list[Expression] = [expression]
    for _ in range(DEEPEST):
        level = [inner for each in level for inner in operands_of(each)]
        if not level:
            return
    raise ExpressionError(f"more than {DEEPEST} operations within each other", 1)

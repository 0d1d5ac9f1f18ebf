"""The text of expressions of attribute maps.

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
from typing import TYPE_CHECKING, NamedTuple

from .functions import FUNCTIONS
from .tree import Call, Conditional, Expression, Number, Operation, Variable, operands_of

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

_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)"
    r"|(?P<name>[^\W\d]\w*(?:\[[0-9]+\])?(?:\.[^\W\d]\w*(?:\[[0-9]+\])?)*)"
    r"|`(?P<quoted>[^`]+)`"
    r"|(?P<sign><=|>=|==|!=|[-+*/^(),<>]))"
)
_WORDS = {"and", "or", "not"}


class ExpressionError(ValueError):
    """A text is no expression.

    Attributes:
        column: Where it goes wrong, from 1.
    """

    def __init__(self, message: str, column: int) -> None:
        super().__init__(f"{message} at column {column}")
        self.column = column


def parse_expression(text: str) -> Expression:
    """Returns the expression that a text describes.

    Args:
        text: Feature `expression` of a conversion.

    Raises:
        ExpressionError: The text is no expression.
    """
    if len(text) > LONGEST:
        raise ExpressionError(f"an expression has at most {LONGEST} characters", LONGEST)
    return _Parser(text).whole()


class _Token(NamedTuple):
    kind: str
    text: str
    column: int


class _Parser:
    def __init__(self, text: str) -> None:
        self._tokens = _tokens(text)
        self._next = 0
        self._depth = 0

    def whole(self) -> Expression:
        expression = self._any_of()
        token = self._token
        if token.kind != "end":
            raise ExpressionError(f"'{token.text}' where the expression should end", token.column)
        _check_depth(expression)
        return expression

    @property
    def _token(self) -> _Token:
        return self._tokens[self._next]

    def _takes(self, *texts: str) -> str:
        """Returns the next token when it is one of some signs and words, else an empty text."""
        token = self._token
        if token.kind not in {"sign", "name"} or token.text not in texts:
            return ""
        self._next += 1
        return token.text

    def _expect(self, sign: str, why: str) -> None:
        column = self._token.column
        if not self._takes(sign):
            raise ExpressionError(f"{why}: '{sign}' is missing", column)

    def _any_of(self) -> Expression:
        return self._joined(self._all_of, "or")

    def _all_of(self) -> Expression:
        return self._joined(self._negation, "and")

    def _negation(self) -> Expression:
        if self._takes("not"):
            return Operation("not", (self._nested(self._negation),))
        left = self._sum()
        if sign := self._takes(*COMPARISONS):
            left = Operation(sign, (left, self._sum()))
            if self._token.text in COMPARISONS:
                raise ExpressionError("comparisons are joined by 'and' or 'or'", self._token.column)
        return left

    def _sum(self) -> Expression:
        return self._joined(self._product, "+", "-")

    def _product(self) -> Expression:
        return self._joined(self._signed, "*", "/")

    def _joined(self, operand: Callable[[], Expression], *signs: str) -> Expression:
        left = operand()
        while sign := self._takes(*signs):
            left = Operation(sign, (left, operand()))
        return left

    def _signed(self) -> Expression:
        if not self._takes("-"):
            return self._power()
        operand = self._nested(self._signed)
        return Number(-operand.value) if isinstance(operand, Number) else Operation("-", (operand,))

    def _power(self) -> Expression:
        base = self._single()
        return Operation("^", (base, self._nested(self._signed))) if self._takes("^") else base

    def _single(self) -> Expression:
        token = self._token
        if self._takes("("):
            inner = self._nested(self._any_of)
            self._expect(")", "a parenthesis is not closed")
            return inner
        if token.kind in {"sign", "end"} or (token.kind == "name" and token.text in _WORDS):
            before = f"'{token.text}'" if token.text else "the end"
            raise ExpressionError(f"a value is missing before {before}", token.column)
        self._next += 1
        if token.kind == "number":
            return _number(token)
        if token.kind == "name":
            if self._takes("("):
                return self._call(token)
            if token.text in CONSTANTS:
                return Number(CONSTANTS[token.text])
        return Variable(token.text, token.column)

    def _call(self, name: _Token) -> Expression:
        if name.text != "if" and name.text not in FUNCTIONS:
            known = ", ".join(["if", *FUNCTIONS])
            raise ExpressionError(f"'{name.text}' is no function; there are {known}", name.column)
        arguments = [self._nested(self._any_of)]
        while self._takes(","):
            arguments.append(self._nested(self._any_of))
        self._expect(")", f"the arguments of {name.text} do not end")
        fewest, most = (3, 3) if name.text == "if" else FUNCTIONS[name.text][2:]
        if not fewest <= len(arguments) <= most:
            number = str(fewest) if fewest == most else f"{fewest} to {most}"
            raise ExpressionError(
                f"{name.text} takes {number} arguments, not {len(arguments)}", name.column
            )
        if name.text == "if":
            return Conditional(*arguments)
        return Call(name.text, tuple(arguments))

    def _nested(self, read: Callable[[], Expression]) -> Expression:
        self._depth += 1
        if self._depth > DEEPEST:
            raise ExpressionError("operations are nested too deeply", self._token.column)
        inner = read()
        self._depth -= 1
        return inner


def _number(token: _Token) -> Number:
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


def _tokens(text: str) -> list[_Token]:
    found: list[_Token] = []
    position, end = 0, len(text.rstrip())
    while position < end:
        match = _TOKEN.match(text, position)
        if match is None or match.lastgroup is None:
            start = position + len(text[position:]) - len(text[position:].lstrip())
            raise ExpressionError(f"{text[start]!a} belongs in no expression", start + 1)
        kind = match.lastgroup
        found.append(_Token(kind, match[kind], match.start(kind) + 1))
        position = match.end()
    return [*found, _Token("end", "", end + 1)]

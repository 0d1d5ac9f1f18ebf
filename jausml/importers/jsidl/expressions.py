"""Numbers as JSIDL writes them: expressions of numbers, constants, + - * / and parentheses.

Values are exact fractions, so that limits of 64-bit integers keep their last digit.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from fractions import Fraction

LONGEST = 1000
DEEPEST = 50
_LARGEST_EXPONENT = 400

_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:[0-9][0-9,]*\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    r"|(?P<name>[A-Za-z_][A-Za-z0-9_]*(?:\s*\.\s*[A-Za-z_][A-Za-z0-9_]*)*)"
    r"|(?P<sign>[-+*/()]))"
)
_NUMBER = re.compile(r"(?:[0-9]+|[0-9]{1,3}(?:,[0-9]{3})+)?\.?[0-9]*(?:[eE]([+-]?[0-9]+))?")

Lookup = Callable[[str], Fraction]
"""Returns the value of a constant by its dotted name; raises ExpressionError."""


class ExpressionError(ValueError):
    """A text is no expression, or has no value; the message says why."""


def evaluate(text: str, constant: Lookup) -> Fraction:
    """Returns the value of an expression.

    Args:
        text: For example `-8*basicConsts.PI` or `10,000`.
        constant: Knows the constants.

    Raises:
        ExpressionError: The text is no expression, divides by zero or is out of all bounds.
    """
    if len(text) > LONGEST:
        raise ExpressionError(f"is longer than {LONGEST} characters")
    parser = _Parser(_tokens(text), constant)
    value = parser.total(0)
    if parser.token[0]:
        raise ExpressionError(f"has '{parser.token[1]}' too much")
    return value


def _tokens(text: str) -> list[tuple[str, str]]:
    tokens = []
    at = 0
    stripped = text.strip()
    while at < len(stripped):
        match = _TOKEN.match(stripped, at)
        if match is None:
            wrong = stripped[at:].strip()[0]
            raise ExpressionError(f"has {wrong!a}, which is no part of an expression")
        kind = str(match.lastgroup)
        tokens.append((kind, match.group(kind)))
        at = match.end()
    if not tokens:
        raise ExpressionError("is empty")
    return [*tokens, ("", "")]


class _Parser:
    """Recursive descent over the tokens."""

    def __init__(self, tokens: list[tuple[str, str]], constant: Lookup) -> None:
        self._tokens = tokens
        self._at = 0
        self._constant = constant

    @property
    def token(self) -> tuple[str, str]:
        return self._tokens[self._at]

    def total(self, depth: int) -> Fraction:
        value = self._product(depth)
        while self.token[1] in ("+", "-"):
            sign = self._take()
            right = self._product(depth)
            value = value + right if sign == "+" else value - right
        return value

    def _product(self, depth: int) -> Fraction:
        value = self._factor(depth)
        while self.token[1] in ("*", "/"):
            sign = self._take()
            right = self._factor(depth)
            if sign == "/" and not right:
                raise ExpressionError("divides by zero")
            value = value * right if sign == "*" else value / right
            _check_size(value)
        return value

    def _factor(self, depth: int) -> Fraction:
        if depth > DEEPEST:
            raise ExpressionError("is nested too deeply")
        kind, text = self.token
        if text in ("+", "-"):
            self._take()
            value = self._factor(depth + 1)
            return -value if text == "-" else value
        if text == "(":
            self._take()
            value = self.total(depth + 1)
            if self.token[1] != ")":
                raise ExpressionError("has a parenthesis that is not closed")
            self._take()
            return value
        if kind == "number":
            return _number(self._take())
        if kind == "name":
            return self._constant("".join(self._take().split()))
        raise ExpressionError(f"has '{text}' where a value is missing" if text else "is incomplete")

    def _take(self) -> str:
        text = self.token[1]
        self._at += 1
        return text


def _number(text: str) -> Fraction:
    match = _NUMBER.fullmatch(text)
    if match is None:
        raise ExpressionError(f"has '{text}', whose commas do not part thousands")
    exponent = match.group(1) or "0"
    if len(exponent) > 4 or abs(int(exponent)) > _LARGEST_EXPONENT:
        raise ExpressionError(f"has '{text}', which is out of all bounds")
    return Fraction(text.replace(",", ""))


def _check_size(value: Fraction) -> None:
    if max(value.numerator.bit_length(), value.denominator.bit_length()) > 20_000:
        raise ExpressionError("is out of all bounds")

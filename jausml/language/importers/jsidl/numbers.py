"""Numbers as JSIDL writes them: expressions of numbers, constants, + - * / and parentheses.

Values are exact fractions, so that limits of 64-bit integers keep their last digit.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from fractions import Fraction

from jausml.language.attributes.cursor import Language, TokenCursor

LONGEST = 1000
"""Characters of an expression; more is none that a person wrote."""
DEEPEST = 50
"""Signs and parentheses within each other."""
_LARGEST_EXPONENT = 400

_NUMBER = re.compile(r"(?:[0-9]+|[0-9]{1,3}(?:,[0-9]{3})+)?\.?[0-9]*(?:[eE]([+-]?[0-9]+))?")

Lookup = Callable[[str], Fraction]
"""Returns the value of a constant by its dotted name; raises NumberError."""


class NumberError(ValueError):
    """A text is no expression, or has no value; the message says of the text why."""


def _malformed(message: str, column: int) -> NumberError:
    return NumberError(f"is no expression: {message} at column {column}")


_LANGUAGE = Language(
    noun="expression",
    tokens=re.compile(
        r"\s*(?:(?P<number>(?:[0-9][0-9,]*\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
        r"|(?P<name>[A-Za-z_][A-Za-z0-9_]*(?:\s*\.\s*[A-Za-z_][A-Za-z0-9_]*)*)"
        r"|(?P<sign>[-+*/()]))"
    ),
    error=_malformed,
    longest=LONGEST,
    deepest=DEEPEST,
)


def evaluate(text: str, constant: Lookup) -> Fraction:
    """Returns the value of an expression.

    Raises:
        NumberError: The text is no expression, divides by zero or is out of all bounds.
    """
    if not text.strip():
        raise NumberError("is empty")
    return _Parser(text, constant).whole()


class _Parser:
    """Recursive descent over the tokens, which computes as it reads."""

    def __init__(self, text: str, constant: Lookup) -> None:
        self._cursor = TokenCursor(text, _LANGUAGE)
        self._constant = constant

    def whole(self) -> Fraction:
        value = self._total()
        self._cursor.expect_end()
        return value

    def _total(self) -> Fraction:
        value = self._product()
        while sign := self._cursor.take("+", "-"):
            right = self._product()
            value = value + right if sign == "+" else value - right
        return value

    def _product(self) -> Fraction:
        value = self._factor()
        while sign := self._cursor.take("*", "/"):
            right = self._factor()
            if sign == "/" and not right:
                raise NumberError("divides by zero")
            value = value * right if sign == "*" else value / right
            _check_size(value)
        return value

    def _factor(self) -> Fraction:
        cursor = self._cursor
        if sign := cursor.take("+", "-"):
            value = cursor.nested(self._factor)
            return -value if sign == "-" else value
        if cursor.take("("):
            return cursor.parenthesized(self._total)
        if cursor.token.kind == "number":
            return _number(cursor.advance().text)
        if cursor.token.kind == "name":
            return self._constant("".join(cursor.advance().text.split()))
        raise cursor.error(f"a value is missing before {cursor.token}")


def _number(text: str) -> Fraction:
    match = _NUMBER.fullmatch(text)
    if match is None:
        raise NumberError(f"has '{text}', whose commas do not part thousands")
    exponent = match.group(1) or "0"
    if len(exponent) > 4 or abs(int(exponent)) > _LARGEST_EXPONENT:
        raise NumberError(f"has '{text}', which is out of all bounds")
    return Fraction(text.replace(",", ""))


def _check_size(value: Fraction) -> None:
    if max(value.numerator.bit_length(), value.denominator.bit_length()) > 20_000:
        raise NumberError("is out of all bounds")

"""Units of measurement as models write them: SI symbols, and the words of JAUS.

    m/s^2    m/s²    rad s^-1    kg*m/s    N m    1    percent
    meter per second squared    square meter    newton meter    degree Celsius

In words, all that follows `per` divides. In symbols a slash divides what follows it up to the next
sign. Angles are a dimension of their own, so that a radian is not mistaken for a plain number.
"""

from __future__ import annotations

import difflib
import math
import re
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

from jausml.language.attributes.cursor import Language, LanguageError, TokenCursor

LONGEST = 200
"""Characters of a unit; more is no unit that a person wrote."""
_LARGEST_POWER = 9

Dimension = tuple[tuple[str, Fraction], ...]
"""Base quantities with their powers, without zeros, in alphabetic order."""


class UnitError(LanguageError):
    """A text is no unit.

    Attributes:
        column: Where it goes wrong, from 1.
        name: The name that is not known; empty where something else is wrong.
    """

    def __init__(self, message: str, column: int, name: str = "") -> None:
        super().__init__(message, column)
        self.name = name


@dataclass(frozen=True)
class Unit:
    """A unit: a value times `factor` plus `offset` is the value in SI base units.

    Attributes:
        dimension: What it measures. Units that measure the same have the same.
        factor: Size in SI base units and radians.
        offset: Zero of the scale in SI base units; not 0 for degrees Celsius and Fahrenheit alone.
    """

    dimension: Dimension
    factor: float
    offset: float = 0.0

    def is_compatible(self, other: Unit) -> bool:
        """Whether values of one unit can be stated in the other."""
        return self.dimension == other.dimension

    def squared(self) -> Unit:
        """The unit of the square of a value: of a variance, for example."""
        return _power(self, Fraction(2))

    def root(self) -> Unit:
        """The unit of the square root of a value."""
        return _power(self, Fraction(1, 2))


@lru_cache(maxsize=256)
def parse_unit(text: str) -> Unit:
    """Returns the unit that a text names."""
    return _Parser(text).whole()


def conversion_between(source: Unit, target: Unit) -> tuple[float, float]:
    """Returns the factor and offset from values of one unit to those of another.

    Raises:
        ValueError: The units measure different things.
    """
    if not source.is_compatible(target):
        raise ValueError("units of different dimensions")
    if source == target:
        return 1.0, 0.0
    return source.factor / target.factor, (source.offset - target.offset) / target.factor


def nearest_units(text: str) -> list[str]:
    """Returns names of units that resemble a text in which one is wrong, the nearest first."""
    try:
        parse_unit(text)
    except UnitError as error:
        known = [*_SYMBOLS, *_WORDS]
        wrong = error.name or text.strip()
        matches = difflib.get_close_matches(wrong, known, n=3, cutoff=0.6)
        return matches or difflib.get_close_matches(wrong.lower(), known, n=3, cutoff=0.6)
    return []


def _unit(factor: float = 1.0, offset: float = 0.0, /, **powers: int) -> Unit:
    return Unit(
        tuple(sorted((base, Fraction(power)) for base, power in powers.items())), factor, offset
    )


def _times(left: Unit, right: Unit) -> Unit:
    """The product, of scales that start at zero: a degree Celsius in it is a step of one kelvin."""
    powers = dict(left.dimension)
    for base, power in right.dimension:
        powers[base] = powers.get(base, Fraction(0)) + power
    dimension = tuple(sorted((base, power) for base, power in powers.items() if power))
    return Unit(dimension, left.factor * right.factor)


def _power(unit: Unit, power: Fraction) -> Unit:
    dimension = tuple((base, fraction * power) for base, fraction in unit.dimension)
    return Unit(dimension, unit.factor ** float(power))


_ANGLE = {"rad": 1}
# Symbols of the SI brochure (9th edition), tables 2, 4 and 8; the second part takes prefixes.
_PLAIN = {
    "1": _unit(),
    "min": _unit(60.0, s=1),
    "h": _unit(3600.0, s=1),
    "d": _unit(86400.0, s=1),
    "deg": _unit(math.pi / 180, **_ANGLE),
    "°": _unit(math.pi / 180, **_ANGLE),
    "rev": _unit(math.tau, **_ANGLE),
    "rpm": _unit(math.tau / 60, rad=1, s=-1),
    "%": _unit(0.01),
    "ppm": _unit(1e-6),
    "dB": _unit(dB=1),
    "°C": _unit(1.0, 273.15, K=1),
    "degC": _unit(1.0, 273.15, K=1),
    "°F": _unit(5 / 9, 459.67 * 5 / 9, K=1),
    "degF": _unit(5 / 9, 459.67 * 5 / 9, K=1),
    "kn": _unit(1852 / 3600, m=1, s=-1),
    "mph": _unit(0.44704, m=1, s=-1),
    "in": _unit(0.0254, m=1),
    "ft": _unit(0.3048, m=1),
    "mi": _unit(1609.344, m=1),
    "nmi": _unit(1852.0, m=1),
    "lb": _unit(0.45359237, kg=1),
}
_PREFIXED = {
    "m": _unit(m=1),
    "g": _unit(1e-3, kg=1),
    "s": _unit(s=1),
    "A": _unit(A=1),
    "K": _unit(K=1),
    "mol": _unit(mol=1),
    "cd": _unit(cd=1),
    "rad": _unit(**_ANGLE),
    "sr": _unit(rad=2),
    "Hz": _unit(s=-1),
    "N": _unit(kg=1, m=1, s=-2),
    "Pa": _unit(kg=1, m=-1, s=-2),
    "bar": _unit(1e5, kg=1, m=-1, s=-2),
    "J": _unit(kg=1, m=2, s=-2),
    "W": _unit(kg=1, m=2, s=-3),
    "Wh": _unit(3600.0, kg=1, m=2, s=-2),
    "C": _unit(A=1, s=1),
    "Ah": _unit(3600.0, A=1, s=1),
    "V": _unit(kg=1, m=2, s=-3, A=-1),
    "F": _unit(kg=-1, m=-2, s=4, A=2),
    "ohm": _unit(kg=1, m=2, s=-3, A=-2),
    "Ω": _unit(kg=1, m=2, s=-3, A=-2),
    "S": _unit(kg=-1, m=-2, s=3, A=2),
    "Wb": _unit(kg=1, m=2, s=-2, A=-1),
    "T": _unit(kg=1, s=-2, A=-1),
    "H": _unit(kg=1, m=2, s=-2, A=-2),
    "lm": _unit(cd=1, rad=2),
    "lx": _unit(cd=1, rad=2, m=-2),
    "Bq": _unit(s=-1),
    "Gy": _unit(m=2, s=-2),
    "Sv": _unit(m=2, s=-2),
    "L": _unit(1e-3, m=3),
    "l": _unit(1e-3, m=3),
    "bit": _unit(bit=1),
    "B": _unit(8.0, bit=1),
}
_SYMBOLS = {**_PREFIXED, **_PLAIN}
_PREFIXES = {
    "n": 1e-9, "µ": 1e-6, "μ": 1e-6, "u": 1e-6, "m": 1e-3, "c": 1e-2, "d": 1e-1,
    "da": 1e1, "h": 1e2, "k": 1e3, "M": 1e6, "G": 1e9, "T": 1e12,
}  # fmt: skip
_PREFIX_WORDS = {
    "nano": 1e-9, "micro": 1e-6, "milli": 1e-3, "centi": 1e-2, "deci": 1e-1,
    "deca": 1e1, "hecto": 1e2, "kilo": 1e3, "mega": 1e6, "giga": 1e9, "tera": 1e12,
}  # fmt: skip
# Names in words, as JAUS writes them, with the symbols that they stand for.
_WORDS = {
    "one": "1", "meter": "m", "metre": "m", "gram": "g", "second": "s", "ampere": "A",
    "kelvin": "K", "mole": "mol", "candela": "cd", "radian": "rad", "steradian": "sr",
    "hertz": "Hz", "newton": "N", "pascal": "Pa", "bar": "bar", "joule": "J", "watt": "W",
    "coulomb": "C", "volt": "V", "farad": "F", "ohm": "ohm", "siemens": "S", "weber": "Wb",
    "tesla": "T", "henry": "H", "lumen": "lm", "lux": "lx", "becquerel": "Bq", "gray": "Gy",
    "sievert": "Sv", "liter": "L", "litre": "L", "bit": "bit", "byte": "B", "minute": "min",
    "hour": "h", "day": "d", "degree": "deg", "revolution": "rev", "rotation": "rev",
    "percent": "%", "celsius": "°C", "fahrenheit": "°F", "knot": "kn", "inch": "in",
    "foot": "ft", "feet": "ft", "inches": "in", "henries": "H", "mile": "mi", "pound": "lb",
}  # fmt: skip
# What follows "degree", and the symbol of both.
_DEGREES = {
    "c": "°C", "celsius": "°C", "f": "°F", "fahrenheit": "°F", "k": "K", "kelvin": "K",
}  # fmt: skip

_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_LANGUAGE = Language(
    noun="unit",
    tokens=re.compile(
        r"\s*(?:(?P<power>\^\s*[-+]?[0-9]+|-[0-9]+|[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)|(?P<number>[0-9]+)"
        r"|(?P<name>°[CF]?|%|[A-Za-zµμΩ]+)|(?P<sign>[-*·./()]))"
    ),
    error=UnitError,
    longest=LONGEST,
    deepest=10,
    ignores_case=True,
)


class _Parser:
    """Reads one unit; units that stand side by side are multiplied."""

    def __init__(self, text: str) -> None:
        self._cursor = TokenCursor(text, _LANGUAGE)

    def whole(self) -> Unit:
        unit = self._product()
        self._cursor.expect_end()
        return unit

    def _product(self) -> Unit:
        cursor = self._cursor
        result: Unit | None = None
        divides = is_under = False
        while cursor.token.kind != "end" and cursor.token.text != ")":
            if cursor.take("/"):
                divides = True
            elif result is not None and cursor.take("*", "·", ".", "-"):
                divides = False
            is_under = bool(cursor.take("per")) or is_under
            factor = self._factor()
            if divides or is_under:
                factor = _power(factor, Fraction(-1))
            # Alone, a unit keeps the zero of its scale.
            result = factor if result is None else _times(result, factor)
        if result is None:
            raise cursor.error("a unit is missing")
        return result

    def _factor(self) -> Unit:
        if self._cursor.take("square"):
            return _power(self._single(), Fraction(2))
        if self._cursor.take("cubic"):
            return _power(self._single(), Fraction(3))
        unit = self._single()
        power = self._power()
        return unit if power == 1 else _power(unit, power)

    def _power(self) -> Fraction:
        cursor = self._cursor
        if cursor.take("squared"):
            return Fraction(2)
        if cursor.take("cubed"):
            return Fraction(3)
        # "m2" for m^2; a number anywhere else is no power.
        if cursor.token.kind not in {"power", "number"}:
            return Fraction(1)
        token = cursor.advance()
        value = int(token.text.lstrip("^").strip().translate(_SUPERSCRIPTS))
        if not 0 < abs(value) <= _LARGEST_POWER:
            raise cursor.error(f"{value} is no power of a unit", token)
        return Fraction(value)

    def _single(self) -> Unit:
        cursor = self._cursor
        if cursor.take("("):
            return cursor.parenthesized(self._product)
        token = cursor.token
        if token.kind == "number" and token.text == "1":
            cursor.advance()
            return _SYMBOLS["1"]
        if token.kind != "name":
            raise cursor.error(f"a unit is missing before {token}")
        cursor.advance()
        name = token.text
        if name.lower() in {"degree", "degrees", "deg", "°"}:
            # Nobody multiplies degrees by coulombs or farads.
            name = _DEGREES.get(cursor.take(*_DEGREES), name)
        unit = _named(name)
        if unit is None:
            raise UnitError(f"'{name}' is no known unit", token.column, name)
        return unit


def _named(name: str) -> Unit | None:
    """Returns the unit of a symbol or word, with or without a prefix."""
    if name in _SYMBOLS:
        return _SYMBOLS[name]
    for length in (1, 2):
        prefix, symbol = name[:length], name[length:]
        if prefix in _PREFIXES and symbol in _PREFIXED:
            return _times(_unit(_PREFIXES[prefix]), _PREFIXED[symbol])
    word = name.lower()
    for plain in (word, word.removesuffix("s")):
        if plain in _WORDS:
            return _SYMBOLS[_WORDS[plain]]
        for prefix, factor in _PREFIX_WORDS.items():
            symbol = _WORDS.get(plain.removeprefix(prefix), "")
            if plain.startswith(prefix) and symbol in _PREFIXED:
                return _times(_unit(factor), _PREFIXED[symbol])
    return None

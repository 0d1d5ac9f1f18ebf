"""Single values of JAUS messages as the items that structs pack, with the checks of the codecs."""

from __future__ import annotations

import ast
import struct
from typing import TYPE_CHECKING

from jausml.generation.literals import python_literal, python_string
from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.python.codec.scalars import Bits, Fixed, Tag

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml_generators.python.codec.classes import BitFieldClass


def item(value: Fixed, code: str, field: str) -> str:
    """Returns the expression that makes the item of a value.

    It makes what the codec makes, and raises what it raises; a struct that packs it does the rest.

    Args:
        value: What kind of value it is.
        code: A local variable or a literal, as Python text.
        field: Attribute that an error names.
    """
    if isinstance(value, Bits):
        return code
    if value.check == "scaled":
        return _scaled(value, code, field)
    if value.check == "integer":
        return _integer(value, code, field)
    if value.check == "real":
        lower, upper = value.limits
        checked = f"real({code}, {lower}, {upper}, {python_string(field)})"
        return (
            code if _is_number(code) else f"{code} if {lower} <= {code} <= {upper} else {checked}"
        )
    return value.pack(code, field)


def default_item(value: Fixed, bits: BitFieldClass | None, field: str) -> str:
    """Returns the item of a value as a message has it when it is made.

    Args:
        value: What kind of value it is.
        bits: Its class, when it is a bit field.
        field: Attribute that an error names.
    """
    if bits is not None:
        return bit_field_item(bits, {})
    if isinstance(value, Tag):
        return value.default
    return item(value, value.default, field)


def bit_field_item(bits: BitFieldClass, codes: Mapping[str, str]) -> str:
    """Returns the integer of a bit field whose parts are known.

    Args:
        bits: The bit field.
        codes: The values of its parts by attribute; others are as they are made.
    """
    constant, terms = 0, []
    for sub in bits.sub_fields:
        code = codes.get(sub.attribute, sub.value.default)
        if _is_number(code):
            constant |= (int(code) - sub.value.offset) << sub.low
            continue
        checked = item(sub.value, code, sub.attribute)
        terms.append(f"({checked}) << {sub.low}" if sub.low else f"({checked})")
    if constant or not terms:
        terms.append(f"0x{constant:X}")
    return " | ".join(terms)


def _scaled(value: Fixed, code: str, field: str) -> str:
    lower, step, maximum = value.limits
    if _is_number(code) and value.scale is not None:
        smallest, largest = value.scale
        position = (ast.literal_eval(code) - smallest) / ((largest - smallest) / int(maximum, 16))
        if not 0.0 <= position <= int(maximum, 16):
            raise NotFlatError(f"{code} is outside {smallest} .. {largest}")
        return str(round(position))
    checked = f"scaled({code}, {lower}, {step}, {maximum}, {python_string(field)})"
    inside = f"0.0 <= (position := {scaled_position(value, code)}) <= {maximum}"
    return f"round(position) if {inside} else {checked}"


def scaled_position(value: Fixed, code: str) -> str:
    """Returns the expression of the steps that a scaled value is away from the least one.

    Args:
        value: What kind of value it is.
        code: A local variable, as Python text.
    """
    lower, step, _ = value.limits
    number = float(lower)
    if number:
        sign = "-" if number > 0 else "+"
        code = f"({code} {sign} {python_literal(abs(number))})"
    return f"{code} / ({step})"


def _integer(value: Fixed, code: str, field: str) -> str:
    lower, upper = (int(each) for each in value.limits)
    bits = 8 * struct.calcsize(f"<{value.format}") if value.format else 0
    is_signed = value.format.islower()
    least = -(2 ** (bits - 1)) if is_signed else 0
    most = 2 ** (bits - is_signed) - 1
    if _is_number(code):
        return str(int(code, 0) - value.offset)
    if not value.offset and (lower, upper) == (least, most):
        # The struct refuses what is outside.
        return code
    minus = f" - {value.offset}" if value.offset > 0 else f" + {-value.offset}"
    checked = f"integer({code}, {lower}, {upper}, {python_string(field)})"
    either = f"{code} if {lower} <= {code} <= {upper} else {checked}"
    return f"({either}){minus}" if value.offset else either


def _is_number(code: str) -> bool:
    """Whether a Python text is a number as it is."""
    try:
        return isinstance(ast.literal_eval(code), (int, float))
    except (ValueError, SyntaxError):
        return False

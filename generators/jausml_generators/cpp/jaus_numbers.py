"""Numbers of JAUS messages as statements of C++ that read, check and write them (AS5684)."""

from __future__ import annotations

from jausml_generators.cpp.types import Plain, Type, UnprintableError, cpp_integer, cpp_number
from jausml_generators.python.codec.classes import SubField
from jausml_generators.python.codec.scalars import Fixed

NUMBERS = {
    "b": "std::int8_t",
    "B": "std::uint8_t",
    "h": "std::int16_t",
    "H": "std::uint16_t",
    "i": "std::int32_t",
    "I": "std::uint32_t",
    "q": "std::int64_t",
    "Q": "std::uint64_t",
    "f": "float",
    "d": "double",
}
"""Types of C++ by the format characters of `struct`."""

BY_SIZE = {1: "B", 2: "H", 4: "I", 8: "Q"}
"""Format characters of integers without a sign, by their bytes."""


def group(sub: SubField, kind: Plain) -> str:
    """Returns the number that bits of an integer are."""
    bits = f"(bits >> {sub.low} & 0x{sub.mask:X})" if sub.low else f"(bits & 0x{sub.mask:X})"
    offset = f" + {cpp_integer(sub.value.offset)}" if sub.value.offset else ""
    return f"static_cast<{kind.cpp}>{bits}{offset}"


def checked_group(sub: SubField, name: str, kind: Plain) -> list[str]:
    """Returns the statements that add a number to bits."""
    offset = sub.value.offset
    value = f"jausml::shifted({name}, {cpp_integer(-offset)})" if offset else name
    bits = f"static_cast<std::uint64_t>({value})"
    return [
        f"out.require(jausml::is_within({name}, {_ranges(sub.value, kind)}));",
        f"bits |= {bits} << {sub.low};" if sub.low else f"bits |= {bits};",
    ]


def read_number(value: Fixed, target: str) -> str:
    """Returns the statement that reads a number."""
    number = NUMBERS[value.format]
    if value.scale is not None:
        lower, step = _scale(value)
        return f"in.scaled<{number}>({target}, {lower}, {step});"
    if value.format in "fd":
        return f"in.real<{number}>({target});"
    return f"in.integer<{number}>({target}{_offset(value)});"


def write_number(value: Fixed, text: str, kind: Type) -> str:
    """Returns the statement that writes a number."""
    number = NUMBERS[value.format]
    match value.check:
        case "scaled" | "scaled_down" | "scaled_up":
            lower, step = _scale(value)
            return f"out.{value.check}<{number}>({text}, {lower}, {step});"
        case "real":
            lower, upper = (cpp_number(float(limit)) for limit in value.limits)
            return f"out.real<{number}>({text}, {lower}, {upper});"
        case "whole" | "whole_of":
            ranges = _ranges(value, Plain(number))
            return f"out.whole<{number}>({text}, {ranges}{_offset(value)});"
        case "integer" | "one_of":
            return f"out.integer<{number}>({text}, {_ranges(value, kind)}{_offset(value)});"
    raise UnprintableError(f"the check {value.check}")


def write_octets(value: Fixed, text: str) -> str:
    """Returns the statement that writes records of one octet."""
    number = NUMBERS[value.format]
    return f"out.octets<{number}>({text}, {_ranges(value, Plain(number))});"


def _scale(value: Fixed) -> tuple[str, str]:
    """Lower end and step, the step as the division that the standard says."""
    lower, upper = value.scale or (0.0, 0.0)
    steps = 2 ** (8 * value.size) - 1
    return cpp_number(lower), f"{cpp_number(upper - lower)} / {cpp_number(float(steps))}"


def _ranges(value: Fixed, kind: Type) -> str:
    """The legal ranges, as far as the type goes."""
    # Beyond the type a range cannot be hit, and its literal would not compile.
    least, most = (0, 2**64 - 1) if kind.cpp == NUMBERS["Q"] else (-(2**63), 2**63 - 1)
    kept = [(max(low, least), min(high, most)) for low, high in value.ranges if low <= most]
    texts = (f"{{{cpp_integer(low)}, {cpp_integer(high)}}}" for low, high in kept)
    return f"{{{', '.join(texts)}}}"


def _offset(value: Fixed) -> str:
    """A further argument where the integer on the wire is not the value."""
    return f", {cpp_integer(value.offset)}" if value.offset else ""


def unsigned(value: int) -> str:
    """Returns a limit of counts as a literal."""
    return f"{value}u" if value < 2**32 else f"{value}ULL"

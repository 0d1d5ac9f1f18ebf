"""Names of interfaces and fields by the rules of rosidl."""

from __future__ import annotations

import keyword
import re

from jausml.language.model import words
from jausml_generators.python import names

# Words of C and C++ that a struct's member cannot have; those of Python come from `keyword`.
_RESERVED = frozenset(
    """
    alignas alignof and and_eq asm auto bitand bitor bool break case catch char class compl concept
    const consteval constexpr constinit const_cast continue co_await co_return co_yield decltype
    default delete do double dynamic_cast else enum explicit export extern false float for friend
    goto if inline int long mutable namespace new noexcept not not_eq nullptr operator or or_eq
    private protected public register reinterpret_cast requires restrict return short signed sizeof
    static static_assert static_cast struct switch template this thread_local throw true try typedef
    typeid typename union unsigned using virtual void volatile wchar_t while xor xor_eq
    """.split()  # noqa: SIM905 -- a list of words is read more easily
)


def type_name(name: str) -> str:
    """Returns the name of a message type, e.g. `ReportVelocityState`."""
    text = names.class_name(name)
    return text[0].upper() + text[1:]


def field_name(name: str) -> str:
    """Returns the name of a field, e.g. `velocity_x`."""
    text = re.sub("__+", "_", words.snake_case(name)).strip("_") or "unnamed"
    text = f"n{text}" if text[0].isdigit() else text
    is_reserved = text in _RESERVED or keyword.iskeyword(text)
    return f"{text}_value" if is_reserved else text


def constant_name(*parts: str) -> str:
    """Returns the name of a constant, e.g. `GEAR_PARK`."""
    text = "_".join(word for part in parts for word in words.words(part)).upper()
    text = re.sub("__+", "_", text).strip("_") or "UNNAMED"
    return f"N{text}" if text[0].isdigit() else text

"""Lua literals: model text and tables of it stay data in a Lua file, for Lua 5.1 to 5.4."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from jausml.generation.literals import LINE_WIDTH

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    LuaValue = bool | int | float | str | Sequence["LuaValue"] | Mapping[int | str, "LuaValue"]

_INDENT = "    "
_ESCAPED = re.compile(rb'[^ -~]|["\\]')
_NAME = re.compile("[A-Za-z_][A-Za-z0-9_]*")
_KEYWORDS = frozenset(
    (
        *("and", "break", "do", "else", "elseif", "end", "false", "for", "function", "goto", "if"),
        *("in", "local", "nil", "not", "or", "repeat", "return", "then", "true", "until", "while"),
    )
)


def lua_string(value: object) -> str:
    r"""Returns an ASCII Lua string literal such as `"a\034b"`, on one line.

    Args:
        value: Any text; it stands in the string as UTF-8, a lone surrogate as U+FFFD.
    """
    text = re.sub("[\ud800-\udfff]", "\ufffd", str(value))
    # Three digits always: a shorter escape would take up a digit that follows it.
    escaped = _ESCAPED.sub(lambda m: b"\\%03d" % m.group()[0], text.encode("utf-8"))
    return f'"{escaped.decode("ascii")}"'


def lua_literal(value: LuaValue, column: int = 0) -> str:
    """Returns a Lua expression for a value, laid out like this file.

    Args:
        value: A bool, number or text, a sequence (it becomes a table counted from 1) or a mapping.

    Raises:
        TypeError: The value is of another type.
    """
    return _laid_out(value, 0, column)


def _laid_out(value: LuaValue, indent: int, column: int) -> str:
    """Returns a value for a line with some columns before it, whose own indent is given."""
    line = _on_one_line(value)
    if isinstance(value, (bool, int, float, str)) or len(line) + column <= LINE_WIDTH:
        return line
    inner = indent + len(_INDENT)
    margin = " " * inner
    items = (
        f"{margin}{key}{_laid_out(item, inner, inner + len(key) + 1)},"
        for key, item in _items(value)
    )
    return "\n".join(["{", *items, f"{' ' * indent}}}"])


def _on_one_line(value: LuaValue) -> str:
    if isinstance(value, str):
        return lua_string(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float) and not math.isfinite(value):
        return "0/0" if math.isnan(value) else "math.huge" if value > 0 else "-math.huge"
    if isinstance(value, (int, float)):
        return repr(value)
    inside = ", ".join(f"{key}{_on_one_line(item)}" for key, item in _items(value))
    return f"{{ {inside} }}" if inside else "{}"


def _items(value: LuaValue) -> Iterator[tuple[str, LuaValue]]:
    """Yields the items of a table with what stands before each."""
    if hasattr(value, "items"):
        for key, item in value.items():
            yield f"{_key(key)} = ", item
    elif isinstance(value, (list, tuple)):
        for item in value:
            yield "", item
    else:
        raise TypeError(f"no Lua literal for {type(value).__name__}")


def _key(key: int | str) -> str:
    if isinstance(key, str) and _NAME.fullmatch(key) and key not in _KEYWORDS:
        return key
    return f"[{lua_literal(key)}]"

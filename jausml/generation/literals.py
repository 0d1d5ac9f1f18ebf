"""Model text as data: literals, comments and docstrings of every output language.

All results are the same bytes on every supported Python: no Unicode category tables are asked.
"""

from __future__ import annotations

import json
import keyword
import math
import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias

LuaValue: TypeAlias = (
    "bool | int | float | str | Sequence['LuaValue'] | Mapping[int | str, 'LuaValue']"
)

LINE_WIDTH = 100
_INDENT = "    "
_LINE_ENDS = re.compile("\r\n|[\r\v\f\x1c-\x1e\x85\u2028\u2029]")
# C0 and C1 controls, zero-width and bidirectional controls, surrogates, noncharacters.
_UNPRINTABLE = re.compile(
    "[\x00-\x09\x0b-\x1f\x7f-\x9f\u00ad\u061c\u200b-\u200f\u202a-\u202e\u2060-\u2069\ufeff"
    "\ufff9-\ufffb\ufffe\uffff\ud800-\udfff]"
)
# Characters outside the Char production of XML 1.0, section 2.2.
_NOT_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
_XML_ESCAPES = {
    "&": "&amp;",
    "<": "&lt;",
    ">": "&gt;",
    '"': "&quot;",
    "'": "&apos;",
    "\t": "&#9;",
    "\n": "&#10;",
    "\r": "&#13;",
}
_XML_SPECIAL = re.compile("[&<>\"'\t\n\r]")
_SURROGATES = re.compile("[\ud800-\udfff]")
_ABOVE_BMP = re.compile("[\U00010000-\U0010ffff]")


def printable(text: str) -> str:
    """Returns the text with every kind of line end as LF and without control characters."""
    if text.isascii() and text.isprintable():
        return text
    return _UNPRINTABLE.sub(
        lambda match: " " if match.group() == "\t" else "", _LINE_ENDS.sub("\n", text)
    )


def python_string(value: object) -> str:
    r"""Returns an ASCII Python string literal, in the quotes that ruff's formatter would choose."""
    text = str(value)
    if '"' not in text and "'" not in text:
        return f'"{ascii(text)[1:-1]}"'
    quote = "'" if text.count('"') > text.count("'") else '"'
    # ascii() is free in its choice of quotes; a text with no quotes at all leaves it no choice.
    pieces = (ascii(piece)[1:-1] for piece in re.split("['\"]", text))
    marks = [f"\\{mark}" if mark == quote else mark for mark in re.findall("['\"]", text)]
    joined = "".join(piece + mark for piece, mark in zip(pieces, [*marks, ""], strict=True))
    return f"{quote}{joined}{quote}"


def python_literal(value: object) -> str:
    """Returns a Python expression for None, a bool, an int, a float, a string or bytes."""
    if isinstance(value, str):
        return python_string(value)
    if isinstance(value, bytes):
        return f'bytes.fromhex("{value.hex()}")'
    if isinstance(value, float) and not math.isfinite(value):
        return f'float("{value}")'
    if isinstance(value, float):
        # ruff's formatter writes 1e22 for what repr calls 1e+22.
        return repr(value).replace("e+", "e")
    if value is None or isinstance(value, (bool, int)):
        return repr(value)
    raise TypeError(f"no Python literal for {type(value).__name__}")


def identifier(value: object) -> str:
    """Returns a Python name (dots allowed) unchanged, for names that come from a model."""
    name = str(value)
    for part in name.split("."):
        if not (part.isascii() and part.isidentifier()) or keyword.iskeyword(part):
            raise ValueError(f"{name!r} is not a Python name")
    return name


def xml_text(value: object) -> str:
    """Returns text escaped for XML content and attribute values in either kind of quotes."""
    legal = _NOT_XML.sub("\ufffd", str(value))
    return _XML_SPECIAL.sub(lambda match: _XML_ESCAPES[match.group()], legal)


def xml_comment(value: object) -> str:
    """Returns text that may stand inside `<!-- ... -->` on one line."""
    text = " ".join(printable(str(value)).split())
    return re.sub(r"-(?=-|$)", "- ", text)


def yaml_string(value: object) -> str:
    """Returns a double-quoted ASCII YAML scalar (YAML 1.2, section 7.3.1) on one line."""
    text = json.dumps(_SURROGATES.sub("\ufffd", str(value)), ensure_ascii=False)
    # YAML reads the surrogate pairs of JSON as two characters, and DEL not at all.
    text = _ABOVE_BMP.sub(lambda match: f"\\U{ord(match.group()):08x}", text)
    return re.sub("[\x7f-\uffff]", lambda match: f"\\u{ord(match.group()):04x}", text)


def comment(value: object, indent: int = 0, prefix: str = "# ") -> str:
    """Returns text as comment lines, wrapped to the line width.

    Args:
        indent: Columns before each line; the first line is not indented here.
    """
    width = LINE_WIDTH - indent - len(prefix)
    lines: list[str] = []
    for paragraph in paragraphs(str(value)):
        lines += ["", *_wrap(paragraph, width)] if lines else _wrap(paragraph, width)
    return indented([(prefix + line).rstrip() for line in lines or [""]], indent)


def paragraphs(text: str) -> list[str]:
    """Returns the printable paragraphs of a text, each on one line; blank lines separate them."""
    joined = (" ".join(part.split()) for part in re.split(r"\n\s*\n", printable(text)))
    return [paragraph for paragraph in joined if paragraph]


def _wrap(text: str, width: int, continued: str = "", *, breaks: bool = False) -> list[str]:
    return textwrap.wrap(
        text, width, subsequent_indent=continued, break_long_words=breaks, break_on_hyphens=False
    )


def indented(lines: Sequence[str], indent: int) -> str:
    """Returns lines as one text, all but the first after some columns."""
    margin = " " * indent
    first, *others = lines
    return "\n".join([first, *(margin + line if line else "" for line in others)])


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
    escaped = _ESCAPED.sub(lambda match: b"\\%03d" % match.group()[0], text.encode("utf-8"))
    return f'"{escaped.decode("ascii")}"'


def lua_literal(value: LuaValue, column: int = 0) -> str:
    """Returns a Lua expression for a value, laid out like this file.

    Args:
        value: A bool, number or text, a sequence (it becomes a table counted from 1) or a mapping.
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


def clean(text: str | None) -> str:
    """Returns model text on one line, safe inside a docstring and a comment."""
    plain = " ".join(printable(text or "").split())
    return plain.replace("\\", "/").replace('"', "'")


def sentence(text: str) -> str:
    """Returns clean text with a capital first and a full stop last."""
    ended = _ended(text)
    return ended[0].upper() + ended[1:]


def described(text: str) -> str:
    """Returns any text as a clean sentence, even one without a printable character."""
    return sentence(clean(text) or "unnamed")


def model_docstring(value: object, indent: int = 4) -> str:
    r"""Returns a whole docstring for a text of the model, for templates.

    The first paragraph is the summary; when it is too long for a line, its first sentence is, or
    what fits of it, and the rest follows. Double quotes become single ones and a backslash becomes
    a slash, so that no text can end the literal.

    Args:
        indent: Columns before the docstring; the first line is not indented here.
    """
    texts = [clean(text) for text in paragraphs(str(value))] or ["Not documented in the model."]
    lines = docstring(_ended(texts[0]), indent, texts[1:])
    return indented(lines.split("\n"), indent)


def docstring(
    summary: str,
    column: int,
    further: Sequence[str] = (),
    attributes: Sequence[tuple[str, str]] = (),
) -> str:
    """Returns a docstring with its quotes.

    Args:
        column: Column at which it will stand; the lines themselves begin at 0.
    """
    width = LINE_WIDTH - column
    if not further and not attributes and len(summary) + 6 <= width:
        return f'"""{summary}"""'
    # ruff's formatter puts the closing quotes behind a line that stands alone, fit or not.
    first, rest = _summary(summary, width - (3 if further or attributes else 6))
    lines = [f'"""{first}']
    for paragraph in (*rest, *further):
        lines += ["", *_wrap(paragraph, width, breaks=True)]
    if attributes:
        lines += ["", "Attributes:"]
    for name, description in attributes:
        lines += _wrap(f"    {name}: {description}", width, "        ", breaks=True)
    return "\n".join([*lines, '"""'])


def _ended(text: str) -> str:
    return text if text.endswith((".", "?", "!")) else f"{text}."


def _summary(text: str, width: int) -> tuple[str, tuple[str, ...]]:
    """Returns a first line that fits, and what follows as a paragraph.

    The line ends with a sentence or a clause; only where it ends at a comma, or amid words, the
    paragraph says all again.
    """
    if len(text) <= width:
        return text, ()
    head, stop, rest = text.partition(". ")
    if stop and len(head) < width:
        return f"{head}.", (rest,)
    for mark in ("; ", ": "):
        head = text[:width].rpartition(mark)[0]
        if head:
            return f"{head}.", (sentence(text[len(head) + len(mark) :]),)
    head = text[:width].rpartition(", ")[0] or text[:width].rpartition(" ")[0] or text[: width - 1]
    return f"{head}.", (text,)

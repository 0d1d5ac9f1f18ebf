"""Docstrings from model text: wrapped, and unable to end the literal they stand in."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

from jausml.generation.literals import LINE_WIDTH, indented, paragraphs, printable

if TYPE_CHECKING:
    from collections.abc import Sequence


def clean(text: str | None) -> str:
    """Returns model text on one line, safe inside a docstring and a comment.

    Args:
        text: Any text, or None.
    """
    plain = " ".join(printable(text or "").split())
    return plain.replace("\\", "/").replace('"', "'")


def sentence(text: str) -> str:
    """Returns clean text with a capital first and a full stop last.

    Args:
        text: Clean text, not empty.
    """
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
        lines += ["", *_wrap(paragraph, width)]
    if attributes:
        lines += ["", "Attributes:"]
    for name, description in attributes:
        lines += _wrap(f"    {name}: {description}", width, "        ")
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


def _wrap(text: str, width: int, continued: str = "") -> list[str]:
    return textwrap.wrap(
        text,
        width,
        subsequent_indent=continued,
        break_long_words=True,
        break_on_hyphens=False,
    )

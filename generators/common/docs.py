"""Docstrings from model text: wrapped, and unable to end the literal they stand in."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

from jausml.generation.literals import LINE_WIDTH, printable

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
    ended = text if text.endswith((".", "?", "!")) else f"{text}."
    return ended[0].upper() + ended[1:]


def described(text: str) -> str:
    """Returns any text as a clean sentence, even one without a printable character.

    Args:
        text: Text of the model.
    """
    return sentence(clean(text) or "unnamed")


def docstring(
    summary: str,
    column: int,
    paragraphs: Sequence[str] = (),
    attributes: Sequence[tuple[str, str]] = (),
) -> str:
    """Returns a docstring with its quotes.

    Args:
        summary: Clean text of the first line.
        column: Column at which it will stand; the lines themselves begin at 0.
        paragraphs: Clean texts that follow.
        attributes: Names and clean descriptions for a section `Attributes`.
    """
    width = LINE_WIDTH - column
    if not paragraphs and not attributes and len(summary) + 6 <= width:
        return f'"""{summary}"""'
    first, rest = _summary(summary, width - 3)
    lines = [f'"""{first}']
    for paragraph in (*rest, *paragraphs):
        lines += ["", *_wrap(paragraph, width)]
    if attributes:
        lines += ["", "Attributes:"]
    for name, description in attributes:
        lines += _wrap(f"    {name}: {description}", width, "        ")
    return "\n".join([*lines, '"""'])


def _summary(text: str, width: int) -> tuple[str, tuple[str, ...]]:
    """Returns a first line that fits, and the text as a paragraph when it is not all of it."""
    if len(text) <= width:
        return text, ()
    head, stop, _ = text.partition(". ")
    if stop and len(head) < width:
        return f"{head}.", (text[len(head) + 2 :],)
    return textwrap.shorten(text, width, placeholder=" ..."), (text,)


def _wrap(text: str, width: int, continued: str = "") -> list[str]:
    return textwrap.wrap(
        text,
        width,
        subsequent_indent=continued,
        break_long_words=True,
        break_on_hyphens=False,
    )

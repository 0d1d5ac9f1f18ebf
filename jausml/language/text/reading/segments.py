"""Texts in segments that can be parsed one by one: what was not changed need not be parsed again.

A segment ends with the line on which a bracket ends an element of the text.
"""

from __future__ import annotations

import re

from jausml.language.text.reading.parsing import Parsed, parse
from jausml.language.text.tree import LONGEST, SyntaxTree

_CUT = re.compile(
    r"""
    (?P<skipped> "(?:\\[^\n]|[^"\\\n])*"? | `(?:\\[^\n]|[^`\\\n])*`? | //[^\n]* | /\*.*?(?:\*/|\Z) )
    | (?P<opening> [{(\[] )
    | (?P<closing> [})\]] ) (?P<end> [ \t]* (?://[^\n]*)? \n )?
    """,
    re.VERBOSE | re.DOTALL,
)
_NOTHING = re.compile(r"(?: \s | //[^\n]* | /\*.*?(?:\*/|\Z) )*\Z", re.VERBOSE | re.DOTALL)
_EMPTY_LINE = re.compile(r"[ \t]*\n")


def segments_of(text: str) -> list[tuple[int, str]]:
    """Cuts a text into segments.

    Returns:
        The line on which each begins, from 1, and its text.
    """
    if "\r" in text or len(text) > LONGEST:
        return [(1, text)]
    found = []
    start, line, depth = 0, 1, 0
    for match in _CUT.finditer(text):
        if match["opening"]:
            depth += 1
        elif match["closing"]:
            depth = max(depth - 1, 0)
            end = match.end()
            if match["end"] and not depth and match["closing"] == "}":
                found.append((line, text[start:end]))
                line += text.count("\n", start, end)
                start = end
    if found and _NOTHING.match(text, start):
        # Comments at the end belong to what is before them.
        line, last = found.pop()
        start -= len(last)
    return [*found, (line, text[start:])]


def parse_segment(line: int, text: str) -> Parsed:
    """Reads a segment; positions are those in the whole text."""
    parsed = parse(text, line)
    if line > 1 and parsed.document.items:
        # An empty line before it tells it from the segment before.
        parsed.document.items[0].spaced = bool(_EMPTY_LINE.match(text))
    return parsed


def joined(segments: list[Parsed]) -> Parsed:
    """Returns what parsing the whole text gives, if there is no error in it."""
    document = SyntaxTree(
        [item for each in segments for item in each.document.items],
        [comment for each in segments for comment in each.document.closing],
    )
    faults = [fault for each in segments for fault in each.faults]
    return Parsed(document, faults, [token for each in segments for token in each.tokens])

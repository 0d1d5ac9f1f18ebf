"""Layout of C++: lines that are too long are broken where they bind least."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from jausml.generation.literals import LINE_WIDTH

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

_PLACES = re.compile(
    r'"(?:[^"\\]|\\.)*"|(?<=,) | (?=(?:&&|\|\||[?:+*/-]) )|(?<= =) |(?<=>) (?=\w+;)'
)
"""Texts, in which nothing is broken, and blanks where a line may be."""

_MORE = "    "


def laid_out(lines: Iterable[str]) -> Iterator[str]:
    """Yields lines, none of them longer than it should be if it can be broken."""
    for line in lines:
        if len(line) <= LINE_WIDTH:
            yield line
            continue
        code, remark, comment = line.partition("  // ")
        if remark:
            indent = " " * (len(code) - len(code.lstrip()))
            yield f"{indent}// {comment}"
            yield from _broken(code)
        else:
            yield from _broken(line)


def _broken(line: str) -> Iterator[str]:
    indent = " " * (len(line) - len(line.lstrip()))
    while len(line) > LINE_WIDTH:
        depths = _depths(line)
        begin = len(line) - len(line.lstrip())
        places = [
            each.start()
            for each in _PLACES.finditer(line)
            if each[0] == " " and begin < each.start() <= LINE_WIDTH
        ]
        if not places:
            break
        # Of the places that fill the line by more than half, the last of those that bind least,
        # and that behind a comma before an operator.
        far = [each for each in places if each > LINE_WIDTH // 2] or places
        at = min(reversed(far), key=lambda each: (depths[each], line[each - 1] != ","))
        yield line[:at]
        line = f"{indent}{_MORE}{line[at + 1 :]}"
    yield line


def _depths(line: str) -> list[int]:
    """How many brackets are open at each character."""
    depth, found = 0, []
    for each in line:
        depth += (each in "([{") - (each in ")]}")
        found.append(depth)
    return found

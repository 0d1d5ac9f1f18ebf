"""Comments in a merge: new ones of theirs come before the same element as there.

Comments belong to no element, so that no plan has them. One that theirs removed is removed, if
our side has it unchanged; one that theirs wrote is added. So both sides keep their comments.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

from jausml.language.text.reading.scanning import scan

_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)

LineOf = Callable[[int, int, bool], "int | None"]
"""Returns the line, from 1, of the element in the merge that follows a line and column of theirs
(or that precedes them, if the last argument is True). None where there is none."""


@dataclass(frozen=True)
class Comment:
    """A comment, and its place among the characters of a text."""

    written: str
    start: int
    end: int

    @property
    def said(self) -> str:
        """The words of the comment, whatever its layout."""
        return " ".join(self.written.strip("<!-/*> \n").split())


def comments_of(text: str, *, is_xmi: bool) -> list[Comment]:
    """Returns the comments of a text."""
    if is_xmi:
        return [Comment(match.group(), *match.span()) for match in _COMMENT.finditer(text)]
    tokens = scan(text).comments
    return [Comment(str(token), token.start_pos or 0, token.end_pos or 0) for token in tokens]


def with_comments(merged: str, base: str, theirs: str, line_of: LineOf, *, is_xmi: bool) -> str:
    """Returns a merge with their changes of the comments of the base."""
    was, here, there = (comments_of(version, is_xmi=is_xmi) for version in (base, merged, theirs))
    counts = [Counter(comment.said for comment in comments) for comments in (was, here, there)]
    ends = [match.end() for match in re.finditer(r"\n|\Z", merged)]
    starts = [0, *ends[:-1]]
    edits: list[tuple[int, int, str]] = []
    for comment in here:
        # A comment that occurs once in both is the same; of several the removed one is unknown.
        if counts[0][comment.said] == counts[1][comment.said] == 1 and not counts[2][comment.said]:
            edits.append(_removal(merged, comment))
    known = counts[0] | counts[1]
    for comment in there:
        # Each comment of theirs uses up a known one of the same words: the others are new.
        known[comment.said] -= 1
        if known[comment.said] >= 0:
            continue
        begin = theirs.rfind("\n", 0, comment.start) + 1
        line, column = theirs.count("\n", 0, comment.start) + 1, comment.start - begin + 1
        is_behind = bool(theirs[begin : comment.start].strip())
        line_number = line_of(line, column, is_behind)
        at = starts[line_number - 1] if line_number is not None else len(merged)
        indentation = re.match(r"[ \t]*", merged[at:])
        margin = indentation.group() if indentation is not None else ""
        edits.append((at, at, f"{margin}{comment.written}\n"))
    newline = "\r\n" if "\r\n" in merged else "\n"
    parts: list[str] = []
    done = 0
    for start, end, new in sorted(edits, key=lambda edit: edit[0]):
        written = new.replace("\r\n", "\n").replace("\n", newline)
        parts += (merged[done:start], written)
        # A new comment may come behind a removed one.
        done = max(done, end)
    return "".join((*parts, merged[done:]))


def _removal(text: str, comment: Comment) -> tuple[int, int, str]:
    """Returns the edit that removes a comment, and its line if that has no other text."""
    start = text.rfind("\n", 0, comment.start) + 1
    end = text.find("\n", comment.end) + 1 or len(text)
    is_alone = not (text[start : comment.start] + text[comment.end : end]).strip()
    return (start, end, "") if is_alone else (comment.start, comment.end, "")

"""Texts by pieces: of a text that was parsed before in another state, only what changed is parsed.

A long piece is parsed without what its block consists of, and that is put into it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from threading import Lock
from typing import TYPE_CHECKING

from jausml.language.text.reading.cutting import common_ends, cut
from jausml.language.text.reading.joining import Joined, Part, Placed, Tokens, moved
from jausml.language.text.reading.parsing import MOST_FAULTS, Parsed, parse, parse_part
from jausml.language.text.reading.scanning import with_line_feeds
from jausml.language.text.reading.shaping import Items
from jausml.language.text.tree import LONGEST, Element, SyntaxTree

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.language.text.reading.cutting import Block, Piece

_LONG = 1_000
"""Characters from which on a piece is parsed by the pieces of its block."""

_FEW = 8
"""Texts whose trees are kept."""


@dataclass(slots=True)
class _State:
    """A text as it is cut."""

    text: str
    whole: Block


@dataclass(slots=True)
class _Kept:
    """A text that is edited: its last state, and the last one in which nothing was open.

    What was typed when something was opened is not lost when it is closed again.
    """

    last: _State
    closed: _State


class Pieces:
    """The pieces of the texts that were parsed last."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._kept: list[_Kept] = []

    def parsed(self, text: str) -> Parsed:
        """Returns what `parse` gives, but where something is wrong, other pieces do not suffer.

        May be called from any thread. Nobody may change what is returned.
        """
        text = with_line_feeds(text.removeprefix("\ufeff"))
        if len(text) > LONGEST:
            return parse(text)
        with self._lock:
            kept = self._taken(text)
            known = {id(each): each for each in (kept.last, kept.closed)} if kept else {}
            whole = cut(text, [(each.text, each.whole) for each in known.values()])
            if whole is None:
                return parse(text)
            state = _State(text, whole)
            is_open = any(each.block is not None and each.block.is_open for each in whole.pieces)
            closed = kept.closed if is_open and kept is not None else state
            self._kept = [_Kept(state, closed), *self._kept][:_FEW]
            return _joined(_all(text, whole.pieces, 0, 1, in_block=False))

    def _taken(self, text: str) -> _Kept | None:
        """Takes out what is known of another state of a text: of one that is half the same."""
        for at, each in enumerate(self._kept):
            before = each.last.text
            if 2 * sum(common_ends(before, text)) >= max(len(before), len(text)):
                return self._kept.pop(at)
        return None


def _all(
    text: str, pieces: Sequence[Piece], start: int, line: int, *, in_block: bool
) -> list[Placed]:
    """Reads pieces one behind the other, the first of a list, which begins there."""
    parts: list[Placed] = []
    key = (True, in_block)
    for piece in pieces:
        part = piece.known.get(key) or _read(text, piece, start, line, key)
        parts.append((part, line - part.line))
        start += piece.size
        line += piece.lines
        key = (False, in_block)
    return parts


def _read(text: str, piece: Piece, start: int, line: int, key: tuple[bool, bool]) -> Part:
    is_first, in_block = key
    part = piece.known.get((is_first, not in_block))
    if part is None or not _is_same_everywhere(part.parsed):
        parsed = _composed(text, piece, start, line, is_first=is_first, in_block=in_block)
        if parsed is None:
            inside = text[start : start + piece.size]
            parsed = parse_part(inside, line, is_first=is_first, in_block=in_block)
        part = Part(parsed, line, bool(parsed.faults or parsed.document.closing))
    piece.known[key] = part
    return part


def _is_same_everywhere(parsed: Parsed) -> bool:
    """Tells whether what was read is the same in a block and outside."""
    document = parsed.document
    items = document.items
    return not (parsed.faults or document.closing) and all(
        isinstance(each, Element) for each in items
    )


def _composed(
    text: str, piece: Piece, start: int, line: int, *, is_first: bool, in_block: bool
) -> Parsed | None:
    """Reads a piece by the pieces of its block; None where that is not how it is made."""
    block = piece.block
    if block is None or len(block.pieces) < 2 or piece.size < _LONG:
        return None
    begin = start + block.before
    blank = "\n" * block.lines
    shown = f"{text[start:begin]}{blank}{text[begin + block.size : start + piece.size]}"
    found = parse_part(shown, line, is_first=is_first, in_block=in_block)
    tokens = list(found.tokens)
    last = found.document.items[-1] if found.document.items else None
    if not isinstance(last, Element) or not isinstance(last.items, Items):
        return None
    faults, bracket = (1, "LBRACE") if block.is_open else (0, "RBRACE")
    if len(found.faults) > faults or tokens[-1].type != bracket:
        return None
    if last.items or last.items.start is None:
        return None
    first = line + block.lines_before
    parts = _all(text, block.pieces, begin, first, in_block=True)
    inner = _joined(parts)
    items = Joined(parts)
    items.start, items.end = last.items.start, last.items.end
    if block.is_open:
        items.end = (line + piece.lines, len(text) - text.rfind("\n"))
        last.span = last.span._replace(end_line=items.end[0], end_column=items.end[1])
    last.items = items
    last.closing += inner.document.closing
    at = next((n for n, each in enumerate(tokens) if (each.line or 1) >= first), len(tokens))
    around = [(tokens[:at], line), (inner.tokens, first), (tokens[at:], first + block.lines)]
    found.tokens = Tokens([(Part(Parsed(SyntaxTree(), [], some), at), 0) for some, at in around])
    found.faults = inner.faults + found.faults
    found.is_apart = not block.is_open and inner.is_apart
    return found


def _joined(parts: Sequence[Placed]) -> Parsed:
    """Joins parts one behind the other."""
    joined = Parsed(SyntaxTree(Joined(parts)), tokens=Tokens(parts))
    for part, by in [each for each in parts if each[0].has_more]:
        parsed = part.parsed
        joined.faults += [each._replace(span=moved(each.span, by)) for each in parsed.faults]
        joined.is_apart &= parsed.is_apart or not parsed.faults
        joined.document.closing += parsed.document.closing
    joined.is_apart &= len(joined.faults) < MOST_FAULTS
    return joined


@lru_cache(maxsize=1)
def _pieces() -> Pieces:
    return Pieces()


@lru_cache(maxsize=_FEW)
def roughly_parsed(text: str) -> Parsed:
    """Returns the tree of a text as soon as a key was pressed: parsed is the piece that changed.

    It is that of `parsed_text` unless there are syntax errors that others may follow from.
    """
    return _pieces().parsed(text)


@lru_cache(maxsize=_FEW)
def parsed_text(text: str) -> Parsed:
    """Returns the tree of a text with its syntax errors; that of a text just seen is kept."""
    found = roughly_parsed(text)
    return found if found.is_apart else parse(text)

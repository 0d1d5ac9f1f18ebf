"""Cutting of texts into pieces, of which those of an earlier state stay that the change leaves.

A piece ends with the line on which a bracket ends an element, of the text or of a block. The block
of a piece consists of pieces itself. No piece knows where it stands, so that others may change.
"""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from dataclasses import dataclass, field
from itertools import accumulate
from operator import attrgetter
from typing import TYPE_CHECKING

from jausml.language.text.tree import DEEPEST

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from jausml.language.text.reading.joining import Part

_CUT = re.compile(
    r"""
    (?: [^"`/{}()\[\]]+ | /(?![/*]) )*  # by leaps, or every character is asked for all of these
    (?: "(?:\\[^\n]|[^"\\\n])*"? | `(?:\\[^\n]|[^`\\\n])*`? | //[^\n]*
    | /\*(?:[^*]+|\*(?!/))*(?:\*/)?
    | (?P<opening> [{(\[] ) (?P<begin> [ \t\r]* \n )?
    | (?P<closing> [})\]] ) (?P<end> [ \t\r]* (?://[^\n]*)? \n )?
    | \Z )
    """,
    re.VERBOSE | re.DOTALL,
)
_NOTHING = re.compile(r"(?: \s | //[^\n]* | /\*.*?(?:\*/|\Z) )*", re.VERBOSE | re.DOTALL)


@dataclass(slots=True, eq=False)
class Piece:
    """A stretch of a text.

    Attributes:
        size: How many characters it has.
        lines: How many line ends it has.
        block: What it ends with, where that consists of pieces.
        depth: How deep its brackets are nested.
        is_balanced: Whether it closes no bracket that it did not open.
        known: What was read of it, by whether it is the first and whether it stands in a block.
    """

    size: int
    lines: int
    block: Block | None
    depth: int
    is_balanced: bool = True
    known: dict[tuple[bool, bool], Part] = field(default_factory=dict)


@dataclass(slots=True, eq=False)
class Block:
    """What stands between brackets, or the whole text.

    Attributes:
        before: Characters of its piece in front of it.
        lines_before: Line ends of its piece in front of it.
        is_open: Whether the text ends before its bracket is closed.
    """

    pieces: list[Piece]
    before: int
    lines_before: int
    size: int
    lines: int
    is_open: bool = False


@dataclass(slots=True)
class _Frame:
    """A bracket that is open, or the whole text.

    Attributes:
        start: Where its first piece begins; none where it has none.
        at: Where the piece begins that is not complete, of which these are:
        depth: How deep its brackets were nested.
        is_balanced: Whether it closed none but its own.
    """

    start: int | None
    at: int
    pieces: list[Piece] = field(default_factory=list)
    deepest: int = 0
    depth: int = 0
    is_balanced: bool = True
    end: int = 0


class _Known:
    """The pieces of another state of a text that stay as they are.

    Attributes:
        between: Those between the first and the last change, where others may be, by their text.
    """

    def __init__(self, before: str, text: str, whole: Block) -> None:
        self.between: dict[str, Piece] = {}
        front, back = common_ends(before, text)
        self._front = front
        self._shift = len(text) - len(before)
        self._in_front: dict[int, tuple[list[Piece], int]] = {}
        self._behind: list[tuple[list[int], list[Piece]]] = []
        pending = [(0, whole)]
        while pending:
            pending += self._look(before, *pending.pop(), len(before) - back)

    def _look(
        self, before: str, at: int, block: Block, old_end: int
    ) -> Iterator[tuple[int, Block]]:
        """Notes what stays of a block; yields the blocks in it of which a part may stay."""
        pieces = block.pieces
        starts = list(accumulate(map(_SIZE, pieces), initial=at))
        # The last one may go on with what comes behind it.
        first = min(max(bisect_right(starts, self._front) - 1, 0), len(pieces) - 1)
        last = max(min(bisect_left(starts, old_end), len(pieces)), first)
        if first:
            self._in_front[at] = (pieces[:first], starts[first])
        if last < len(pieces):
            self._behind.append((starts[last:], pieces[last:]))
        for index in range(first, last):
            start, end = starts[index : index + 2]
            if self._front <= start and end <= old_end:
                self.between[before[start:end]] = pieces[index]
        # A piece of this text may reach into the first one behind the change.
        for index in range(first, min(last + 1, len(pieces))):
            inner = pieces[index].block
            if inner is not None:
                yield starts[index] + inner.before, inner

    def run(self, position: int) -> tuple[list[Piece], int] | None:
        """Returns the pieces that stay from a position on, and where they end."""
        if position <= self._front and position in self._in_front:
            return self._in_front[position]
        old = position - self._shift
        for starts, pieces in self._behind:
            first = bisect_left(starts, old)
            if first < len(pieces) and starts[first] == old:
                # One that closes brackets of others may do something else now.
                wrong = (n for n in range(first, len(pieces)) if not pieces[n].is_balanced)
                last = next(wrong, len(pieces))
                return (pieces[first:last], starts[last] + self._shift) if last > first else None
        return None


def cut(text: str, known: Iterable[tuple[str, Block]] = ()) -> Block | None:
    """Cuts a text; None where brackets are nested too deep.

    `known`: states of the text that were cut before, of which pieces may stay as they are.
    """
    return _Cutter(text, [_Known(before, text, whole) for before, whole in known]).whole()


class _Cutter:
    """One run over a text."""

    def __init__(self, text: str, known: Sequence[_Known]) -> None:
        self._text = text
        self._known = known
        self._between = {part: piece for each in known for part, piece in each.between.items()}
        self._frames = [_Frame(0, 0)]
        self._is_too_deep = False

    def whole(self) -> Block | None:
        """Returns the pieces of the text."""
        text, frames = self._text, self._frames
        position = self._taken(0)
        while position < len(text) and len(frames) <= DEEPEST:
            match = _CUT.match(text, position)
            if match is None:
                break
            position = match.end()
            if match["opening"]:
                begins = match["opening"] == "{" and match["begin"]
                frames.append(_Frame(position if begins else None, position))
                if begins:
                    position = self._taken(position)
            elif match["closing"] and len(frames) > 1:
                if self._closed(match):
                    position = self._taken(position)
            elif match["closing"]:
                frames[0].is_balanced = False
        if len(frames) > DEEPEST or self._is_too_deep:
            return None
        while len(frames) > 1:
            inner, around = frames.pop(), frames[-1]
            self._end(inner, len(text))
            around.depth = max(around.depth, inner.deepest + 1)
            self._complete(around, len(text), inner, is_open=True)
        self._end(frames[0], len(text))
        return _block(text, 0, frames[0], is_open=False)

    def _closed(self, match: re.Match[str]) -> bool:
        """Closes a bracket; tells whether a piece ends there."""
        inner, around = self._frames.pop(), self._frames[-1]
        bracket = match.start("closing")
        if inner.start is not None:
            end = self._text.rfind("\n", 0, bracket) + 1
            if end < inner.at or self._text[end:bracket].strip(" \t"):
                inner.start = None
            else:
                self._end(inner, end)
        around.depth = max(around.depth, inner.deepest + 1, inner.depth + 1)
        if not match["end"] or match["closing"] != "}" or around.start is None:
            return False
        self._complete(around, match.end(), inner)
        return True

    def _end(self, frame: _Frame, end: int) -> None:
        """Makes a piece of what is left of a list; comments belong to what is before them."""
        frame.end = end
        rest = _NOTHING.match(self._text, frame.at, end)
        is_nothing = rest is not None and rest.end() == end
        if not frame.pieces or not is_nothing:
            self._complete(frame, end)
        elif end > frame.at:
            last = frame.pieces[-1]
            lines = self._text.count("\n", frame.at, end)
            frame.pieces[-1] = Piece(
                last.size + end - frame.at,
                last.lines + lines,
                last.block,
                last.depth,
                last.is_balanced,
            )

    def _complete(
        self, frame: _Frame, end: int, inner: _Frame | None = None, *, is_open: bool = False
    ) -> None:
        """Makes a piece of a list of what stands there to an end; `inner`: what it ends with."""
        start = frame.at
        known = self._between.get(self._text[start:end]) if self._between else None
        piece = known or self._made(frame, end, inner, is_open=is_open)
        frame.pieces.append(piece)
        frame.deepest = max(frame.deepest, piece.depth)
        frame.at, frame.depth, frame.is_balanced = end, 0, True

    def _made(self, frame: _Frame, end: int, inner: _Frame | None, *, is_open: bool) -> Piece:
        start = frame.at
        block = None
        if inner is not None and inner.start is not None:
            block = _block(self._text, start, inner, is_open=is_open)
        count = self._text.count
        if block is None:
            lines = count("\n", start, end)
        else:
            lines = block.lines_before + block.lines
            lines += count("\n", start + block.before + block.size, end)
        return Piece(end - start, lines, block, frame.depth, frame.is_balanced)

    def _taken(self, position: int) -> int:
        """Takes what is known from a position on; returns where it ends."""
        frame = self._frames[-1]
        if frame.start is None:
            return position
        run = next((run for each in self._known if (run := each.run(position))), None)
        if run is None:
            return position
        pieces, end = run
        frame.pieces += pieces
        frame.at = end
        depth = max(map(_DEPTH, pieces))
        frame.deepest = max(frame.deepest, depth)
        self._is_too_deep |= len(self._frames) + depth > DEEPEST
        return end


_SIZE, _LINES, _DEPTH = attrgetter("size"), attrgetter("lines"), attrgetter("depth")


def _block(text: str, start: int, frame: _Frame, *, is_open: bool) -> Block:
    begin = frame.start or 0
    before = text.count("\n", start, begin)
    lines = sum(map(_LINES, frame.pieces))
    return Block(frame.pieces, begin - start, before, frame.end - begin, lines, is_open)


def common_ends(old: str, new: str) -> tuple[int, int]:
    """Returns how many characters two texts have in common at the front and then at the back."""
    most = min(len(old), len(new))
    front = _most(most, lambda low, high: new.startswith(old[low:high], low))
    behind, shift = len(old), len(new) - len(old)
    back = _most(
        most - front,
        lambda low, high: new.startswith(old[behind - high : behind - low], behind - high + shift),
    )
    return front, back


def _most(most: int, is_common: Callable[[int, int], bool]) -> int:
    """Returns up to where all is common; each stretch is looked at about once."""
    low, high = 0, most
    while low < high:
        middle = (low + high + 1) // 2
        if is_common(low, middle):
            low = middle
        else:
            high = middle - 1
    return low

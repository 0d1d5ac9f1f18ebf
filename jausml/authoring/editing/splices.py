"""Splices: bytes of a file that others take the place of, the way back, and the text of a file."""

from __future__ import annotations

import difflib
import operator
from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from typing import TYPE_CHECKING, Any

from jausml.authoring.editing.commands import EditError
from jausml.language.text.reading.scanning import line_end

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence


@dataclass(frozen=True, slots=True)
class Splice:
    """A change of one place of a file.

    `file`: the file, relative to the root with forward slashes. `start`: offset in bytes, in the
    file as it was before any splice of the same step.
    """

    file: str
    start: int
    old: bytes
    new: bytes

    @property
    def end(self) -> int:
        """Offset behind the old bytes."""
        return self.start + len(self.old)


class FileText:
    """The text of a file, of which splices are made by offsets in characters.

    `stored`: the text without a byte order mark, its line ends as they are.
    """

    errors = "strict"
    """What becomes of characters that the encoding lacks, as `str.encode` has it."""

    def __init__(self, file: str, data: bytes, encoding: str, mark: int = 0) -> None:
        self.file = file
        self.stored = data[mark:].decode(encoding)
        self._data = data
        self._encoding = encoding
        self._mark = mark

    @cached_property
    def newline(self) -> str:
        """The line end of the file: that of its first line."""
        return line_end(self.stored)

    def splice(self, start: int, end: int, new: str) -> Splice:
        """Returns the splice that puts a text in place of characters.

        `new`: the new text, markup included, with line feeds as line ends.
        """
        first, last = self._offset(start), self._offset(end)
        data = new.replace("\n", self.newline).encode(self._encoding, self.errors)
        return Splice(self.file, first, self._data[first:last], data)

    @cached_property
    def _width(self) -> int:
        """Bytes of each character, 0 when they differ."""
        for width in (1, 2):
            if len(self.stored) * width == len(self._data) - self._mark:
                return width
        return 0

    @cached_property
    def _line_starts(self) -> tuple[list[int], list[int]]:
        """Where lines start, in bytes and in characters."""
        lines = self.stored.splitlines(keepends=True)
        sizes = (len(each.encode(self._encoding)) for each in lines)
        in_bytes = list(accumulate(sizes, initial=self._mark))
        return in_bytes, list(accumulate(map(len, lines), initial=0))

    def _character(self, offset: int) -> int:
        """Returns the offset in characters for one in bytes."""
        if self._width:
            return (offset - self._mark) // self._width
        in_bytes, in_characters = self._line_starts
        line = bisect_right(in_bytes, offset) - 1
        return in_characters[line] + len(self._data[in_bytes[line] : offset].decode(self._encoding))

    def _offset(self, character: int) -> int:
        """Returns the offset in bytes for one in characters."""
        if self._width:
            return self._mark + character * self._width
        in_bytes, in_characters = self._line_starts
        line = bisect_right(in_characters, character) - 1
        text = self.stored[in_characters[line] : character]
        return in_bytes[line] + len(text.encode(self._encoding))


def common_ends(
    old: Sequence[Any], new: Sequence[Any], is_same: Callable[[Any, Any], bool] = operator.eq
) -> tuple[int, int]:
    """Returns how many values two sequences have in common at the front and then at the back."""
    most = min(len(old), len(new))
    front = 0
    while front < most and is_same(old[front], new[front]):
        front += 1
    back = 0
    while back < most - front and is_same(old[-1 - back], new[-1 - back]):
        back += 1
    return front, back


def merged(splices: Iterable[Splice]) -> list[Splice]:
    """Returns splices of one file in order, without those of bytes that others take away."""
    found: list[Splice] = []
    # What is put in before bytes that go away stays.
    order = sorted(dict.fromkeys(splices), key=lambda each: (each.start, bool(each.old), -each.end))
    for each in order:
        if each.old == each.new:
            continue
        last = found[-1] if found else None
        if last is None or each.start >= last.end:
            found.append(each)
        elif each.end > last.end:
            message = "two changes of the same text do not go together; make one after the other"
            raise EditError(message)
    return found


def applied(data: bytes, splices: Sequence[Splice]) -> bytes:
    """Returns what splices of one file make of it.

    `splices`: those of one step, in order, none over another.
    """
    parts: list[bytes] = []
    at = 0
    for each in splices:
        if each.start < at or data[each.start : each.end] != each.old:
            raise EditError(f"{each.file} has changed since the edit", conflict=True)
        parts += (data[at : each.start], each.new)
        at = each.end
    return b"".join([*parts, data[at:]])


def inverted(splices: Sequence[Splice]) -> list[Splice]:
    """Returns the splices that make of the result of one step what was there before."""
    found = []
    shift = 0
    for each in splices:
        found.append(Splice(each.file, each.start + shift, each.new, each.old))
        shift += len(each.new) - len(each.old)
    return found


def difference(file: str, old: bytes, new: bytes) -> list[Splice]:
    """Returns the one splice that makes new bytes of old ones; none when they are the same."""
    if old == new:
        return []
    most = min(len(old), len(new))
    front = _common(most, lambda size: old[:size] == new[:size])
    back = _common(most - front, lambda size: old[len(old) - size :] == new[len(new) - size :])
    return [Splice(file, front, old[front : len(old) - back], new[front : len(new) - back])]


def unified_diff(file: str, old: bytes, new: bytes) -> str:
    """Returns the difference of two states of a file, as `diff -u` writes it."""
    lines = (_lines(old), _lines(new))
    return "".join(difflib.unified_diff(*lines, f"a/{file}", f"b/{file}"))


def _lines(data: bytes) -> list[str]:
    text = data.decode("utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8", "replace")
    return [f"{each}\n" for each in text.splitlines()]


def _common(most: int, is_common: Callable[[int], bool]) -> int:
    """Returns the greatest size, at most so many bytes, that is common; smaller ones are too."""
    low, high = 0, most
    while low < high:
        middle = (low + high + 1) // 2
        if is_common(middle):
            low = middle
        else:
            high = middle - 1
    return low

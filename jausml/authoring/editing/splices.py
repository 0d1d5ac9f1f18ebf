"""Splices: bytes of a file that others take the place of, and the way back."""

from __future__ import annotations

import difflib
import operator
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from jausml.authoring.editing.commands import EditError


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


def applied(data: bytes, splices: Sequence[Splice]) -> bytes:
    """Returns what splices of one file make of it.

    `splices`: those of one step, in order, none over another.
    """
    parts: list[bytes] = []
    at = 0
    for splice in splices:
        if splice.start < at or data[splice.start : splice.end] != splice.old:
            raise EditError(f"{splice.file} has changed since the edit", conflict=True)
        parts += (data[at : splice.start], splice.new)
        at = splice.end
    return b"".join([*parts, data[at:]])


def inverted(splices: Sequence[Splice]) -> list[Splice]:
    """Returns the splices that make of the result of one step what was there before."""
    inverses = []
    shift = 0
    for splice in splices:
        inverses.append(Splice(splice.file, splice.start + shift, splice.new, splice.old))
        shift += len(splice.new) - len(splice.old)
    return inverses


def difference(file: str, old: bytes, new: bytes) -> list[Splice]:
    """Returns the one splice that makes new bytes of old ones; none when they are the same."""
    if old == new:
        return []
    # Comparing slices is fast, so halving beats going byte by byte.
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
    return [f"{line}\n" for line in text.splitlines()]


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

"""Splices: bytes of a file that others take the place of, and the way back."""

from __future__ import annotations

import difflib
from bisect import bisect_left
from dataclasses import dataclass
from typing import AnyStr


@dataclass(frozen=True, slots=True)
class Splice:
    """A change of one place of a file; `start` is its offset in bytes."""

    start: int
    old: bytes
    new: bytes

    def inverted(self) -> Splice:
        """Returns the splice that takes it back."""
        return Splice(self.start, self.new, self.old)

    def applied(self, data: bytes) -> bytes:
        """Returns the file after the splice, for its bytes before."""
        return data[: self.start] + self.new + data[self.start + len(self.old) :]


def difference(old: bytes, new: bytes) -> Splice:
    """Returns the splice that makes new bytes of old ones."""
    front, back = common_ends(old, new)
    return Splice(front, old[front : len(old) - back], new[front : len(new) - back])


def common_ends(old: AnyStr, new: AnyStr) -> tuple[int, int]:
    """Returns how much two texts have in common at the front, and of the rest at the back."""
    # Comparing slices is fast, so halving beats going byte by byte: what is common is common
    # of each smaller size too.
    most = min(len(old), len(new))
    front = bisect_left(range(most + 1), 1, key=lambda size: old[:size] != new[:size]) - 1
    sizes = range(most - front + 1)
    back = bisect_left(sizes, 1, key=lambda size: old[len(old) - size :] != new[len(new) - size :])
    return front, back - 1


def unified_diff(file: str, old: bytes, new: bytes) -> str:
    """Returns the difference of two states of a file, as `diff -u` writes it."""
    lines = (_lines(old), _lines(new))
    return "".join(difflib.unified_diff(*lines, f"a/{file}", f"b/{file}"))


def _lines(data: bytes) -> list[str]:
    text = data.decode("utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8", "replace")
    return [f"{line}\n" for line in text.splitlines()]

"""Splices: bytes of a file that others take the place of, and the way back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import EditError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence


@dataclass(frozen=True, slots=True)
class Splice:
    """A change of one place of a file.

    Attributes:
        file: The file, relative to the root with forward slashes.
        start: Offset in bytes, in the file as it was before any splice of the same step.
    """

    file: str
    start: int
    old: bytes
    new: bytes

    @property
    def end(self) -> int:
        """Offset behind the old bytes."""
        return self.start + len(self.old)


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

    Args:
        splices: Those of one step, in order, none over another.
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

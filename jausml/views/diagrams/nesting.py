"""What stands in frames, in the order in which nested notations write it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple, Protocol

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence


class Boxed(Protocol):
    """A box."""

    @property
    def group(self) -> str:
        """Id of its frame, empty for none."""


class Framed(Protocol):
    """A frame."""

    @property
    def id(self) -> str:
        """Its id."""

    @property
    def parent(self) -> str:
        """Id of the frame around it, empty for none."""


class Step(NamedTuple):
    """A box, or where a frame begins or ends."""

    what: Literal["box", "begin", "end"]
    number: int
    depth: int


def nested(boxes: Sequence[Boxed], frames: Sequence[Framed]) -> Iterator[Step]:
    """Yields boxes and frames: first those in no frame, then each frame with its own."""
    yield from _inside("", 0, boxes, frames)


def _inside(
    frame: str, depth: int, boxes: Sequence[Boxed], frames: Sequence[Framed]
) -> Iterator[Step]:
    for number, box in enumerate(boxes):
        if box.group == frame:
            yield Step("box", number, depth)
    for number, each in enumerate(frames):
        if each.parent == frame:
            yield Step("begin", number, depth)
            yield from _inside(each.id, depth + 1, boxes, frames)
            yield Step("end", number, depth)

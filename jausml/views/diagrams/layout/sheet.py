"""What a layout engine is given and what it returns: sizes in, places out, in pixels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

Point = tuple[float, float]


class LayoutError(Exception):
    """There is no layout: the engine is missing or failed. The message says which."""


@dataclass(frozen=True)
class Row:
    """A row of a box at which lines end.

    Attributes:
        id: Id of the port.
        height: Its height.
    """

    id: str
    height: int


@dataclass(frozen=True)
class Box:
    """A box to be placed.

    Attributes:
        id: Its id.
        width: Its width.
        head: Height of what stands above the rows.
        rows: The rows, from the top; they fill the box.
        group: Id of its frame, empty for none.
        column: Its column.
    """

    id: str
    width: int
    head: int
    rows: tuple[Row, ...]
    group: str
    column: int

    @property
    def height(self) -> int:
        """Its height."""
        return self.head + sum(each.height for each in self.rows)


@dataclass(frozen=True)
class Frame:
    """A frame around boxes.

    Attributes:
        id: Its id.
        parent: Id of the frame around it, empty for none.
        width: Width of its title.
        height: Height of its title.
    """

    id: str
    parent: str
    width: int
    height: int


@dataclass(frozen=True)
class Line:
    """A line to be drawn.

    Attributes:
        id: Its id.
        source: Ids of the box and, where it ends at one, of the row.
        target: The same of the other end.
        width: Width of its label, 0 for none.
        height: Height of its label.
    """

    id: str
    source: tuple[str, str]
    target: tuple[str, str]
    width: int
    height: int


@dataclass(frozen=True)
class Sheet:
    """What is to be placed.

    Attributes:
        boxes: The boxes.
        frames: The frames, outer ones first.
        lines: The lines.
        downwards: Whether lines go from top to bottom.
        packed: Whether what no line joins is packed into a rectangle.
        facing: Whether rows of two columns face each other, as in maps.
    """

    boxes: tuple[Box, ...]
    frames: tuple[Frame, ...]
    lines: tuple[Line, ...]
    downwards: bool = False
    packed: bool = False
    facing: bool = False


@dataclass(frozen=True)
class Route:
    """The way of a line.

    Attributes:
        points: A start, then three points for each cubic Bezier curve.
        label: The middle of its label, None without one.
    """

    points: tuple[Point, ...]
    label: Point | None


@dataclass(frozen=True)
class Places:
    """Where everything stands; y grows downwards.

    Attributes:
        width: Width of all.
        height: Height of all.
        boxes: Upper left corners by id.
        frames: Upper left and lower right corners by id.
        lines: Ways by id.
    """

    width: float
    height: float
    boxes: dict[str, Point]
    frames: dict[str, tuple[Point, Point]]
    lines: dict[str, Route]


class Engine(Protocol):
    """Places what stands on a sheet."""

    def place(self, sheet: Sheet) -> Places:
        """Returns where everything stands, the same for the same sheet.

        Args:
            sheet: What is to be placed.

        Raises:
            LayoutError: There is no layout.
        """

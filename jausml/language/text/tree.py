"""Syntax tree of ros2jaus text: what is written where, before anybody asks what it means.

The tree keeps comments and documentation at the items that they belong to, so that text can be laid
out anew without a loss. Names stand in it without back quotes, texts without quotation marks.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

UNBOUNDED = "*"
"""The size of a member that is a sequence of any length."""


class Span(NamedTuple):
    """A stretch of text; lines and columns, in characters, count from 1. The end is exclusive."""

    line: int = 1
    column: int = 1
    end_line: int = 1
    end_column: int = 1


NOWHERE = Span()
"""The span of what was not read from a text."""


@dataclass(frozen=True, slots=True)
class Name:
    """A name, a keyword, a dotted or slashed reference, or the path of an attribute."""

    text: str
    span: Span = NOWHERE


@dataclass(frozen=True, slots=True)
class Number:
    """A number as it is written (`0x10`, `-1.5e3`), or a JAUS address (`100.1.1`)."""

    text: str
    span: Span = NOWHERE


@dataclass(frozen=True, slots=True)
class Text:
    """A text in quotation marks, with its escapes resolved."""

    text: str
    span: Span = NOWHERE


@dataclass(frozen=True, slots=True)
class Href:
    """A reference by file and fragment, `@"../robot.xmi#//@components.0"`."""

    text: str
    span: Span = NOWHERE


@dataclass(slots=True, kw_only=True)
class Item:
    """An item on lines of its own.

    Attributes:
        documentation: Text of the documentation comment before it, without its marks.
        comments: Ordinary comments before it, each with its marks (`// ...` or `/* ... */`).
        trailing: The ordinary comments behind it on its line, with their marks. Items with brackets
            have `closing` too: those on lines of their own before the closing bracket.
        spaced: Whether an empty line stands before it and its comments.
    """

    span: Span = NOWHERE
    documentation: str = ""
    comments: list[str] = field(default_factory=list)
    trailing: str = ""
    spaced: bool = False


@dataclass(slots=True)
class Import(Item):
    """`import "robot.xmi"`, or `import mappings.global_pose` for a file of the shipped library."""

    target: Name | Text


@dataclass(slots=True)
class Element(Item):
    """An element of a model with a block: `bridge front { ... }`, `qos { ... }`, `pose { ... }`.

    Attributes:
        keyword: The class in small letters (`bridge`, `service_connection`); None where one word
            alone stands before the block, which is `name` then: a map's name or a class.
    """

    keyword: Name | None
    name: Name | None
    items: list[BlockItem] = field(default_factory=list)
    closing: list[str] = field(default_factory=list)


@dataclass(slots=True)
class Feature(Item):
    """A feature with its values: `rate: 25`, `provides: a.B, c.D`, `qos: { depth: 5 }`."""

    name: Name
    values: list[Value] = field(default_factory=list)


@dataclass(slots=True)
class Member(Item):
    """A member of a message: `float32 speed`, `uint8 [3] codes`, `struct [ ... ] pose`.

    Attributes:
        type: The type word with its bound, such as `string<=20`; a list of members for a struct.
        size: Number of elements of an array; empty for a single member.
    """

    type: Name | list[Member]
    size: str
    name: Name | None
    features: list[Feature] = field(default_factory=list)


@dataclass(slots=True)
class End(Item):
    """One end of a map: `JAUS ReportVelocityState ( ... )` or `ROS nav_msgs/Odometry`.

    Attributes:
        members: The members that are listed; None where there are no parentheses.
    """

    is_jaus: bool
    type: Name
    members: list[Member] | None
    features: list[Feature] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Clock:
    """The word `clock` as a source: the present time."""

    span: Span = NOWHERE


@dataclass(frozen=True, slots=True)
class Call:
    """A conversion: `negate`, `scale(0.1)`, `look_up(lamp)`, `expression("2 * value")`."""

    name: Name
    arguments: tuple[Name | Number | Text, ...] = ()
    span: Span = NOWHERE


@dataclass(slots=True)
class Assignment(Item):
    """`Roll, Pitch, Yaw -> pose.orientation : frd_angles_to_flu_quaternion { ... }`.

    Attributes:
        sources: Paths; or one constant, or the clock.
    """

    sources: list[Name | Number | Text | Clock]
    targets: list[Name]
    conversions: list[Call] = field(default_factory=list)
    items: list[BlockItem] = field(default_factory=list)
    closing: list[str] = field(default_factory=list)


@dataclass(slots=True)
class Ignored(Item):
    """`ignore twist.angular`."""

    target: Name


@dataclass(slots=True)
class Direction(Item):
    """`JAUS->ROS ( ... )` or `ROS->JAUS ( ... )`."""

    to_ros: bool
    assignments: list[Assignment | Ignored] = field(default_factory=list)
    closing: list[str] = field(default_factory=list)


@dataclass(slots=True)
class Entry(Item):
    """One pair of a table, `OFF <-> false`."""

    jaus: Name | Number | Text
    ros: Name | Number | Text


@dataclass(slots=True)
class Table(Item):
    """`table lamp ( OFF <-> false  ON <-> true )`."""

    name: Name
    entries: list[Entry] = field(default_factory=list)
    closing: list[str] = field(default_factory=list)


@dataclass(slots=True)
class VectorEntry(Item):
    """One value of a test vector: `pose.orientation.z = 0.70711 ~ 1e-5`."""

    path: Name
    value: Name | Number | Text
    tolerance: Number | None = None


@dataclass(slots=True)
class Vector(Item):
    """`vector facing_north JAUS->ROS ( Yaw = 0 => pose.orientation.z = 0.70711 ~ 1e-5 )`."""

    name: Name
    to_ros: bool
    given: list[VectorEntry] = field(default_factory=list)
    expected: list[VectorEntry] = field(default_factory=list)
    closing: list[str] = field(default_factory=list)


Value: TypeAlias = Name | Number | Text | Href | Element
"""A value of a feature. An `Element` is a block: `{ ... }`, or `new record pose { ... }`."""

BlockItem: TypeAlias = (
    Element | Feature | Member | End | Direction | Assignment | Ignored | Table | Vector
)


@dataclass(slots=True)
class SyntaxTree:
    """A text."""

    items: list[Import | BlockItem] = field(default_factory=list)
    closing: list[str] = field(default_factory=list)


def lists_of(item: Item) -> list[tuple[Sequence[Item], list[str] | None]]:
    """Returns the lists of an item, each with the comments before its closing bracket.

    Returns:
        The lists in order; None for the comments where none are kept.
    """
    if isinstance(item, (Element, Assignment)):
        return [(item.items, item.closing)]
    if isinstance(item, Direction):
        return [(item.assignments, item.closing)]
    if isinstance(item, Table):
        return [(item.entries, item.closing)]
    if isinstance(item, Vector):
        return [(item.given, None), (item.expected, item.closing)]
    if isinstance(item, Feature):
        return [(value.items, value.closing) for value in item.values if isinstance(value, Element)]
    if isinstance(item, Member):
        return [(item.type if isinstance(item.type, list) else [], None), (item.features, None)]
    if isinstance(item, End):
        return [([] if item.members is None else item.members, None), (item.features, None)]
    return []


def is_bare(element: Element) -> bool:
    """Tells whether an element is written without a block: `topic /odom`."""
    names = [name for name in (element.keyword, element.name) if name is not None]
    end = (element.span.end_line, element.span.end_column)
    return not element.items and end == (names[-1].span.end_line, names[-1].span.end_column)


def is_map(items: Iterable[Item]) -> bool:
    """Tells whether a block is that of an attribute map, by its items."""
    return any(isinstance(item, End | Direction) for item in items)


LONGEST = 4 * 1024 * 1024
"""Characters that a text may have."""
DEEPEST = 64
"""How deep brackets may be nested."""

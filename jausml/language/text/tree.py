"""Syntax tree of ros2jaus text: what is written where, before anybody asks what it means.

The tree keeps comments and documentation at the items that they belong to, so that text can be laid
out anew without a loss. Names stand in it without back quotes, texts without quotation marks.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import NamedTuple, TypeAlias

from jausml.language.metamodel import ClassTable, FeatureKind, Metamodels

UNBOUNDED = "*"
"""The size of a member that is a sequence of any length."""


class Span(NamedTuple):
    """A stretch of text; lines and columns, in characters, are counted from 1."""

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
        comments: Ordinary comments before it, each with its marks (`// ...` or `/* ... */`).
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

_APART = re.compile(r'"(?:[^"\\]|\\.)*"|`(?:[^`\\]|\\.)*`|//[^\n]*|/\*.*?\*/', re.DOTALL)
"""Texts, quoted names and comments: within one there is none of the others."""
_LINE_START = re.compile(r"[ \t\r]*\*?[ ]?")
_LINE_BREAK = re.compile(r"(?<!\n)\n(?!\n)")
_ESCAPED_END = re.compile(r"\*\\(\\*)/")


def is_documentation(comment: str) -> bool:
    """Tells whether a comment documents the item behind it."""
    is_marked = comment.startswith("/**") and comment[3] not in "*/"
    return is_marked and bool(documentation_text(comment))


def ordinary_comments(text: str) -> list[str]:
    """Returns the comments of a text that document nothing, in order."""
    comments = (match.group() for match in comments_in(text))
    return [comment for comment in comments if not is_documentation(comment)]


def comments_in(text: str) -> Iterator[re.Match[str]]:
    """Yields the comments of a text, with their marks and places."""
    return (match for match in _APART.finditer(text) if match.group()[0] == "/")


def documentation_text(comment: str) -> str:
    r"""Returns the text of a documentation comment, without its marks and the stars of its lines.

    A line break stands for a blank; empty lines stand between paragraphs.
    """
    first, *further = comment[3:-2].split("\n")
    lines = [line.strip(" \t\r") for line in (first, *map(_without_star, further))]
    text = "\n".join(lines).strip("\n")
    return _ESCAPED_END.sub(r"*\1/", _LINE_BREAK.sub(" ", text))


def _without_star(line: str) -> str:
    match = _LINE_START.match(line)
    if match is None or "*" not in match.group():
        return line.lstrip(" \t\r")
    return line[match.end() :]


KEYWORDS = ("import", "JAUS", "ROS", "struct", "table", "vector", "ignore", "clock", "new")
"""Words that are names only in back quotes."""

_WORD_STARTS = re.compile(r"(?<=[a-z0-9])(?=[A-Z][a-z])")
_QUALITY_OF_SERVICE = ("QoS", "Qos")


def snake_case(class_name: str) -> str:
    """Returns the name of a class in small letters with underscores, as `message_def`."""
    return _WORD_STARTS.sub("_", class_name.replace(*_QUALITY_OF_SERVICE)).lower()


def classes_by_keyword(metamodels: Metamodels) -> Mapping[str, ClassTable]:
    """Returns the classes that have elements, by the keywords that stand for them.

    A keyword that several classes share stands for none: they are named with their packages
    (`ros.node`), which every class may be.
    """
    concrete = [table for table in metamodels.classes.values() if not table.abstract]
    names = [snake_case(table.name) for table in concrete]
    classes_by_name = {
        f"{class_table.package.name}.{snake_case(class_table.name)}": class_table
        for class_table in concrete
    }
    short = zip(names, concrete, strict=True)
    return classes_by_name | {name: table for name, table in short if names.count(name) == 1}


@cache
def owning_features(owner: ClassTable, table: ClassTable) -> tuple[str, ...]:
    """Returns the features of a class that may own an element of another class.

    The feature of the very class goes before one of a class that it specialises: a bridge of a
    system is one of its bridges, and not just one of its components.
    """
    taking = {
        name: feature.target
        for name, feature in owner.features.items()
        if feature.kind is FeatureKind.CONTAINMENT and feature.target in table.supertypes
    }
    exact = tuple(name for name, target in taking.items() if target is table)
    return exact or tuple(taking)

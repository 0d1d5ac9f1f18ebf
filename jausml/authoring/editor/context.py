"""The context of a place in a text: lists, classes, parts of items.

The tree tells the lists, for the parser keeps them when an item in them is wrong. The tokens before
the place tell the part.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import Enum
from functools import cache
from itertools import chain
from typing import TYPE_CHECKING

from jausml.authoring.editor.places import Place, end_of
from jausml.language.metamodel import ClassTable, FeatureKind, FeatureTable, load_metamodels
from jausml.language.text import tree
from jausml.language.text.keywords import classes_by_keyword
from jausml.language.text.reading.shaping import Items

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from lark import Token

    from jausml.language.text.reading.parsing import Parsed

ASSIGNMENTS = ("bridge.FieldAssignment", "bridge.ListAssignment", "bridge.MessageAssignment")


@cache
def keywords() -> Mapping[str, ClassTable]:
    """Returns the classes by their keywords."""
    return classes_by_keyword(load_metamodels())


def table(qualified_class: str) -> ClassTable:
    """Returns the class of a qualified name."""
    return load_metamodels().classes[qualified_class]


def class_of(element: tree.Element, owner: ClassTable | None) -> ClassTable | None:
    """Returns the class of a block, None when it is not known.

    `owner`: the class of the block around it; None on top level.
    """
    if element.keyword is not None:
        return keywords().get(element.keyword.text)
    if any(isinstance(item, (tree.End, tree.Direction)) for item in element.items):
        return table("bridge.AttributeMap")
    name = element.name.text if element.name is not None else ""
    if name in keywords():
        return keywords()[name]
    attribute_map = table("bridge.AttributeMap")
    holds_maps = owner is None or attribute_map in contained_classes(owner)
    return attribute_map if holds_maps else None


def class_of_value(element: tree.Element, feature: FeatureTable | None) -> ClassTable | None:
    """Returns the class of a block that is the value of a feature."""
    if element.keyword is not None:
        return keywords().get(element.keyword.text)
    return feature.target if feature is not None else None


def features_of(container: tree.Item | None, owner: ClassTable | None) -> dict[str, FeatureTable]:
    """Returns the features that a block can state."""
    if isinstance(container, tree.Assignment):
        tables = [table(assignment) for assignment in ASSIGNMENTS]
        return {
            name: feature
            for class_table in tables
            for name, feature in class_table.features.items()
        }
    if isinstance(container, tree.Member):
        names = ("units", "frame", "minimum", "maximum", "optional")
        known = {**table("ros.PrimitiveField").features, **table("jaus.FixedField").features}
        return {name: known[name] for name in names if name in known}
    if isinstance(container, tree.End):
        return dict(table("jaus.MessageDef").features)
    return dict(owner.features) if owner is not None else {}


def feature_named(
    feature: tree.Feature, container: tree.Item | None, owner: ClassTable | None
) -> FeatureTable | None:
    """Returns the feature of the metamodels that an item names; None for an unknown one."""
    return features_of(container, owner).get(feature.name.text)


def contained_classes(owner: ClassTable) -> list[ClassTable]:
    """Returns the classes of what an element of a class can own."""
    classes: dict[ClassTable, None] = {}
    for feature in owner.features.values():
        if feature.kind is FeatureKind.CONTAINMENT and feature.target is not None:
            concrete = [subtype for subtype in feature.target.subtypes if not subtype.abstract]
            classes.update(
                dict.fromkeys(sorted(concrete, key=lambda class_table: class_table.name))
            )
    return list(classes)


_WORD_AT_END = re.compile(r"[\w./`\[\]]*\Z")
_REST_OF_WORD = re.compile(r"[\w./`\[\]]*")
_GOES_ON = {"ARROW", "COMMA", "COLON", "LPAR", "EQUAL", "PAIR", "GIVES", "AT_MOST", "NEW"}


class Part(Enum):
    """The part of an item that stands at a place."""

    ITEM = "the beginning of an item"
    IMPORT = "a file of the library"
    JAUS_TYPE = "a JAUS message"
    ROS_TYPE = "a ROS message"
    MEMBER = "a member of a message"
    SOURCE = "a source path"
    TARGET = "a target path"
    CONVERSION = "a conversion"
    ARGUMENT = "an argument of a conversion"
    VALUE = "a value of a feature"
    NOTHING = "what nobody can tell"


@dataclass(frozen=True, slots=True)
class Level:
    """A list that a place is in.

    `item`: what the list belongs to; None for the document itself.
    """

    item: tree.Item | None
    table: ClassTable | None
    items: Sequence[tree.Item]


@dataclass(frozen=True, slots=True)
class Context:
    """The surroundings of a place.

    Attributes:
        levels: The lists around it, the outermost first.
        start: Where that word begins.
        end: Where the whole word ends.
        about: The conversion of an argument, or the feature of a value.
    """

    levels: tuple[Level, ...]
    part: Part
    word: str
    start: Place
    end: Place
    about: str = ""
    in_text: bool = False

    @property
    def item(self) -> tree.Item | None:
        """The item of the innermost list."""
        return self.levels[-1].item

    @property
    def table(self) -> ClassTable | None:
        """The class of the innermost block."""
        return self.levels[-1].table

    def around(self, kind: type[tree.Item]) -> tree.Item | None:
        """Returns the innermost item of a kind around the place."""
        items = (level.item for level in reversed(self.levels) if isinstance(level.item, kind))
        return next(items, None)

    @property
    def map(self) -> tree.Element | None:
        """The attribute map around the place."""
        wanted = table("bridge.AttributeMap")
        for level in reversed(self.levels):
            if level.table is wanted and isinstance(level.item, tree.Element):
                return level.item
        return None

    def end_of_map(self, *, is_jaus: bool) -> tree.End | None:
        """Returns an end of the map around the place."""
        items = self.map.items if self.map is not None else []
        ends = (item for item in items if isinstance(item, tree.End) and item.is_jaus == is_jaus)
        return next(ends, None)


def context_at(text: str, parsed: Parsed, place: Place) -> Context:
    """Returns where a place is."""
    line = _line_of(text, place.line)
    before = line[: place.column - 1]
    match = _WORD_AT_END.search(before)
    word = match.group() if match is not None else ""
    rest = _REST_OF_WORD.match(line, place.column - 1)
    start = Place(place.line, place.column - len(word))
    end = Place(place.line, rest.end() + 1 if rest is not None else place.column)
    levels = tuple(_levels(parsed.document, start))
    tokens = (token for token in reversed(parsed.tokens) if _position(token) <= start)
    last = next(tokens, None)
    quoted = last if last is not None and _is_text_around(last, place) else None
    behind = [] if last is None or last is quoted or _position(last) == start else [last]
    statement = _statement(chain(behind, tokens), levels[-1], start)
    part, about = _part(levels[-1], statement)
    return Context(levels, part, word, start, end, about, quoted is not None)


def _line_of(text: str, line: int) -> str:
    """Returns a line of a text, counted from 1; an empty one behind the end."""
    lines = text.split("\n", line)
    return lines[line - 1] if len(lines) >= line else ""


def _position(token: Token) -> Place:
    return Place(token.line or 1, token.column or 1)


def _is_text_around(token: Token, place: Place) -> bool:
    if token.type != "TEXT" or token.line != place.line:
        return False
    return (token.column or 1) < place.column <= (token.end_column or 1)


def _levels(document: tree.SyntaxTree, place: Place) -> Iterable[Level]:
    """Yields the lists that hold a place."""
    level = Level(None, None, document.items)
    while True:
        yield level
        inner = [
            inner_level for inner_level in _inner_levels(level) if _holds(inner_level.items, place)
        ]
        if not inner:
            return
        # A list whose bracket is missing reaches to the end of the text: the last one counts.
        level = inner[-1]


def _holds(items: Sequence[tree.Item], place: Place) -> bool:
    if not isinstance(items, Items) or items.start is None:
        return False
    return Place(*items.start) < place <= Place(*items.end)


def _inner_levels(level: Level) -> Iterable[Level]:
    """Yields the lists of the items of a list."""
    for item in level.items:
        if isinstance(item, tree.Feature):
            known = feature_named(item, level.item, level.table)
            for value in item.values:
                if isinstance(value, tree.Element):
                    yield Level(value, class_of_value(value, known), value.items)
        else:
            own = class_of(item, level.table) if isinstance(item, tree.Element) else None
            for items, _ in tree.lists_of(item):
                yield Level(item, own, items)


def _statement(tokens: Iterable[Token], level: Level, start: Place) -> list[Token]:
    """Returns the tokens of the unfinished item before a place; `tokens`: the last one first."""
    begin = _begin(level, start)
    line = start.line
    statement: list[Token] = []
    for token in tokens:
        # A new line begins a new item unless the one before cannot end there.
        if _position(token) < begin or (token.line != line and token.type not in _GOES_ON):
            break
        statement.insert(0, token)
        line = token.line or 1
    return statement


def _begin(level: Level, start: Place) -> Place:
    """Returns the end of the last whole item before a place, or the beginning of the list."""
    opening = level.items.start if isinstance(level.items, Items) else None
    begin = Place(opening[0], opening[1] + 1) if opening is not None else Place(1, 1)
    ends = (end_of(item.span) for item in level.items)
    return max([begin, *(end for end in ends if end < start)])


def _part(level: Level, statement: Sequence[Token]) -> tuple[Part, str]:
    """Returns the part that follows the tokens of an unfinished item, and its subject."""
    item = level.item
    types = [token.type for token in statement]
    last = types[-1] if types else ""
    if isinstance(item, (tree.Direction, tree.Assignment)) and (
        part := _assignment_part(statement)
    ):
        return part
    if "COLON" in types and last in ("COLON", "COMMA"):
        return Part.VALUE, str(statement[types.index("COLON") - 1])
    if isinstance(item, tree.Vector):
        side = Part.SOURCE if level.items is item.given else Part.TARGET
        return (Part.NOTHING if last == "EQUAL" else side), ""
    if isinstance(item, tree.End) and not types:
        return Part.MEMBER, ""
    if last in ("JAUS", "ROS", "IMPORT"):
        parts = {"JAUS": Part.JAUS_TYPE, "ROS": Part.ROS_TYPE, "IMPORT": Part.IMPORT}
        return parts[last], ""
    return (Part.ITEM if not types else Part.NOTHING), ""


def _assignment_part(statement: Sequence[Token]) -> tuple[Part, str] | None:
    types = [token.type for token in statement]
    last = types[-1] if types else ""
    if last == "IGNORE":
        return Part.TARGET, ""
    if types.count("LPAR") > types.count("RPAR"):
        opening = len(types) - 1 - types[::-1].index("LPAR")
        return Part.ARGUMENT, str(statement[opening - 1])
    if "ARROW" in types:
        if last in ("ARROW", "COMMA", "COLON"):
            return (Part.CONVERSION if "COLON" in types else Part.TARGET), ""
        return Part.NOTHING, ""
    if "COLON" in types:
        return None
    return (Part.SOURCE, "") if not types or last == "COMMA" else (Part.NOTHING, "")

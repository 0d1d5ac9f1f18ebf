"""Lists of a syntax tree, taken apart into one piece for each element, and put together again.

Several blocks may be the values of one feature, and the assignments of a direction share its
brackets. Taken apart, each may go, come or change by itself.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias, cast

from jausml.language.metamodel import ClassTable, FeatureKind
from jausml.language.text.tree import (
    Assignment,
    Call,
    Direction,
    Element,
    End,
    Feature,
    Import,
    Item,
    Table,
    Vector,
    lists_of,
)
from jausml.language.text.writing.layout import space
from jausml.language.text.writing.unparsing import MAP

Part: TypeAlias = "Item | Call"


@dataclass(slots=True)
class Piece:
    """An item with at most one element.

    Attributes:
        part: What stood for the element before: the item itself, or the block that is its value.
        origin: The direction or feature that it shares with others; its own head for that.
    """

    item: Item
    part: Part | None = None
    origin: Direction | Feature | None = None


def pieces_of(items: Iterable[Item]) -> Iterator[Piece]:
    """Yields the pieces of a list. The items stay as they are."""
    for item in items:
        if isinstance(item, Direction):
            yield Piece(item, item, item)
            yield from (Piece(assignment, assignment, item) for assignment in item.assignments)
        elif isinstance(item, Feature) and any(isinstance(value, Element) for value in item.values):
            yield from _values(item)
        else:
            yield Piece(item, item)


def _values(item: Feature) -> Iterator[Piece]:
    if len(item.values) == 1 and isinstance(item.values[0], Element):
        yield Piece(item, item.values[0])
        return
    for value in item.values:
        alone = Feature(item.name, [value])
        # What is before the feature belongs to its first value, what trails it to the last.
        if value is item.values[0]:
            alone.comments, alone.documentation = item.comments, item.documentation
            alone.spaced = item.spaced
        if value is item.values[-1]:
            alone.trailing = item.trailing
        yield Piece(alone, value if isinstance(value, Element) else alone, item)


def piece_of(part: Item, items: Iterable[Item]) -> Piece | None:
    """Returns the piece of an element, without a heading that stays before the next one."""
    pieces = list(pieces_of(items))
    for piece in pieces:
        if piece.part is part:
            # A heading is of what follows too, unless nothing does.
            heading = heading_of(piece.item) if piece is not pieces[-1] else []
            own = piece.item.comments[len(heading) :]
            return Piece(replace(piece.item, comments=own), part, piece.origin)
        is_whole = isinstance(piece.part, Item) and not isinstance(piece.item, Direction)
        for inner, _ in lists_of(piece.part) if is_whole else ():  # type: ignore[arg-type]
            inner_piece = piece_of(part, inner)
            if inner_piece is not None:
                return inner_piece
    return None


def list_of(pieces: Iterable[Piece]) -> list[Item]:
    """Returns the list that pieces make. A direction that has lost all it had goes."""
    items: list[Item] = []
    heads: list[tuple[Direction, Direction]] = []
    origin: Direction | Feature | None = None
    for piece in pieces:
        item = piece.item
        if isinstance(item, Direction):
            heads.append((item, replace(item, assignments=[])))
            items.append(heads[-1][1])
        elif isinstance(piece.origin, Direction):
            # Something came between the arrows of one direction, so its brackets open again.
            if piece.origin is not origin:
                again = Direction(piece.origin.to_ros)
                set_apart(items, again)
                items.append(again)
            cast("Direction", items[-1]).assignments.append(cast("Assignment", item))
        elif isinstance(piece.origin, Feature) and isinstance(item, Feature):
            last = items[-1] if items else None
            if piece.origin is origin and isinstance(last, Feature) and _can_join(last, item):
                last.values += item.values
                last.trailing = item.trailing
            else:
                items.append(replace(item, values=[*item.values]))
        else:
            items.append(item)
        origin = piece.origin
    # A direction that was empty before was meant to be there.
    emptied = {id(new) for old, new in heads if old.assignments and _says_nothing(new)}
    return [entry for entry in items if id(entry) not in emptied]


def _says_nothing(item: Direction) -> bool:
    return not (item.assignments or item.comments or item.trailing or any(item.closing))


def _can_join(last: Feature, item: Feature) -> bool:
    # Within one feature the comments would lose their place.
    return not (last.trailing or last.documentation or item.documentation or item.comments)


def set_apart(before: Sequence[Item], item: Item) -> None:
    """Sets a new item apart from the one before, as items of its kind are."""
    if len(before) > 1 and type(before[-1]) is type(item):
        item.spaced = before[-1].spaced
    elif before:
        # space() sets both, and the item that is there already is to stay.
        kept = before[-1].spaced
        space([*before[-1:], item])
        before[-1].spaced = kept


def heading_of(item: Item) -> list[str]:
    """Returns the comments before an item that an empty line parts from it."""
    ends = [at + 1 for at, comment in enumerate(item.comments) if not comment]
    return item.comments[: ends[-1]] if ends else []


def comments_in(item: Item) -> Iterator[str]:
    """Yields the comments within an item, without those at itself."""
    for items, closing in lists_of(item):
        for inner_item in items:
            yield from (*filter(None, inner_item.comments), *filter(None, [inner_item.trailing]))
            yield from comments_in(inner_item)
        yield from filter(None, closing or ())


def in_place_of(old: Item, new: Item) -> Item:
    """Returns a new item with the comments and the empty line of an old one."""
    said = Counter(comments_in(new))
    # A new element may have no place for them within it, so they go before it.
    lost = list((Counter(comments_in(old)) - said).elements())
    new.comments, new.trailing, new.spaced = [*old.comments, *lost], old.trailing, old.spaced
    return new


_MAP_ORDER = (
    *("openDecisions", "tables", "quantities", "joins", "reportJoins", "stopRos", "stopJaus"),
    *("toRos", "toJaus", "vectors"),
)
"""The features of maps that own elements, in the order in which they are written."""


def rank_of(item: Item, table: ClassTable, owned: dict[int, str], part: Part | None = None) -> int:
    """Returns where an item stands in a block by the metamodel."""
    # Imports and the ends of a map come before all features.
    if isinstance(item, Import):
        return -3
    if isinstance(item, End):
        return -2 if item.is_jaus else -1
    if isinstance(item, Direction):
        return rank(table, "toRos" if item.to_ros else "toJaus")
    if isinstance(item, Table | Vector):
        return rank(table, "tables" if isinstance(item, Table) else "vectors")
    if isinstance(item, Feature):
        return rank(table, item.name.text)
    return rank(table, owned.get(id(part), "" if isinstance(item, Element) else "assignments"))


def rank(table: ClassTable, name: str) -> int:
    """Returns where the values of a feature stand: elements that are owned come last."""
    feature = table.features.get(name)
    if feature is None:
        return 0
    features = list(table.features)
    if feature.kind is not FeatureKind.CONTAINMENT:
        return features.index(name)
    if table.qualified_name == MAP and name in _MAP_ORDER:
        return len(features) + _MAP_ORDER.index(name)
    return len(features) + features.index(name)

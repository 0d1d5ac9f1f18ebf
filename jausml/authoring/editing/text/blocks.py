"""Blocks of a text as they will be: what stands there, what has changed, and what comes new.

A *copy* is an element as it will be; its *part* is the node of the parsed tree that stands for it,
if one does. A *piece* is what a list of the tree has of one element. Whatever no command touches
stays the very node that was parsed.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any, cast

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.drafts import Context
from jausml.authoring.editing.text.item_writer import ItemWriter
from jausml.authoring.editing.text.naming import Naming
from jausml.authoring.editing.text.pieces import (
    Part,
    Piece,
    heading_of,
    in_place_of,
    list_of,
    piece_of,
    pieces_of,
    rank,
    rank_of,
    set_apart,
)
from jausml.authoring.editing.working_copy import ElementCopy
from jausml.language.metamodel import ClassTable
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.names import name_of
from jausml.language.text import tree
from jausml.language.text.keywords import keyword_of, owning_features
from jausml.language.text.reading.document import TextDocument
from jausml.language.text.writing.spelling import IN_THE_HEAD, is_comment, is_name
from jausml.language.text.writing.unparsing import IMPLIED_PARTS, MAP

_ENDS = {"message": True, "type": False}
"""The features of a map that its ends say, and whether each is the JAUS end."""
_BY_ARROW = frozenset({"target", "source", "value"})


class Blocks:
    """Maker of the blocks of one text, by the changes of its planner.

    Attributes:
        changed: Features of each element that have new values; False for one without values now.
        touched: Elements in which something changes, by id of their part.
        gone: Ids of the parts of elements that are removed, or moved away.
        placed: Elements that are new, or are moved to here.
        implied: Root elements that the text does not write.
    """

    def __init__(self, context: Context, names: Naming) -> None:
        self._context = context
        self._writer = ItemWriter(context, names)
        self._names = names
        self.written = cast("TextDocument", context.document.written)
        self.changed: dict[ElementCopy, dict[str, bool]] = {}
        self.touched: dict[int, ElementCopy] = {}
        self.gone: set[int] = set()
        self.placed: list[ElementCopy] = []
        roots = context.working_copy.roots[context.file]
        self.implied = [root for root in roots if self.part(root) is None]

    def part_of(self, obj: EObject) -> Part | None:
        """Returns the part of an element that was read; None without one."""
        node = self._context.model.node_of(obj)
        return None if node is None else self.written.source_of(node)

    def part(self, copy: ElementCopy) -> Part | None:
        """Returns the part of a copy; None without one in this text."""
        is_here = copy.obj is not None and copy.file == self._context.file
        return self.part_of(cast("EObject", copy.obj)) if is_here else None

    def refusal(self, copy: ElementCopy) -> EditError:
        """Returns the error for a change of an element that the text does not write."""
        kind, name = copy.table.name, copy.obj and name_of(copy.obj)
        what = f"{kind} '{name}'" if name else f"this {kind}"
        message = f"{what} follows from the rest of {self._context.file}: edit the text"
        if copy.owner is None:
            keyword = keyword_of(kind)
            message += f", and put {keyword} {name or 'NAME'} {{ ... }} around what it has"
        return EditError(message)

    def items(self, items: Sequence[tree.Item]) -> list[tree.Item]:
        """Returns the items of the text."""
        pieces = self._kept(items)
        for placed in self.placed:
            owner = placed.owner
            if owner is None or owner not in self.implied:
                continue
            if placed.feature not in IMPLIED_PARTS.get(owner.table.qualified_name, ()):
                raise self.refusal(owner)
            self._insert_element(pieces, placed, owner)
        return list_of(pieces)

    def _kept(self, items: Iterable[tree.Item]) -> list[Piece]:
        """Returns the pieces of a list, with their changes."""
        pieces = []
        heading: list[str] = []
        for piece in pieces_of(items):
            if id(piece.part) in self.gone:
                # A heading that an empty line sets apart is of what follows too: it stays.
                heading += heading_of(piece.item)
                continue
            copy = self.touched.get(id(piece.part))
            pieces.append(piece if copy is None else self._merged(piece, copy))
            if heading:
                item = pieces[-1].item
                pieces[-1].item = replace(item, comments=[*heading, *item.comments], spaced=True)
                heading = []
        return pieces

    def _block(self, items: Iterable[tree.Item], copy: ElementCopy) -> list[tree.Item]:
        """Returns the items in the block of an element."""
        pieces = self._kept(items)
        for name, is_said in self.changed.get(copy, {}).items():
            self._write_feature(pieces, copy, name, is_said=is_said)
        for placed in self.placed:
            if placed.owner is copy:
                self._insert_element(pieces, placed, copy)
        return list_of(pieces)

    # What changes where it stands

    def _merged(self, piece: Piece, copy: ElementCopy) -> Piece:
        part, changed = piece.part, self.changed.get(copy, {})
        if isinstance(part, tree.Element):
            # The block may be the value of a feature, whose own words stay.
            block = replace(part)
            item = block if piece.item is part else replace(piece.item, values=[block])  # type: ignore[call-arg]
            if "name" in changed and not _has_feature(part, "name"):
                self._rename(block, copy, part)
            self._write_documentation(item, copy, part)
            block.items = self._block(part.items, copy)  # type: ignore[assignment]
            return Piece(item, part, piece.origin)
        merged: tree.Item | None = None
        if isinstance(part, tree.Assignment | tree.Ignored):
            merged = self._assignment(part, copy)
        elif isinstance(part, tree.Table | tree.Vector):
            merged = self._pairs(part, copy)
        if merged is not None:
            self._write_documentation(merged, copy, cast("tree.Item", part))
            return Piece(merged, part, piece.origin)
        around = self.part(copy.owner) if copy.owner is not None else None
        new = in_place_of(piece.item, self._writer.item(copy, around))
        # What is written as another kind of item cannot share the brackets of its neighbours.
        is_alike = type(new) is type(piece.item) or isinstance(new, tree.Assignment | tree.Ignored)
        return Piece(new, part, piece.origin if is_alike else None)

    def _rename(self, block: tree.Element, copy: ElementCopy, part: tree.Element) -> None:
        """Writes a new name before a block; one that is no word is left to the feature `name`."""
        kind, word = tree.Name(keyword_of(copy.table.name)), tree.Name(copy.name)
        is_sayable = is_name(copy.name)
        if block.keyword is not None:
            block.name = word if is_sayable else None
        elif self._is_named_by(part, copy):
            block.name = word if is_sayable else kind
        elif is_sayable:
            block.keyword, block.name = block.name or kind, word

    def _is_named_by(self, part: tree.Element, copy: ElementCopy) -> bool:
        """Tells whether the one word before a block is the name of the element."""
        node = self._context.model.node_of(cast("EObject", copy.obj))
        children = node.children if node is not None else ()
        spans = [self.written.value_span(child) for child in children if child.tag == "name"]
        return part.name is not None and any(span is part.name.span for span in spans)

    def _write_documentation(self, item: tree.Item, copy: ElementCopy, part: tree.Item) -> None:
        if "documentation" in self.changed.get(copy, {}) and not _has_feature(
            part, "documentation"
        ):
            text = next(iter(copy.values.get("documentation", ())), None)
            item.documentation = text if text is not None and is_comment(text) else ""

    def _assignment(
        self, part: tree.Assignment | tree.Ignored, copy: ElementCopy
    ) -> tree.Item | None:
        """Returns the arrow after the changes, None where it must be written in another form."""
        new, changed = self._writer.arrow(copy), self.changed.get(copy, {})
        if isinstance(part, tree.Ignored):
            return replace(part, target=new.target) if isinstance(new, tree.Ignored) else None
        if not isinstance(new, tree.Assignment):
            return None
        assignment = replace(part, items=self._block(part.items, copy))  # type: ignore[arg-type]
        if "target" in changed:
            assignment.targets = new.targets
        if not changed.keys().isdisjoint({"source", "value"}):
            assignment.sources = new.sources
        owned = copy.owned.get("conversions", ())
        if not self._has_blocks(copy):
            if len(new.conversions) < len(owned):
                return None
            pairs = zip(owned, new.conversions, strict=True)
            assignment.conversions = [self._call(conversion, call) for conversion, call in pairs]
        return assignment

    def _call(self, copy: ElementCopy, new: tree.Call) -> tree.Call:
        part = self.part(copy)
        return part if isinstance(part, tree.Call) and copy not in self.changed else new

    def _has_blocks(self, copy: ElementCopy) -> bool:
        """Tells whether conversions stand in blocks, and not behind the arrow."""
        owned = copy.owned.get("conversions", ())
        return any(isinstance(self.part(conversion), tree.Element) for conversion in owned)

    def _pairs(self, part: tree.Table | tree.Vector, copy: ElementCopy) -> tree.Item | None:
        """Returns a table or a vector after the changes, None where it needs another form."""
        around = self.part(cast("ElementCopy", copy.owner))
        new, changed = self._writer.item(copy, around), self.changed.get(copy, {})
        if type(new) is not type(part):
            return None
        merged_part = replace(part)
        if isinstance(new, tree.Table | tree.Vector) and "name" in changed:
            merged_part.name = new.name
        if isinstance(merged_part, tree.Vector) and isinstance(new, tree.Vector):
            merged_part.to_ros = new.to_ros
            merged_part.given = self._entries(copy, "given", new.given)
            merged_part.expected = self._entries(copy, "expected", new.expected)
        elif isinstance(merged_part, tree.Table) and isinstance(new, tree.Table):
            merged_part.entries = self._entries(copy, "entries", new.entries)
        return merged_part

    def _entries(self, copy: ElementCopy, feature: str, new: Sequence[tree.Item]) -> list[Any]:
        entries = []
        for value_copy, item in zip(copy.owned.get(feature, ()), new, strict=True):
            part = self.part(value_copy)
            if not isinstance(part, tree.Entry | tree.VectorEntry):
                entries.append(item)
                continue
            merged = replace(part)
            for name in self.changed.get(value_copy, ()):
                setattr(merged, name, getattr(item, name))
            entries.append(merged)
        return entries

    # Values of features

    def _write_feature(
        self, pieces: list[Piece], copy: ElementCopy, name: str, *, is_said: bool
    ) -> None:
        """Writes the values that a feature has now."""
        is_assignment = isinstance(self.part(copy), tree.Assignment)
        if is_assignment and name in _BY_ARROW:
            return
        old = [piece for piece in pieces if _is_of(piece.item, name, copy.table)]
        if name in IN_THE_HEAD and not old:
            text = next(iter(copy.values.get(name, ())), None)
            is_sayable = is_name(text) if name == "name" else is_comment(text)
            is_said = text is not None and not is_sayable
        item = self._feature_item(copy, name, old) if is_said else None
        if old and item is not None:
            old[0].item = in_place_of(old[0].item, item)
        elif item is not None:
            self._insert_by_rank(pieces, Piece(item), copy, rank_of(item, copy.table, {}))
        kept = old[:1] if item is not None else []
        pieces[:] = [piece for piece in pieces if piece in kept or piece not in old]

    def _feature_item(self, copy: ElementCopy, name: str, old: Sequence[Piece]) -> tree.Item:
        is_end = copy.table.qualified_name == MAP and name in _ENDS
        if is_end and not (old and isinstance(old[0].item, tree.Feature)):
            feature = copy.table.features[name]
            element = self._writer.detached_element(copy, is_whole=False)
            type_ = self._names.name(cast("EObject", copy.obj), getattr(element, name), feature)
            if isinstance(type_, tree.Name):
                return tree.End(_ENDS[name], type_, None)
        return self._writer.feature(copy, name)

    # What comes new, or comes from elsewhere

    def _insert_element(self, pieces: list[Piece], copy: ElementCopy, owner: ElementCopy) -> None:
        """Inserts an element beside its siblings; without any, by the order of the metamodel."""
        around = self.part(owner)
        is_conversion = isinstance(around, tree.Assignment) and copy.feature == "conversions"
        if is_conversion and not self._has_blocks(owner):
            return  # it stands behind the arrow
        piece = self._piece_for(copy, owner)
        places = {id(present.part): at for at, present in enumerate(pieces)}
        earlier, later = (
            [places[key] for sibling in siblings if (key := id(self.part(sibling))) in places]
            for siblings in copy.siblings
        )
        is_way = owner.table.qualified_name == MAP and copy.feature in ("toRos", "toJaus")
        is_arrow = is_way and isinstance(piece.item, tree.Assignment | tree.Ignored)
        before, behind = next(reversed(earlier), None), next(iter(later), None)
        if is_arrow:
            self._put_arrow(pieces, piece, copy, before, behind)
            return
        near = before if before is not None else behind
        if isinstance(piece.item, tree.Feature) and near is not None:
            origin = pieces[near].origin
            is_alike = isinstance(origin, tree.Feature) and origin.name.text == piece.item.name.text
            piece.origin = origin if is_alike else None
        if before is not None:
            self._insert_at(pieces, before + 1, piece, is_top=around is None)
        elif behind is not None:
            # Before the head of a direction, not between it and its first arrow.
            at = behind - isinstance(pieces[behind].origin, tree.Direction)
            self._insert_at(pieces, at, piece, is_top=around is None)
        elif around is None:
            self._insert_at(pieces, len(pieces), piece, is_top=True)
        else:
            self._insert_by_rank(pieces, piece, owner, rank(owner.table, copy.feature))

    def _put_arrow(
        self,
        pieces: list[Piece],
        piece: Piece,
        copy: ElementCopy,
        before: int | None,
        behind: int | None,
    ) -> None:
        """Puts an arrow into the brackets of a neighbour, else of an empty direction, or new."""
        to_ros = copy.feature == "toRos"
        piece.item = replace(piece.item, spaced=False)
        for near, step in ((before, 1), (behind, 0)):
            if near is not None and isinstance(pieces[near].origin, tree.Direction):
                piece.origin = pieces[near].origin
                pieces.insert(near + step, piece)
                return
        piece.origin = tree.Direction(to_ros)
        if before is not None or behind is not None:
            pieces.insert(before + 1 if before is not None else cast("int", behind), piece)
            return
        for at, present in enumerate(pieces):
            if isinstance(present.item, tree.Direction) and present.item.to_ros == to_ros:
                piece.origin = present.item
                pieces.insert(at + 1, piece)
                return
        owner = cast("ElementCopy", copy.owner)
        self._insert_by_rank(pieces, piece, owner, rank(owner.table, copy.feature))

    def _piece_for(self, copy: ElementCopy, owner: ElementCopy) -> Piece:
        """Returns an element as it is written in an owner, with its comments."""
        around, part = self.part(owner), self.part(copy)
        if around is None and owner not in self.implied:
            raise self.refusal(owner)
        old = piece_of(part, self.written.tree.items) if isinstance(part, tree.Item) else None
        if old is None:
            new = self._writer.item(copy, around)
            if around is None and not isinstance(new, tree.Element):
                raise EditError(f"text has no place for this element of {copy.feature}")
            return Piece(new, part)
        if _keeps_its_words(old, copy, owner, around):
            return Piece(old.item, part)
        return Piece(in_place_of(old.item, self._writer.item(copy, around)), part)

    def _insert_by_rank(
        self, pieces: list[Piece], piece: Piece, owner: ElementCopy, wanted: int
    ) -> None:
        """Inserts a piece behind the last one of an earlier feature by the metamodel."""
        owned = {
            id(self.part(child)): child.feature
            for children in owner.owned.values()
            for child in children
        }
        ranks = (rank_of(present.item, owner.table, owned, present.part) for present in pieces)
        at = max((at + 1 for at, present in enumerate(ranks) if present <= wanted), default=0)
        self._insert_at(pieces, at, piece, is_top=False)

    def _insert_at(self, pieces: list[Piece], at: int, piece: Piece, *, is_top: bool) -> None:
        before = [
            present.origin if present.origin is not None else present.item
            for present in pieces[:at]
        ]
        if is_top:
            piece.item.spaced = bool(at)
        else:
            set_apart(before, piece.item)
        if at == 0 and pieces:
            behind = replace(pieces[0].item)
            set_apart([piece.item], behind)
            behind.spaced |= is_top
            pieces[0].item = behind
        pieces.insert(at, piece)


def _has_feature(part: tree.Item, name: str) -> bool:
    """Tells whether a block has a feature of this name written out."""
    items = part.items if isinstance(part, tree.Element | tree.Assignment) else ()
    return any(isinstance(item, tree.Feature) and item.name.text == name for item in items)


def _is_of(item: tree.Item, name: str, table: ClassTable) -> bool:
    """Tells whether an item says the values of a feature."""
    if isinstance(item, tree.End):
        return table.qualified_name == MAP and item.is_jaus is _ENDS.get(name)
    return isinstance(item, tree.Feature) and item.name.text == name


def _keeps_its_words(
    piece: Piece, copy: ElementCopy, owner: ElementCopy, around: Part | None
) -> bool:
    """Tells whether a moved element can keep its former words."""
    if isinstance(piece.item, tree.Feature):
        return piece.item.name.text == copy.feature
    if isinstance(piece.item, tree.Element):
        return owning_features(owner.table, copy.table) == (copy.feature,)
    is_arrow = isinstance(piece.item, tree.Assignment | tree.Ignored)
    return (
        isinstance(around, tree.Element | tree.Assignment)
        if is_arrow
        else isinstance(around, tree.Element)
    )

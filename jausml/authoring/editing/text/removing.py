"""Removal of elements from a text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.model.names import name_of
from jausml.language.text.keywords import snake_case
from jausml.language.text.tree import Assignment, Call, Direction, Element, Feature, Item, Name

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jausml.authoring.editing.text.desk import Desk
    from jausml.authoring.editing.text.outline import Body, Part
    from jausml.language.metamodel.classes.ecore import EObject


class Removing:
    """Removes elements with what they own."""

    def __init__(self, desk: Desk) -> None:
        self._desk = desk

    def remove(self, elements: Iterable[EObject]) -> None:
        """Takes elements out of the text."""
        parts = {id(part): part for part in map(self._desk.part, elements)}
        calls = [each for each in parts.values() if isinstance(each, Call)]
        self._remove_calls(calls)
        items: dict[int, Item] = {}
        for part in parts.values():
            if isinstance(part, Call):
                continue
            item = self._desk.outline.item_of(part)
            if isinstance(item, Feature) and not all(id(each) in parts for each in item.values):
                self._remove_value(item, part)
            else:
                items[id(item)] = item
        self._remove_items(items)

    def _remove_items(self, items: dict[int, Item]) -> None:
        self._keep_roots(items)
        bodies: dict[Body, list[Item]] = {}
        for item in items.values():
            bodies.setdefault(self._desk.outline.place(item)[0], []).append(item)
        for body, gone in list(bodies.items()):
            owner = body.owner
            if len(gone) < len(body.items):
                continue
            if isinstance(owner, Direction) and not owner.closing:
                # A direction without assignments says nothing.
                del bodies[body]
                around, _ = self._desk.outline.place(owner)
                bodies.setdefault(around, []).append(owner)
            elif isinstance(owner, Assignment) and not owner.closing:
                del bodies[body]
                start = self._desk.source.before_space(body.start - 1, 0)
                self._desk.edits.delete(start, body.end + 1)
        for body, gone in bodies.items():
            self._desk.blocks.remove(body, gone)

    def _keep_roots(self, items: dict[int, Item]) -> None:
        """Writes roots that nothing implies any more in place of what did."""
        for root in self._desk.context.document.roots:
            if self._desk.find_part(root) is not None:
                continue
            parts = map(self._desk.find_part, self._desk.model.owned(root))
            owned = [self._desk.outline.item_of(each) for each in parts if each is not None]
            if owned and all(id(each) in items for each in owned):
                first = items.pop(id(owned[0]))
                outline = self._desk.outline
                self._desk.edits.delete(outline.whole_start(first), outline.start(first))
                keyword = snake_case(self._desk.table(root).name)
                self._desk.put(first, Element(Name(keyword), Name(name_of(root))))

    def _remove_value(self, item: Feature, part: Part) -> None:
        """Takes one of several blocks out that are the values of a feature."""
        source = self._desk.source
        spans = [source.range_of(each.span) for each in item.values]
        at = next(i for i, each in enumerate(item.values) if each is part)
        if at:
            self._desk.edits.delete(spans[at - 1][1], spans[at][1])
        else:
            self._desk.edits.delete(spans[0][0], spans[1][0])

    def _remove_calls(self, calls: Sequence[Call]) -> None:
        source, edits = self._desk.source, self._desk.edits
        gone = set(map(id, calls))
        owners = {id(self._desk.outline.holder(each)): each for each in calls}
        for each in owners.values():
            owner = self._desk.outline.holder(each)
            if not isinstance(owner, Assignment):
                continue
            spans = [source.range_of(call.span) for call in owner.conversions]
            kept = [i for i, call in enumerate(owner.conversions) if id(call) not in gone]
            if not kept:
                start = source.range_of(owner.targets[-1].span)[1]
                edits.delete(start, spans[-1][1])
                continue
            edits.delete(spans[0][0], spans[kept[0]][0])
            for i, call in enumerate(owner.conversions):
                if id(call) in gone and i > kept[0]:
                    edits.delete(spans[i - 1][1], spans[i][1])

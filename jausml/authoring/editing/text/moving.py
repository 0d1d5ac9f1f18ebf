"""Elements that are removed, or go elsewhere in their text with their comments and layout."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.authoring.editing.sketches import copied
from jausml.language.metamodel.filling import hang
from jausml.language.model.names import name_of
from jausml.language.text.keywords import owning_features, snake_case
from jausml.language.text.tree import (
    Assignment,
    Call,
    Direction,
    Element,
    Feature,
    Ignored,
    Item,
    Name,
    Vector,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jausml.authoring.editing.text.adding import Adding
    from jausml.authoring.editing.text.edited import Desk, Places
    from jausml.authoring.editing.text.outline import Body, Part
    from jausml.language.metamodel import FeatureTable
    from jausml.language.metamodel.classes.ecore import EObject


class Moving:
    """Moves elements within a text."""

    def __init__(self, desk: Desk, places: Places, adding: Adding, removing: Removing) -> None:
        self._desk = desk
        self._places = places
        self._adding = adding
        self._removing = removing

    def move(
        self, obj: EObject, owner: EObject, feature: FeatureTable, position: int | None
    ) -> None:
        """Gives an element another owner or another position."""
        if _stands_there(obj, owner, feature, position):
            return
        part = self._desk.part(obj)
        if isinstance(part, Call):
            self._move_call(obj, owner, feature, position)
            return
        item = self._desk.outline.item_of(part)
        body = self._body(owner, feature, item, position, obj)
        if body is not None and self._can_stay_as_it_is(part, item, owner, feature, body):
            before = self._places.for_owned(owner, feature.name, body, position, obj)
            self._carry(item, body, before)
        else:
            sketch, _ = copied(obj, self._desk.metamodels)
            hang(sketch, owner, feature)
            self._adding.add(owner, feature, sketch, position, obj)
            self._removing.remove([obj])

    def _move_call(
        self, obj: EObject, owner: EObject, feature: FeatureTable, position: int | None
    ) -> None:
        sketch, _ = copied(obj, self._desk.metamodels)
        if owner is obj.eContainer():
            self._adding.add(owner, feature, sketch, position, obj)
            return
        self._removing.remove([obj])
        self._adding.add(owner, feature, sketch, position)

    def _body(
        self,
        owner: EObject,
        feature: FeatureTable,
        item: Item,
        position: int | None,
        obj: EObject,
    ) -> Body | None:
        """Returns the list into which the item goes, None where that is not the block itself."""
        part = self._desk.find_part(owner)
        if part is None:
            return self._desk.outline.top
        if isinstance(part, Vector):
            return self._desk.outline.body(part, 1 if feature.name == "expected" else 0)
        if isinstance(item, Assignment | Ignored) and not isinstance(part, Assignment):
            others = [each for each in getattr(owner, feature.name) if each is not obj]
            at = len(others) if position is None else min(position, len(others))
            beside = others[at - 1] if at else others[0] if others else obj
            near = self._desk.outline.item_of(self._desk.part(beside))
            body, _ = self._desk.outline.place(near)
            is_direction = isinstance(body.owner, Direction)
            return body if is_direction and beside.eContainer() is owner else None
        return self._desk.outline.body(part)

    def _can_stay_as_it_is(
        self, part: Part, item: Item, owner: EObject, feature: FeatureTable, body: Body
    ) -> bool:
        """Tells whether the same words stand for the element in another list."""
        place, _ = self._desk.outline.place(item)
        if isinstance(item, Feature):
            return len(item.values) == 1 and item.name.text == feature.name
        if isinstance(item, Element):
            obj = self._desk.object_of(part)
            table = self._desk.table(obj) if obj is not None else None
            own = self._desk.table(owner)
            return table is not None and owning_features(own, table) == [feature.name]
        is_arrow = isinstance(item, Assignment | Ignored)
        return is_arrow or type(place.owner) is type(body.owner)

    def _carry(self, item: Item, body: Body, before: Item | None) -> None:
        """Takes the lines of an item elsewhere."""
        desk, source = self._desk, self._desk.source
        place, _ = desk.outline.place(item)
        start, end = desk.outline.whole_start(item), desk.outline.whole_end(item)
        first = source.indent_of(start)
        indent = desk.blocks.indent(body)
        lines = source.text[start:end].replace("\r\n", "\n").split("\n")
        moved = [lines[0], *(_shifted(each, first, indent) for each in lines[1:])]
        desk.blocks.insert_raw(body, before, item, [f"{indent}{moved[0]}", *moved[1:]])
        desk.blocks.remove(place, [item])


def _stands_there(
    obj: EObject, owner: EObject, feature: FeatureTable, position: int | None
) -> bool:
    """Tells whether an element is where it shall go."""
    if not feature.many or obj.eContainer() is not owner:
        return False
    siblings = list(getattr(owner, feature.name))
    if obj not in siblings:
        return False
    last = len(siblings) - 1
    return siblings.index(obj) == (last if position is None else min(position, last))


def _shifted(line: str, first: str, indent: str) -> str:
    """Returns a line with the indent of its new place."""
    if not line.strip():
        return line
    return indent + line.removeprefix(first) if line.startswith(first) else line


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

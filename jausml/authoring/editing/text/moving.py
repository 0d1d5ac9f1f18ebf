"""Elements that go elsewhere in their text, with their comments and their layout."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.authoring.editing.sketches import copied
from jausml.language.metamodel.filling import hang
from jausml.language.text.keywords import owning_features
from jausml.language.text.tree import Assignment, Call, Direction, Element, Feature, Ignored, Vector

if TYPE_CHECKING:
    from jausml.authoring.editing.text.adding import Adding
    from jausml.authoring.editing.text.desk import Desk
    from jausml.authoring.editing.text.outline import Body, Part
    from jausml.authoring.editing.text.places import Places
    from jausml.authoring.editing.text.removing import Removing
    from jausml.language.metamodel import FeatureTable
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.text.tree import Item


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

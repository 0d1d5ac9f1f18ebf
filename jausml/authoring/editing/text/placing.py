"""Elements that come into a text, go out of it, or go elsewhere with comments and layout."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from jausml.authoring.editing.commands import EditError
from jausml.language.metamodel.classes import bridge
from jausml.language.model.names import name_of
from jausml.language.text.tree import (
    Assignment,
    Call,
    Direction,
    Element,
    Feature,
    Ignored,
    Item,
    Name,
    Table,
    Vector,
    owning_features,
    snake_case,
)
from jausml.language.text.writing.layout import shown_call
from jausml.language.text.writing.unparsing import IMPLIED_PARTS, MAP, table_entry, vector_entry

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jausml.authoring.editing.text.edited import EditedText, InsertionPoints
    from jausml.authoring.editing.text.mapping import MapChanges
    from jausml.authoring.editing.text.source import Body, Part
    from jausml.authoring.editing.working_copy import ElementCopy
    from jausml.language.metamodel import FeatureTable
    from jausml.language.metamodel.classes.ecore import EObject

_ARROWS = ("toRos", "toJaus")


class Adding:
    """Adds elements."""

    def __init__(self, edited: EditedText, points: InsertionPoints, mapping: MapChanges) -> None:
        self._edited = edited
        self._points = points
        self._mapping = mapping

    def add(self, copy: ElementCopy) -> None:
        """Adds an element of the working copy, where its siblings say."""
        around = cast("ElementCopy", copy.owner)
        owner, feature = cast("EObject", around.obj), around.table.features[copy.feature]
        made = self._edited.detached(copy)
        part = self._edited.find_part(owner)
        if part is None:
            self._add_to_implied(owner, feature, made, copy)
        elif isinstance(made, bridge.Conversion) and not isinstance(part, Element):
            self._add_conversion(owner, cast("Assignment", part), made, copy)
        elif isinstance(made, bridge.Assignment) and feature.name in _ARROWS:
            self._add_arrow(cast("Element", part), feature, made, copy)
        else:
            body = self._edited.body(part, copy.feature)
            before = None
            if body is not None:
                earlier, later = map(self._points.items, copy.siblings)
                if earlier and later and earlier[-1] is later[0]:
                    text = f"the {feature.name} stand in one list; add it before or behind them"
                    raise EditError(text)
                before = self._points.for_owned(copy, body)
                item = self._item(owner, part, feature, made)
                self._edited.blocks.insert(body, before, item)
            else:
                self._edited.add_item(part, None, self._item(owner, part, feature, made))

    def _add_to_implied(
        self, owner: EObject, feature: FeatureTable, made: EObject, copy: ElementCopy
    ) -> None:
        """Adds an element of a root that the text implies: it stands there by itself."""
        parts = IMPLIED_PARTS.get(self._edited.table(owner).qualified_name, ())
        if feature.name not in parts:
            self._edited.part(owner)  # says why not
        item = self._edited.elements.item(owner, made, feature)
        if not isinstance(item, Element):
            raise EditError(f"text has no place for this element of {feature.name}")
        top = self._edited.outline.top
        before = self._points.for_owned(copy, top)
        self._edited.blocks.insert(top, before, item)

    def _item(self, owner: EObject, part: Part, feature: FeatureTable, made: EObject) -> Item:
        """Returns how a new element is written in the block of its owner."""
        maps = self._edited.maps
        found: Item | None = None
        if isinstance(part, Assignment) and isinstance(made, bridge.Assignment):
            found = maps.arrow(made)
        elif isinstance(part, Table) and isinstance(made, bridge.TableEntry):
            found = table_entry(made)
        elif isinstance(part, Vector) and isinstance(made, bridge.VectorValue):
            found = vector_entry(made)
        if isinstance(part, Table | Vector) and found is None:
            raise EditError(f"text cannot say this element of {feature.name} here")
        if found is not None:
            return found
        if self._edited.table(owner).qualified_name == MAP:
            if isinstance(made, bridge.ValueTable):
                return maps.table(made)
            if isinstance(made, bridge.TestVector):
                return maps.vector(made)
            if feature.name in ("stopRos", "stopJaus"):
                return self._edited.elements.value_item(made, feature)
        return self._edited.elements.item(owner, made, feature)

    def _add_arrow(
        self, part: Element, feature: FeatureTable, made: bridge.Assignment, copy: ElementCopy
    ) -> None:
        """Adds an assignment to a direction of a map, which it begins if there is none."""
        earlier, later = map(self._points.items, copy.siblings)
        before, behind = next(reversed(earlier), None), next(iter(later), None)
        arrow = self._edited.maps.arrow(made)
        lists = [self._edited.outline.place(each)[0] if each else None for each in (before, behind)]
        if arrow is not None:
            for body, item in zip(lists, (before, None), strict=True):
                if body is not None and isinstance(body.owner, Direction):
                    self._edited.blocks.insert(body, item, arrow)
                    return
            direction = self._empty_direction(part, to_ros=feature.name == "toRos")
            if direction is not None and before is None and behind is None:
                self._edited.blocks.insert(direction, None, arrow)
                return
            new: Item = Direction(feature.name == "toRos", [arrow])
        else:
            new = self._edited.elements.value_item(made, feature)
            if (
                lists[0] is not None
                and lists[0] is lists[1]
                and isinstance(lists[0].owner, Direction)
            ):
                raise EditError(
                    f"no arrow can say this element of {feature.name}; add it at the end"
                )
        self._add_whole(part, copy, before, new)

    def _empty_direction(self, part: Element, *, to_ros: bool) -> Body | None:
        for item in part.items:
            if isinstance(item, Direction) and item.to_ros == to_ros and not item.assignments:
                return self._edited.outline.body(item)
        return None

    def _add_whole(self, part: Element, copy: ElementCopy, before: Item | None, new: Item) -> None:
        """Adds a direction, or a block in its place, to a map."""
        body = self._edited.outline.body(part)
        if before is not None:
            inner, _ = self._edited.outline.place(before)
            before = inner.owner if isinstance(inner.owner, Direction) else before
        elif body is not None:
            before = self._points.for_owned(copy, body)
        self._edited.add_item(part, before, new)

    def _add_conversion(
        self, owner: EObject, part: Assignment, made: bridge.Conversion, copy: ElementCopy
    ) -> None:
        earlier, later = (
            [self._edited.part(cast("EObject", each.obj)) for each in some]
            for some in copy.siblings
        )
        call = self._edited.maps.call(made)
        is_within = copy.obj is not None and copy.obj.eContainer() is owner
        calls = [*earlier, *later]
        if call is None or is_within or not all(isinstance(each, Call) for each in calls):
            self._mapping.put_conversions(owner)
            return
        source, edits = self._edited.source, self._edited.edits
        if earlier:
            edits.insert(source.range_of(earlier[-1].span)[1], f", {shown_call(call)}")
        elif later:
            edits.insert(source.range_of(later[0].span)[0], f"{shown_call(call)}, ")
        else:
            end = source.range_of(part.targets[-1].span)[1]
            edits.insert(end, f" : {shown_call(call)}")


class Moving:
    """Moves elements within a text."""

    def __init__(
        self, edited: EditedText, points: InsertionPoints, adding: Adding, removing: Removing
    ) -> None:
        self._edited = edited
        self._points = points
        self._adding = adding
        self._removing = removing

    def move(self, copy: ElementCopy) -> None:
        """Gives an element the owner and the position that it has in the working copy."""
        obj, around = cast("EObject", copy.obj), cast("ElementCopy", copy.owner)
        owner = cast("EObject", around.obj)
        if _stands_there(obj, copy, owner):
            return
        part = self._edited.part(obj)
        _check_names(obj, owner)
        if isinstance(part, Call):
            if owner is not obj.eContainer():
                self._removing.remove([obj])
            self._adding.add(copy)
            return
        item = self._edited.outline.item_of(part)
        feature = around.table.features[copy.feature]
        body = self._body(copy, owner, item)
        if body is not None and self._can_stay_as_it_is(part, item, owner, feature, body):
            self._carry(item, body, self._points.for_owned(copy, body))
        else:
            self._adding.add(copy)
            self._removing.remove([obj])

    def _body(self, copy: ElementCopy, owner: EObject, item: Item) -> Body | None:
        """Returns the list into which the item goes, None where that is not the block itself."""
        part = self._edited.find_part(owner)
        if part is None:
            return self._edited.outline.top
        if isinstance(item, Assignment | Ignored) and not isinstance(part, Assignment):
            earlier, later = map(self._points.items, copy.siblings)
            beside = [*earlier[-1:], *later[:1]]
            near = beside[0] if beside else item
            body, _ = self._edited.outline.place(near)
            is_direction = isinstance(body.owner, Direction)
            is_own = bool(beside) or cast("EObject", copy.obj).eContainer() is owner
            return body if is_direction and is_own else None
        return self._edited.body(part, copy.feature)

    def _can_stay_as_it_is(
        self, part: Part, item: Item, owner: EObject, feature: FeatureTable, body: Body
    ) -> bool:
        """Tells whether the same words stand for the element in another list."""
        place, _ = self._edited.outline.place(item)
        if isinstance(item, Feature):
            return len(item.values) == 1 and item.name.text == feature.name
        if isinstance(item, Element):
            obj = self._edited.object_of(part)
            table = self._edited.table(obj) if obj is not None else None
            own = self._edited.table(owner)
            return table is not None and owning_features(own, table) == (feature.name,)
        is_arrow = isinstance(item, Assignment | Ignored)
        return is_arrow or type(place.owner) is type(body.owner)

    def _carry(self, item: Item, body: Body, before: Item | None) -> None:
        """Takes the lines of an item elsewhere."""
        edited, source = self._edited, self._edited.source
        place, _ = edited.outline.place(item)
        start, end = edited.outline.whole_start(item), edited.outline.whole_end(item)
        first = source.indent_of(start)
        indent = edited.blocks.indent(body)
        lines = source.text[start:end].replace("\r\n", "\n").split("\n")
        moved = [lines[0], *(_shifted(each, first, indent) for each in lines[1:])]
        stacked = [f"{indent}{moved[0]}", *moved[1:]]
        edited.blocks.insert_raw(body, before, item, stacked)
        if place is not body or not edited.blocks.breaks(body, item, stacked):
            edited.blocks.remove(place, [item])


def _check_names(obj: EObject, owner: EObject) -> None:
    """Refuses a move to a map where the names of conversions mean other quantities and tables."""
    if not isinstance(owner, bridge.AttributeMap) or obj.eContainer() is owner:
        return
    there = {str(each.name): each for each in (*owner.quantities, *owner.tables)}
    for each in getattr(obj, "conversions", ()):
        for used in (each.quantity, each.table):
            if used is not None and there.get(str(used.name), used) is not used:
                raise EditError(f"'{used.name}' is another one in map '{owner.name}'")


def _stands_there(obj: EObject, copy: ElementCopy, owner: EObject) -> bool:
    """Tells whether an element is where it shall go."""
    if obj.eContainer() is not owner or obj.eContainmentFeature().name != copy.feature:
        return False
    value = getattr(owner, copy.feature)
    return value is obj or list(value).index(obj) == len(copy.siblings[0])


def _shifted(line: str, first: str, indent: str) -> str:
    """Returns a line with the indent of its new place."""
    if not line.strip():
        return line
    return indent + line.removeprefix(first) if line.startswith(first) else line


class Removing:
    """Removes elements with what they own."""

    def __init__(self, edited: EditedText) -> None:
        self._edited = edited

    def remove(self, elements: Iterable[EObject]) -> None:
        """Takes elements out of the text."""
        parts = {id(part): part for part in map(self._edited.part, elements)}
        calls = [each for each in parts.values() if isinstance(each, Call)]
        self._remove_calls(calls)
        items: dict[int, Item] = {}
        for part in parts.values():
            if isinstance(part, Call):
                continue
            item = self._edited.outline.item_of(part)
            if isinstance(item, Feature) and not all(id(each) in parts for each in item.values):
                self._remove_value(item, part)
            else:
                items[id(item)] = item
        self._remove_items(items)

    def _remove_items(self, items: dict[int, Item]) -> None:
        self._keep_roots(items)
        bodies: dict[Body, list[Item]] = {}
        for item in items.values():
            bodies.setdefault(self._edited.outline.place(item)[0], []).append(item)
        for body, gone in list(bodies.items()):
            owner = body.owner
            if len(gone) < len(body.items):
                continue
            if isinstance(owner, Direction) and not owner.closing:
                # A direction without assignments says nothing.
                del bodies[body]
                around, _ = self._edited.outline.place(owner)
                bodies.setdefault(around, []).append(owner)
            elif isinstance(owner, Assignment) and not owner.closing:
                del bodies[body]
                start = self._edited.source.before_space(body.start - 1, 0)
                self._edited.edits.delete(start, body.end + 1)
        for body, gone in bodies.items():
            self._edited.blocks.remove(body, gone)

    def _keep_roots(self, items: dict[int, Item]) -> None:
        """Writes roots that nothing implies any more in place of what did."""
        for root in self._edited.context.document.roots:
            if self._edited.find_part(root) is not None:
                continue
            parts = map(self._edited.find_part, self._edited.model.owned(root))
            owned = [self._edited.outline.item_of(each) for each in parts if each is not None]
            if owned and all(id(each) in items for each in owned):
                first = items.pop(id(owned[0]))
                outline = self._edited.outline
                self._edited.edits.delete(outline.whole_start(first), outline.start(first))
                keyword = snake_case(self._edited.table(root).name)
                self._edited.put(first, Element(Name(keyword), Name(name_of(root))))

    def _remove_value(self, item: Feature, part: Part) -> None:
        """Takes one of several blocks out that are the values of a feature."""
        source = self._edited.source
        spans = [source.range_of(each.span) for each in item.values]
        at = next(i for i, each in enumerate(item.values) if each is part)
        if at:
            self._edited.edits.delete(spans[at - 1][1], spans[at][1])
        else:
            self._edited.edits.delete(spans[0][0], spans[1][0])

    def _remove_calls(self, calls: Sequence[Call]) -> None:
        source, edits = self._edited.source, self._edited.edits
        gone = set(map(id, calls))
        owners = {id(self._edited.outline.holder(each)): each for each in calls}
        for each in owners.values():
            owner = self._edited.outline.holder(each)
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

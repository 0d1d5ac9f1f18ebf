"""New elements in a text, and those that go elsewhere in it."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from jausml.authoring.editing.commands import EditError
from jausml.language.metamodel.classes import bridge
from jausml.language.text.tree import (
    Assignment,
    Call,
    Direction,
    Element,
    Item,
    Table,
    Vector,
)
from jausml.language.text.writing.layout import shown_call
from jausml.language.text.writing.unparsing import IMPLIED_PARTS, MAP, table_entry, vector_entry

if TYPE_CHECKING:
    from jausml.authoring.editing.text.edited import EditedText, InsertionPoints
    from jausml.authoring.editing.text.mapping import MapChanges
    from jausml.authoring.editing.text.outline import Body, Part
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

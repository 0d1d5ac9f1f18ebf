"""Places of new items: beside what says the same feature, else where the writer would put them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel import FeatureKind
from jausml.language.text.tree import Direction, Element, End, Feature, Import, Item, Table, Vector
from jausml.language.text.writing.maps import MAP

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.authoring.editing.text.desk import Desk
    from jausml.authoring.editing.text.outline import Body
    from jausml.language.metamodel import ClassTable
    from jausml.language.metamodel.classes.ecore import EObject

_MAP_ORDER = (
    *("tables", "quantities", "joins", "reportJoins", "stopRos", "stopJaus"),
    *("toRos", "toJaus", "vectors"),
)
"""The features of maps that own elements, in the order in which they are written."""


class Places:
    """Finds places in the blocks of elements."""

    def __init__(self, desk: Desk) -> None:
        self._desk = desk

    def for_value(self, obj: EObject, feature: str, body: Body) -> Item | None:
        """Returns the item behind which a new value of an attribute or a reference goes."""
        return self._last_before(obj, feature, body)

    def for_owned(
        self, obj: EObject, feature: str, body: Body, position: int | None, without: EObject | None
    ) -> Item | None:
        """Returns the item behind which a new element goes, None for the first place.

        Args:
            position: The position among the elements of the feature, None for the last.
            without: An element that does not count since it is taken away.
        """
        siblings = self._siblings(obj, feature, body, without)
        if not siblings:
            return self._last_before(obj, feature, body)
        if position is None or position >= len(siblings):
            return siblings[-1]
        if position:
            return siblings[position - 1]
        index = self._desk.outline.place(siblings[0])[1]
        gone = self._desk.find_part(without) if without is not None else None
        skipped = self._desk.outline.item_of(gone) if gone is not None else None
        before = [each for each in body.items[:index] if each is not skipped]
        return before[-1] if before else None

    def _siblings(
        self, obj: EObject, feature: str, body: Body, without: EObject | None
    ) -> Sequence[Item]:
        value = getattr(obj, feature)
        elements = list(value) if self._desk.table(obj).features[feature].many else [value]
        found = []
        for each in elements:
            part = self._desk.find_part(each) if each not in (None, without) else None
            if part is None:
                continue
            item = self._desk.outline.item_of(part)
            if self._desk.outline.place(item)[0] is body and item not in found:
                found.append(item)
        return found

    def _last_before(self, obj: EObject, feature: str, body: Body) -> Item | None:
        table = self._desk.table(obj)
        if body.owner is None:
            return body.items[-1] if body.items else None
        wanted = _rank(table, feature)
        found = [each for each in body.items if self._rank(table, each) <= wanted]
        return found[-1] if found else None

    def _rank(self, table: ClassTable, item: Item) -> int:
        """Returns where in its block the writer would put an item."""
        if isinstance(item, Import):
            return -3
        if isinstance(item, End):
            return -2 if item.is_jaus else -1
        if isinstance(item, Direction):
            return _rank(table, "toRos" if item.to_ros else "toJaus")
        if isinstance(item, Table | Vector):
            return _rank(table, "tables" if isinstance(item, Table) else "vectors")
        if isinstance(item, Feature):
            return _rank(table, item.name.text)
        if isinstance(item, Element):
            return self._rank_of_element(table, item)
        return _rank(table, "assignments")

    def _rank_of_element(self, table: ClassTable, item: Element) -> int:
        owned = self._desk.owned_by(item)
        return _rank(table, owned) if owned else 0


def _rank(table: ClassTable, name: str) -> int:
    feature = table.features.get(name)
    if feature is None:
        return 0
    features = list(table.features)
    if feature.kind is not FeatureKind.CONTAINMENT:
        return features.index(name)
    if table.qualified_name == MAP and name in _MAP_ORDER:
        return len(features) + _MAP_ORDER.index(name)
    return len(features) + features.index(name)

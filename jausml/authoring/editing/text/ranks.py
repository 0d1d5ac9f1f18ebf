"""The order of what stands in a block, by the metamodel."""

from __future__ import annotations

from jausml.authoring.editing.text.pieces import Part
from jausml.language.metamodel import ClassTable, FeatureKind
from jausml.language.text.tree import Direction, Element, End, Feature, Import, Item, Table, Vector
from jausml.language.text.writing.unparsing import MAP

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

"""Writes elements of a working copy as the items of the text that stand for them.

They are detached first: as a command leaves them, to be written and named like any element of the
model. They refer to elements of the model and have an owner there, or one that is detached itself;
the model knows nothing of them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

from jausml.authoring.editing.drafts import Context
from jausml.authoring.editing.text.naming import Naming
from jausml.authoring.editing.text.pieces import Part
from jausml.authoring.editing.working_copy import ElementCopy
from jausml.language.metamodel import DataTypeTable
from jausml.language.metamodel.classes import bridge
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import fill, hang, link, new_object, point, set_value
from jausml.language.model.refs import Ref
from jausml.language.model.values import convert
from jausml.language.semantics.connections.exchanges import FEATURES, infer
from jausml.language.text import tree
from jausml.language.text.writing.references import ElementWriter
from jausml.language.text.writing.unparsing import MAP, MapWriter, table_entry, vector_entry


class ItemWriter:
    """Writes elements of one text."""

    def __init__(self, context: Context, names: Naming) -> None:
        metamodels = context.model.metamodels
        self._context = context
        self._names = names
        self.elements = ElementWriter(metamodels, names)
        self.maps = MapWriter(self.elements, names, metamodels)
        self.elements.special[MAP] = self.maps.items

    def detached_element(self, copy: ElementCopy, *, is_whole: bool = True) -> EObject:
        """Returns a detached element after the changes; its owner is an element of the model."""
        element = detached(copy, self.find, is_whole=is_whole)
        if copy.owner is not None:
            # Names are looked up from the owner, but the owner must not learn of the element.
            hang(self.find(copy.owner), copy.owner.table.features[copy.feature], element)
        if copy.obj is None:
            settle_new(element, copy)
        return element

    def find(self, target: ElementCopy | Ref) -> EObject:
        """Returns the element of the model that a reference means."""
        if isinstance(target, str):
            return self._names.find(target)
        if target.obj is not None and target.file == self._context.file:
            return target.obj
        return self._names.find(self._context.ref(target))

    def arrow(self, copy: ElementCopy) -> tree.Assignment | tree.Ignored | None:
        """Returns an assignment as an arrow, None where no arrow says it."""
        element = self.detached_element(copy)
        return self.maps.arrow(element) if isinstance(element, bridge.Assignment) else None

    def item(self, copy: ElementCopy, around: Part | None) -> tree.Item:
        """Returns an element as it is written in its owner.

        `around`: what stands for the owner; in a table, a vector and an arrow less need be said.
        """
        element, owner = self.detached_element(copy), copy.owner
        if owner is None:
            return self.elements.root(element)
        feature = owner.table.features[copy.feature]
        item: tree.Item | None = None
        if isinstance(element, bridge.Assignment):
            is_way = isinstance(around, tree.Element) and feature.name in ("toRos", "toJaus")
            is_sayable = is_way or isinstance(around, tree.Assignment)
            item = self.maps.arrow(element) if is_sayable else None
            return item or self.elements.value_item(element, feature)
        if isinstance(around, tree.Table) and isinstance(element, bridge.TableEntry):
            item = table_entry(element)
        elif isinstance(around, tree.Vector) and isinstance(element, bridge.VectorValue):
            item = vector_entry(element)
        elif owner.table.qualified_name == MAP and isinstance(element, bridge.ValueTable):
            item = self.maps.table(element)
        elif owner.table.qualified_name == MAP and isinstance(element, bridge.TestVector):
            item = self.maps.vector(element)
        elif owner.table.qualified_name == MAP and feature.name in ("stopRos", "stopJaus"):
            item = self.elements.value_item(element, feature)
        return item or self.elements.item(self.find(owner), element, feature)

    def feature(self, copy: ElementCopy, name: str) -> tree.Feature:
        """Returns the values of an attribute or of a reference."""
        return self.elements.feature(
            self.detached_element(copy, is_whole=False), copy.table.features[name]
        )


def detached(
    copy: ElementCopy, find: Callable[[ElementCopy | Ref], EObject], *, is_whole: bool = True
) -> EObject:
    """Returns an element of a working copy without an owner.

    `find`: returns the element of the model that a reference means. `is_whole`: with all that it
    owns.
    """
    element: Any = new_object(copy.table)
    features = copy.table.features
    for name, texts in copy.values.items():
        feature = features[name]
        data_type = cast("DataTypeTable", feature.data_type)
        values = [None if text is None else convert(text, data_type)[0] for text in texts]
        if feature.settable:
            fill(element, feature, values)
    for name, targets in copy.references.items():
        if features[name].settable:
            for target in targets:
                # Not linked: elements of the model must not refer back to one that is thrown away.
                point(element, features[name], find(target))
    for name, owned in copy.owned.items() if is_whole else ():
        for owned_copy in owned:
            link(element, features[name], detached(owned_copy, find))
    return element  # type: ignore[no-any-return]


def settle_new(new_element: EObject, copy: ElementCopy) -> None:
    """Sets the inferred features of new connections, where a command leaves them open.

    So the text leaves it open too.
    """
    if isinstance(new_element, bridge.Connection) and copy.open:
        stated = [
            None if feature_name in copy.open else getattr(new_element, feature_name).name
            for feature_name in FEATURES
        ]
        inferred = infer(new_element, *stated)
        for name in FEATURES:
            feature = copy.table.features[name]
            literals = cast("DataTypeTable", feature.data_type).literals
            set_value(new_element, feature, literals[getattr(inferred, name)])
    for name, owned in copy.owned.items():
        elements = getattr(new_element, name)
        for element, inner in zip(
            elements if copy.table.features[name].many else [elements], owned, strict=True
        ):
            settle_new(element, inner)

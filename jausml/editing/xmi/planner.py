"""Planner of changes of XMI files."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from jausml.editing.commands import EditError, Set
from jausml.editing.xmi.attributes import addition, removal, value_splice
from jausml.editing.xmi.source import Source
from jausml.metamodel import FeatureKind
from jausml.model.values import convert
from jausml.model.xmi.writer import UnwritableError, lexical

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.editing.commands import Command, Values
    from jausml.editing.planning import Context
    from jausml.editing.splices import Splice
    from jausml.metamodel import DataTypeTable, FeatureTable
    from jausml.metamodel.classes.ecore import EObject


class XmiPlanner:
    """Plans changes of XMI files, as `jausml.editing.planning.Planner` says."""

    def plan(self, commands: Sequence[Command], context: Context) -> list[Splice]:
        """Returns what is to change in one file so that commands hold."""
        try:
            return _Plan(context).run(commands)
        except UnwritableError as error:
            raise EditError(str(error)) from error


class _Plan:
    """Plan of the changes of one file."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._metamodels = context.model.metamodels
        self._source = Source(context.document, context.file)
        self._splices: list[Splice] = []

    def run(self, commands: Sequence[Command]) -> list[Splice]:
        for each in commands:
            element = self._context.find(each.element) if isinstance(each, Set) else None
            if isinstance(each, Set) and element is not None and self._context.is_own(element):
                self._set(element, each)
        return self._splices

    def _set(self, obj: EObject, command: Set) -> None:
        feature = self._metamodels.class_of(obj).features[command.feature]
        if feature.kind is FeatureKind.ATTRIBUTE and not feature.many:
            self._set_attribute(obj, feature, command.values)
        else:
            raise EditError(f"setting {feature.name} is not known yet")

    def _set_attribute(self, obj: EObject, feature: FeatureTable, values: Values) -> None:
        node = self._context.model.node_of(obj)
        if node is None:
            return
        element = self._source.element(node)
        written = element.attribute(feature.name)
        text = canonical(values[0], feature) if values else None
        if text is None:
            if written is not None:
                self._splices.append(removal(self._source, written))
        elif written is not None:
            self._splices.append(value_splice(self._source, written, text))
        else:
            order = list(self._metamodels.class_of(obj).features)
            self._splices.append(addition(self._source, element, feature.name, text, order))


def canonical(text: str, feature: FeatureTable) -> str:
    """Returns a value of an attribute as EMF writes it.

    Raises:
        EditError: It is none.
    """
    value, fault = convert(text, cast("DataTypeTable", feature.data_type))
    if fault is not None:
        hint = f" ({fault.hint})" if fault.hint else ""
        raise EditError(f"{feature.name}: {fault.reason}{hint}")
    return lexical(value, feature)

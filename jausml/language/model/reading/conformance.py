"""Check of the bounds of features: what must be there, and how much may be."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel import ClassTable, FeatureKind, FeatureTable
from jausml.language.metamodel.filling import count
from jausml.language.model.reading.problems import NodePlace

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.documents import Document
    from jausml.language.model.model import Model
    from jausml.language.model.reading.problems import Problems
    from jausml.language.model.xmi.parsing import Node


def check_bounds(documents: Iterable[Document], model: Model, problems: Problems) -> None:
    """Checks the lower and upper bounds of all features of the elements of documents.

    A feature with another finding is left alone: one cause is one error.
    """
    for document in documents:
        pending = list(reversed(document.root_nodes))
        while pending:
            node = pending.pop()
            if node.obj is None:
                continue
            pending.extend(reversed(node.children))
            table = model.metamodels.class_of(node.obj)
            for feature in table.bounded:
                number = count(node.obj, feature)
                if number >= max(feature.lower, 1) and (
                    feature.upper < 0 or number <= feature.upper
                ):
                    continue
                if not problems.is_spoilt(node.obj, feature.name):
                    _report(document, node, table, feature, number, problems)


def _report(
    document: Document,
    node: Node,
    table: ClassTable,
    feature: FeatureTable,
    number: int,
    problems: Problems,
) -> None:
    problems.spoil(node.obj, feature.name)
    what = f"feature '{feature.name}' of {_label(table, node.obj)}"
    written = node.get(feature.name) is not None
    place = NodePlace(document, node, ("", feature.name) if written else None)
    if 0 <= feature.upper < number:
        message = f"{what} has {number} values, at most {feature.upper} are allowed"
        problems.report("JML109", place, message)
    elif number == 0 and feature.can_be_missing:
        message = f"required {what} is missing"
        notation = document.notation
        hint = _how(feature) if notation is None else notation.how_to_give(table, feature)
        problems.report("JML108", place, message, hint)
    elif 0 < number < feature.lower:
        message = f"{what} has {number} values, at least {feature.lower} are required"
        problems.report("JML110", place, message)


def _how(feature: FeatureTable) -> str:
    if feature.kind is FeatureKind.CONTAINMENT:
        return f"add a child element <{feature.name}> ({feature.type_name})"
    return f"it takes {'a reference to ' if feature.is_reference else ''}{feature.type_name}"


def _label(table: ClassTable, obj: EObject) -> str:
    name = getattr(obj, "name", None)
    return f"{table.name} '{name}'" if name else table.name

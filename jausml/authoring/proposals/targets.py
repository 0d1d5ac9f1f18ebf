"""Targets of references: what of the project and the library a reference may lead to."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.authoring.proposals.elements import Scope, label_of
from jausml.language.metamodel.classes import bridge, jaus, ros, system
from jausml.language.model.names import name_of
from jausml.language.project import library
from jausml.language.semantics.jaus.services import lineage, outputs

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from jausml.language.metamodel import ClassTable, FeatureTable
    from jausml.language.metamodel.classes.ecore import EObject

_OF_THE_SYSTEM = (jaus.Component, ros.Node, system.Host)


@dataclass(frozen=True, slots=True)
class Choice:
    """One of the values that a field may have."""

    value: str
    label: str
    documentation: str = ""


def legal_targets(scope: Scope, element: EObject, feature: FeatureTable) -> tuple[Choice, ...]:
    """Returns what a reference of an element may lead to, in the order of the names."""
    table = scope.model.metamodels.class_of(element)
    for cls in table.supertypes:
        find = _NARROW.get(f"{cls.qualified_name}.{feature.name}")
        if find is not None and (narrow := find(element)) is not None:
            return _choices(scope, narrow)
    found = everywhere(scope, feature.target, element)
    if feature.name == "query":
        used = getattr(element, "query", None)
        own = scope.ref(used) if used is not None else ""
        return tuple(each for each in found if _is_query(each) or each.value == own)
    return found


def _is_query(choice: Choice) -> bool:
    return choice.label.rpartition(".")[2].startswith("Query")


def everywhere(
    scope: Scope, target: ClassTable | None, element: EObject | None = None
) -> tuple[Choice, ...]:
    """Returns the elements of a class in the project and the library."""
    if target is None:
        return ()
    kind = target.python_class
    own = [each for each in scope.own(kind) if each is not element]
    if any(issubclass(kind, each) for each in _OF_THE_SYSTEM):
        around = _system_of(element)
        return _choices(scope, [each for each in own if _system_of(each) is around])
    if kind is jaus.Field:
        types = (each for one in scope.model.instances(jaus.ServiceSet) for each in one.types)
        return _choices(scope, [each for each in types if each is not element])
    return (*_choices(scope, own), *library_choices(target))


@cache
def library_choices(target: ClassTable) -> tuple[Choice, ...]:
    """Returns the elements of a class that the library has."""
    return _choices(Scope(library(), Path("/")), library().instances(target.python_class))


def _choices(scope: Scope, elements: Iterable[EObject]) -> tuple[Choice, ...]:
    found = [(label_of(each), each) for each in elements]
    counts = Counter(label for label, _ in found)
    choices = [
        Choice(
            scope.ref(each),
            f"{label} ({_file(scope, each)})" if counts[label] > 1 else label,
            _first_sentence(str(getattr(each, "documentation", None) or "")),
        )
        for label, each in found
    ]
    return tuple(sorted(choices, key=lambda each: (each.label.lower(), each.label, each.value)))


def _first_sentence(text: str) -> str:
    return text.partition(". ")[0].removesuffix(".")


def _file(scope: Scope, element: EObject) -> str:
    document = scope.model.document_of(element)
    return document.path.stem if document is not None else ""


def _system_of(element: EObject | None) -> EObject | None:
    while element is not None and not isinstance(element, system.System):
        element = element.eContainer()
    return element


def _map_of(element: EObject) -> bridge.AttributeMap | None:
    around: EObject | None = element
    while around is not None:
        if isinstance(around, bridge.AttributeMap):
            return around
        if isinstance(around, bridge.Connection):
            return around.map
        around = around.eContainer()
    return None


def _tables(element: EObject) -> list[EObject] | None:
    found = _map_of(element)
    return None if found is None else list(found.tables)


def _quantities(element: EObject) -> list[EObject] | None:
    found = _map_of(element)
    return None if found is None else list(found.quantities)


def _joins(element: EObject) -> list[EObject] | None:
    found = _map_of(element)
    return None if found is None else list(found.joins)


def _report_joins(element: EObject) -> list[EObject] | None:
    found = _map_of(element)
    return None if found is None else list(found.reportJoins)


def _reports(element: EObject) -> list[EObject] | None:
    """What the provider of a service connection sends; all messages where none is chosen."""
    if not isinstance(element, jaus.ServiceConnection):
        return None
    provider = element.provider or element.search
    return None if provider is None else list(dict.fromkeys(outputs(provider)))


def _taken(element: EObject) -> list[EObject] | None:
    """What the service of a state machine takes, inherited messages included."""
    around: EObject | None = element
    while around is not None and not isinstance(around, jaus.Service):
        around = around.eContainer()
    if around is None:
        return None
    return [each for one in lineage(around) for each in one.inputs if name_of(each)]


_NARROW: Mapping[str, Callable[[EObject], list[EObject] | None]] = {
    "bridge.Conversion.table": _tables,
    "bridge.Conversion.quantity": _quantities,
    "bridge.Topic.join": _joins,
    "bridge.ReportSource.join": _report_joins,
    "jaus.ServiceConnection.message": _reports,
    "jaus.Transition.message": _taken,
}
"""References that lead to fewer elements than those of their class."""

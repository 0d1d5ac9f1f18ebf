"""Trial assignments: what the rules say of assignments that no model has yet."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from jausml.metamodel import FeatureKind
from jausml.metamodel.filling import link, new_object, set_value, set_values
from jausml.model.values import convert
from jausml.semantics.subject import Subject
from jausml.studio.answers.elements import map_around
from jausml.studio.answers.made_models import made_model
from jausml.validation.rules import all_rules

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.editing.commands import Child
    from jausml.metamodel import FeatureTable, Metamodels
    from jausml.metamodel.classes import bridge
    from jausml.metamodel.classes.ecore import EObject
    from jausml.validation.rule import Finding, Rule

_RULES = frozenset(
    {
        *("JML411", "JML412", "JML413", "JML414", "JML431", "JML432", "JML433", "JML434"),
        *("JML435", "JML436", "JML438", "JML441", "JML446", "JML447", "JML458", "JML459"),
        *("JML461",),
    }
)
"""The rules that judge an assignment by itself."""


@dataclass(frozen=True)
class Judged:
    """An assignment that was tried.

    Attributes:
        assignment: The assignment.
        findings: What the rules say of it, errors first.
    """

    assignment: Child
    findings: tuple[tuple[Rule, Finding], ...]

    @property
    def is_accepted(self) -> bool:
        """Whether no rule finds an error or a warning."""
        return not any(_severity(each) != "info" for each in self.findings)

    @property
    def is_possible(self) -> bool:
        """Whether no rule finds an error."""
        return not any(_severity(each) == "error" for each in self.findings)

    @property
    def said(self) -> str:
        """What the rules say first, with what they advise."""
        for _, finding in self.findings:
            return f"{finding.message}; {finding.hint}" if finding.hint else finding.message
        return ""


def judge(
    metamodels: Metamodels, used: bridge.AttributeMap, assignments: Sequence[Child]
) -> list[Judged]:
    """Returns what the rules say of assignments, each of which stands alone in its map.

    Nothing of the model is touched: maps are made that refer to the same message and type.

    Args:
        metamodels: The metamodels of the model.
        used: The map that they are for.
        assignments: Each with the feature of the map that shall own it.
    """
    library = new_object(metamodels.classes["bridge.MapLibrary"])
    maps = [_map_like(metamodels, used, each, library) for each in assignments]
    subject = Subject(made_model(metamodels, library))
    found: dict[EObject, list[tuple[Rule, Finding]]] = {each: [] for each in maps}
    for rule in all_rules():
        if rule.id in _RULES:
            for finding in rule.check(subject):
                owner = map_around(finding.element)
                if owner is not None and owner in found and finding.element is not owner:
                    found[owner].append((rule, finding))
    return [
        replace(Judged(each, ()), findings=tuple(sorted(found[made], key=_gravity)))
        for each, made in zip(assignments, maps, strict=True)
    ]


def _severity(found: tuple[Rule, Finding]) -> str:
    rule, finding = found
    return (finding.severity or rule.severity).value


def _gravity(found: tuple[Rule, Finding]) -> tuple[int, str]:
    return ("error", "warning", "info").index(_severity(found)), found[0].id


def _map_like(
    metamodels: Metamodels, used: bridge.AttributeMap, assignment: Child, owner: EObject
) -> EObject:
    """Makes a map with the ends of another one, and one assignment."""
    table = metamodels.class_of(used)
    made: EObject = new_object(table)
    set_value(made, table.features["name"], used.name)
    for name in ("message", "type"):
        link(made, table.features[name], getattr(used, name))
    for name in ("joins", "reportJoins"):
        for join in getattr(used, name):
            link(made, table.features[name], _join_like(metamodels, join))
    link(made, table.features[assignment.feature], made_of(metamodels, assignment))
    link(owner, metamodels.class_of(owner).features["maps"], made)
    return made


def _join_like(metamodels: Metamodels, join: EObject) -> EObject:
    table = metamodels.class_of(join)
    made: EObject = new_object(table)
    for name, feature in table.features.items():
        value = getattr(join, name)
        if feature.kind is FeatureKind.CROSS_REFERENCE and value is not None:
            link(made, feature, value)
        elif feature.kind is FeatureKind.ATTRIBUTE:
            set_value(made, feature, value)
    return made


def made_of(metamodels: Metamodels, child: Child) -> EObject:
    """Makes an element of what a command would add; references are left out."""
    table = metamodels.classes[child.kind]
    made: EObject = new_object(table)
    for name, texts in child.values.items():
        _set(made, table.features[name], texts)
    for each in child.children:
        link(made, table.features[each.feature], made_of(metamodels, each))
    return made


def _set(made: Any, feature: FeatureTable, texts: Sequence[str]) -> None:
    if feature.data_type is None:
        return
    values = [convert(text, feature.data_type)[0] for text in texts]
    if feature.many:
        set_values(made, feature, values)
    elif values:
        set_value(made, feature, values[0])

"""Trial assignments: what the rules say of assignments that no model has yet."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.authoring.proposals.mapping.tabling import table_of
from jausml.language.metamodel import FeatureKind
from jausml.language.metamodel.filling import (
    contents,
    link,
    new_object,
    point,
    set_value,
    set_values,
)
from jausml.language.model.model import made_model
from jausml.language.model.values import convert
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rules import all_rules

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from jausml.authoring.editing.commands import Child
    from jausml.language.metamodel import FeatureTable, Metamodels
    from jausml.language.metamodel.classes import bridge, jaus, ros
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.validation.rule import Finding, Rule

_RULES = frozenset(
    {
        *("JML411", "JML412", "JML413", "JML414", "JML431", "JML432", "JML433", "JML434"),
        *("JML435", "JML436", "JML438", "JML441", "JML446", "JML447", "JML458", "JML459"),
        *("JML461",),
    }
)
"""The rules that judge an assignment by itself."""

_TOGETHER = _RULES | {"JML415"}
"""Those that judge it beside the others of its map."""


@dataclass(frozen=True)
class Judged:
    """An assignment that was tried.

    Attributes:
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
    """
    library = new_object(metamodels.classes["bridge.MapLibrary"])
    made: list[EObject] = []
    for each in assignments:
        made += with_assignments(metamodels, _map_like(metamodels, used, library), [each])
    return _judged(metamodels, library, assignments, made, _RULES)


def judge_together(
    metamodels: Metamodels, used: bridge.AttributeMap, assignments: Sequence[Child]
) -> list[Judged]:
    """Returns what the rules say of assignments that stand in their map with those it has."""
    library = new_object(metamodels.classes["bridge.MapLibrary"])
    whole = _map_like(metamodels, used, library)
    for name in ("toRos", "toJaus"):
        for each in getattr(used, name):
            link(whole, metamodels.class_of(whole).features[name], _copied(metamodels, each))
    made = with_assignments(metamodels, whole, assignments)
    return _judged(metamodels, library, assignments, made, _TOGETHER)


def fresh_map(
    metamodels: Metamodels, name: str, message: jaus.MessageDef, kind: ros.MessageType
) -> bridge.AttributeMap:
    """Makes a map without assignments that stands in no model."""
    library = new_object(metamodels.classes["bridge.MapLibrary"])
    table = metamodels.classes["bridge.AttributeMap"]
    made: bridge.AttributeMap = new_object(table)
    set_value(made, table.features["name"], name)
    point(made, table.features["message"], message)
    point(made, table.features["type"], kind)
    link(library, metamodels.class_of(library).features["maps"], made)
    return made


def findings(metamodels: Metamodels, made: bridge.AttributeMap) -> list[tuple[Rule, Finding]]:
    """Returns what all rules say of a map that `fresh_map` made, errors first, notes left out."""
    subject = Subject(made_model(metamodels, made.eContainer() or made))
    said = [(rule, each) for rule in all_rules() for each in rule.check(subject)]
    return sorted((each for each in said if _severity(each) != "info"), key=_gravity)


def _judged(
    metamodels: Metamodels,
    library: EObject,
    assignments: Sequence[Child],
    made: Sequence[EObject],
    rules: Collection[str],
) -> list[Judged]:
    """Returns what rules say of elements that were made of assignments."""
    subject = Subject(made_model(metamodels, library))
    found: dict[EObject, list[tuple[Rule, Finding]]] = {each: [] for each in made}
    for rule in all_rules():
        for finding in rule.check(subject) if rule.id in rules else ():
            element: EObject | None = finding.element
            while element is not None and element not in found:
                element = element.eContainer()
            if element is not None:
                found[element].append((rule, finding))
    return [
        Judged(each, tuple(sorted(found[own], key=_gravity)))
        for each, own in zip(assignments, made, strict=True)
    ]


def _severity(found: tuple[Rule, Finding]) -> str:
    rule, finding = found
    return (finding.severity or rule.severity).value


def _gravity(found: tuple[Rule, Finding]) -> tuple[int, str]:
    return ("error", "warning", "info").index(_severity(found)), found[0].id


def _map_like(metamodels: Metamodels, used: bridge.AttributeMap, owner: EObject) -> EObject:
    """Makes a map with the ends of another one, without assignments."""
    table = metamodels.class_of(used)
    made: EObject = new_object(table)
    set_value(made, table.features["name"], used.name)
    for name in ("message", "type"):
        point(made, table.features[name], getattr(used, name))
    for name in ("joins", "reportJoins"):
        for join in getattr(used, name):
            link(made, table.features[name], _copied(metamodels, join))
    link(owner, metamodels.class_of(owner).features["maps"], made)
    return made


def with_assignments(
    metamodels: Metamodels, whole: EObject, assignments: Sequence[Child]
) -> list[EObject]:
    """Adds assignments to a map that was made, and returns the elements.

    Args:
        assignments: Each with the feature of the map that shall own it; tables come before what
            names them.
    """
    made = [made_of(metamodels, each) for each in assignments]
    for each, element in zip(assignments, made, strict=True):
        link(whole, metamodels.class_of(whole).features[each.feature], element)
        _refer_to_tables(metamodels, whole, each, element)
    return made


def _refer_to_tables(metamodels: Metamodels, whole: Any, child: Child, made: Any) -> None:
    """Lets conversions refer to tables of the map, which they name."""
    named = [table_of(each) for each in child.children]
    for name, conversion in zip(named, made.conversions if any(named) else (), strict=False):
        for table in whole.tables if name else ():
            if table.name == name:
                point(conversion, metamodels.class_of(conversion).features["table"], table)


def _copied(metamodels: Metamodels, element: EObject) -> EObject:
    """Returns an element like another one, with all that it owns; what it refers to is the same."""
    table = metamodels.class_of(element)
    made: EObject = new_object(table)
    for name, feature in table.features.items():
        if name not in element.__dict__ or not feature.settable:
            continue
        values = contents(element, feature)
        if feature.kind is FeatureKind.CROSS_REFERENCE:
            for each in values:
                point(made, feature, each)
        elif feature.kind is FeatureKind.CONTAINMENT:
            for each in values:
                link(made, feature, _copied(metamodels, each))
        elif feature.many:
            set_values(made, feature, values)
        elif feature.kind is FeatureKind.ATTRIBUTE and values:
            set_value(made, feature, values[0])
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

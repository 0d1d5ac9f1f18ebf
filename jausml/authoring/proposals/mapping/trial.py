"""Assignments that no model has yet: what the rules say of them, and the tables they need."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from jausml.authoring.editing.commands import NEW, Add, Child
from jausml.authoring.proposals.new_elements import free_name
from jausml.language.metamodel import FeatureKind, Metamodels
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import (
    contents,
    fill,
    link,
    new_object,
    point,
    set_value,
)
from jausml.language.model.model import made_model
from jausml.language.model.names import with_owners
from jausml.language.model.refs import Ref
from jausml.language.model.values import convert
from jausml.language.semantics.conversions.authored import LookUp
from jausml.language.semantics.paths.attributes import Comparison, compared, table_entries
from jausml.language.semantics.paths.jaus_paths import JausPlace
from jausml.language.semantics.paths.ros_paths import RosPlace
from jausml.language.semantics.paths.scopes import outer_scope
from jausml.language.semantics.subject import Subject, remembering
from jausml.language.validation.rule import Finding, Rule
from jausml.language.validation.rules import all_rules

_TABLES, _TABLE = "tables", "table"

Pairs = tuple[tuple[str, str], ...]
"""The entries of a table: names of JAUS and of ROS."""


@dataclass(frozen=True)
class Tabled:
    """Assignments with the tables that they need.

    `assignments`: all assignments; those by a table name it in their conversion.
    """

    tables: tuple[Child, ...]
    assignments: tuple[Child, ...]


def tabled(map_: bridge.AttributeMap, assignments: Iterable[Child]) -> Tabled:
    """Adds a table where both ends of an assignment have equal names with other numbers.

    `assignments`: those that are to be. What lies in lists, or has conversions, stays as it is.
    """
    names = {
        table.name: tuple((entry.jaus, entry.ros) for entry in table.entries)
        for table in map_.tables
    }
    tables, new_assignments = [], []
    for assignment in assignments:
        pairs = _needed(map_, assignment)
        if not pairs:
            new_assignments.append(assignment)
            continue
        name = next((name for name, known in names.items() if known == pairs), "")
        if not name:
            jaus = "source" if assignment.feature == "toRos" else "target"
            name = free_name(assignment.values[jaus][0].rpartition(".")[2], names)
            names[name] = pairs
            tables.append(_table(name, pairs))
        values = {"kind": (LookUp.name,), _TABLE: (name,)}
        conversion = Child("conversions", "bridge.Conversion", values)
        new_assignments.append(replace(assignment, children=(conversion,)))
    return Tabled(tuple(tables), tuple(new_assignments))


def table_of(conversion: Child) -> str:
    """Returns the name of the table of a conversion that is to be, empty for one without."""
    return conversion.values.get(_TABLE, ("",))[0]


def additions(
    owner: Ref,
    tables: Sequence[Child],
    assignments: Iterable[Child],
    known: Iterable[tuple[str, Ref]],
    first: int,
) -> list[Add]:
    """Returns the commands that add tables to a map, and then the assignments that refer to them.

    `first`: how many elements the batch of commands has made before.
    """
    refs = dict(known)
    refs |= {child.values["name"][0]: f"{NEW}{first + at}" for at, child in enumerate(tables)}
    children = (*tables, *(_referring(assignment, refs) for assignment in assignments))
    return [
        Add(owner, child.feature, child.kind, child.values, child.children) for child in children
    ]


def _referring(child: Child, refs: dict[str, Ref]) -> Child:
    steps = tuple(
        replace(step, values={**step.values, _TABLE: (refs[name],)})
        if (name := table_of(step))
        else step
        for step in child.children
    )
    return replace(child, children=steps)


def _needed(map_: bridge.AttributeMap, child: Child) -> Pairs:
    """Returns the entries that an assignment needs; none where the numbers mean the same."""
    if child.kind != "bridge.FieldAssignment" or child.children:
        return ()
    to_ros = child.feature == "toRos"
    comparison = _compared(
        map_, child.values["source"][0], child.values["target"][0], to_ros=to_ros
    )
    if comparison is None or not (comparison.renumbered and comparison.is_of_one_enumeration):
        return ()
    return tuple((jaus.name, ros.name) for jaus, ros in table_entries(comparison, to_ros=to_ros))


def _compared(
    map_: bridge.AttributeMap, source: str, target: str, *, to_ros: bool
) -> Comparison | None:
    scope = outer_scope(map_, to_ros=to_ros)
    ends = [scope.find_source(source), scope.find_target(target)]
    places = [end for end in ends if isinstance(end, JausPlace | RosPlace)]
    return compared(*(place.attribute() for place in places)) if len(places) == len(ends) else None


def _table(name: str, pairs: Pairs) -> Child:
    entries = (
        Child("entries", "bridge.TableEntry", {"jaus": (jaus,), "ros": (ros,)})
        for jaus, ros in pairs
    )
    return Child(_TABLES, "bridge.ValueTable", {"name": (name,)}, tuple(entries))


_RULES = frozenset(
    {
        *("JML411", "JML412", "JML413", "JML414", "JML431", "JML432", "JML433", "JML434"),
        *("JML435", "JML436", "JML438", "JML441", "JML446", "JML447", "JML458", "JML459"),
        *("JML461",),
    }
)
"""The rules that judge an assignment by itself."""

_TOGETHER = _RULES | {"JML415"}  # the rules that judge an assignment beside the others of its map


@dataclass(frozen=True)
class Judged:
    """An assignment that was tried.

    `findings`: what the rules say of it, errors first.
    """

    assignment: Child
    findings: tuple[tuple[Rule, Finding], ...]

    @property
    def is_accepted(self) -> bool:
        """Whether no rule finds an error or a warning."""
        return not any(_severity(finding) != "info" for finding in self.findings)

    @property
    def is_possible(self) -> bool:
        """Whether no rule finds an error."""
        return not any(_severity(finding) == "error" for finding in self.findings)

    @property
    def said(self) -> str:
        """The first finding, with its hint."""
        for _, finding in self.findings:
            return f"{finding.message}; {finding.hint}" if finding.hint else finding.message
        return ""


def judge(
    metamodels: Metamodels, map_: bridge.AttributeMap, assignments: Sequence[Child]
) -> list[Judged]:
    """Returns the findings of the rules about assignments, each of which stands alone in its map.

    Nothing of the model is touched: maps are made that refer to the same message and type.
    """
    library = new_object(metamodels.classes["bridge.MapLibrary"])
    elements: list[EObject] = []
    for assignment in assignments:
        elements += with_assignments(metamodels, _map_like(metamodels, map_, library), [assignment])
    return _judged(metamodels, library, assignments, elements, _RULES)


def judge_together(
    metamodels: Metamodels, map_: bridge.AttributeMap, assignments: Sequence[Child]
) -> list[Judged]:
    """Returns the findings about assignments that stand in their map beside those it has."""
    library = new_object(metamodels.classes["bridge.MapLibrary"])
    whole = _map_like(metamodels, map_, library)
    for name in ("toRos", "toJaus"):
        for assignment in getattr(map_, name):
            link(whole, metamodels.class_of(whole).features[name], _copied(metamodels, assignment))
    elements = with_assignments(metamodels, whole, assignments)
    return _judged(metamodels, library, assignments, elements, _TOGETHER)


def fresh_map(
    metamodels: Metamodels, name: str, message: jaus.MessageDef, kind: ros.MessageType
) -> bridge.AttributeMap:
    """Makes a map without assignments that stands in no model."""
    library = new_object(metamodels.classes["bridge.MapLibrary"])
    table = metamodels.classes["bridge.AttributeMap"]
    new_map: bridge.AttributeMap = new_object(table)
    set_value(new_map, table.features["name"], name)
    point(new_map, table.features["message"], message)
    point(new_map, table.features["type"], kind)
    link(library, metamodels.class_of(library).features["maps"], new_map)
    return new_map


def findings(metamodels: Metamodels, new_map: bridge.AttributeMap) -> list[tuple[Rule, Finding]]:
    """Returns the findings of all rules about a new map, errors first, notes left out."""
    subject = Subject(made_model(metamodels, new_map.eContainer() or new_map))
    with remembering():
        said = [(rule, finding) for rule in all_rules() for finding in rule.findings(subject)]
    return sorted((pair for pair in said if _severity(pair) != "info"), key=_gravity)


def _judged(
    metamodels: Metamodels,
    library: EObject,
    assignments: Sequence[Child],
    elements: Sequence[EObject],
    rules: Collection[str],
) -> list[Judged]:
    """Returns the findings of rules about elements that were made of assignments."""
    subject = Subject(made_model(metamodels, library))
    findings_by_element: dict[EObject, list[tuple[Rule, Finding]]] = {
        made_element: [] for made_element in elements
    }
    with remembering():
        for rule in all_rules():
            for finding in rule.findings(subject) if rule.id in rules else ():
                for element in with_owners(finding.element):
                    if element in findings_by_element:
                        findings_by_element[element].append((rule, finding))
                        break
    return [
        Judged(child, tuple(sorted(findings_by_element[own], key=_gravity)))
        for child, own in zip(assignments, elements, strict=True)
    ]


def _severity(pair: tuple[Rule, Finding]) -> str:
    rule, finding = pair
    return (finding.severity or rule.severity).value


def _gravity(pair: tuple[Rule, Finding]) -> tuple[int, str]:
    return ("error", "warning", "info").index(_severity(pair)), pair[0].id


def _map_like(metamodels: Metamodels, map_: bridge.AttributeMap, owner: EObject) -> EObject:
    """Makes a map with the ends of another one, without assignments."""
    table = metamodels.class_of(map_)
    new_map: EObject = new_object(table)
    set_value(new_map, table.features["name"], map_.name)
    for name in ("message", "type"):
        point(new_map, table.features[name], getattr(map_, name))
    for name in ("joins", "reportJoins"):
        for join in getattr(map_, name):
            link(new_map, table.features[name], _copied(metamodels, join))
    link(owner, metamodels.class_of(owner).features["maps"], new_map)
    return new_map


def with_assignments(
    metamodels: Metamodels, whole: EObject, assignments: Sequence[Child]
) -> list[EObject]:
    """Adds assignments to a map that was made, and returns the elements.

    `assignments`: each with the feature of the map that shall own it; tables come before what names
    them.
    """
    elements = [made_of(metamodels, assignment) for assignment in assignments]
    for child, element in zip(assignments, elements, strict=True):
        link(whole, metamodels.class_of(whole).features[child.feature], element)
        _refer_to_tables(metamodels, whole, child, element)
    return elements


def _refer_to_tables(metamodels: Metamodels, whole: Any, child: Child, assignment: Any) -> None:
    """Lets conversions refer to tables of the map, which they name."""
    named = [table_of(step) for step in child.children]
    for name, conversion in zip(named, assignment.conversions if any(named) else (), strict=False):
        for table in whole.tables if name else ():
            if table.name == name:
                point(conversion, metamodels.class_of(conversion).features["table"], table)


def _copied(metamodels: Metamodels, element: EObject) -> EObject:
    """Returns a copy of an element with all its parts; its references stay the same."""
    table = metamodels.class_of(element)
    duplicate: EObject = new_object(table)
    for name, feature in table.features.items():
        if name not in element.__dict__ or not feature.settable:
            continue
        values = contents(element, feature)
        if feature.kind is FeatureKind.CROSS_REFERENCE:
            for value in values:
                point(duplicate, feature, value)
        elif feature.kind is FeatureKind.CONTAINMENT:
            for value in values:
                link(duplicate, feature, _copied(metamodels, value))
        elif feature.kind is FeatureKind.ATTRIBUTE:
            fill(duplicate, feature, values)
    return duplicate


def made_of(metamodels: Metamodels, child: Child) -> EObject:
    """Returns the element of an addition; references are left out."""
    table = metamodels.classes[child.kind]
    element: EObject = new_object(table)
    for name, texts in child.values.items():
        feature = table.features[name]
        if feature.data_type is not None:
            fill(element, feature, [convert(text, feature.data_type)[0] for text in texts])
    for inner_child in child.children:
        link(element, table.features[inner_child.feature], made_of(metamodels, inner_child))
    return element

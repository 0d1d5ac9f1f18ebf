"""Assignments as commands and as text: each replaces what fills the same member."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from jausml.authoring.editing.commands import Child, Command, Remove
from jausml.authoring.proposals.elements import Option, Options, Scope
from jausml.authoring.proposals.mapping.members import Member
from jausml.authoring.proposals.mapping.trial import additions, judge
from jausml.language.metamodel.classes import bridge
from jausml.language.model.names import name_of
from jausml.language.semantics.conversions import CONVERSIONS, Effect, UnitEffect
from jausml.language.semantics.paths.scopes import parse_path, source_paths, target_paths

_WITH_FACTOR = [
    conversion
    for conversion in CONVERSIONS.values()
    if conversion.effect is Effect.LINEAR and len(conversion.arguments) == 1
]

_POLICIES = ("whenAbsent", "defaultValue", "outOfRange")

UNKNOWN = "1"
"""The number that stands for one that the author knows."""

OF_AUTHORS = tuple(
    conversion.name
    for conversion in sorted(
        _WITH_FACTOR, key=lambda conversion: conversion.units is UnitEffect.ANY
    )
)
"""Conversions whose argument the author knows, with 1 in its place: proposed behind all others.

Those that say something of units come first.
"""


def filling(
    scope: Scope,
    map_: bridge.AttributeMap,
    child: Child,
    source: Member | None,
    target: Member,
    feature: str,
    tables: Sequence[Child] = (),
) -> tuple[Command, ...]:
    """Returns the commands that add an assignment, in place of one with the same target.

    `feature`: the direction: `toRos` or `toJaus`.
    """
    owner: bridge.AttributeMap | bridge.ListAssignment = map_
    if source is not None and source.outer:
        around = _list_of(map_, source, target, feature)
        if around is not None:
            owner, child, feature = around, innermost(child), "assignments"
    known = [(name_of(table), scope.ref(table)) for table in map_.tables]
    adds = additions(scope.ref(owner), tables, [child], known, 0)
    filled = {parse_path(word) for word in child.values["target"][0].split(", ")}
    gone = [
        assignment
        for assignment in getattr(owner, feature)
        if any(parse_path(path) in filled for path in target_paths(assignment))
    ]
    return (*adds, *(Remove(scope.ref(assignment)) for assignment in gone))


def _list_of(
    map_: bridge.AttributeMap, source: Member, target: Member, feature: str
) -> bridge.ListAssignment | None:
    """Returns the assignment of the lists in which two members lie, if there is one."""
    for assignment in getattr(map_, feature):
        if isinstance(assignment, bridge.ListAssignment):
            ends = source_paths(assignment)[:1], target_paths(assignment)[:1]
            if ends == ([source.outer], [target.outer]):
                return assignment
    return None


def innermost(child: Child) -> Child:
    """Returns the assignment itself: of one of lists, that of their elements."""
    nested = [assignment for assignment in child.children if assignment.feature == "assignments"]
    return nested[0] if nested else child


def steps(child: Child) -> tuple[str, ...]:
    """Returns the names of the conversions of an assignment."""
    inner = innermost(child)
    return tuple(step.values["kind"][0] for step in inner.children if "kind" in step.values)


def statement(child: Child) -> str:
    """Returns an assignment in the text notation."""
    values = {name: texts[0] for name, texts in child.values.items() if texts}
    target = values.get("target", "")
    if child.kind == "bridge.Ignore":
        return f"ignore {target}"
    if child.kind == "bridge.ClockAssignment":
        return f"clock -> {target}"
    if child.kind == "bridge.ConstantAssignment":
        return f"{_literal(values['value'])} -> {target}"
    head = f"{values['source']} -> {target}"
    if child.kind == "bridge.ListAssignment":
        inner = (assignment for assignment in child.children if assignment.feature == "assignments")
        return f"{head} {{ {'  '.join(map(statement, inner))} }}"
    more = [f"{name}: {values[name]}" for name in _POLICIES if name in values]
    calls = [_call(step) for step in child.children if "kind" in step.values]
    head += f" : {', '.join(calls)}" if calls else ""
    return f"{head} {{ {'  '.join(more)} }}" if more else head


def _call(conversion: Child) -> str:
    values = conversion.values
    name, arguments = values["kind"][0], values.get("table", values.get("arguments", ()))
    return f"{name}({', '.join(arguments)})" if arguments else name


def _literal(value: str) -> str:
    try:
        float(value)
    except ValueError:
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    return value


def constant(scope: Scope, map_: bridge.AttributeMap, target: Member, value: str) -> Options:
    """Returns how a member becomes a constant, or why it cannot have the value."""
    values = {"target": (target.inner,), "value": (value,)}
    return _sourceless(scope, map_, target, "bridge.ConstantAssignment", values, "constant")


def clock(scope: Scope, map_: bridge.AttributeMap, target: Member) -> Options:
    """Returns how a member becomes the present time, or why it cannot."""
    return _sourceless(
        scope, map_, target, "bridge.ClockAssignment", {"target": (target.inner,)}, "present time"
    )


def ignore(scope: Scope, map_: bridge.AttributeMap, target: Member) -> Options:
    """Returns how a member is left out on purpose."""
    return _sourceless(
        scope, map_, target, "bridge.Ignore", {"target": (target.inner,)}, "leave out"
    )


def _sourceless(
    scope: Scope,
    map_: bridge.AttributeMap,
    target: Member,
    kind: str,
    values: Mapping[str, tuple[str, ...]],
    label: str,
) -> Options:
    feature = "toJaus" if target.is_jaus else "toRos"
    if target.outer:
        return Options(refusal=f"'{target.path}' is of each element of '{target.outer}'")
    child = Child(feature, kind, values)
    [judged] = judge(scope.model.metamodels, map_, [child])
    if not judged.is_possible:
        return Options(refusal=judged.said)
    commands = filling(scope, map_, child, None, target, feature)
    said = judged.said or label
    option = Option(label, said, commands, is_best=True, preview=statement(child))
    return Options((option,))

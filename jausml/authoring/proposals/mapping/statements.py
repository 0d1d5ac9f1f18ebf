"""Statements: assignments that are to be, in the text notation."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.semantics.conversions import CONVERSIONS, Effect, UnitEffect

if TYPE_CHECKING:
    from jausml.authoring.editing.commands import Child

_WITH_FACTOR = [
    each
    for each in CONVERSIONS.values()
    if each.effect is Effect.LINEAR and len(each.arguments) == 1
]
_POLICIES = ("whenAbsent", "defaultValue", "outOfRange")

UNKNOWN = "1"
"""The number that stands for one that the author knows."""

OF_AUTHORS = tuple(
    each.name for each in sorted(_WITH_FACTOR, key=lambda each: each.units is UnitEffect.ANY)
)
"""Conversions whose argument the author knows, with 1 in its place: proposed behind all others.

Those that say something of units come first.
"""


def innermost(child: Child) -> Child:
    """Returns the assignment itself: of one of lists, that of their elements."""
    nested = [each for each in child.children if each.feature == "assignments"]
    return nested[0] if nested else child


def steps(child: Child) -> tuple[str, ...]:
    """Returns the names of the conversions of an assignment."""
    inner = innermost(child)
    return tuple(each.values["kind"][0] for each in inner.children if "kind" in each.values)


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
        inner = (each for each in child.children if each.feature == "assignments")
        return f"{head} {{ {'  '.join(map(statement, inner))} }}"
    more = [f"{name}: {values[name]}" for name in _POLICIES if name in values]
    calls = [_call(each) for each in child.children if "kind" in each.values]
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

"""Translations that interpret the attribute maps of a model, message by message.

What a bridge does that knows its model at run time only: it looks at each assignment of the map,
walks attribute paths by reflection, calls conversions by name and keeps values within what the
target carries. What can be known before a message comes is kept: split paths, parsed expressions,
looked-up functions and classes. What the measured maps do not use is not there: joins, tables,
messages in messages, optional fields.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, Any

from ends import message_class

from jausml.language.attributes.expressions import evaluate
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.assignments.steps import steps_of
from jausml.language.semantics.paths.attributes import NUMBER, TEXT, Attribute
from jausml.language.semantics.paths.scopes import Placed, outer_scope, parse_path
from jausml.runtime import conversions

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from jausml.language.semantics.assignments.steps import Step
    from jausml.language.semantics.paths.scopes import PathScope
    from jausml.live.messages import MessageEntry

_ELEMENT = "."


@dataclass
class Context:
    """Where paths of the source start.

    Attributes:
        root: The whole message.
        element: The element of a list that is translated; the message itself outside of lists.
        counters: Number of the element and of all elements.
    """

    root: Any
    element: Any
    counters: dict[str, int] = field(default_factory=dict)


class Interpreter:
    """Translates by one attribute map in one direction."""

    def __init__(self, attribute_map: bridge.AttributeMap, entry: MessageEntry, way: str) -> None:
        """Looks at the map once.

        Args:
            attribute_map: The map.
            entry: Interpreting codec of its JAUS message.
            way: `up` or `down`.
        """
        to_ros = way == "up"
        self.ros_class = message_class(_full_name(attribute_map.type))
        self._entry = entry
        self._body = str(attribute_map.message.body.name)
        assignments = attribute_map.toRos if to_ros else attribute_map.toJaus
        rules = _rules(assignments, outer_scope(attribute_map, to_ros=to_ros))
        self._rules = rules

    def to_ros(self, payload: bytes) -> Any:
        """Returns the ROS message of an encoded JAUS message."""
        source = self._entry.decode(payload)[self._body]
        target = self.ros_class()
        context = Context(source, source)
        for rule in self._rules:
            rule.apply(context, target)
        return target

    def to_jaus(self, source: Any) -> bytes:
        """Returns the encoded JAUS message of a ROS message."""
        target: dict[str, Any] = {}
        context = Context(source, source)
        for rule in self._rules:
            rule.apply(context, target)
        return self._entry.encode({self._body: target})


def interpreters(
    element: bridge.Bridge, entry_of: Callable[[str], MessageEntry]
) -> dict[str, Interpreter]:
    """Returns the interpreter of each connection of a bridge by its name."""
    found = {}
    for each in element.bridgeConnections:
        way = "up" if each.direction.name == "jausToRos" else "down"
        found[str(each.name)] = Interpreter(each.map, entry_of(str(each.map.message.name)), way)
    return found


def _full_name(message_type: Any) -> str:
    return f"{message_type.eContainer().name}/{message_type.name}"


# ------------------------------------------------------------------ assignments


def _rules(assignments: Iterable[bridge.Assignment], scope: PathScope) -> list[Any]:
    rules: list[Any] = []
    for each in assignments:
        placed = Placed(each, scope)
        match each:
            case bridge.ListAssignment():
                rules.append(ListRule(placed))
            case bridge.FieldAssignment():
                rules.append(FieldRule(placed))
            case bridge.ConstantAssignment():
                rules.append(ConstantRule(placed))
            case bridge.ClockAssignment():
                rules.append(ClockRule(placed))
            case bridge.Ignore():
                pass
            case _:
                raise NotImplementedError(type(each).__name__)
    return rules


class FieldRule:
    """Takes values of the source, converts them, fits them and stores them."""

    def __init__(self, placed: Placed[bridge.FieldAssignment]) -> None:
        self._sources = [path for path, _ in placed.sources]
        self._targets = [(path, _attribute(found)) for path, found in placed.targets]
        self._steps = steps_of(placed)

    def apply(self, context: Context, target: Any) -> None:
        """Fills the targets of one message."""
        for (path, attribute), value in zip(self._targets, self.values(context), strict=True):
            put(target, path, fitted(value, attribute))

    def values(self, context: Context) -> list[Any]:
        """Returns the converted values of one message."""
        values = [get(context, path) for path in self._sources]
        for step in self._steps:
            values = _converted(step, values, context)
        return values

    def element(self, context: Context) -> Any:
        """Returns the value of a list element that has no members."""
        return fitted(self.values(context)[0], self._targets[0][1])

    @property
    def is_element(self) -> bool:
        """Whether the target is the element of a list itself."""
        return self._targets[0][0] == _ELEMENT


class ConstantRule:
    """Stores a constant of the model."""

    def __init__(self, placed: Placed[bridge.ConstantAssignment]) -> None:
        self._path, found = placed.targets[0]
        attribute = _attribute(found)
        text = str(placed.assignment.value)
        self._value = fitted(float(text) if attribute.kind == NUMBER else text, attribute)

    def apply(self, _context: Context, target: Any) -> None:
        """Fills the target of one message."""
        put(target, self._path, self._value)


class ClockRule:
    """Stores the present time."""

    def __init__(self, placed: Placed[bridge.ClockAssignment]) -> None:
        self._path = placed.targets[0][0]

    def apply(self, _context: Context, target: Any) -> None:
        """Fills the target of one message."""
        put(target, self._path, conversions.Time(*divmod(time.time_ns(), 10**9)))


class ListRule:
    """Makes an element of the target list for each one of the source list."""

    def __init__(self, placed: Placed[bridge.ListAssignment]) -> None:
        inner = placed.scope.inner(placed.assignment)
        assert inner is not None
        self._source = placed.sources[0][0]
        self._target = placed.targets[0][0]
        self._rules = _rules(placed.assignment.assignments, inner)
        self._to_ros = placed.scope.to_ros
        is_plain = [isinstance(each, FieldRule) and each.is_element for each in self._rules]
        self._is_plain = any(is_plain)

    def apply(self, context: Context, target: Any) -> None:
        """Fills the list of one message."""
        items = get(context, self._source)
        inner = Context(context.root, None, {"count": len(items)})
        if self._is_plain:
            put(target, self._target, self._plain(items, inner))
            return
        make: Callable[[], Any] = self._class(target) if self._to_ros else dict
        elements = []
        for number, item in enumerate(items):
            inner.element, inner.counters["index"] = item, number
            element = make()
            for rule in self._rules:
                rule.apply(inner, element)
            elements.append(element)
        put(target, self._target, elements)

    def _plain(self, items: Any, inner: Context) -> list[Any]:
        elements = []
        rule = self._rules[0]
        for number, item in enumerate(items):
            inner.element, inner.counters["index"] = item, number
            elements.append(rule.element(inner))
        return elements

    def _class(self, target: Any) -> Callable[[], Any]:
        for step in _steps(self._target)[:-1]:
            target = getattr(target, step)
        kinds = target.get_fields_and_field_types()
        kind = kinds[_steps(self._target)[-1]]
        return message_class(kind.removeprefix("sequence<").rstrip(">"))


def _attribute(found: object) -> Attribute:
    assert isinstance(found, Attribute), found
    return found


# ------------------------------------------------------------------ values


@cache
def _steps(path: str) -> tuple[str, ...]:
    return parse_path(path.removeprefix("/"))


def get(context: Context, path: str) -> Any:
    """Returns the value at the end of a source path: a key, an attribute or an index each step."""
    if path in context.counters:
        return context.counters[path]
    value = context.root if path.startswith("/") else context.element
    for step in _steps(path):
        if step.startswith("["):
            value = value[int(step[1:-1])]
        elif isinstance(value, dict):
            value = value[step]
        else:
            value = getattr(value, step)
    return value


def put(target: Any, path: str, value: Any) -> None:
    """Stores a value at the end of a target path."""
    *around, last = _steps(path)
    for step in around:
        target = target.setdefault(step, {}) if isinstance(target, dict) else getattr(target, step)
    if isinstance(target, dict):
        target[last] = value
    elif hasattr(value, "_fields"):  # a quaternion or a time: its members
        inside = getattr(target, last)
        for name in value._fields:
            setattr(inside, name, getattr(value, name))
    else:
        setattr(target, last, value)


def fitted(value: Any, attribute: Attribute) -> Any:
    """Returns a value as the target carries it: its type, and within its range."""
    if attribute.kind == NUMBER:
        if attribute.lower is not None and value < attribute.lower:
            value = attribute.lower
        if attribute.upper is not None and value > attribute.upper:
            value = attribute.upper
        return round(value) if attribute.integral else float(value)
    if attribute.kind == TEXT:
        return str(value)[: attribute.length]
    return value


def _converted(step: Step, values: list[Any], context: Context) -> list[Any]:
    if step.name == "expression":
        (formula,) = step.arguments or ()
        known = {
            name: values[at] if at >= 0 else context.counters[name]
            for name, at in formula.names.items()
        }
        return [evaluate(formula.expression, known)]
    if step.conversion.changes_nothing:
        return values
    result = getattr(conversions, step.name)(*values, *(step.arguments or ()))
    return list(result) if len(step.conversion.outputs) > 1 else [result]

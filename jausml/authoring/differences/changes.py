"""Changes from one state of a model to another: whom they break, and their words."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from typing import Any

from jausml.authoring.differences.matching import address, values
from jausml.language.metamodel import ClassTable, FeatureTable
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.diagnostics import Location
from jausml.language.semantics.conversions import Effect, conversion_of

_PEERS = {
    "jaus.Component": {"address", "provides", "coreServices"},
    "jaus.Service": {"urn", "version", "inherits"},
    "jaus.MessageDef": {"code", "isCommand"},
    "ros.InterfacePackage": {"name"},
    "ros.MessageType": {"name"},
    "ros.ServiceType": {"name"},
    "ros.ActionType": {"name"},
    "ros.Field": {"name", "type", "messageType", "arrayKind", "arraySize", "stringBound"},
    "ros.Constant": {"type", "value"},
    "ros.Node": {"namespace"},
    "ros.Publisher": {"topic", "type"},
    "ros.Subscription": {"topic", "type"},
    "ros.ServiceServer": {"service", "type"},
    "ros.ServiceClient": {"service", "type"},
    "ros.QoSProfile": {"reliability", "durability", "deadline", "liveliness", "leaseDuration"},
    "bridge.Topic": {"name"},
    "bridge.AttributeMap": {"message", "type"},
    "bridge.Connection": {"direction", "map"},
    "bridge.RosServiceConnection": {"direction", "service", "type", "message", "answer"},
    "bridge.RosActionConnection": {"direction", "action", "type", "driver"},
    "bridge.Bridge": {"namespace", "allowedHosts"},
    "system.System": {"rosDomain"},
    "system.Host": {"transport", "port", "multicastGroup"},
}
"""Features that others see on the network, by the class that has them."""

_ON_THE_WIRE = (
    "jaus.Field",
    "jaus.ScaleRange",
    "jaus.ValueSet",
    "jaus.Value",
    "jaus.Alternative",
    "jaus.SubField",
    "jaus.Format",
    "jaus.ValueRange",
    "jaus.EnumeratedValue",
)

_OFF_THE_WIRE = {"name", "documentation"}  # the features of a field that do not matter on the wire

_SEEN = (
    "jaus.Component",
    "jaus.Service",
    "jaus.MessageDef",
    "ros.MessageType",
    "ros.ServiceType",
    "ros.ActionType",
    "ros.Publisher",
    "ros.Subscription",
    "ros.ServiceServer",
    "ros.ServiceClient",
    "bridge.Topic",
    "bridge.Connection",
    "bridge.RosServiceConnection",
    "bridge.RosActionConnection",
)
"""Elements whose end others on the network notice."""

_LAYOUTS = (*_ON_THE_WIRE, "ros.Field")
"""Elements that change the layout of a message by coming or going."""

_NAMED_IN_CODE = (
    "jaus.Component",
    "jaus.ServiceConnection",
    "jaus.Service",
    "jaus.MessageDef",
    "jaus.Field",
    "jaus.SubField",
    "jaus.EnumeratedValue",
    "jaus.Format",
    "jaus.State",
    "jaus.Action",
    "jaus.StateMachine",
    "jaus.InternalEvent",
    "ros.Node",
    "ros.Publisher",
    "ros.Subscription",
    "ros.ServiceServer",
    "ros.ServiceClient",
    "ros.Parameter",
    "ros.InterfacePackage",
    "ros.MessageType",
    "ros.ServiceType",
    "ros.ActionType",
    "ros.Field",
    "ros.Constant",
    "bridge.AttributeMap",
    "bridge.Connection",
    "bridge.RosServiceConnection",
    "bridge.RosActionConnection",
    "bridge.Quantity",
    "system.System",
)
"""Elements whose names are those of generated modules, classes, methods or parameters."""

_GROWING = {"provides", "inherits"}  # features to which values may be added without harm to anybody


class Kind(Enum):
    """Kinds of changes of an element."""

    ADDED = "added"
    REMOVED = "removed"
    RENAMED = "renamed"
    CHANGED = "changed"
    ORDERED = "ordered"
    """Its parts stand in another order, where the order means something."""


class Breaks(Enum):
    """Whom a change may break."""

    PEERS = "peers"
    """Programs on the network that were built for the former state, of JAUS or of ROS."""
    CODE = "code"
    """Code of users that names or extends what was generated."""


@dataclass(frozen=True)
class Change:
    """One change.

    Attributes:
        element: The class of the element in words, such as `bridge connection`.
        path: Where it stands, by the names of the new state, of the old one if it was removed.
        feature: The feature that changed; empty for the whole element.
        old_place: Where the old state says it, None where it does not.
        new_place: Where the new state says it, None where it does not.
    """

    kind: Kind
    element: str
    path: str
    feature: str = ""
    old: str = ""
    new: str = ""
    text: str = ""
    breaks: tuple[Breaks, ...] = ()
    old_place: Location | None = None
    new_place: Location | None = None
    old_element: EObject | None = None
    new_element: EObject | None = None


def breaks(
    kind: Kind, obj: EObject, table: ClassTable, feature: str, *, is_lost: bool
) -> tuple[Breaks, ...]:
    """Returns whom a change of an element may break."""
    classes = {supertype.qualified_name for supertype in table.supertypes}
    breakages = []
    if isinstance(obj, ros.QoSProfile) and not feature:
        # A profile that comes or goes changes the policies of its owner that it states.
        changed = {
            policy.name
            for policy in table.features.values()
            if getattr(obj, policy.name) != policy.default
        }
        is_broken = not changed.isdisjoint(_PEERS["ros.QoSProfile"])
    else:
        is_broken = _breaks_peers(kind, classes, feature, is_lost=is_lost)
    if is_broken:
        breakages.append(Breaks.PEERS)
    if kind in (Kind.REMOVED, Kind.RENAMED) and classes & set(_NAMED_IN_CODE):
        breakages.append(Breaks.CODE)
    if feature == "method" and is_lost:
        breakages.append(Breaks.CODE)
    return tuple(breakages)


def _breaks_peers(kind: Kind, classes: set[str], feature: str, *, is_lost: bool) -> bool:
    match kind:
        case Kind.ADDED:
            return bool(classes & set(_LAYOUTS))
        case Kind.REMOVED:
            return bool(classes & {*_SEEN, *_LAYOUTS})
        case Kind.ORDERED:
            return not classes & {"jaus.State", "jaus.Transition"}
    if classes & set(_ON_THE_WIRE) and feature not in _OFF_THE_WIRE:
        return True
    is_seen = any(feature in _PEERS.get(class_name, ()) for class_name in classes)
    return is_seen and (is_lost or feature not in _GROWING)


def marked(marks: Iterable[Breaks]) -> str:
    """Returns whom a change breaks, in words; empty for nobody."""
    words = " and ".join(mark.value for mark in marks)
    return f"breaks {words}" if words else ""


NOTHING = "nothing"

_UNITS = {
    "rate": "Hz",
    "rateCap": "Hz",
    "maxRate": "Hz",
    "frequency": "Hz",
    "ageLimit": "s",
    "controlTimeout": "s",
    "deadline": "s",
    "eventTimeout": "s",
    "freshness": "s",
    "leaseDuration": "s",
    "lifespan": "s",
    "silenceTimeout": "s",
    "timeout": "s",
}
"""Units of features, as the metamodels document them."""

_CAPITAL = re.compile(r"(?<=[a-z0-9])(?=[A-Z])")


def words(name: str) -> str:
    """Returns a name of the metamodel in words: `silenceTimeout` as `silence timeout`."""
    return _CAPITAL.sub(" ", name).lower()


def element_words(table: ClassTable) -> str:
    """Returns the word for the kind of an element, such as `message` or `connection`."""
    return _ELEMENTS.get(table.qualified_name) or words(table.name)


_ELEMENTS = {
    "bridge.AttributeMap": "map",
    "bridge.Connection": "connection",
    "bridge.RosServiceConnection": "connection",
    "bridge.RosActionConnection": "connection",
    "jaus.MessageDef": "message",
    "jaus.ServiceConnection": "connection",
    "ros.QoSProfile": "QoS",
}


def value_text(value: Any) -> str:
    """Returns a value as people write it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{value:.15g}"
    if isinstance(value, jaus.Service):
        return f"{value.name} {value.version}".strip()
    if address(value):
        return str(getattr(value, "name", None) or address(value))
    return str(getattr(value, "name", value))


def feature_text(obj: EObject, feature: FeatureTable) -> str:
    """Returns the values of a feature, without its unit; empty for none."""
    return " ".join(map(value_text, values(obj, feature)))


def with_unit(feature: str, old: str, new: str) -> str:
    """Returns `25 -> 50 Hz` for two values of a feature."""
    unit = _UNITS.get(feature, "")
    return f"{old or NOTHING} -> {new or NOTHING}{f' {unit}' if unit and new else ''}"


def statement(obj: EObject) -> str:
    """Returns an assignment of a map in one line, which is told as a whole when a part changes.

    An open decision is told by its text.
    """
    target = str(getattr(obj, "target", "") or "?")
    match obj:
        case bridge.OpenDecision():
            return str(obj.text)
        case bridge.Ignore():
            return f"{target} ignored"
        case bridge.ClockAssignment():
            return f"clock -> {target}"
        case bridge.ConstantAssignment():
            return f"{obj.value!s} -> {target}"
        case bridge.MessageAssignment():
            return f"{obj.source} -> {target} by map {value_text(obj.map)}"
        case bridge.FieldAssignment() | bridge.ListAssignment():
            steps = ", ".join(map(conversion, obj.conversions))
            return f"{obj.source} -> {target}{f' : {steps}' if steps else ''}"
    return target


def conversion(obj: bridge.Conversion) -> str:
    """Returns a conversion with its arguments."""
    arguments = list(map(value_text, obj.arguments))
    arguments += [str(text) for text in (obj.expression, obj.method, obj.units) if text]
    arguments += [
        value_text(operand) for operand in (obj.table, obj.quantity) if operand is not None
    ]
    return f"{obj.kind.name}({', '.join(arguments)})" if arguments else str(obj.kind.name)


def is_sign_change(old: EObject, new: EObject) -> bool:
    """Tells whether two assignments differ in the sign alone."""
    if not (isinstance(old, bridge.FieldAssignment) and isinstance(new, bridge.FieldAssignment)):
        return False
    same = (old.source, old.target) == (new.source, new.target)
    (rest, turns), (other_rest, other_turns) = map(_without_sign, (old, new))
    return same and rest == other_rest and turns % 2 != other_turns % 2


def _without_sign(assignment: bridge.FieldAssignment) -> tuple[list[str], int]:
    """Returns the conversions that do more than to turn the sign, and how many turn it."""
    steps = list(assignment.conversions)
    rest = [conversion(step) for step in steps if conversion_of(step).effect is not Effect.NEGATED]
    return rest, len(steps) - len(rest)

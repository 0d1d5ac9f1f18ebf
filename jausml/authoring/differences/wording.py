"""Words for elements, values and assignments."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from jausml.authoring.differences.matching import address, values
from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.semantics.conversions import Effect, conversion_of

if TYPE_CHECKING:
    from jausml.language.metamodel import ClassTable, FeatureTable
    from jausml.language.metamodel.classes.ecore import EObject

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
    """Returns what an element is, in words."""
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
        return f"{value:.10g}"
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
    """Returns a conversion with what it is given."""
    given = [f"{each:.10g}" for each in obj.arguments]
    given += [str(each) for each in (obj.expression, obj.method, obj.units) if each]
    given += [value_text(each) for each in (obj.table, obj.quantity) if each is not None]
    return f"{obj.kind.name}({', '.join(given)})" if given else str(obj.kind.name)


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
    rest = [conversion(each) for each in steps if conversion_of(each).effect is not Effect.NEGATED]
    return rest, len(steps) - len(rest)

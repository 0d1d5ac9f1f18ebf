"""Rules about test vectors of maps."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.paths.attributes import Attribute, PathFault, constant_fault
from jausml.language.semantics.paths.scopes import PathScope, outer_scope
from jausml.language.validation.rule import Finding, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.semantics.subject import Subject

_ABSENT = "absent"


@rule("JML444", Severity.ERROR, "impossible test vector")
def vectors(subject: Subject) -> Iterator[Finding]:
    """The values of a test vector are values of attributes of the messages that they stand for.

    The given values belong to the source, the expected ones to the target. `absent` is for optional
    fields of a JAUS message. The map has assignments for the direction, and a tolerance is a finite
    number that is not negative.

    Bad: `<expected path="pose.orientation" value="0.7071"/>`

    Good: `<expected path="pose.orientation.z" value="0.7071" tolerance="1e-4"/>`
    """
    for each in subject.instances(bridge.AttributeMap):
        if not subject.is_intact(each.message, each.type):
            continue
        for vector in each.vectors:
            if subject.is_intact(vector):
                yield from _vector_findings(each, vector)


def _vector_findings(
    attribute_map: bridge.AttributeMap, vector: bridge.TestVector
) -> Iterator[Finding]:
    to_ros = vector.direction.name == "jausToRos"
    feature = "toRos" if to_ros else "toJaus"
    if not (attribute_map.toRos if to_ros else attribute_map.toJaus):
        message = f"vector '{vector.name}' tests {feature}, which the map does not have"
        yield Finding(vector, message, "direction")
        return
    scope = outer_scope(attribute_map, to_ros=to_ros, indexed=True)
    for value in vector.given:
        yield from _value_findings(value, scope, is_given=True)
    for value in vector.expected:
        yield from _value_findings(value, scope, is_given=False)


def _value_findings(
    value: bridge.VectorValue, scope: PathScope, *, is_given: bool
) -> Iterator[Finding]:
    if value.path is None or value.value is None:
        return
    if not (math.isfinite(value.tolerance) and value.tolerance >= 0):
        yield Finding(value, f"tolerance {value.tolerance:g} is no distance", "tolerance")
    find = scope.find_source if is_given else scope.find_target
    place = find(value.path)
    if isinstance(place, PathFault):
        yield Finding(value, f"'{value.path}': {place.message}", "path", place.hint)
        return
    if place is None:
        return
    attribute = place.attribute()
    fault = _value_fault(value.value, attribute, is_jaus=is_given == scope.to_ros)
    if fault:
        yield Finding(value, f"{value.value!a} of '{value.path}' {fault}", "value")


def _value_fault(text: str, attribute: Attribute, *, is_jaus: bool) -> str:
    if text != _ABSENT:
        return constant_fault(text, attribute)
    if not is_jaus:
        return "is for JAUS fields: all fields of a ROS message are there"
    return "" if attribute.optional else "is for optional fields"

"""Rules about attribute maps and their test vectors."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from jausml.language.metamodel.classes import bridge, ros
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.assignments.steps import ChainFault, chain_kinds, fits, yields
from jausml.language.semantics.conversions import conversions_between
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.paths import attributes, scopes
from jausml.language.semantics.paths.wholes import ShapeError
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, rule

_MANY = (attributes.LIST, attributes.NUMBERS)


@rule("JML411", "no such attribute", kinds=scopes.Direction)
def paths(_: Subject, direction: scopes.Direction) -> Iterator[Finding]:
    """The paths of an assignment lead to attributes of the JAUS message and of the ROS type.

    JAUS paths start at the members of the top record or sequence of the message; ROS paths at
    the fields of the type, or at the name of a join. Elements of fixed arrays and of JAUS lists are
    named by index: `covariance[7]`. Behind a variant or a variable field stands the name of the
    option or alternative. Paths in a ListAssignment start at the element, those with '/' at the
    message. `count` behind a list or an array is the number of its elements, which is no target.

    Bad: `target="twist.lin.x"`

    Good: `target="twist.linear.x"`
    """
    for placed in direction.assignments:
        for path, end in placed.targets:
            if isinstance(end, attributes.PathFault):
                message = f"target '{path}': {end.message}"
                yield Finding(placed.assignment, message, "target", end.hint)
        for path, end in placed.sources:
            if isinstance(end, attributes.PathFault):
                message = f"source '{path}': {end.message}"
                yield Finding(placed.assignment, message, "source", end.hint)


@rule("JML412", "value does not fit the target", kinds=scopes.Direction)
def types(_: Subject, direction: scopes.Direction) -> Iterator[Finding]:
    """The result of an assignment has the kind that its target accepts.

    Numbers go to numbers, text to text, bool to bool or to an unscaled integer and back, octets of
    a variable-length field to a sequence of uint8 and back. A JAUS TimeStamp becomes a
    builtin_interfaces/Time, and angles become a quaternion, by a conversion; one that yields
    several values has as many targets. An instant alone takes the time, by the clock or with
    `whenAbsent="receptionTime"`.

    A record goes to a message, and an array to an array, member by member: the members have the
    same names (`SpeedLimit` is `speed_limit`), fixed arrays as many elements. Other lists and
    arrays are translated by a ListAssignment, and other wholes in the skeleton of the bridge.

    Bad: `target="header.stamp" source="TimeStamp"` without a conversion

    Good: the same with `<conversions kind="timestamp_to_time"/>`
    """
    for placed in direction.of_kind(bridge.ConstantAssignment, bridge.ClockAssignment):
        if len(placed.targets) > 1:
            message = f"{len(placed.targets)} targets of one value"
            yield Finding(placed.assignment, message, "target", "write one assignment for each")
    for timed in direction.of_kind(bridge.ClockAssignment):
        yield from _time_findings(timed, "target")
    for absent in direction.of_kind(bridge.FieldAssignment, bridge.ListAssignment):
        if absent.assignment.whenAbsent.name == "receptionTime":
            yield from _time_findings(absent, "whenAbsent")
    for copied in direction.of_kind(bridge.FieldAssignment):
        if copied.source_attributes and copied.target_attributes:
            yield from _type_findings(copied)


def _time_findings(placed: scopes.Placed[bridge.Assignment], feature: str) -> Iterator[Finding]:
    for path, target in placed.targets:
        if isinstance(target, attributes.Attribute) and target.kind not in (
            attributes.TIME,
            attributes.TIME_STAMP,
        ):
            message = f"'{path}' is {target.name}, it takes no time"
            yield Finding(placed.assignment, message, feature)


@rule("JML413", "constant does not fit the target", kinds=scopes.Direction)
def constants(_: Subject, direction: scopes.Direction) -> Iterator[Finding]:
    """A constant is a value of its target: a number in its range, true or false, or text.

    The same holds for the `defaultValue` of an assignment with `whenAbsent="useDefault"`, which
    must state one. If such an assignment has several sources, the value is a number that takes the
    place of an absent source.

    Bad: `target="PropulsiveLinearEffortX" value="101"`, where the field ends at 100

    Good: `value="100"`
    """
    for placed in direction.of_kind(bridge.ConstantAssignment):
        value = placed.assignment.value
        for path, target in placed.targets:
            fault = _constant_fault(value, target)
            if fault:
                message = f"constant {value!r} of '{path}' {fault}"
                yield Finding(placed.assignment, message, "value")
    for copied in direction.of_kind(bridge.FieldAssignment):
        yield from _default_findings(copied)


def _constant_fault(value: str | None, target: attributes.Found) -> str:
    if value is None or not isinstance(target, attributes.Attribute):
        return ""
    return attributes.constant_fault(value, target)


def _default_findings(placed: scopes.Placed[bridge.FieldAssignment]) -> Iterator[Finding]:
    assignment, value = placed.assignment, placed.assignment.defaultValue
    if assignment.whenAbsent.name != "useDefault":
        if value is not None:
            message = f"the defaultValue of '{assignment.target}' is not used"
            hint = 'set whenAbsent="useDefault"'
            yield Finding(assignment, message, "defaultValue", hint, severity=Severity.WARNING)
        return
    if value is None:
        message = f"'{assignment.target}' has no defaultValue to use"
        yield Finding(assignment, message, "whenAbsent")
        return
    of_sources = len(placed.sources) > 1
    for path, end in placed.sources if of_sources else placed.targets:
        fault = _constant_fault(value, end)
        if fault:
            message = f"defaultValue {value!r} of '{path}' {fault}"
            yield Finding(assignment, message, "defaultValue")


def _type_findings(placed: scopes.Placed[bridge.FieldAssignment]) -> Iterator[Finding]:
    assignment = placed.assignment
    untranslatable = _untranslatable(placed)
    if untranslatable is not None:
        yield untranslatable
        return
    if assignment.conversions:
        yield from _result_findings(placed)
        return
    source, target = placed.source_attributes[0], placed.target_attributes[0]
    if len(placed.targets) > 1:
        message = f"{len(placed.targets)} targets without a conversion that yields them"
        yield Finding(assignment, message, "target")
    elif len(placed.sources) == 1 and not fits(source, target):
        known = conversions_between([source.kind], target.kind)
        hint = f"convert it by {' or '.join(known)}" if known else ""
        message = f"'{assignment.source}' is {source.name}"
        message += f", but '{assignment.target}' is {target.name}"
        yield Finding(assignment, message, "target", hint)


def _untranslatable(placed: scopes.Placed[bridge.FieldAssignment]) -> Finding | None:
    """A finding for an end that no FieldAssignment reads or fills."""
    try:
        scopes.parts_in(placed.assignment, placed.scope)
    except ShapeError as error:
        arrow = f"'{placed.assignment.source}' -> '{placed.assignment.target}'"
        message = f"{arrow} is of wholes that do not correspond: {error}"
        return Finding(placed.assignment, message, "target", "assign their members")
    ends = [("source", *source) for source in placed.sources]
    ends += [("target", *target) for target in placed.targets]
    for feature, path, attribute in ends:
        if not isinstance(attribute, attributes.Attribute):
            continue
        verb = "translate" if feature == "source" else "fill"
        if not attribute.kind:
            hint = f"assign its members, or {verb} it in the skeleton of the bridge"
            return Finding(placed.assignment, f"'{path}' is {attribute.name}", feature, hint)
        if attribute.kind in _MANY:
            arrow = f"{placed.assignment.source} -> {placed.assignment.target}"
            hint = f"{verb} its elements by a ListAssignment, in text {arrow} {{ ... }}"
            return Finding(placed.assignment, f"'{path}' is {attribute.name}", feature, hint)
    return None


def _result_findings(placed: scopes.Placed[bridge.FieldAssignment]) -> Iterator[Finding]:
    assignment, last = placed.assignment, placed.assignment.conversions[-1]
    kinds = chain_kinds(
        assignment.conversions,
        [source_attribute.kind for source_attribute in placed.source_attributes],
    )
    if isinstance(kinds, ChainFault):
        # The chain is wrong; what its end promises may be wrong besides.
        kinds = chain_kinds([last], ["any"])
    if isinstance(kinds, ChainFault):
        return
    if len(kinds) != len(placed.targets):
        message = f"{last.kind.name} yields {len(kinds)} value{'s' * (len(kinds) != 1)}"
        count = len(placed.targets)
        message += f", but there {'is 1 target' if count == 1 else f'are {count} targets'}"
        yield Finding(assignment, message, "target")
        return
    for kind, (path, target) in zip(kinds, placed.targets, strict=True):
        if isinstance(target, attributes.Attribute) and not yields(last, kind, target):
            message = f"{last.kind.name} yields {kind}, but '{path}' is {target.name}"
            yield Finding(assignment, message, "target")


_ABSENT, _WHOLE = "absent", "."


@rule("JML444", "impossible test vector", kinds=bridge.AttributeMap)
def vectors(subject: Subject, attribute_map: bridge.AttributeMap) -> Iterator[Finding]:
    """The values of a test vector are values of attributes of the messages that they stand for.

    The given values belong to the source, the expected ones to the target. `absent` is for optional
    fields of a JAUS message, and for `.` where no message shall come out, which then is all that is
    expected. Octets are pairs of hexadecimal digits. The map has assignments for the direction, and
    a tolerance is a finite number that is not negative.

    Bad: `<expected path="pose.orientation" value="0.7071"/>`

    Good: `<expected path="pose.orientation.z" value="0.7071" tolerance="1e-4"/>`
    """
    if not subject.is_intact(attribute_map.message, attribute_map.type):
        return
    for vector in attribute_map.vectors:
        if subject.is_intact(vector):
            yield from _vector_findings(attribute_map, vector)


def _vector_findings(
    attribute_map: bridge.AttributeMap, vector: bridge.TestVector
) -> Iterator[Finding]:
    to_ros = is_to_ros(vector)
    feature = "toRos" if to_ros else "toJaus"
    if not (attribute_map.toRos if to_ros else attribute_map.toJaus):
        message = f"vector '{vector.name}' tests {feature}, which the map does not have"
        yield Finding(vector, message, "direction")
        return
    scope = scopes.outer_scope(attribute_map, to_ros=to_ros)
    for value in vector.given:
        yield from _value_findings(value, scope, is_given=True)
    whole = next(
        (vector_value for vector_value in vector.expected if vector_value.path == _WHOLE), None
    )
    if whole is not None:
        if whole.value != _ABSENT or len(vector.expected) > 1:
            message = "'.' is the whole message, which can be absent alone"
            yield Finding(whole, message, "path")
        return
    for value in vector.expected:
        yield from _value_findings(value, scope, is_given=False)


def _value_findings(
    value: bridge.VectorValue, scope: scopes.PathScope, *, is_given: bool
) -> Iterator[Finding]:
    if value.path is None or value.value is None:
        return
    if not (math.isfinite(value.tolerance) and value.tolerance >= 0):
        yield Finding(value, f"tolerance {value.tolerance:g} is no distance", "tolerance")
    find = scope.find_source if is_given else scope.find_target
    place = find(value.path)
    if isinstance(place, attributes.PathFault):
        yield Finding(value, f"'{value.path}': {place.message}", "path", place.hint)
        return
    if place is None:
        return
    attribute = place.attribute()
    if is_given and attribute.is_ros and isinstance(attribute.field, ros.PrimitiveField):
        # A message carries what its type can, whatever its definition says of units and ranges.
        able = attributes.primitive(attribute.field.type.name)
        attribute = replace(attribute, lower=able.lower, upper=able.upper)
    fault = _value_fault(value.value, attribute, is_jaus=is_given == scope.to_ros)
    if fault:
        yield Finding(value, f"{value.value!r} of '{value.path}' {fault}", "value")


def _value_fault(text: str, attribute: attributes.Attribute, *, is_jaus: bool) -> str:
    if text != _ABSENT:
        if attribute.kind == attributes.OCTETS:
            return (
                ""
                if attributes.octets_of(text) is not None
                else "is not pairs of hexadecimal digits"
            )
        return attributes.constant_fault(text, attribute)
    if not is_jaus:
        return "is for JAUS fields: all fields of a ROS message are there"
    return "" if attribute.optional else "is for optional fields"


@rule(
    "JML498",
    "decision that is open",
    is_decision=True,
    kinds=bridge.OpenDecision,
    needs=("text", "blocking"),
)
def decisions_made(_: Subject, decision: bridge.OpenDecision) -> Iterator[Finding]:
    """No decision of a map or connection is open.

    No tool can make it, since it depends on the vehicle. It is an error where a safety or the
    meaning of a value hangs on it, and a warning with `blocking` false. Decide, write that into
    the model, and remove the open decision.

    Bad: `<openDecisions text="state the top speed of the vehicle, instead of 1"/>`

    Good: no such element, and the top speed in the map
    """
    if decision.text is None:
        return
    owner = decision.eContainer()
    place = f" in '{owner.name}'" if isinstance(owner, bridge.DecisionOwner) else ""
    severity = None if decision.blocking else Severity.WARNING
    hint = "decide it, then remove the open decision"
    yield Finding(decision, f"open{place}: {decision.text}", "text", hint, severity=severity)

"""Rules about what members mean: those that are crossed, and what only a person can judge."""

from __future__ import annotations

from collections.abc import Iterator

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.assignments.meanings import (
    by_table,
    crossed,
    outcome,
    turns_unseen,
    unknown_targets,
)
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.paths import scopes
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, rule


@rule("JML515", "members that are crossed", severity=Severity.WARNING, kinds=scopes.Direction)
def members_crossed(_: Subject, direction: scopes.Direction) -> Iterator[Finding]:
    """A member goes to the one that is called as it is, where both sides have both names.

    Two members that are exchanged in both directions come back unchanged, so that no round trip
    shows it. Names are compared without case and separators; members whose axes are known are
    judged by these. A map that is meant to exchange them says so in an `@allow`.

    Bad: `PortTemp -> star_temp` and `StarTemp -> port_temp`

    Good: `PortTemp -> port_temp` and `StarTemp -> star_temp`
    """
    for placed in direction.of_kind(bridge.FieldAssignment):
        if names := crossed(placed):
            source, target = placed.assignment.source, placed.assignment.target
            message = f"'{source}' goes to '{target}', though there is '{names[0]}'"
            message += f", and '{names[1]}' beside it"
            hint = f"{source} -> {names[0]}, or an @allow with the reason"
            yield Finding(placed.assignment, message, "target", hint)


@rule(
    "JML517",
    "meaning that nothing can judge",
    severity=Severity.INFO,
    is_decision=True,
    kinds=scopes.Direction,
)
def meanings_known(subject: Subject, direction: scopes.Direction) -> Iterator[Finding]:
    """A change of sign or a table is backed by axes or names at both ends, or by a test vector.

    Where rules know neither, a map that is wrong in both directions looks like one that is right.
    A test vector by a person who has looked at the vehicle, or at its manual, says which it is.
    A safety case leaves it undeveloped until then. In maps of the library, of which profiles are
    made, this is an error.

    Bad: `Rudder -> rudder : negate` between fields without a frame, and no vector

    Good: the same with `vector starboard JAUS->ROS ( Rudder = 0.2 => rudder = -0.2 ~ 1e-4 )`
    """
    map_ = direction.map
    if direction.owner is not map_:
        return
    doubtful = [
        placed
        for placed in direction.of_kind(bridge.FieldAssignment)
        if turns_unseen(placed) or by_table(placed)
    ]
    unknown = dict(unknown_targets(map_, to_ros=direction.to_ros)) if doubtful else {}
    for placed in doubtful:
        targets = scopes.target_paths(placed.assignment)
        target = next((path for path in targets if path in unknown), None)
        if target is not None:
            change = "is turned in sign" if turns_unseen(placed) else "is looked up in a table"
            message = f"'{target}' {change}, and nothing says whether that is right"
            hint = f"a test vector of a person; rules lack {unknown[target]}"
            severity = Severity.ERROR if subject.model.is_library(map_) else None
            yield Finding(placed.assignment, message, "target", hint, severity=severity)


@rule("JML518", "vector that its map refutes", severity=Severity.WARNING, kinds=scopes.Direction)
def vectors_kept(_: Subject, direction: scopes.Direction) -> Iterator[Finding]:
    """For the values that a test vector gives, its map makes the values that the vector expects.

    Assignments from one number to one number are computed here; a generated test of the bridge
    tries the rest. A vector is the word of a person, so the fault is mostly in the map.

    Bad: `Rudder -> rudder : negate` with `vector ahead JAUS->ROS ( Rudder = 0.2 => rudder = 0.2 )`

    Good: `Rudder -> rudder` with the same vector
    """
    map_ = direction.map
    if direction.owner is not map_:
        return
    by_target = {placed.assignment.target.strip(): placed for placed in _computable(direction)}
    for vector in map_.vectors:
        if is_to_ros(vector) != direction.to_ros:
            continue
        inputs = {value.path: value.value for value in vector.given}
        for expected in vector.expected:
            placed = by_target.get(expected.path)
            result = None if placed is None else outcome(placed, inputs, expected)
            if result is not None:
                message = f"'{vector.name}' expects {expected.value} of '{expected.path}', "
                yield Finding(expected, f"{message}the map makes {result:.9g}", "value")


def _computable(direction: scopes.Direction) -> Iterator[scopes.Placed[bridge.FieldAssignment]]:
    """Yields the assignments outside lists from one number to one number."""
    for placed in direction.of_kind(bridge.FieldAssignment):
        ends = placed.source_attributes, placed.target_attributes
        if all(len(end) == 1 for end in ends) and not placed.scope.is_nested:
            yield placed

"""Stops: what a connection sends when the source of a command is lost, or why nothing."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.assignments.units import measure
from jausml.language.semantics.connections.exchanges import MESSAGE
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus import commands
from jausml.language.semantics.names import words
from jausml.language.semantics.paths.attributes import NOT_FINITE, NUMBER, Attribute, is_real
from jausml.language.semantics.paths.scopes import (
    PathScope,
    Placed,
    attribute_at,
    flattened,
    outer_scope,
    parse_path,
    target_paths,
)

SILENCE_TIMEOUT = 1.0
"""Seconds of silence that a command with a safe value stands when nobody says how long.

Whoever steers repeats the command several times a second; one second forgives a few lost datagrams,
and in it a vehicle at walking pace goes little more than a metre.
"""


def carries_commands(connection: bridge.Connection) -> bool:
    """Tells whether a connection carries commands that move the vehicle.

    An emergency is none: it passes from anybody, in any state, and stands when its source is lost.
    """
    return connection.exchange.name == MESSAGE and commands.is_steering(connection.map.message)


def keeps_last_command(connection: bridge.Connection) -> bool:
    """Tells whether the last command stands when its source is lost, for a reason.

    What sets nothing in motion may stand: its definition says so, nobody has to decide it.
    """
    if connection.onSilence.name == "hold":
        return True
    defines_stop = connection.safeValue or stop_of_map(connection) is not None
    return not defines_stop and not connection.map.message.moves


def hold_reason(connection: bridge.Connection) -> str:
    """Returns the reason why the last command may stand; empty without one."""
    message = connection.map.message
    return connection.holdReason or ("" if message.moves else f"{message.name} moves nothing")


def stop_of_map(connection: bridge.Connection) -> bridge.Stop | None:
    """Returns the stop of the map for the direction of a connection."""
    return connection.map.stopRos if is_to_ros(connection) else connection.map.stopJaus


def has_stop(connection: bridge.Connection) -> bool:
    """Tells whether a connection sends a stop when its source is lost."""
    if connection.safeValue:
        return True
    return (
        carries_commands(connection)
        and not keeps_last_command(connection)
        and stop_of_map(connection) is not None
    )


def has_stops(owner: bridge.Bridge) -> bool:
    """Tells whether a bridge has commands that a guardian could stop."""
    connections = [
        connection
        for connection in owner.bridgeConnections
        if connection.map and connection.map.message
    ]
    goals = [action for action in owner.actionConnections if is_to_ros(action)]
    return bool(goals) or any(
        carries_commands(connection) and has_stop(connection) for connection in connections
    )


def silence_timeout(connection: bridge.Connection) -> float:
    """Returns the seconds of silence that count as a loss of the source; 0 is never."""
    if connection.silenceTimeout is not None:
        return float(connection.silenceTimeout)
    if not carries_commands(connection) or not has_stop(connection):
        return 0.0
    stop = stop_of_map(connection)
    return SILENCE_TIMEOUT if stop is None else float(stop.silenceTimeout)


def stop_assignments(connection: bridge.Connection) -> tuple[bridge.Assignment, ...]:
    """Returns the assignments of the stop or safe value of a connection.

    What its map fills without a source, with the clock and with constants that are no quantity,
    comes before the values of the stop itself, which may say otherwise.
    """
    stop = stop_of_map(connection)
    values: Iterable[bridge.ConstantAssignment] = connection.safeValue
    if not values and stop is not None:
        values = stop.values
    return with_constants(connection.map, values, to_ros=is_to_ros(connection))


def with_constants(
    attribute_map: bridge.AttributeMap, values: Iterable[bridge.ConstantAssignment], *, to_ros: bool
) -> tuple[bridge.Assignment, ...]:
    """Returns the values of a stop behind what the map fills without a source.

    Names of frames, kinds and masks say what a message means, in a stop too. A speed that a map
    holds constant would make its stop drive, so quantities are what the stop says, else zero.
    """
    stated_paths = {parse_path(path) for value in values for path in target_paths(value)}
    scope = outer_scope(attribute_map, to_ros=to_ros)
    constants = (
        assignment
        for assignment in (attribute_map.toRos if to_ros else attribute_map.toJaus)
        if isinstance(assignment, (bridge.ConstantAssignment, bridge.ClockAssignment))
        and not stated_paths & {parse_path(path) for path in target_paths(assignment)}
        and (
            _is_zero(assignment)
            or not any(map(_is_quantity, Placed(assignment, scope).target_attributes))
        )
    )
    return (*constants, *values)


def _is_zero(assignment: bridge.Assignment) -> bool:
    value = assignment.value if isinstance(assignment, bridge.ConstantAssignment) else ""
    return is_real(value) and not float(value)


def _is_quantity(attribute: Attribute) -> bool:
    return attribute.kind == NUMBER and (not attribute.integral or bool(attribute.units))


def stop_values(connection: bridge.Connection) -> list[str]:
    """Returns the values in the stop of a connection, each as `thrust = 0`; none for zeros."""
    stop = stop_of_map(connection)
    values = connection.safeValue or (stop.values if stop is not None else ())
    return [f"{value.target} = {value.value}" for value in values]


def stop_text(connection: bridge.Connection) -> str:
    """Returns the values that the stop of a connection sends, in words."""
    return ", ".join(stop_values(connection)) or "zeros"


def moving_values(connection: bridge.Connection) -> list[tuple[str, str]]:
    """Returns paths and values that the stop of a connection sends though they move a vehicle.

    They are rates (m/s, rad/s), accelerations, forces, torques and efforts that are not 0, those
    of brakes excepted; a value that a ROS type gives a member by default counts as well.
    """
    scope = outer_scope(connection.map, to_ros=is_to_ros(connection))
    values = _defaults(connection.map, scope) if scope.to_ros else {}
    for assignment in stop_assignments(connection):
        # What the clock gives is no number, and takes the place of a default.
        value = str(assignment.value) if isinstance(assignment, bridge.ConstantAssignment) else ""
        values.update(dict.fromkeys(target_paths(assignment), value))
    moving: list[tuple[str, str]] = []
    for path, value in values.items():
        if not (is_real(value) or value in NOT_FINITE) or float(value) == 0:
            continue
        target = attribute_at(scope.find_target(path))
        if isinstance(target, Attribute):
            units = target.units or _source_units(connection.map, scope, path)
            if _moves(target, units):
                moving.append((path, value))
    return moving


def _defaults(attribute_map: bridge.AttributeMap, scope: PathScope) -> dict[str, str]:
    """Returns the defaults of a ROS type for the targets that a map fills by default, by path."""
    return {
        path: str(getattr(target.field, "defaultValue", None) or "")
        for placed in _filling(attribute_map, scope)
        for path, target in placed.targets
        if isinstance(target, Attribute)
    }


def _source_units(attribute_map: bridge.AttributeMap, scope: PathScope, path: str) -> str:
    """Returns the unit of the source of a target, which is that of a target without its own."""
    filling = [
        filled
        for filled in _filling(attribute_map, scope)
        if path in target_paths(filled.assignment)
    ]
    sources = filling[-1].source_attributes if filling else ()
    return next((source.units for source in sources if source.units), "")


def _filling(
    attribute_map: bridge.AttributeMap, scope: PathScope
) -> Iterator[Placed[bridge.Assignment]]:
    assignments = attribute_map.toRos if scope.to_ros else attribute_map.toJaus
    # The lists of a stop are empty: nothing fills their elements.
    return (placed for placed in flattened(assignments, scope) if not placed.scope.is_nested)


_BRAKING = frozenset({"brake", "braking", "resistive"})


def _moves(target: Attribute, units: str) -> bool:
    label_words = {word.casefold() for word in words(target.label)}
    known_measure = measure(units)
    exponent_of_time = (
        dict(known_measure.unit.dimension).get("s", 0) if known_measure is not None else 0
    )
    # 1/s is that of rates; 1/s^2 is that of accelerations, forces and torques.
    is_motion = exponent_of_time in (-1, -2) or "effort" in label_words
    return target.kind == NUMBER and is_motion and not label_words & _BRAKING

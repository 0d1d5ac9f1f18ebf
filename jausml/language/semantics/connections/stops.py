"""Stops: what a connection sends when the source of a command is lost, or why nothing."""

from __future__ import annotations

import re
from collections.abc import Iterable
from difflib import SequenceMatcher

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.assignments.units import measure
from jausml.language.semantics.jaus import commands
from jausml.language.semantics.names import words
from jausml.language.semantics.paths.attributes import NUMBER, Attribute, is_real
from jausml.language.semantics.paths.scopes import (
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


TOOL_REASON = "it stands until the next one see that something stops the vehicle on its way"
"""What tools once wrote as a reason, without punctuation: nobody has decided anything."""

_ALIKE = 0.8
"""From which likeness on, of 1 for the same words, a text is taken for an edited copy of another.

A sentence of another cause that shares its form, such as that of a waypoint which SetTravelSpeed
stops, has 0.76; one word replaced leaves 0.93.
"""


def is_reason(text: str) -> bool:
    """Tells whether a text can be the reason of a person why a last command may stand.

    Args:
        text: The text. What tools have written is none, nor are some of its words, or nearly all;
            and one word such as `todo` gives no reason.
    """
    own, of_tool = re.findall(r"\w+", text.casefold()), TOOL_REASON.split()
    likeness = SequenceMatcher(None, own, of_tool, autojunk=False).ratio()
    return len({*own}) > 1 and not {*own} <= {*of_tool} and likeness < _ALIKE


def is_command(connection: bridge.Connection) -> bool:
    """Tells whether a connection carries commands, which set something in motion.

    An emergency is none: it passes from anybody, in any state, and stands when its source is lost.
    """
    return connection.exchange.name == "message" and commands.is_steering(connection.map.message)


def holds(connection: bridge.Connection) -> bool:
    """Tells whether the last command stands when its source is lost, for a reason.

    What sets nothing in motion may stand: its definition says so, nobody has to decide it.
    """
    if connection.onSilence.name == "hold":
        return True
    has_stop = connection.safeValue or stop_of_map(connection) is not None
    return not has_stop and not connection.map.message.moves


def hold_reason(connection: bridge.Connection) -> str:
    """Returns why the last command may stand; empty when nobody says it."""
    message = connection.map.message
    return connection.holdReason or ("" if message.moves else f"{message.name} moves nothing")


def stop_of_map(connection: bridge.Connection) -> bridge.Stop | None:
    """Returns the stop of the map for the direction of a connection."""
    used = connection.map
    return used.stopRos if connection.direction.name == "jausToRos" else used.stopJaus


def has_stop(connection: bridge.Connection) -> bool:
    """Tells whether a connection sends something when its source is lost."""
    if connection.safeValue:
        return True
    return is_command(connection) and not holds(connection) and stop_of_map(connection) is not None


def silence_timeout(connection: bridge.Connection) -> float:
    """Returns the seconds of silence that count as a loss of the source; 0 is never."""
    if connection.silenceTimeout is not None:
        return float(connection.silenceTimeout)
    if not is_command(connection) or not has_stop(connection):
        return 0.0
    stop = stop_of_map(connection)
    return SILENCE_TIMEOUT if stop is None else float(stop.silenceTimeout)


def stop_assignments(connection: bridge.Connection) -> tuple[bridge.Assignment, ...]:
    """Returns what fills the stop or safe value of a connection.

    What its map fills without a source, with the clock and with constants that are no quantity,
    comes before the values of the stop itself, which may say otherwise.
    """
    stop = stop_of_map(connection)
    values: Iterable[bridge.ConstantAssignment] = connection.safeValue
    if not values and stop is not None:
        values = stop.values
    to_ros = connection.direction.name == "jausToRos"
    return with_constants(connection.map, values, to_ros=to_ros)


def with_constants(
    used: bridge.AttributeMap, values: Iterable[bridge.ConstantAssignment], *, to_ros: bool
) -> tuple[bridge.Assignment, ...]:
    """Returns the values of a stop behind what the map fills without a source.

    Names of frames, kinds and masks say what a message means, in a stop too. A speed that a map
    holds constant would make its stop drive, so quantities are what the stop says, else zero.
    """
    said = {parse_path(path) for value in values for path in target_paths(value)}
    scope = outer_scope(used, to_ros=to_ros)
    constants = (
        assignment
        for assignment in (used.toRos if to_ros else used.toJaus)
        if isinstance(assignment, (bridge.ConstantAssignment, bridge.ClockAssignment))
        and not said & {parse_path(path) for path in target_paths(assignment)}
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


def stated(connection: bridge.Connection) -> list[str]:
    """Returns what the stop of a connection states, each as `thrust = 0`; none: it is zeros."""
    stop = stop_of_map(connection)
    values = connection.safeValue or (stop.values if stop is not None else ())
    return [f"{value.target} = {value.value}" for value in values]


def told(connection: bridge.Connection) -> str:
    """Returns what the stop of a connection sends, in words."""
    return ", ".join(stated(connection)) or "zeros"


def driving(connection: bridge.Connection) -> list[tuple[str, str]]:
    """Returns paths and values that the stop of a connection sends though they move a vehicle.

    They are rates (m/s, rad/s), accelerations, forces, torques and efforts that are not 0, those
    of brakes excepted; a value that a ROS type gives a member by default counts as well.
    """
    to_ros = connection.direction.name == "jausToRos"
    scope, found = outer_scope(connection.map, to_ros=to_ros), dict[str, str]()
    units = dict[str, str]()
    for placed in flattened(connection.map.toRos if to_ros else connection.map.toJaus, scope):
        known = next((one.units for one in placed.source_attributes if one.units), "")
        for path, target in () if placed.scope.is_nested else placed.targets:
            if isinstance(target, Attribute):
                units[path] = target.units or known
                default = getattr(target.field, "defaultValue", None)
                found[path] = str(default or "") if to_ros else ""
    for value in stop_assignments(connection):
        said = value.value if isinstance(value, bridge.ConstantAssignment) else ""
        found.update((path, str(said)) for path in target_paths(value))
    return [
        (path, value)
        for path, value in found.items()
        if is_real(value)
        and float(value)
        and isinstance(target := attribute_at(scope.find_target(path)), Attribute)
        and _moves(target, units.get(path, "") or target.units)
    ]


_BRAKING = frozenset({"brake", "braking", "resistive"})


def _moves(target: Attribute, units: str) -> bool:
    named = {word.casefold() for word in words(target.label)}
    known = measure(units)
    power = dict(known.unit.dimension).get("s", 0) if known is not None else 0
    is_motion = power in (-1, -2) or "effort" in named
    return target.kind == NUMBER and is_motion and not named & _BRAKING

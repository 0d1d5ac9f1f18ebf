"""What is told of a connection on request: its limits, its quality of service, its safe values."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.connections import stops
from jausml.language.semantics.paths.scopes import target_paths
from jausml.views.diagrams.views.context import number

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.metamodel.classes import ros


def qos(profile: ros.QoSProfile | None) -> str:
    """Returns a quality of service in words, empty for the default."""
    if profile is None:
        return ""
    depth = f" {profile.depth}" if profile.history.name == "keep_last" else ""
    words = [_words(profile.reliability.name), _words(profile.durability.name)]
    words.append(_words(profile.history.name) + depth)
    for name, seconds in (("deadline", profile.deadline), ("lifespan", profile.lifespan)):
        words += [f"{name} {number(seconds)} s"] if seconds else []
    if profile.leaseDuration:
        words.append(
            f"alive {_words(profile.liveliness.name)} in {number(profile.leaseDuration)} s"
        )
    return ", ".join(words)


def topics_qos(connection: bridge.Connection) -> str:
    """Returns the quality of service of the topics of a connection, of those that state one."""
    told = ((str(each.name or "?"), qos(each.qos)) for each in connection.topics)
    return "; ".join(f"{name}: {words}" for name, words in told if words)


def limits(connection: bridge.Connection) -> str:
    """Returns what keeps messages of a connection from passing, in words."""
    return ", ".join(_limits(connection))


def _limits(connection: bridge.Connection) -> Iterator[str]:
    if connection.rateCap:
        yield f"at most {number(connection.rateCap)} Hz are taken of one source"
    if connection.decimation > 1:
        yield f"one of {connection.decimation} passes"
    if connection.maxRate:
        yield f"at most {number(connection.maxRate)} Hz pass"
    if connection.ageLimit:
        yield f"none older than {number(connection.ageLimit)} s"


def when_lost(connection: bridge.Connection) -> str:
    """Returns what a connection does when its source is lost, in words; empty for nothing."""
    used = connection.map
    if used is None or used.message is None:
        return ""
    if not stops.has_stop(connection):
        if not stops.is_command(connection) or not stops.holds(connection):
            return ""
        return ": ".join(filter(None, ("the last command stands", stops.hold_reason(connection))))
    seconds = stops.silence_timeout(connection)
    values = ", ".join(_value(each) for each in stops.stop_assignments(connection))
    when = f"after {number(seconds)} s of silence" if seconds else "when control of it is lost"
    return f"{when}: {values or 'the defaults'}"


def _value(assignment: bridge.Assignment) -> str:
    what = assignment.value if isinstance(assignment, bridge.ConstantAssignment) else "clock"
    return f"{', '.join(target_paths(assignment))} = {what}"


def _words(literal: str) -> str:
    return literal.replace("_", " ")

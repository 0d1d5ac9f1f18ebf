"""Stops that a person has declared: in a connection of the model, or when the studio starts.

Nothing is made up: a stop without a time-out, or of which two connections say different things, is
none, and the reason is told.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.authoring.proposals.elements import AnswerError
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.connections import stops
from jausml.language.semantics.paths.scopes import target_paths
from jausml.live.messages.entries import by_name, parse_fields
from jausml.live.messages.text import sample

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.language.model import Model
    from jausml.live.messages import Catalogue, MessageEntry

WORDS = ("standby", "emergency")
"""What the stop of everything may be (AS5710, Management)."""

SHORTEST, LONGEST = 0.1, 60.0
"""Seconds that a time-out may have."""


@dataclass(frozen=True)
class DeclaredStop:
    """What ends a command that is sent again and again (`source`: who has declared it)."""

    message: str
    fields: dict[str, Any]
    timeout: float
    source: str


def told_stop(text: str, catalogue: Catalogue) -> DeclaredStop:
    """Returns the stop of a text `MESSAGE SECONDS FIELDS`.

    Raises:
        ValueError: It is none, or its fields are no such message.
    """
    name, _, rest = text.strip().partition(" ")
    seconds, _, fields = rest.strip().partition(" ")
    try:
        timeout = float(seconds)
    except ValueError:
        raise ValueError(f"{text!r} is no stop: MESSAGE SECONDS FIELDS") from None
    if not SHORTEST <= timeout <= LONGEST:
        raise ValueError(f"{seconds} s is not within {SHORTEST} s .. {LONGEST:g} s")
    entry = catalogue.message(name)
    completed_fields = entry.completed(parse_fields(fields.strip() or "{}"))
    entry.encode(completed_fields)
    return DeclaredStop(entry.name, completed_fields, timeout, "the command line")


class Stops:
    """The stops of one model and one start."""

    def __init__(self, model: Model | None, stated_stops: Iterable[DeclaredStop]) -> None:
        """Reads what is declared, once: what a page edits later changes no stop."""
        self._by_message = {stop.message: stop for stop in stated_stops}
        self._of_model: dict[tuple[str, str], list[DeclaredStop | str]] = {}
        for owner in () if model is None else model.instances(bridge.Bridge, library=False):
            for bridge_connection in owner.bridgeConnections:
                for target in _receivers(owner, bridge_connection):
                    declarations = self._of_model.setdefault(
                        (target, str(bridge_connection.map.message.name)), []
                    )
                    declarations.append(
                        _declared(bridge_connection, f"{owner.name}.{bridge_connection.name}")
                    )

    def of(self, target: str, entry: MessageEntry) -> DeclaredStop:
        """Returns the stop of a command to a component.

        Raises:
            AnswerError: Nobody has declared one, or the declarations contradict each other.
        """
        if entry.name in self._by_message:
            return self._by_message[entry.name]
        declarations = self._of_model.get((target, entry.name), [])
        declared = [stop for stop in declarations if isinstance(stop, DeclaredStop)]
        meanings = {(json.dumps(stop.fields, sort_keys=True), stop.timeout) for stop in declared}
        if len(meanings) == 1:
            return _completed(declared[0], entry)
        if meanings:
            names = ", ".join(stop.source for stop in declared)
            raise AnswerError(f"the stops of {names} are different; say one with --stop")
        why = next((reason for reason in declarations if isinstance(reason, str)), "")
        raise AnswerError(
            f"no stop of {entry.name} to {target} is declared"
            + (f" ({why})" if why else "")
            + "; a connection of the model does it, or --stop when the studio starts"
        )


def _receivers(owner: bridge.Bridge, connection: bridge.Connection) -> Iterator[str]:
    """Yields the JAUS ids of those who take the commands of a connection."""
    if connection.map is None or connection.map.message is None:
        return
    if not stops.carries_commands(connection):
        return
    takers = [owner] if connection.direction.name == "jausToRos" else connection.peers
    yield from (str(taker.address) for taker in takers if taker.address)


def _declared(connection: bridge.Connection, name: str) -> DeclaredStop | str:
    """Returns the stop of the JAUS message of a connection, or why there is none."""
    is_sent = connection.direction.name == "rosToJaus"
    if connection.onSilence.name == "hold":
        return f"{name} holds the last command"
    values: Iterable[bridge.ConstantAssignment] = connection.safeValue if is_sent else ()
    if not values:
        if connection.map.stopJaus is None:
            return f"{name} has no JAUS stop"
        values = connection.map.stopJaus.values
    if connection.silenceTimeout is None or not connection.silenceTimeout > 0:
        return f"{name} declares no silenceTimeout"
    assignments = stops.with_constants(connection.map, values, to_ros=False)
    fields: dict[str, Any] = {}
    for assignment in assignments:
        if not isinstance(assignment, bridge.ConstantAssignment):
            return f"the stop of {name} needs the clock"
        fields |= dict.fromkeys(target_paths(assignment), _value(str(assignment.value)))
    return DeclaredStop("", fields, float(connection.silenceTimeout), f"connection {name}")


def _value(text: str) -> Any:
    try:
        return float(text) if "." in text or "e" in text.lower() else int(text)
    except ValueError:
        return text


def _completed(stop: DeclaredStop, entry: MessageEntry) -> DeclaredStop:
    """Returns a stop of a model with all fields: those it leaves out are 0, as in a bridge."""
    fields = sample(entry.record)
    _put(fields, entry.completed(by_name(stop.fields)))
    entry.encode(fields)
    return DeclaredStop(entry.name, fields, stop.timeout, stop.source)


def _put(fields: dict[str, Any], values: dict[str, Any]) -> None:
    for name, value in values.items():
        if isinstance(value, dict) and isinstance(fields.get(name), dict):
            _put(fields[name], value)
        else:
            fields[name] = value

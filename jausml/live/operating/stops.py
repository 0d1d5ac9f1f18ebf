"""Stops of repeated commands, declared in a connection of the model or on the command line.

None is inferred: a stop without a time-out, or that two connections declare differently, is
refused with the reason.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

from jausml.live.messages import Catalogue, MessageEntry
from jausml.live.messages.field_paths import by_name, parse_fields
from jausml.live.messages.text import sample
from jausml.live.operating.knowledge import Declarations, DeclaredStop
from jausml.live.peers.operator import Operator
from jausml.live.peers.query_client import Refused
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import SetEmergency, Standby
from jausml.runtime.wire.message import Message

STOP_KINDS = ("standby", "emergency")  # of the stop of everything (AS5710, Management)

# Limits of a time-out in seconds; with shorter ones a busy moment would cause a stop.
SHORTEST, LONGEST = 0.3, 60.0

_EMERGENCY_STOP = 1  # code of the only emergency (AS5710, SetEmergency)

TRIES = 5  # sendings of a stop that is not acknowledged, each with the repetitions of JUDP


def stop_of(kind: str) -> Message:
    """Returns the message of a stop of everything (`kind`: one of `STOP_KINDS`)."""
    return SetEmergency(emergency_code=_EMERGENCY_STOP) if kind == "emergency" else Standby()


def deliver(
    operator: Operator,
    target: JausAddress,
    message: Message,
    is_wanted: Callable[[], bool],
    ended: Callable[[bool], None],
    tries: int = TRIES,
) -> None:
    """Sends a stop until it is acknowledged, no longer wanted, or was sent `tries` times.

    Args:
        ended: Is called at the end with whether it was acknowledged.
    """

    def arrived(is_acknowledged: bool) -> None:  # noqa: FBT001
        if is_acknowledged or tries == 1 or not is_wanted():
            ended(is_acknowledged)
        else:
            deliver(operator, target, message, is_wanted, ended, tries - 1)

    operator.deliver(target, message, arrived)


def parse_stop(text: str, catalogue: Catalogue) -> DeclaredStop:
    """Returns the stop in a text `MESSAGE SECONDS FIELDS`.

    Raises:
        ValueError: The text has another form, the time-out is out of range, or the message is
            unknown or does not have such fields.
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
    """The stops at the start of the unit: later edits of the model do not change them."""

    def __init__(
        self, of_model: Mapping[tuple[str, str], Declarations], stops: Iterable[DeclaredStop]
    ) -> None:
        """Takes the stops of the model, and those of the command line, which come first."""
        self._by_message = {stop.message: stop for stop in stops}
        self._of_model = of_model

    def of(self, target: str, entry: MessageEntry) -> DeclaredStop:
        """Returns the stop of a command to a component.

        Raises:
            Refused: Nobody has declared one, or the declarations contradict each other.
        """
        if entry.name in self._by_message:
            return self._by_message[entry.name]
        declarations = self._of_model.get((target, entry.name), ())
        declared = [stop for stop in declarations if isinstance(stop, DeclaredStop)]
        meanings = {(json.dumps(stop.fields, sort_keys=True), stop.timeout) for stop in declared}
        if len(meanings) == 1:
            return _completed(declared[0], entry)
        if meanings:
            names = ", ".join(stop.source for stop in declared)
            raise Refused(f"the stops of {names} are different; say one with --stop")
        why = next((reason for reason in declarations if isinstance(reason, str)), "")
        raise Refused(
            f"no stop of {entry.name} to {target} was declared at the start"
            + (f" ({why})" if why else "")
            + "; a connection of the model does it, or --stop"
        )


def _completed(stop: DeclaredStop, entry: MessageEntry) -> DeclaredStop:
    """Returns a stop of a model with all fields of its message: missing ones are 0, as in a bridge.

    Raises:
        Refused: The time-out is too short.
    """
    if stop.timeout < SHORTEST:
        raise Refused(f"{stop.timeout:g} s of {stop.source} is shorter than {SHORTEST} s")
    fields = sample(entry.record)
    _put(fields, entry.completed(by_name(stop.fields)))
    entry.encode(fields)
    return replace(stop, message=entry.name, fields=fields)


def _put(fields: dict[str, Any], values: dict[str, Any]) -> None:
    for name, value in values.items():
        if isinstance(value, dict) and isinstance(fields.get(name), dict):
            _put(fields[name], value)
        else:
            fields[name] = value

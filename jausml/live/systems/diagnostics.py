"""Statuses of `/diagnostics`, and what bridges say in them (`bridge/connections/reporting.py`)."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.live.systems.state import ConnectionState, Level

if TYPE_CHECKING:
    from collections.abc import Iterable

_LEVELS = (Level.OK, Level.WARNING, Level.ERROR, Level.STALE)
_DECLARED = "declared rate (Hz)"
_OF_A_BRIDGE = (
    "jaus greetings",
    "jaus id",
    "jaus socket",
    "jaus state",
    "jaus traffic",
    "simulated time",
)
_LATENCY = re.compile(r"((?:source to bridge|in the bridge) (?:p50|p99|max)) \(us\)")
_OF_A_PEER = "account of "
_LOSSES = (
    "lost in queue",
    "lost on the way",
    "lost on the way, at most",
    "missed",
    "out of order",
    "too old",
)
_JAUS_ID = re.compile(r"\d{1,5}\.\d{1,3}\.\d{1,3}")
_COUNT = re.compile(r"\d{1,18}")
_PEERS = ("peer", "search")
_OF_A_CONNECTION = {_DECLARED, "translation"}

MOST_VALUES = 256
"""Values of one status that are kept."""

LONGEST_TEXT = 500
"""Characters of one text that are kept."""


@dataclass(frozen=True, slots=True)
class DiagnosticStatus:
    """A `diagnostic_msgs/msg/DiagnosticStatus`.

    Attributes:
        level: 0 OK, 1 WARN, 2 ERROR, 3 STALE.
    """

    level: int
    name: str
    message: str = ""
    hardware_id: str = ""
    values: tuple[tuple[str, str], ...] = ()


def connection_of(status: DiagnosticStatus, now: float) -> ConnectionState | None:
    """Returns what a status tells of a connection or of a bridge; None when it is of another maker.

    Whatever a value cannot be read as is left out; as text it is among the values all the same.
    """
    bridge, colon, name = status.name.rpartition(": ")
    values = tuple((cut(key), cut(value)) for key, value in status.values[:MOST_VALUES])
    by_name = dict(values)
    concerns_bridge = name in _OF_A_BRIDGE or name.startswith(_OF_A_PEER)
    peers = {key: value for key, value in values if key.partition(" ")[0] in _PEERS}
    is_known = colon and (concerns_bridge or peers or not _OF_A_CONNECTION.isdisjoint(by_name))
    if not is_known or not _JAUS_ID.fullmatch(status.hardware_id):
        return None
    known = 0 <= status.level < len(_LEVELS)
    return ConnectionState(
        bridge=cut(bridge),
        name=cut(name),
        jaus_id=status.hardware_id,
        level=_LEVELS[status.level] if known else Level.ERROR,
        phase=by_name.get("state", "") if not concerns_bridge else "",
        reason=cut(status.message),
        rate=number(by_name.get("rate (Hz)", "")),
        declared_rate=number(by_name.get(_DECLARED, "")) or None,
        age=number(by_name.get("age (s)", "")),
        told=now,
        drops=_drops(values),
        latency=_latency(values),
        peers=peers,
        values=values,
        concerns_bridge=concerns_bridge,
    )


def number(text: str) -> float | None:
    """Returns the number that a text is, None when it is none or not finite."""
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def cut(text: str) -> str:
    """Returns a text that is not longer than what is kept."""
    return text if len(text) <= LONGEST_TEXT else text[: LONGEST_TEXT - 1] + "…"


def _drops(values: Iterable[tuple[str, str]]) -> dict[str, int]:
    found = {}
    for key, value in values:
        is_loss = key.startswith("dropped") or key in _LOSSES
        if is_loss and _COUNT.fullmatch(value) and int(value):
            found[key.removeprefix("dropped: ")] = int(value)
    return found


def _latency(values: Iterable[tuple[str, str]]) -> dict[str, float]:
    found = {}
    for key, value in values:
        match, figure = _LATENCY.fullmatch(key), number(value)
        if match is not None and figure is not None:
            found[match[1]] = figure
    return found

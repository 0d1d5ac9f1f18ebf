"""What is checked of a system: a product for each connection with commands and each machine."""

from __future__ import annotations

from dataclasses import dataclass
from math import gcd
from typing import TYPE_CHECKING

from jausml.language.semantics.connections import stops
from jausml.language.semantics.jaus.commands import guard_of_receivers
from jausml.language.semantics.jaus.core_services import CORE
from jausml.language.semantics.jaus.services import service_versions
from jausml.model_checking.connection import CommandPassage
from jausml.model_checking.core_services import CoreServices
from jausml.model_checking.obeying import ObeyingProduct

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.metamodel.classes import bridge, jaus, system
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.model_checking.properties import CheckedProduct

MOST_TICKS = 60
"""Ticks of the longest time-out; shorter ones are rounded up then."""

_VERSION_1_1 = (1, 1)
_TAKES_OVER = "an operator of more authority"
_ANYBODY = "a client"


@dataclass(frozen=True)
class Subject:
    """Something that is checked by itself.

    Attributes:
        element: What it is about in the model, at which findings point.
        tick: Seconds of one step of time.
        held: Why the last command may stand when its source is lost; empty where a stop is sent.
    """

    name: str
    element: EObject
    product: CheckedProduct
    tick: float
    held: str = ""


def subjects_of(system_: system.System, demanded: float = 0.0) -> Iterator[Subject]:
    """Yields what is checked of a system.

    Args:
        demanded: Seconds in which each stop is demanded; 0 for what the model says of each.
    """
    for owner in system_.bridges:
        for connection in () if owner.external else owner.bridgeConnections:
            if stops.is_command(connection) and connection.direction.name == "jausToRos":
                yield _obeying(system_, owner, connection, demanded)


def _obeying(
    system_: system.System, owner: bridge.Bridge, connection: bridge.Connection, demanded: float
) -> Subject:
    clock = _Clock([stops.silence_timeout(connection), float(owner.controlTimeout), demanded])
    peers = [str(each.name) for each in connection.peers]
    client = peers[0] if peers else _ANYBODY
    services = core_services_of(owner, clock, _authorities(owner, connection, client))
    guard = guard_of_receivers(connection.map.message, [owner], None)
    has_stop = stops.has_stop(connection)
    passage = CommandPassage(
        guard, clock.ticks(stops.silence_timeout(connection)), peers=peers or None
    )
    product = ObeyingProduct(
        str(owner.name),
        str(connection.map.message.name),
        services,
        passage,
        (client, _TAKES_OVER),
        has_stop,
        clock.ticks(demanded),
    )
    held = "" if has_stop else stops.hold_reason(connection)
    return Subject(f"{owner.name}.{connection.name}", connection, product, clock.tick, held)


def _authorities(
    owner: bridge.Bridge, connection: bridge.Connection, client: str
) -> dict[str, int]:
    stated = [int(each.authority) for each in connection.peers if owner in each.controls]
    own = max(stated[:1] + [int(owner.defaultAuthority)]) if not stated else stated[0]
    return {client: own, _TAKES_OVER: own + 1}


def core_services_of(
    component: jaus.Component, clock: _Clock, authorities: dict[str, int]
) -> CoreServices:
    """Returns the core services of a component as the runtime runs them."""
    version = service_versions(component).get(f"{CORE}Management", _VERSION_1_1)
    return CoreServices(
        authorities,
        int(component.defaultAuthority),
        clock.ticks(float(component.controlTimeout)),
        is_1_0=version < _VERSION_1_1,
    )


class _Clock:
    """Steps of time in which the time-outs of a product are whole numbers."""

    def __init__(self, seconds: list[float]) -> None:
        times = [round(each * 1000) for each in seconds if each > 0] or [1000]
        step = gcd(*times)
        if max(times) > step * MOST_TICKS:
            step = -(-max(times) // MOST_TICKS)
        self.tick = step / 1000

    def ticks(self, seconds: float) -> int:
        """Returns how many steps a time-out takes; 0 for one that never comes."""
        step = round(self.tick * 1000)
        return -(-round(seconds * 1000) // step) if seconds > 0 else 0

"""Subjects of checks in a system: a product for each connection with commands and each machine."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import gcd

from jausml.language.metamodel.classes import bridge, jaus, system
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.semantics.connections import stops
from jausml.language.semantics.connections.calls import driver_messages
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.commands import Guard, guard_of, guard_of_receivers
from jausml.language.semantics.jaus.core_services import CORE, SERVED_BY_RUNTIME, standard_services
from jausml.language.semantics.jaus.inheritance import lineage, with_inherited
from jausml.language.semantics.jaus.inherited_machines import Machine, machines_of
from jausml.language.semantics.jaus.services import find_same, provided_services, service_versions
from jausml.model_checking.bridge_products import CommandingProduct, ObeyingProduct
from jausml.model_checking.runtime_machines import CommandConnection, CoreServices
from jausml.model_checking.search import Product
from jausml.model_checking.service_machine import MachineProduct

MOST_TICKS = 60  # ticks of the longest time-out; shorter ones are rounded up then

_VERSION_1_1 = (1, 1)
_TAKES_OVER = "an operator of more authority"
_ANYBODY = "a client"
_GREATEST_AUTHORITY = 255  # of the byte that RequestControl has for it
_LAPSE = 5.0  # seconds after which control of a component lapses that says nothing of it
RENEWALS = 4  # renewals of control in the time in which it lapses (`controlled_target.py`)
# Greatest seconds after which control counts as lost for a bridge (`controlled_target.py`).
_PATIENCE = 4.0


@dataclass(frozen=True)
class Subject:
    """A part of a system that is checked separately.

    Attributes:
        element: Its element in the model, for the place of findings.
        tick: Seconds of one step of time.
        held: Why the last command may stay when its source is lost; empty if a stop is sent.
        stop: The contents of that stop, in words.
    """

    name: str
    element: EObject
    product: Product
    tick: float
    held: str = ""
    stop: str = ""


def subjects_of(system_: system.System, demanded: float = 0.0) -> Iterator[Subject]:
    """Yields the subjects of a system."""
    for owner in system_.bridges:
        for connection in () if owner.external else owner.bridgeConnections:
            if not stops.carries_commands(connection):
                continue
            if is_to_ros(connection):
                yield _obeying_messages(owner, connection, demanded)
            else:
                for peer in connection.peers or (None,):
                    yield _commanding(owner, connection, peer, demanded)
        for action in () if owner.external else owner.actionConnections:
            driver = driver_messages(action.driver)
            if driver is not None and is_to_ros(action):
                # A lost control cancels the goal, and a list ends by itself only.
                yield _obeying(owner, action, driver.execute, demanded)

    for component in system_.components:
        if not component.external and not isinstance(component, bridge.Bridge):
            yield from machine_subjects(component, demanded)


def machine_subjects(component: jaus.Component, demanded: float = 0.0) -> Iterator[Subject]:
    """Yields the product of each machine that is generated for a component."""
    clock = _Clock([float(component.controlTimeout), demanded])
    authority = int(component.defaultAuthority)
    core = core_services_of(component, clock, _with_rival(_ANYBODY, authority))
    provided = provided_services(component)
    yield from _behaving(str(component.name), component.provides, provided, (core, clock), demanded)


def service_subjects(service: jaus.Service) -> Iterator[Subject]:
    """Yields the product of each machine of a service, in a component of defaults."""
    clock = _Clock([_LAPSE])
    core = CoreServices({_ANYBODY: 0, _TAKES_OVER: 1}, timeout=clock.ticks(_LAPSE))
    provided = with_inherited([service, *standard_services()])
    yield from _behaving(str(service.name), [service], provided, (core, clock))


def _behaving(
    name: str,
    provides: Iterable[jaus.Service],
    provided: Sequence[jaus.Service],
    timed: tuple[CoreServices, _Clock],
    demanded: float = 0.0,
) -> Iterator[Subject]:
    core, clock = timed
    services = [
        service for service in with_inherited(provides) if service.urn not in SERVED_BY_RUNTIME
    ]
    for machine in machines_of(services[::-1]):
        product = MachineProduct(
            name,
            machine,
            core,
            (_ANYBODY, _TAKES_OVER),
            _obeyed(provided, machine, services),
            clock.ticks(demanded),
        )
        title = f"{name}: {machine.name} of {machine.service_name}"
        held = "" if machine.extends_core else "its states are left to the code of the component"
        yield Subject(title, machine.elements[-1], product, clock.tick, held)


def _obeyed(
    provided: Sequence[jaus.Service], machine: Machine, services: Sequence[jaus.Service]
) -> dict[str, Guard]:
    """Returns the guards that a component checks before its machine, by message name.

    Where the core services are extended, the guards of the machine say who is obeyed.
    """
    access = f"{CORE}AccessControl"
    guards_by_message: dict[str, Guard] = {}
    for service in services:
        extends = machine.extends_core and any(
            ancestor.urn == access for ancestor in lineage(service)
        )
        for message in service.inputs:
            guard = "ANY" if extends else guard_of(message, service, provided)
            guards_by_message.setdefault(str(message.name), guard)
    return guards_by_message


def _commanding(
    owner: bridge.Bridge,
    connection: bridge.Connection,
    peer: jaus.Component | None,
    demanded: float,
) -> Subject:
    """Returns the product with one peer; a searched one has the defaults of components."""
    silence, watch = stops.silence_timeout(connection), _watch_of(peer, connection)
    lapse = _LAPSE if peer is None else float(peer.controlTimeout)
    # Control is renewed several times before it lapses, which bounds the steps.
    clock = _Clock([silence, watch, lapse / RENEWALS, demanded, lapse])
    message = connection.map.message
    guard = guard_of_receivers(message, connection.peers, connection.search)
    name = "a peer that is found" if peer is None else str(peer.name)
    authorities = _with_rival(str(owner.name), int(owner.authority))
    if peer is None:
        services = CoreServices(authorities, timeout=clock.ticks(lapse))
    else:
        services = core_services_of(peer, clock, authorities)
    has_stop = stops.has_stop(connection)
    product = CommandingProduct(
        str(owner.name),
        name,
        str(message.name),
        services,
        core_services_of(owner, clock, {}),
        CommandConnection(
            guard if connection.control else "ANY", clock.ticks(silence), to_ros=False
        ),
        clock.ticks(min(lapse or _PATIENCE, _PATIENCE)),
        clock.ticks(watch),
        _TAKES_OVER,
        has_stop,
        clock.ticks(demanded),
    )
    held = "" if has_stop else stops.hold_reason(connection)
    subject_name = f"{owner.name}.{connection.name} to {name}"
    stop = stops.stop_text(connection) if has_stop else ""
    return Subject(subject_name, connection, product, clock.tick, held, stop)


def _watch_of(peer: jaus.Component | None, connection: bridge.Connection) -> float:
    """Returns the silence after which a peer stops by itself, by the model; 0 for never."""
    if not isinstance(peer, bridge.Bridge):
        return 0.0
    taken = (
        stops.silence_timeout(bridge_connection)
        for bridge_connection in peer.bridgeConnections
        if is_to_ros(bridge_connection)
        and stops.has_stop(bridge_connection)
        and find_same(bridge_connection.map.message, [connection.map.message]) is not None
    )
    return next((timeout for timeout in taken if timeout), 0.0)


def _obeying_messages(
    owner: bridge.Bridge, connection: bridge.Connection, demanded: float
) -> Subject:
    held = None if stops.has_stop(connection) else stops.hold_reason(connection)
    silence = stops.silence_timeout(connection)
    return _obeying(owner, connection, connection.map.message, demanded, silence, held)


def _obeying(
    owner: bridge.Bridge,
    connection: bridge.Connection | bridge.RosActionConnection,
    message: jaus.MessageDef,
    demanded: float,
    silence: float = 0.0,
    held: str | None = None,
) -> Subject:
    """Returns the product of the receiver of a command; `held`: its reason for no stop, or None."""
    clock = _Clock([silence, float(owner.controlTimeout), demanded])
    peers = [str(peer.name) for peer in connection.peers]
    client = peers[0] if peers else _ANYBODY
    services = core_services_of(owner, clock, _authorities(owner, connection, client))
    guard = guard_of_receivers(message, [owner], None)
    connection_state = CommandConnection(guard, clock.ticks(silence), peers=peers or None)
    product = ObeyingProduct(
        str(owner.name),
        str(message.name),
        services,
        connection_state,
        (client, _TAKES_OVER),
        held is None,
        clock.ticks(demanded),
    )
    name = f"{owner.name}.{connection.name}"
    stop = ""
    if isinstance(connection, bridge.Connection) and held is None:
        stop = stops.stop_text(connection)
    return Subject(name, connection, product, clock.tick, held or "", stop)


def _authorities(
    owner: bridge.Bridge, connection: bridge.Connection | bridge.RosActionConnection, client: str
) -> dict[str, int]:
    stated = [int(peer.authority) for peer in connection.peers if owner in peer.controls]
    own = stated[0] if stated else int(owner.defaultAuthority)
    return _with_rival(client, own)


def _with_rival(client: str, authority: int) -> dict[str, int]:
    """Returns the authorities of a client and of who takes over, if anybody can have more."""
    return {client: authority, _TAKES_OVER: min(authority + 1, _GREATEST_AUTHORITY)}


def core_services_of(
    component: jaus.Component, clock: _Clock, authorities: dict[str, int]
) -> CoreServices:
    """Returns the core services of a component, as in the runtime."""
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
        times = [_milliseconds(duration) for duration in seconds if duration > 0] or [1000]
        step = gcd(*times)
        # Shorter steps would only add states.
        if max(times) > step * MOST_TICKS:
            step = -(-max(times) // MOST_TICKS)
        self.tick = step / 1000

    def ticks(self, seconds: float) -> int:
        """Returns the steps of a time-out; 0 for never."""
        step = _milliseconds(self.tick)
        # Rounded up: no time-out may come earlier than that of the runtime.
        return -(-_milliseconds(seconds) // step) if seconds > 0 else 0


def _milliseconds(seconds: float) -> int:
    """Returns a time that is not 0, which would be never."""
    return max(1, round(seconds * 1000))

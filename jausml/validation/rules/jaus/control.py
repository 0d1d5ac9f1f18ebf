"""Rules about who talks to whom: control that nobody grants, components that ask themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.metamodel.classes import bridge, jaus
from jausml.model.diagnostics import Severity
from jausml.semantics import calls
from jausml.semantics.commands import is_command
from jausml.validation.rule import Finding, Note, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.metamodel.classes.ecore import EObject
    from jausml.semantics.subject import Subject


@rule("JML364", Severity.ERROR, "control that is never granted")
def authority_suffices(subject: Subject) -> Iterator[Finding]:
    """A component that controls another one has at least the authority that the other one requires.

    With less, each RequestControl is rejected for insufficient authority (AS5710, AccessControl),
    and no command passes.

    Bad: `controls="vehicle" authority="100"` where vehicle has `defaultAuthority="200"`

    Good: the same with `authority="200"`
    """
    for component in subject.instances(jaus.Component):
        for place, feature, target in _controlled(component):
            if not subject.is_intact(target) or component.authority >= target.defaultAuthority:
                continue
            message = f"'{target.name}' obeys authority {target.defaultAuthority} and above,"
            message += f" '{component.name}' has {component.authority}"
            note = Note(target, f"'{target.name}'", "defaultAuthority")
            yield Finding(place, message, feature, "raise its authority", (note,))


@rule("JML365", Severity.ERROR, "component that is its own peer")
def no_own_peers(subject: Subject) -> Iterator[Finding]:
    """The peers of a connection are other components than the one that has it.

    Bad: `peers="front"` in a connection of the bridge front

    Good: `peers="vehicle"`
    """
    needs = ("name", "peers")
    found: list[bridge.Connection | bridge.RosServiceConnection | bridge.RosActionConnection] = []
    found += subject.instances(bridge.Connection, needs=needs)
    found += subject.instances(bridge.RosServiceConnection, needs=needs)
    found += subject.instances(bridge.RosActionConnection, needs=needs)
    for connection in found:
        owner = connection.eContainer()
        if owner is not None and any(peer is owner for peer in connection.peers):
            message = f"'{connection.name}' has its own bridge '{owner.name}' as a peer"
            yield Finding(connection, message, "peers")
    for asked in subject.instances(jaus.ServiceConnection, needs=("name", "provider")):
        component = asked.eContainer()
        if component is not None and asked.provider is component:
            message = f"'{asked.name}' asks '{component.name}', which has it"
            yield Finding(asked, message, "provider")


def _controlled(component: jaus.Component) -> Iterator[tuple[EObject, str, jaus.Component]]:
    """Yields whom a component controls, with the element and the feature that say so."""
    for target in component.controls:
        yield component, "controls", target
    if not isinstance(component, bridge.Bridge):
        return
    for connection in component.bridgeConnections:
        sends = connection.direction.name == "rosToJaus" and connection.exchange.name == "message"
        message = connection.map.message if connection.map is not None else None
        if sends and connection.control and message is not None and is_command(message):
            for peer in connection.peers:
                yield connection, "peers", peer
    yield from _controlled_for_clients(component)


def _controlled_for_clients(owner: bridge.Bridge) -> Iterator[tuple[EObject, str, jaus.Component]]:
    """Yields whom a bridge controls for the clients of its ROS services and actions."""
    for call in owner.serviceConnections:
        asking = calls.asking(call)
        if calls.serves(call) and call.control and asking is not None and is_command(asking):
            for peer in call.peers:
                yield call, "peers", peer
    for action in owner.actionConnections:
        if action.direction.name == "rosToJaus" and action.control:
            for peer in action.peers:
                yield action, "peers", peer

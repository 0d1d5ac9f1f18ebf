"""Rules about who talks to whom: control that nobody grants, components that ask themselves."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.metamodel.filling import is_set
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections import calls
from jausml.language.semantics.jaus.commands import is_command
from jausml.language.validation.rule import Finding, Note, rule

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import TypeAlias

    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.semantics.subject import Subject

    _Connection: TypeAlias = (
        bridge.Connection | bridge.RosServiceConnection | bridge.RosActionConnection
    )


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


@rule("JML366", Severity.INFO, "control that lapses without a word")
def lapse_is_decided(subject: Subject) -> Iterator[Finding]:
    """A bridge that takes commands of clients outside of the model says when control lapses.

    Without a `controlTimeout`, control lapses 5 s after it was requested last, and what is driven
    stops. Clients of v1.0 of the core services, and many of others, request control once and never
    again: they lose the vehicle in mid-drive. 0 keeps control until it is released or preempted;
    then nothing notices a client that is gone but the silence of its commands. Components of jausml
    renew control: where the peers are of the model and not external, nothing is to be decided.

    Bad: a connection with commands of an external operator, or of anybody, without `controlTimeout`

    Good: `controlTimeout="0"` for a client that asks once, `controlTimeout="5"` for one that renews
    """
    for owner in subject.instances(bridge.Bridge):
        table = subject.model.metamodels.class_of(owner).features["controlTimeout"]
        if is_set(owner, table):
            continue
        connections: tuple[_Connection, ...] = (
            *owner.bridgeConnections,
            *owner.serviceConnections,
            *owner.actionConnections,
        )
        for connection in connections:
            if not _takes_commands(subject, connection):
                continue
            known = list(connection.peers)
            outside = [each for each in known if each.external]
            if outside or not known:
                client = f"'{outside[0].name}'" if outside else "its client"
                message = f"control of '{owner.name}' lapses {owner.controlTimeout} s after "
                message += f"{client} has requested it last"
                hint = "state controlTimeout: 0 for clients that request control once"
                note = Note(connection, f"'{connection.name}' takes its commands", "peers")
                yield Finding(owner, message, hint=hint, related=(note,))
                break


def _takes_commands(subject: Subject, connection: _Connection) -> bool:
    """Tells whether components may command the ROS side by a connection."""
    if connection.direction.name != "jausToRos":
        return False
    if isinstance(connection, bridge.RosActionConnection):
        return True
    if isinstance(connection, bridge.RosServiceConnection):
        message = calls.asking(connection)
    else:
        used = connection.map
        message = (
            used.message if used is not None and connection.exchange.name == "message" else None
        )
    return message is not None and subject.is_intact(message) and is_command(message)


@rule("JML368", Severity.INFO, "controllers of one authority")
def authorities_differ(subject: Subject) -> Iterator[Finding]:
    """Of several controllers of a component, one has more authority than the other.

    A component that is controlled obeys nobody else but who has more authority (AS5710,
    AccessControl, RequestControl): between equals, whoever asked first keeps control until it is
    released, and the other one is told that it is not available.

    Bad: two components with `controls="vehicle"`

    Good: `authority="200"` at the one that may take over
    """
    first: dict[tuple[jaus.Component, int], tuple[jaus.Component, EObject]] = {}
    told: set[tuple[jaus.Component, jaus.Component]] = set()
    for component in subject.instances(jaus.Component):
        for place, feature, target in _controlled(component):
            other, note = first.setdefault((target, component.authority), (component, place))
            if other is component or (component, target) in told:
                continue
            told.add((component, target))
            message = f"'{component.name}' and '{other.name}' control '{target.name}' with one"
            message += f" authority, {component.authority}: whoever asks first keeps it"
            hint = "raise the authority of the one that may take over"
            yield Finding(place, message, feature, hint, (Note(note, f"'{other.name}'"),))


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

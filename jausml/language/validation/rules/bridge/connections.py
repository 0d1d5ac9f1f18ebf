"""Rules about the connections of bridges: services, queries, rates, loops."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.connections.exchanges import FEATURES, possible_exchanges
from jausml.language.semantics.connections.limits import LEAST_RATE
from jausml.language.semantics.connections.topics import Flow, find_loops, flow_of
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus import fields, services
from jausml.language.semantics.jaus.commands import is_steering
from jausml.language.semantics.paths.scopes import is_sound
from jausml.language.semantics.subject import Subject
from jausml.language.validation.findings import (
    missing_query,
    provider_name,
    time_findings,
    uncontrollable,
    unprovided,
)
from jausml.language.validation.rule import Finding, Note, rule
from jausml.language.validation.rules.jaus.components import rate_finding

_ENDS = ("name", "map", "direction", "exchange", "peers", "search", "query", "control")
_TIMES = ("name", "direction", "exchange", "rate")


def _is_owned(subject: Subject, connection: bridge.Connection) -> bool:
    return is_sound(subject, connection) and connection.eContainer() is not None


_of_connections = partial(rule, kinds=bridge.Connection, needs=_ENDS, condition=_is_owned)


@_of_connections("JML421", "map without assignments for the direction", is_decision=True)
def direction_assigned(subject: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """The map of a connection has assignments for the direction of the connection.

    Without them every message crosses the bridge empty.

    Bad: a connection with `direction="rosToJaus"` and a map that has `toRos` alone

    Good: the same map with `toJaus`
    """
    map_ = connection.map
    to_ros = is_to_ros(connection)
    feature = "toRos" if to_ros else "toJaus"
    targets = map_.type.fields if to_ros else fields.attributes(map_.message)
    if targets and not getattr(map_, feature) and subject.is_intact(map_):
        note = Note(map_, f"map '{map_.name}'")
        message = f"map '{map_.name}' has no {feature} assignments, which"
        message += f" {connection.direction.name} needs"
        hint = _other_ways(subject, connection)
        yield Finding(connection, message, "map", hint, (note,))


@_of_connections("JML422", "no service for the message")
def message_provided(subject: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A service at the right end of a connection has the message of its map.

    - JAUS to ROS by events or queries: each peer provides a service that sends the report.
    - JAUS to ROS by messages: the bridge provides a service that takes the message, or each peer
      provides one that sends it.
    - ROS to JAUS by events or queries: the bridge provides a service that sends the report.
    - ROS to JAUS by messages: each peer provides a service that takes the message.

    Inherited services count, and so does the same message (code and layout) in another service.

    Bad: `direction="rosToJaus" peers="sensor"` with the map of SetWrenchEffort, where sensor does
    not provide PrimitiveDriver

    Good: the same with a peer that provides PrimitiveDriver
    """
    owner, peers = connection.eContainer(), services.peers_of(connection)
    if owner is not None and all(
        services.is_known(subject, component) for component in (owner, *peers)
    ):
        for finding in _service_findings(connection, owner, peers):
            hints = filter(None, (finding.hint, _other_ways(subject, connection)))
            yield replace(finding, hint=", or ".join(hints))


@_of_connections("JML423", "connection without a peer")
def peers_named(subject: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A connection that asks for reports or sends messages names its peers, or searches for them.

    Without peers, a bridge accepts messages from every sender, and reports to every component that
    asks.

    Bad: `exchange="periodicEvent"` without `peers`

    Good: `exchange="periodicEvent" peers="vehicle"`
    """
    by_message = connection.exchange.name == "message"
    if services.peers_of(connection) or by_message is is_to_ros(connection):
        return
    if not services.is_known(subject, connection.eContainer()):
        return  # the way that a text leaves open follows from the services of the bridge
    purpose = "to send it to" if by_message else "to ask for it"
    message = f"'{connection.name}' carries {connection.map.message.name}"
    hints = "" if by_message else _serving(connection), _other_ways(subject, connection)
    hint = ", or ".join(filter(None, ("name peers or search for them", *hints)))
    yield Finding(connection, f"{message}, but names no peer {purpose}", "exchange", hint)


@_of_connections("JML424", "connection of a bridge without a query")
def query_known(subject: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A report that crosses by events or queries is asked for by a query that its sender takes.

    Without `query` it is found by name: QueryX for ReportX, or X.

    Bad: `exchange="periodicEvent"` with a message named Odometry and no `query`

    Good: the same with `query` set to the message that asks for it
    """
    if connection.exchange.name == "message":
        return
    if connection.query is not None and not subject.is_intact(connection.query):
        return
    message = connection.map.message
    senders = services.peers_of(connection) if is_to_ros(connection) else [connection.eContainer()]
    for sender in senders:
        if sender is None or not services.is_known(subject, sender):
            continue
        if services.find_output(message, sender) is None:
            continue
        if services.find_query(connection, sender) is None:
            yield missing_query(connection, message, sender)
            break


@rule(
    "JML425", "rate of a bridge's connection out of range", kinds=bridge.Connection, needs=("name",)
)
def rate_range(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """The rate of periodic events and queries is 0.02 to 1092 per second (AS5710).

    A rate of 0, the default, means the frequency of the bridge, which is then not 0. A time is 0 to
    3600 seconds.

    Bad: `exchange="periodicEvent" rate="2000"`

    Good: `exchange="periodicEvent" rate="25.0"`
    """
    yield from time_findings(connection, "silenceTimeout")


@rate_range.also(bridge.Stop)
def _rate_range_stop(_: Subject, stop: bridge.Stop) -> Iterator[Finding]:
    yield from time_findings(stop, "silenceTimeout")


@rate_range.also(bridge.Connection, needs=_TIMES)
def _rate_range_connection(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    asks = connection.exchange.name == "query" and is_to_ros(connection)
    is_timed = connection.exchange.name == "periodicEvent" or asks
    owner = connection.eContainer()
    if is_timed and connection.rate != 0:
        yield from rate_finding(connection)
    elif is_timed and owner is not None and 0 < owner.frequency < LEAST_RATE:
        message = f"frequency {owner.frequency:g} of '{owner.name}', the rate of"
        message += f" '{connection.name}', is not {LEAST_RATE:g} or more"
        yield Finding(connection, message, "rate", "state a rate")
    elif is_timed and owner is not None and owner.frequency == 0:
        message = f"'{connection.name}' has no rate, and bridge '{owner.name}' no frequency"
        yield Finding(connection, message, "rate", "state one of them")


@_of_connections("JML427", "command to a peer that cannot be controlled")
def peers_controllable(subject: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A connection that controls its peers has peers that provide AccessControl.

    Commands wait until control is granted, which such a peer never does (AS5710).

    Bad: `control` (true by default) for a command to a peer with `coreServices="none"` whose
    services do not inherit AccessControl

    Good: `control="false"` for this peer
    """
    if is_to_ros(connection) or not connection.control or not is_steering(connection.map.message):
        return
    yield from uncontrollable(subject, connection, services.peers_of(connection))


@rule("JML428", "bridges feed each other")
def loops(subject: Subject) -> Iterator[Finding]:
    """A message that a bridge publishes does not return to its source.

    A connection that publishes to a topic and one that subscribes to it carry a message in a
    circle when the second sends the same message to the peer that the first has it from, directly
    or through further bridges. The messages then multiply without end.

    Bad: ReportLocalPose of the peer to the topic pose, and the topic pose as ReportLocalPose back
    to a component from which it reaches the bridge again

    Good: two topics, pose and estimated_pose
    """
    for group in subject.systems():
        bridges = (participant for participant in group if isinstance(participant, bridge.Bridge))
        flows = [flow for owner in bridges for flow in subject.once(_flows, owner)]
        for loop in find_loops(flows):
            names = " -> ".join(f"{flow.owner.name}/{flow.connection.name}" for flow in loop)
            first = loop[0]
            notes = tuple(Note(flow.connection, f"'{flow.connection.name}'") for flow in loop[1:])
            message = f"what '{first.connection.name}' carries comes back to it"
            yield Finding(first.connection, f"{message}: {names}", "topics", related=notes)


def _flows(subject: Subject, owner: bridge.Bridge) -> list[Flow]:
    return [
        flow_of(connection, owner)
        for connection in owner.bridgeConnections
        if subject.is_read(connection, (*_ENDS, "topics")) and is_sound(subject, connection)
    ]


def _other_ways(subject: Subject, connection: bridge.Connection) -> str:
    """Returns how to state what the connection can be instead, with what it then does."""
    present = {name: str(getattr(connection, name).name) for name in FEATURES}
    hints = []
    for way in possible_exchanges(connection):
        wanted = {"direction": way.direction, "exchange": way.exchange}
        other = {name: text for name, text in wanted.items() if text != present[name]}
        if other:
            hints.append(f"{subject.assigned(connection, other)} ({way.meaning})")
    return f"write {', or '.join(hints)}" if hints else ""


def _serving(connection: bridge.Connection) -> str:
    """Returns how the bridge can serve the report itself; nothing where it provides it already."""
    owner, message = connection.eContainer(), connection.map.message
    service = message.eContainer()
    if owner is None or service is None or services.find_output(message, owner) is not None:
        return ""
    return f"let '{owner.name}' provide {service.name} to serve it"


def _service_findings(
    connection: bridge.Connection, owner: bridge.Bridge, peers: list[services.Provider]
) -> Iterator[Finding]:
    message, by_message = connection.map.message, connection.exchange.name == "message"
    if is_to_ros(connection) and by_message:
        yield from _taken_findings(connection, owner, peers)
    elif by_message:
        without = [peer for peer in peers if services.find_input(message, peer) is None]
        yield from (
            unprovided(connection, component, message, "takes", "map") for component in without
        )
    else:
        senders: list[services.Provider] = peers if is_to_ros(connection) else [owner]
        without = [sender for sender in senders if services.find_output(message, sender) is None]
        yield from (
            unprovided(connection, component, message, "sends", "map") for component in without
        )


def _taken_findings(
    connection: bridge.Connection, owner: bridge.Bridge, peers: list[services.Provider]
) -> Iterator[Finding]:
    message = connection.map.message
    if services.find_input(message, owner) is not None:
        return
    if not peers:
        yield unprovided(connection, owner, message, "takes", "map")
    for peer in peers:
        if services.find_output(message, peer) is None:
            text = f"neither '{owner.name}' provides a service that takes {message.name}"
            text += f" nor {provider_name(peer)} one that sends it"
            notes = tuple(Note(component, provider_name(component)) for component in (owner, peer))
            yield Finding(connection, text, "map", related=notes)

"""Rules about places of components, and about searches for them."""

from __future__ import annotations

import ipaddress
import re
from collections import defaultdict
from collections.abc import Iterator

from jausml.language.metamodel.classes import bridge, jaus, system
from jausml.language.model.diagnostics import Severity
from jausml.language.model.names import around
from jausml.language.semantics.connections import calls
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.hosts import endpoint_of, host_of, is_ipv4
from jausml.language.semantics.jaus.commands import is_command
from jausml.language.semantics.jaus.core_services import is_discovered
from jausml.language.semantics.paths.scopes import Carrier
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule

_LIMITS = {"subsystem": 65534, "node": 254}


@rule(
    "JML354",
    "either named or searched for",
    kinds=(bridge.Connection, bridge.RosServiceConnection),
    needs=("name", "search", "peers"),
)
def named_or_searched(
    _: Subject, connection: bridge.Connection | bridge.RosServiceConnection
) -> Iterator[Finding]:
    """The other end of a connection is either named, or searched for by its services.

    A report of another component has a `provider` or a `search`.

    Bad: a connection with `peers="vehicle"` and a `search`

    Good: the connection with one of them
    """
    if connection.search is not None and connection.peers:
        message = f"'{connection.name}' names peers and searches for peers"
        yield Finding(connection, message, "search", "leave out one of them")


@named_or_searched.also(jaus.ServiceConnection, needs=("name", "search", "provider"))
def _provider_or_search(_: Subject, received: jaus.ServiceConnection) -> Iterator[Finding]:
    if received.search is not None and received.provider is not None:
        message = f"'{received.name}' names a provider and searches for one"
        yield Finding(received, message, "search", "leave out one of them")
    elif received.search is None and received.provider is None:
        message = f"'{received.name}' names no provider and searches for none"
        yield Finding(received, message, None, "name a provider, or search for one")


@rule("JML355", "search that can find nothing", kinds=jaus.PeerSearch, needs=())
def search_possible(subject: Subject, search: jaus.PeerSearch) -> Iterator[Finding]:
    """A search looks where components can be: subsystem 1..65534, node 1..254, 0 for any.

    A search within its own subsystem or node does not name the number of another one.

    Bad: `<search services="..." subsystem="65535"/>`

    Good: `<search services="..." subsystem="100"/>`
    """
    for feature, highest in _LIMITS.items():
        number = getattr(search, feature)
        if not 0 <= number <= highest:
            message = f"{feature} {number} is not in 0..{highest}"
            yield Finding(search, message, feature)
    if subject.is_read(search):
        yield from _elsewhere(search)


@rule(
    "JML356",
    "control of everybody who is found",
    severity=Severity.WARNING,
    kinds=bridge.Connection,
)
def control_of_all(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A connection that takes control of its peers searches for one of them.

    With `choice="all"` each vehicle that appears within reach is controlled and moves by the same
    commands.

    Bad: the commands of a topic, of a ROS service or of a ROS action to
    `<search services="..." choice="all"/>`

    Good: the same with `choice="nearest"`, or with the subsystem of the vehicle
    """
    command = connection.map.message if connection.map is not None else None
    if command is not None and is_command(command):
        yield from _control_of_all(connection)


@control_of_all.also(bridge.RosServiceConnection)
def _control_by_calls(_: Subject, called: bridge.RosServiceConnection) -> Iterator[Finding]:
    asking = calls.asking(called)
    if asking is not None and is_command(asking):
        yield from _control_of_all(called)


@control_of_all.also(bridge.RosActionConnection)
def _control_by_goals(_: Subject, action: bridge.RosActionConnection) -> Iterator[Finding]:
    yield from _control_of_all(action)


@rule("JML357", "subsystem that nobody finds", severity=Severity.INFO)
def subsystem_discovered(subject: Subject) -> Iterator[Finding]:
    """Some component of a subsystem provides Discovery, as components do by default.

    Otherwise, operator control units that use Discovery do not see the subsystem, and searches of
    other components do not find it (AS5710). The rule ignores subsystems with external components,
    since one of them may answer.

    Bad: one component, with `coreServices="none"` and without Discovery

    Good: the same without `coreServices`
    """
    for group in subject.systems():
        subsystems: dict[str, list[jaus.Component]] = defaultdict(list)
        for participant in group:
            if isinstance(participant, jaus.Component) and participant.address:
                subsystems[participant.address.split(".")[0]].append(participant)
        for number, components in subsystems.items():
            if not any(component.external or is_discovered(component) for component in components):
                first = components[0]
                message = f"nobody in subsystem {number} provides Discovery, so nobody finds it"
                yield Finding(first, message, "coreServices", "let one of them provide it")


@rule(
    "JML358",
    "component that shall do what nobody carries out",
    severity=Severity.WARNING,
    kinds=jaus.Component,
    needs=("name", "external", "simulated"),
)
def external_is_idle(_: Subject, component: jaus.Component) -> Iterator[Finding]:
    """An external component has no connections and controls nobody: nothing is generated for it.

    Its address, its type and its services tell others what is there. Nor is it simulated, and a
    bridge neither: its maps say what it does.

    Bad: `<components name="vehicle" external="true" controls="trailer"/>`

    Good: `<components name="vehicle" external="true"/>`
    """
    is_bridge = isinstance(component, bridge.Bridge)
    if is_bridge and component.simulated:
        message = f"the bridge '{component.name}' has no methods that could be simulated"
        yield Finding(component, message, "simulated")
    if not component.external:
        return
    if is_bridge:
        message = f"the bridge '{component.name}' is external: it is not generated"
        yield Finding(component, message, "external")
    if component.simulated:
        message = f"'{component.name}' is external: nothing simulates it"
        yield Finding(component, message, "simulated")
    for feature in ("connections", "controls"):
        if getattr(component, feature):
            message = f"'{component.name}' is external: nobody carries out its {feature}"
            yield Finding(component, message, feature)


def _elsewhere(search: jaus.PeerSearch) -> Iterator[Finding]:
    """Yields a finding about a search within the own subsystem for another one."""
    owner = around(search, jaus.Component)
    if owner is None or not owner.address or search.within.name == "system":
        return
    own = dict(zip(_LIMITS, map(int, owner.address.split(".")), strict=False))
    compared = _LIMITS if search.within.name == "node" else ("subsystem",)
    for feature in compared:
        number = getattr(search, feature)
        if number not in (0, own[feature]):
            message = f"the search is within the own {search.within.name} and asks for"
            yield Finding(search, f"{message} {feature} {number}", feature)


def _control_of_all(connection: Carrier) -> Iterator[Finding]:
    search = connection.search
    if search is None or search.choice.name != "all" or search.subsystem:
        return
    if not is_to_ros(connection) and connection.control:
        message = f"'{connection.name}' takes control of all that its search finds"
        yield Finding(connection, message, "search", "search for one, or in one subsystem")


_NUMBERS = re.compile(r"[0-9.]+")
_HIGHEST_PORT = 65535


@rule(
    "JML359",
    "impossible place of a component",
    kinds=jaus.Component,
    needs=("name", "external", "endpoint", "greet"),
)
def places(_: Subject, component: jaus.Component) -> Iterator[Finding]:
    """An external component that runs on no host of the system may state where it is.

    An `endpoint` has an IPv4 address of one computer, or the name of one, and a port of 1..65535.
    A component that is placed on a host has its place from there, and so has one that is generated.
    Only external components are greeted.

    Bad: `<components name="judge" external="true" endpoint="192.168.1.300"/>`

    Good: `<components name="judge" external="true" endpoint="192.168.1.42:3794" greet="true"/>`
    """
    if component.endpoint and (fault := _fault(component.endpoint)):
        message = f"endpoint {component.endpoint} of '{component.name}' {fault}"
        yield Finding(component, message, "endpoint")
    for feature in ("endpoint", "greet"):
        if getattr(component, feature) and not component.external:
            message = f"'{component.name}' has {feature}, but is generated here"
            hint = "leave it out, or make the component external"
            yield Finding(component, message, feature, hint)


@places.also(system.System)
def _places_system(_: Subject, whole: system.System) -> Iterator[Finding]:
    for component in _elements(whole):
        host = host_of(whole, component)
        if component.external and component.endpoint and host is not None:
            note = Note(host, f"'{host.name}' is at {host.interface}:{host.port}")
            message = f"'{component.name}' has an endpoint, and is placed on '{host.name}'"
            yield Finding(component, message, "endpoint", "leave out one of them", (note,))


@rule(
    "JML361",
    "stated peer that is not reached or not heard",
    severity=Severity.WARNING,
    kinds=system.System,
)
def reached(_: Subject, whole: system.System) -> Iterator[Finding]:
    """Processes reach an external component whose place is stated, and hear what it says.

    A bridge with `allowedHosts` hears the hosts that they name alone. Behind a node manager, the
    node manager decides where messages go. TCP reaches only those whose place is known, so a peer
    that must be greeted needs one there.

    Bad: `<components external="true" endpoint="192.168.1.42"/>` beside a bridge with
    `<allowedHosts>10.0.0.0/24</allowedHosts>`

    Good: the same with `<allowedHosts>192.168.1.42</allowedHosts>`
    """
    for component in _elements(whole):
        if component.external and (component.endpoint or component.greet):
            yield from _not_exchanged(whole, component)


def _not_exchanged(whole: system.System, component: jaus.Component) -> Iterator[Finding]:
    """Yields the obstacles between the processes of a system and a component."""
    feature = "endpoint" if component.endpoint else "greet"
    place = endpoint_of(whole, component)
    processes = [element for element in _elements(whole) if not element.external]
    for host in dict.fromkeys(host_of(whole, process) for process in processes):
        if host is None:
            continue
        note = Note(host, f"'{host.name}' has {host.transport.name}")
        if host.transport.name == "nodeManager" and component.endpoint:
            message = f"endpoint of '{component.name}' has no effect behind a node manager"
            yield Finding(component, message, feature, related=(note,))
        elif host.transport.name == "jtcp" and place is None:
            message = f"'{component.name}' cannot be greeted by TCP: nobody says where it is"
            yield Finding(component, message, feature, "state its endpoint", (note,))
    for process in processes:
        if (
            place is not None
            and isinstance(process, bridge.Bridge)
            and not _hears(process, place[0])
        ):
            note = Note(process, f"'{process.name}' takes messages of its allowedHosts alone")
            message = f"'{process.name}' does not hear '{component.name}' at {place[0]}"
            hint = f"add {place[0]} to its allowedHosts"
            yield Finding(component, message, feature, hint, (note,))


def _hears(owner: bridge.Bridge, host: str) -> bool:
    """Tells whether a bridge may hear a host; what cannot be judged here counts as heard."""
    if not owner.allowedHosts or not is_ipv4(host):
        return True
    address = ipaddress.IPv4Address(host)
    try:
        return any(address in ipaddress.IPv4Network(allowed) for allowed in owner.allowedHosts)
    except ValueError:
        return True


def _fault(endpoint: str) -> str:
    """Returns the fault of an endpoint of the right form, empty when there is none."""
    host, _, port = endpoint.partition(":")
    if port and not 1 <= int(port) <= _HIGHEST_PORT:
        return f"has a port that is not in 1..{_HIGHEST_PORT}"
    if not _NUMBERS.fullmatch(host):
        return ""
    if not is_ipv4(host):
        return "has no IPv4 address"
    address = ipaddress.IPv4Address(host)
    is_of_many = address.is_unspecified or address.is_multicast or address.is_reserved
    return "has no address of one computer" if is_of_many else ""


def _elements(whole: system.System) -> list[jaus.Component]:
    return [*whole.components, *whole.bridges]

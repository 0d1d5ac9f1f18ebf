"""Rules about where bridges run, and who may reach them."""

from __future__ import annotations

import ipaddress
import math
from collections import defaultdict
from collections.abc import Iterator

from jausml.language.metamodel.classes import bridge, system
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections.limits import LEAST_PACE
from jausml.language.semantics.connections.topics import Endpoint, endpoints, policies
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.hosts import host_of
from jausml.language.semantics.jaus.commands import is_steering
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule

PARAMETERS = frozenset(
    {
        "autostart",
        "compiled",
        "diagnostics_frequency",
        "frequency",
        "jaus_allowed_hosts",
        "jaus_amplification_limit",
        "jaus_authority",
        "jaus_digital_resources",
        "jaus_event_rate_budget",
        "jaus_fixed_sources",
        "jaus_fragment_size",
        "jaus_id",
        "jaus_idle_timeout",
        "jaus_interface",
        "jaus_max_connections",
        "jaus_max_events",
        "jaus_max_peers",
        "jaus_multicast_group",
        "jaus_multicast_ttl",
        "jaus_port",
        "jaus_transport",
        "latency",
        "lift_emergency",
        "queue_age_limit",
        "service_introspection",
        "start_type_description_service",
        "use_sim_time",
    }
)
"""Parameters that every bridge has."""


@rule(
    "JML466",
    "bridge that carries nothing",
    kinds=bridge.Bridge,
    needs=("name", "bridgeConnections", "serviceConnections", "actionConnections"),
)
def something_carried(_: Subject, owner: bridge.Bridge) -> Iterator[Finding]:
    """A bridge has a connection: of topics, of a ROS service, or of a ROS action.

    Without one, it is a process that does nothing.

    Bad: a bridge with maps, and no connection

    Good: the same with a `bridgeConnections`, `serviceConnections` or `actionConnections`
    """
    if not (owner.bridgeConnections or owner.serviceConnections or owner.actionConnections):
        message = f"'{owner.name}' carries nothing across"
        yield Finding(owner, message, "bridgeConnections", "give it a connection")


@rule("JML419", "topic published to in two ways", severity=Severity.WARNING, kinds=bridge.Bridge)
def one_quality(subject: Subject, owner: bridge.Bridge) -> Iterator[Finding]:
    """The connections of a bridge that publish to one topic state one quality of service.

    Each quality of service has its own publisher. A subscription that fits only one of them, such
    as a reliable one, gets only the messages of its connections.

    Bad: two connections to pose, one of them with `<qos reliability="best_effort"/>`

    Good: the same `<qos .../>` at both topics, or none
    """
    by_topic: dict[str, list[Endpoint]] = defaultdict(list)
    for end in endpoints([owner]):
        if end.publishes and subject.is_read(end.element):
            by_topic[end.topic].append(end)
    for first, *others in by_topic.values():
        for end in others:
            if _quality(end) != _quality(first):
                note = Note(first.element, "the other one", first.feature)
                message = f"topic {end.topic} has another quality of service here"
                hint = "state the same qos at both"
                yield Finding(end.element, message, "qos", hint, (note,))


def _quality(end: Endpoint) -> tuple[object, ...]:
    return (end.reliability, *policies(end.element.qos).values())


@rule("JML420", "quantity with the name of another parameter", kinds=bridge.Quantity, needs=())
def parameter_names(_: Subject, quantity: bridge.Quantity) -> Iterator[Finding]:
    """A quantity is a parameter of the node of its bridge, which has others already.

    Bad: `<quantities name="jaus_port" value="8.5"/>`

    Good: `<quantities name="max_speed" value="8.5"/>`
    """
    if quantity.name in PARAMETERS:
        message = f"every bridge has a parameter '{quantity.name}'"
        yield Finding(quantity, message, "name", "choose another name")


@rule("JML477", "allowed host that is none", kinds=bridge.Bridge, needs=("name", "allowedHosts"))
def allowed_hosts(_: Subject, owner: bridge.Bridge) -> Iterator[Finding]:
    """An allowed host is an IPv4 address, or a network of such addresses.

    A network is written as its first address and the number of bits that its addresses share.

    Bad: `<allowedHosts>10.0.0.7/24</allowedHosts>`

    Good: `<allowedHosts>10.0.0.0/24</allowedHosts>`
    """
    for text in owner.allowedHosts:
        fault = _fault(text)
        if fault:
            message = f"allowedHosts {text!r} of '{owner.name}' {fault}"
            yield Finding(owner, message, "allowedHosts")


def _fault(text: str) -> str:
    try:
        ipaddress.IPv4Network(text)
    except ValueError:
        pass
    else:
        return ""
    try:
        meant = ipaddress.IPv4Network(text, strict=False)
    except ValueError:
        return "is no IPv4 address and no network"
    return f"is an address within the network {meant}, not the network"


@rule("JML478", "sources that nobody looks at", severity=Severity.WARNING, kinds=system.System)
def sources_known(_: Subject, whole: system.System) -> Iterator[Finding]:
    """A bridge that says where messages may come from speaks JAUS over UDP or TCP itself.

    A node manager does not pass on where a message comes from.

    Bad: a bridge with `fixedSources="true"` on a host with `transport="nodeManager"`

    Good: the same host with `transport="judp"`
    """
    for owner in whole.bridges:
        host = host_of(whole, owner)
        if host is None or host.transport.name != "nodeManager":
            continue
        note = Note(host, f"'{host.name}' has nodeManager")
        for feature in ("allowedHosts", "fixedSources"):
            if getattr(owner, feature):
                message = f"{feature} of '{owner.name}' has no effect behind a node manager"
                yield Finding(owner, message, feature, related=(note,))


@rule(
    "JML479",
    "command of anybody in control",
    severity=Severity.INFO,
    kinds=bridge.Connection,
    needs=("name", "direction", "exchange", "map", "peers", "search", "documentation"),
)
def commanders_known(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A model states who may command the ROS side.

    JAUS has no authentication: the first component that requests control of the bridge gets it, or
    one with a higher authority, and may then send any command that the bridge accepts. `peers` or
    `search` of the connection restrict the components, and `allowedHosts` of the bridge the hosts.
    A documentation of the connection that says why anybody may command also silences the rule.

    Bad: a connection from SetWrenchEffort to a topic, without peers

    Good: the same with `peers="operator"`
    """
    owner = connection.eContainer()
    map_ = connection.map
    if (
        isinstance(owner, bridge.Bridge)
        and is_to_ros(connection)
        and connection.exchange.name == "message"
        and not (connection.peers or connection.search or connection.documentation)
        and not owner.allowedHosts
        and map_ is not None
        and map_.message is not None
        and is_steering(map_.message)
    ):
        message = f"'{connection.name}' takes {map_.message.name} of anybody in control"
        yield Finding(connection, message, "peers", "name peers, or allowedHosts of the bridge")


@rule(
    "JML480",
    "cap of what one source sends",
    kinds=bridge.Connection,
    needs=("name", "direction", "exchange", "rateCap"),
)
def rate_caps(_: Subject, connection: bridge.Connection) -> Iterator[Finding]:
    """A rateCap is 0 or at least 0.001 Hz, and is for unrequested messages.

    The rate of the event or of the query determines how many reports come; for messages from ROS,
    the bridge cannot distinguish the sources.

    Bad: `direction="rosToJaus" rateCap="100"`

    Good: `direction="jausToRos" exchange="message" rateCap="100"`
    """
    if connection.rateCap == 0:
        return
    if not (math.isfinite(connection.rateCap) and connection.rateCap >= LEAST_PACE):
        message = f"rateCap {connection.rateCap:g} of '{connection.name}' is neither 0 nor"
        yield Finding(connection, f"{message} {LEAST_PACE:g} or more", "rateCap")
    if not is_to_ros(connection) or connection.exchange.name != "message":
        message = f"'{connection.name}' takes nothing unasked that a rateCap could be for"
        yield Finding(connection, message, "rateCap", "state a maxRate")


_BUDGETS: dict[str, tuple[float, float]] = {
    "amplificationLimit": (3, 1000),
    "maxPeers": (16, 65535),
    "maxConnections": (4, 4096),
    "idleTimeout": (1, 86400),
    "maxEvents": (1, 255),
    "eventRateBudget": (1, 278460),
}
"""Ranges of what strangers get, as the runtime has them."""

_NO_LIMIT = ("amplificationLimit", "idleTimeout")  # budgets for which 0 means that there is none


@rule("JML489", "budget out of range", kinds=bridge.Bridge, needs=("name",))
def budgets(_: Subject, owner: bridge.Bridge) -> Iterator[Finding]:
    """What a bridge lends to strangers leaves room for those that it is for.

    amplificationLimit is 0 or 3..1000: with less, a peer could not even be asked for a proof.
    idleTimeout is 0 or 1..86400 s, maxPeers 16..65535, maxConnections 4..4096, maxEvents 1..255,
    and eventRateBudget 1..278460 reports a second.

    Bad: `amplificationLimit="1"`

    Good: `amplificationLimit="3"`
    """
    for name, (lower, upper) in _BUDGETS.items():
        value = getattr(owner, name)
        if lower <= value <= upper or (name in _NO_LIMIT and value == 0):
            continue
        allowed = f"{lower}..{upper}"
        allowed = f"0 or {allowed}" if name in _NO_LIMIT else allowed
        message = f"{name} {value:g} of '{owner.name}' is not in {allowed}"
        yield Finding(owner, message, name)

"""Rules about what a bridge is once it runs: its endpoints in ROS, its parameters."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections.topics import endpoints
from jausml.language.validation.rule import Finding, Note, rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language.semantics.connections.topics import Endpoint
    from jausml.language.semantics.subject import Subject

PARAMETERS = frozenset(
    {
        "diagnostics_frequency",
        "jaus_allowed_hosts",
        "jaus_amplification_limit",
        "jaus_authority",
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
        "start_type_description_service",
        "use_sim_time",
    }
)
"""Parameters that every bridge has."""

_POLICIES: dict[str, object] = {
    "durability": "volatile",
    "history": "keep_last",
    "depth": 10,
    "deadline": 0.0,
    "lifespan": 0.0,
    "liveliness": "automatic",
    "leaseDuration": 0.0,
}
"""Policies besides reliability, and what they are when no profile states them."""


@rule("JML466", Severity.ERROR, "bridge that carries nothing")
def something_carried(subject: Subject) -> Iterator[Finding]:
    """A bridge has a connection: of topics, of a ROS service, or of a ROS action.

    Without one, it is a process that does nothing.

    Bad: a bridge with maps, and no connection

    Good: the same with a `bridgeConnections`, `serviceConnections` or `actionConnections`
    """
    needs = ("name", "bridgeConnections", "serviceConnections", "actionConnections")
    for owner in subject.instances(bridge.Bridge, needs=needs):
        if not (owner.bridgeConnections or owner.serviceConnections or owner.actionConnections):
            message = f"'{owner.name}' carries nothing across"
            yield Finding(owner, message, "bridgeConnections", "give it a connection")


@rule("JML419", Severity.WARNING, "topic published to in two ways")
def one_quality(subject: Subject) -> Iterator[Finding]:
    """The connections of a bridge that publish to one topic state one quality of service.

    Each quality of service has its own publisher. A subscription that fits only one of them, such
    as a reliable one, gets only the messages of its connections.

    Bad: two connections to pose, one of them with `<qos reliability="best_effort"/>`

    Good: the same `<qos .../>` at both topics, or none
    """
    for owner in subject.instances(bridge.Bridge):
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
    profile = end.element.qos
    values = [getattr(profile, name, default) for name, default in _POLICIES.items()]
    return (end.reliability, *(getattr(value, "name", value) for value in values))


@rule("JML420", Severity.ERROR, "quantity with the name of another parameter")
def parameter_names(subject: Subject) -> Iterator[Finding]:
    """A quantity is a parameter of the node of its bridge, which has others already.

    Bad: `<quantities name="jaus_port" value="8.5"/>`

    Good: `<quantities name="max_speed" value="8.5"/>`
    """
    for quantity in subject.instances(bridge.Quantity, needs=()):
        if quantity.name in PARAMETERS:
            message = f"every bridge has a parameter '{quantity.name}'"
            yield Finding(quantity, message, "name", "choose another name")

"""Rules about ROS nodes and bridges: names, topics, quality of service, parameters."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from jausml.language.metamodel.classes import bridge, ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.connections.topics import (
    Endpoint,
    endpoints,
    is_latched,
    namespace_fault,
    policies,
    resolve_topic,
    topic_fault,
)
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.paths.attributes import is_integer, is_real
from jausml.language.semantics.paths.ros_paths import ros_name
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule

_DEEPEST = 10_000  # most messages that a quality of service keeps without a word
_TOO_LONG = 2.0**63 / 1e9  # seconds: ROS 2 counts nanoseconds in 64 bits
_LONG = 2**63
_HIGHEST_FREQUENCY = 1000.0
_PROMISED = ("deadline", "leaseDuration")
"""Times of a publisher that are at most those that a subscription asks for."""
_LESS = {
    "durability": ("volatile", "transient_local"),
    "liveliness": ("automatic", "manual_by_topic"),
}
"""What a publisher offers too little of, with what a subscription asks for then."""


@rule("JML401", "illegal ROS name", kinds=ros.TopicEndpoint, needs=())
def ros_names(_: Subject, end: ros.TopicEndpoint) -> Iterator[Finding]:
    """Topic and service names and namespaces obey the rules of ROS 2.

    Parts of letters, digits and underscores are joined by '/'; no part is empty, starts with a
    digit or has two underscores in a row; '~/' at the start means the node's own namespace.

    Bad: `<topics name="/robot//odometry"/>`

    Good: `<topics name="robot/odometry"/>`
    """
    yield from _name_findings(end, "topic", "topic", end.topic)


@ros_names.also(ros.ServiceEndpoint, needs=())
def _ros_names_service_endpoint(_: Subject, server: ros.ServiceEndpoint) -> Iterator[Finding]:
    yield from _name_findings(server, "service", "service", server.service)


@ros_names.also(bridge.Topic, needs=())
def _ros_names_topic(_: Subject, topic: bridge.Topic) -> Iterator[Finding]:
    yield from _name_findings(topic, "name", "topic", topic.name)


@ros_names.also((ros.Node, bridge.Bridge), needs=("name",))
def _ros_names_node(_: Subject, node: ros.Node | bridge.Bridge) -> Iterator[Finding]:
    fault = namespace_fault(node.namespace or "")
    if fault:
        message = f"namespace {node.namespace!r} of '{node.name}' {fault}"
        yield Finding(node, message, "namespace")


@rule("JML402", "topic of two types")
def topic_types(subject: Subject) -> Iterator[Finding]:
    """All publishers and subscriptions of a topic have one type, bridges included.

    ROS 2 never connects endpoints of different types, and does not report it. Names are compared as
    they resolve in the namespaces of their nodes.

    Bad: a node that publishes Twist on cmd_vel, and a bridge that subscribes to TwistStamped there

    Good: TwistStamped at both ends
    """
    for ends in _topics(subject):
        first = ends[0]
        for end in ends[1:]:
            if end.type is not first.type and ros_name(end.type) != ros_name(first.type):
                note = Note(first.element, f"{ros_name(first.type)} here", first.feature)
                yield Finding(
                    end.element,
                    f"topic {end.topic} is of {ros_name(end.type)} here, but of"
                    f" {ros_name(first.type)} in '{first.owner.name}'",
                    end.feature,
                    related=(note,),
                )


@rule("JML475", "service or action served twice, or of two types")
def served_once(subject: Subject) -> Iterator[Finding]:
    """A ROS service or action of a system has one server, and its clients have its type.

    With several servers, it is unknown which one answers a client; one of another type hears
    nothing. Names are compared in full: `stop` and `/stop` are one in a bridge without a namespace.

    Bad: two service connections with `service="stop"`

    Good: `stop_front` and `stop_rear`
    """
    for group in subject.systems(("name", "namespace")):
        by_name: dict[tuple[str, str], list[_Caller]] = defaultdict(list)
        for owner in group:
            if isinstance(owner, ros.Node | bridge.Bridge):
                for end in _callers(subject, owner):
                    by_name[end.kind, end.name].append(end)
        for ends in by_name.values():
            first, *others = sorted(ends, key=lambda end: not end.serves)
            for end in others:
                note = Note(first.element, f"'{first.label}'", first.kind)
                if end.serves:
                    message = f"'{end.label}' serves {end.name}, as '{first.label}' does"
                    yield Finding(end.element, message, end.kind, related=(note,))
                elif ros_name(end.element.type) != ros_name(first.element.type):
                    message = f"{end.kind} {end.name} is of {ros_name(end.element.type)} here, but"
                    message += f" of {ros_name(first.element.type)} in '{first.label}'"
                    yield Finding(end.element, message, "type", related=(note,))


@dataclass(frozen=True)
class _Caller:
    """A server or a client of a ROS service or action, `kind`, by its full name."""

    element: ros.ServiceEndpoint | bridge.RosServiceConnection | bridge.RosActionConnection
    label: str
    kind: str
    name: str
    serves: bool


def _callers(subject: Subject, owner: ros.Node | bridge.Bridge) -> Iterator[_Caller]:
    ends: list[tuple[Any, str, bool]] = []
    if isinstance(owner, ros.Node):
        ends += [(server, "service", True) for server in owner.serviceServers]
        ends += [(client, "service", False) for client in owner.serviceClients]
    else:
        ends += [(call, "service", not is_to_ros(call)) for call in owner.serviceConnections]
        ends += [(action, "action", not is_to_ros(action)) for action in owner.actionConnections]
    for element, kind, serves in ends:
        name = str(getattr(element, kind) or "")
        if name and not topic_fault(name) and subject.is_read(element) and element.type is not None:
            full_name = resolve_topic(name, owner.namespace or "", owner.name or "")
            yield _Caller(element, f"{owner.name}/{element.name}", kind, full_name, serves)


@rule("JML403", "incompatible quality of service", severity=Severity.WARNING)
def qos_compatible(subject: Subject) -> Iterator[Finding]:
    """A subscription asks for no more than the publishers of its topic offer.

    Otherwise ROS 2 does not connect the two. A subscription that is reliable needs a reliable
    publisher, and so do transient_local and manual_by_topic ones; a deadline or a lease needs one
    that is no longer at the publisher. What was published before a subscription began is repeated
    between reliable ends alone: best_effort and transient_local together have no effect.

    Bad: a best_effort publisher and a subscription of a node, which is reliable unless it says
    otherwise

    Good: `<qos reliability="best_effort"/>` at both ends
    """
    for profile in subject.instances(ros.QoSProfile, needs=("reliability", "durability")):
        if profile.reliability.name == "best_effort" and is_latched(profile):
            message = "transient_local has no effect with best_effort: what was published before"
            hint = "leave reliability out, or set durability volatile"
            yield Finding(profile, f"{message} does not come", "durability", hint)
    for ends in _topics(subject):
        offering: dict[object, list[Endpoint]] = defaultdict(list)
        for publisher in (end for end in ends if end.publishes):
            offering[_offer(publisher)].append(publisher)
        for subscription in (end for end in ends if not end.publishes):
            for publisher, *others in offering.values():
                reason = _incompatible(publisher, subscription)
                if reason:
                    note = Note(publisher.element, f"'{publisher.owner.name}' publishes", "qos")
                    message = f"subscription to {subscription.topic} gets nothing from"
                    more = f" and {len(others)} more" if others else ""
                    yield Finding(
                        subscription.element,
                        f"{message} '{publisher.owner.name}'{more}: {reason}",
                        "qos",
                        related=(note,),
                    )


@rule("JML404", "impossible quality of service", kinds=ros.QoSProfile, needs=("history",))
def qos_values(_: Subject, profile: ros.QoSProfile) -> Iterator[Finding]:
    """The depth is 1 or more with keep_last; a time is not negative, and 0 means none.

    ROS 2 counts nanoseconds in 64 bits: no time is longer than 292 years. More than 10000 messages
    are a warning: a receiver that is late gets what was said long ago, and memory keeps it all.

    Bad: `<qos depth="0"/>`, `<qos depth="2000000"/>`

    Good: `<qos depth="1"/>`
    """
    lowest = 1 if profile.history.name == "keep_last" else 0
    if profile.depth < lowest:
        yield Finding(profile, f"depth {profile.depth} is below {lowest}", "depth")
    elif profile.depth > _DEEPEST:
        message = f"depth {profile.depth} keeps more messages than {_DEEPEST}"
        hint = "1 to 100 is usual: what is late is of no use"
        yield Finding(profile, message, "depth", hint, severity=Severity.WARNING)
    for feature, value in (
        ("deadline", profile.deadline),
        ("lifespan", profile.lifespan),
        ("leaseDuration", profile.leaseDuration),
    ):
        if not 0 <= value < _TOO_LONG:
            yield Finding(profile, f"{feature} {value:g} is no time in seconds", feature)


@rule("JML405", "impossible parameter value", kinds=ros.Parameter, needs=("name", "type"))
def parameter_values(_: Subject, parameter: ros.Parameter) -> Iterator[Finding]:
    """The default of a parameter is of its type and within its range, if it has one.

    A range goes from a minimum to a larger maximum, each of which is 0 if it is not stated.

    Bad: `<parameters name="gain" type="double" value="high"/>`

    Good: `<parameters name="gain" type="double" value="0.5" maximum="1.0"/>`
    """
    if parameter.value is None:
        return
    fault = _parameter_fault(parameter)
    if fault:
        message = f"value {parameter.value!r} of parameter '{parameter.name}' {fault}"
        yield Finding(parameter, message, "value")
    for feature, limit in (("minimum", parameter.minimum), ("maximum", parameter.maximum)):
        if not math.isfinite(limit):
            message = f"{feature} of parameter '{parameter.name}' is not finite"
            yield Finding(parameter, message, feature)
    limits = parameter.minimum, parameter.maximum
    if limits[0] > limits[1] or limits[0] == limits[1] != 0:
        message = f"the range {limits[0]:g}..{limits[1]:g} of parameter '{parameter.name}' is empty"
        yield Finding(parameter, message, "minimum", "the minimum is below the maximum")


@rule("JML407", "impossible frequency", kinds=(ros.Node, bridge.Bridge), needs=("name",))
def frequencies(_: Subject, node: ros.Node | bridge.Bridge) -> Iterator[Finding]:
    """A frequency in calls each second is finite, not negative and at most 1000.

    0 means no timer.

    Bad: `<nodes name="controller" frequency="-1.0"/>`

    Good: `<nodes name="controller" frequency="20.0"/>`
    """
    if not 0 <= node.frequency <= _HIGHEST_FREQUENCY:
        message = f"frequency {node.frequency:g} of '{node.name}'"
        yield Finding(node, f"{message} is not in 0..1000", "frequency")


def _topics(subject: Subject) -> list[list[Endpoint]]:
    """Returns the ends of each topic."""
    return subject.once(_find_topics)


def _find_topics(subject: Subject) -> list[list[Endpoint]]:
    topics: list[list[Endpoint]] = []
    for group in subject.systems(("name", "namespace")):
        by_topic: dict[str, list[Endpoint]] = defaultdict(list)
        for end in endpoints(group):
            if subject.is_read(end.element):
                by_topic[end.topic].append(end)
        topics += by_topic.values()
    return topics


def _offer(publisher: Endpoint) -> object:
    """Returns the offer that subscriptions compare: equal publishers are looked at once."""
    offered = policies(publisher.element.qos)
    return publisher.reliability, *(offered[policy] for policy in (*_LESS, *_PROMISED))


def _incompatible(publisher: Endpoint, subscription: Endpoint) -> str:
    """Returns the policy that a subscription asks for and a publisher does not offer, in words."""
    if publisher.reliability == "best_effort" and subscription.reliability == "reliable":
        return "it is best_effort, the subscription reliable"
    offered, asked = policies(publisher.element.qos), policies(subscription.element.qos)
    for policy, (less, more) in _LESS.items():
        if (offered[policy], asked[policy]) == (less, more):
            return f"it is {less}, the subscription {more}"
    for policy in _PROMISED:
        if _seconds(offered[policy]) > _seconds(asked[policy]):
            return f"its {policy} is longer than that of the subscription"
    return ""


def _seconds(time: float) -> float:
    return time if time > 0 else math.inf


def _nodes(subject: Subject) -> list[ros.Node | bridge.Bridge]:
    return [
        *subject.instances(ros.Node, needs=("name",)),
        *subject.instances(bridge.Bridge, needs=("name",)),
    ]


def _name_findings(
    element: EObject, feature: str, noun: str, name: str | None
) -> Iterator[Finding]:
    fault = topic_fault(name) if name is not None else ""
    if fault:
        yield Finding(element, f"{noun} name {name!r} {fault}", feature)


def _parameter_fault(parameter: ros.Parameter) -> str:
    kind, text = parameter.type.name, parameter.value
    if kind == "string":
        return ""
    if kind == "bool":
        return "" if text in ("true", "false") else "is not true or false"
    if kind == "integer" and not is_integer(text):
        return "is not an integer"
    if kind == "double" and not is_real(text):
        return "is not a number"
    value = int(text) if kind == "integer" else float(text)
    if kind == "integer" and not -_LONG <= value < _LONG:
        return "does not fit 64 bits"
    is_limited = parameter.minimum < parameter.maximum
    if is_limited and not parameter.minimum <= value <= parameter.maximum:
        return f"is not in {parameter.minimum:g}..{parameter.maximum:g}"
    return ""

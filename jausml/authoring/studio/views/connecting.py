"""Connecting in the system view: what can flow between two ends, and what runs on a host."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, cast

from jausml.authoring.editing.commands import Add, Command, Remove, Set
from jausml.authoring.proposals.bridging import is_served, offers, profile_of, qos_of
from jausml.authoring.proposals.elements import AnswerError, Option, Options, Scope
from jausml.authoring.proposals.new_elements import name_among
from jausml.authoring.studio.views.crossing import (
    bridged,
    carried,
    further_peer,
    namespace_of,
    seen_from,
    through,
)
from jausml.authoring.studio.views.spots import Spot, all_spots
from jausml.language.metamodel.classes import bridge, jaus, ros, system
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.names import name_of
from jausml.language.semantics.connections.exchanges import EVENT
from jausml.language.semantics.connections.topics import resolve_topic
from jausml.language.semantics.directions import TO_JAUS, TO_ROS
from jausml.language.semantics.hosts import host_of
from jausml.language.semantics.names import snake_case
from jausml.language.semantics.paths.ros_paths import ros_name

_OTHER_ENDS: Mapping[str, tuple[str, str, str]] = {
    "Publisher": ("subscriptions", "ros.Subscription", "topic"),
    "Subscription": ("publishers", "ros.Publisher", "topic"),
    "ServiceClient": ("serviceServers", "ros.ServiceServer", "service"),
    "ServiceServer": ("serviceClients", "ros.ServiceClient", "service"),
}


def connect(scope: Scope, source: Spot, target: Spot) -> Options:
    """Returns the ways to connect two ends of the system view, the best first."""
    if source.owner is target.owner:
        return Options(refusal=f"both ends are of {name_of(source.owner)}; draw to another box")
    options = _options(scope, source, target)
    if options.options:
        first, *others = options.options
        return Options((replace(first, is_best=True), *others))
    return options


def _options(scope: Scope, source: Spot, target: Spot) -> Options:
    match source.owner, target.owner:
        case ros.Node(), ros.Node():
            return topics_between(scope, source, target)
        case bridge.Bridge(), ros.Node():
            return through(scope, source.owner, source, target, TO_ROS)
        case ros.Node(), bridge.Bridge():
            return through(scope, target.owner, target, source, TO_JAUS)
        case jaus.Component(), ros.Node():
            return bridged(scope, source, target, TO_ROS)
        case ros.Node(), jaus.Component():
            return bridged(scope, target, source, TO_JAUS)
        case jaus.Component(), jaus.Component():
            return _among_components(scope, source, target)
    return Options(refusal="only components, bridges and nodes are connected")


def _among_components(scope: Scope, source: Spot, target: Spot) -> Options:
    if isinstance(target.element, bridge.Connection):
        return further_peer(scope, source, target, TO_ROS)
    if isinstance(source.element, bridge.Connection):
        return further_peer(scope, target, source, TO_JAUS)
    across = _through_bridge(scope, source, target)
    if across is None:
        return asked(scope, source, target)
    # Bridges are components too: what they ask for themselves comes after what they carry.
    return Options((*across.options, *asked(scope, source, target).options), across.refusal)


def _through_bridge(scope: Scope, source: Spot, target: Spot) -> Options | None:
    """Returns the messages that a bridge may carry for a component, None for other ends."""
    match source.owner, target.owner:
        case bridge.Bridge(), bridge.Bridge():
            return None
        case _, bridge.Bridge() if target.element is None:
            return carried(scope, target.owner, source, TO_ROS)
        case bridge.Bridge(), _ if source.element is None:
            return carried(scope, source.owner, target, TO_JAUS)
    return None


def ends(scope: Scope, start: Spot) -> list[tuple[Spot, str]]:
    """Returns the ends to which a line can be drawn from one, each with why."""
    line_ends = []
    for other in all_spots(scope):
        answer = connect(scope, start, other)
        if answer.options:
            line_ends.append((other, answer.options[0].why))
    return line_ends


def asked(scope: Scope, source: Spot, target: Spot) -> Options:
    """A component asks another for its reports."""
    provider, asking = source.owner, target.owner
    if not isinstance(provider, jaus.Component) or not isinstance(asking, jaus.Component):
        return Options(refusal="only components are asked")
    fitting_offers = [
        provided_offer
        for provided_offer in offers(provider, TO_ROS)
        if provided_offer.is_provided
        and provided_offer.exchange == EVENT
        and (
            name_of(provided_offer.message) == source.message
            if source.message
            else not is_served(provided_offer.service)
        )
    ]
    if not fitting_offers:
        what = source.message or "report that can be asked for"
        return Options(refusal=f"no service that {name_of(provider)} provides has a {what}")
    options = []
    for offer in fitting_offers:
        name = name_among(name_of(offer.message).removeprefix("Report"), asking.connections)
        values = {
            "name": (name,),
            "provider": (scope.ref(provider),),
            "message": (scope.ref(offer.message),),
        }
        own = scope.ref(asking)
        commands = [Add(own, "connections", "jaus.ServiceConnection", values)]
        uses = tuple(scope.ref(service) for service in asking.uses)
        more = () if scope.ref(offer.service) in uses else (scope.ref(offer.service),)
        options.append(
            Option(
                name_of(offer.message),
                f"{offer.why(name_of(provider))}; {name_of(asking)} asks for it periodically",
                (*((Set(own, "uses", (*uses, *more)),) if more else ()), *commands),
            )
        )
    return Options(tuple(options))


def topics_between(scope: Scope, source: Spot, target: Spot) -> Options:
    """A topic, or a service, between two nodes."""
    start, end = source.element, target.element
    match start, end:
        case ros.Subscription(), _:
            return Options(refusal=f"{name_of(start)} subscribes; draw to it, not from it")
        case _, ros.Publisher():
            return Options(refusal=f"{name_of(end)} publishes; draw from it, not to it")
        case ros.ServiceServer(), _:
            return Options(refusal=f"{name_of(start)} serves; draw to it from what calls it")
        case _, ros.ServiceClient():
            return Options(refusal=f"{name_of(end)} calls; draw from it to what serves it")
        case (ros.Publisher(), ros.Subscription()) | (ros.ServiceClient(), ros.ServiceServer()):
            return _joined(scope, source, target)
        case ((ros.Publisher() | ros.ServiceClient()), None):
            return _mirrored(scope, source, target.owner)
        case None, (ros.Subscription() | ros.ServiceServer()):
            return _mirrored(scope, target, source.owner)
        case None, None:
            return Options(refusal="draw from a topic of a node, or add a publisher to it first")
    return Options(refusal="topics meet topics, and services services")


def _mirrored(scope: Scope, known: Spot, other: EObject) -> Options:
    """A node gets the other end of what a node has."""
    end: Any = known.element
    if end is None or end.type is None:
        return Options(refusal=f"{name_of(end)} has no type yet; choose one in its form")
    feature, cls, named = _OTHER_ENDS[end.eClass.name]
    topic = seen_from(other, known.owner, str(getattr(end, named) or name_of(end)))
    name = name_among(name_of(end), getattr(other, feature))
    kind = end.type
    values = {"name": (name,), named: (topic,), "type": (scope.ref(kind),)}
    profile = profile_of(scope, end) if isinstance(end, ros.TopicEndpoint) else {}
    add = Add(scope.ref(other), feature, cls, values, qos_of(profile))
    noun = cls.removeprefix("ros.")
    label = f"new {snake_case(noun).replace('_', ' ')} {name} of {name_of(other)}"
    return Options((Option(label, f"{name_of(end)} has {ros_name(kind)}", (add,)),))


def _joined(scope: Scope, source: Spot, target: Spot) -> Options:
    """Two ends get one name."""
    start: Any = source.element
    end: Any = target.element
    if start is None or end is None or start.type is None or end.type is None:
        return Options(refusal="an end has no type yet; choose one in its form")
    if ros_name(start.type) != ros_name(end.type):
        text = f"{name_of(start)} has {ros_name(start.type)}, {name_of(end)} {ros_name(end.type)}"
        return Options(refusal=f"{text}; messages of one type alone flow between them")
    named = _OTHER_ENDS[start.eClass.name][2]
    names = [
        resolve_topic(
            getattr(spot.element, named) or "", namespace_of(spot.owner), name_of(spot.owner)
        )
        for spot in (source, target)
    ]
    if names[0] == names[1]:
        return Options(refusal=f"both are connected by {names[0]} already")
    topic = seen_from(target.owner, source.owner, str(getattr(start, named) or name_of(start)))
    command = Set(scope.ref(end), named, (topic,))
    label = f"{name_of(end)} on {topic}"
    why = f"both have {ros_name(start.type)}; {name_of(end)} leaves {getattr(end, named)}"
    return Options((Option(label, why, (command,)),))


_FEATURES = ("components", "nodes")


def hosted(scope: Scope, elements: Sequence[EObject], host: system.Host | None) -> Option:
    """Returns the option that lets elements run on a host; without commands where they do already.

    `host`: the host; None for the frame of none, where external components alone can be.
    """
    moved: dict[system.System, list[EObject]] = {}
    for element in elements:
        whole = _system_of(element, host)
        if whole is not None and host_of(whole, cast("jaus.Component", element)) is not host:
            moved.setdefault(whole, []).append(element)
    what = name_of(elements[0]) if len(elements) == 1 else f"{len(elements)} elements"
    where = f"on {name_of(host)}" if host is not None else "on no host of the system"
    commands = [
        command for whole, some in moved.items() for command in _placed(scope, whole, some, host)
    ]
    return Option(f"Run {what} {where}", "", commands)


def _system_of(element: EObject, host: system.Host | None) -> system.System | None:
    """Returns the system of an element whose host is to change, None if there is nothing to do."""
    whole = element.eContainer()
    name = name_of(element) or element.eClass.name
    if not isinstance(element, jaus.Component | ros.Node) or not isinstance(whole, system.System):
        raise AnswerError(f"{name} is no component or node of a system, which could run on a host")
    if host is None:
        # Any other is somewhere in the system, wherever its box stands.
        is_external = isinstance(element, jaus.Component) and bool(element.external)
        return whole if is_external else None
    if host.eContainer() is not whole:
        raise AnswerError(f"{name} and {name_of(host)} are of different systems")
    return whole


def _placed(
    scope: Scope, whole: system.System, elements: Sequence[EObject], host: system.Host | None
) -> Iterator[Command]:
    """Yields the changes of the placements of a system."""
    own = next(
        (host_placement for host_placement in whole.placements if host_placement.host is host), None
    )
    for placement in whole.placements:
        left = {name: _without(getattr(placement, name), elements) for name in _FEATURES}
        if placement is own:
            for name in _FEATURES:
                left[name] += [element for element in elements if _feature(element) == name]
        if not any(left.values()):
            yield Remove(scope.ref(placement))
            continue
        for name, values in left.items():
            if values != list(getattr(placement, name)):
                refs = tuple(scope.ref(value) for value in values)
                yield Set(scope.ref(placement), name, refs)
    if own is None and host is not None and not _follows(whole, elements, host):
        placed = {
            name: refs
            for name in _FEATURES
            if (
                refs := tuple(
                    scope.ref(element) for element in elements if _feature(element) == name
                )
            )
        }
        placement_values = {"host": (scope.ref(host),), **placed}
        yield Add(scope.ref(whole), "placements", "system.Placement", placement_values)


def _feature(element: EObject) -> str:
    return "nodes" if isinstance(element, ros.Node) else "components"


def _without(values: Sequence[EObject], others: Sequence[EObject]) -> list[EObject]:
    return [value for value in values if value not in others]


def _follows(whole: system.System, elements: Sequence[EObject], host: system.Host) -> bool:
    """Tells whether elements run on a host without being placed there."""
    is_external = any(
        isinstance(element, jaus.Component) and element.external for element in elements
    )
    return next(iter(whole.hosts), None) is host and not is_external

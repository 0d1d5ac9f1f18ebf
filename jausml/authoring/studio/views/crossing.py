"""Connections across a bridge, between JAUS components and ROS nodes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from jausml.authoring.editing.commands import Add, Command, Set
from jausml.authoring.proposals.bridging import (
    Draft,
    Offer,
    bridges_of,
    fitting,
    is_served,
    lacks_stop,
    offers,
    profile_of,
    qos_of,
    system_of,
)
from jausml.authoring.proposals.elements import Option, Options, Scope
from jausml.authoring.proposals.named_elements import are_examples
from jausml.authoring.proposals.new_elements import name_among
from jausml.authoring.proposals.partition import burden, merits_of
from jausml.authoring.studio.views.spots import Spot
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.names import name_of
from jausml.language.semantics.connections.exchanges import EVENT
from jausml.language.semantics.connections.topics import resolve_topic
from jausml.language.semantics.directions import TO_JAUS, TO_ROS, is_to_ros
from jausml.language.semantics.jaus.services import find_same
from jausml.language.semantics.names import snake_case
from jausml.language.semantics.paths.ros_paths import ros_name


def bridged(scope: Scope, at_jaus: Spot, at_ros: Spot, direction: str) -> Options:
    """Through a bridge that is there, or a new one."""
    whole = system_of(scope)
    owners: Sequence[EObject] = bridges_of(scope) or ([whole] if whole is not None else [])
    if not owners:
        return Options(refusal="the file has no system that could have a bridge")
    refusal = _wrong_end(at_ros, direction)
    if refusal:
        return Options(refusal=refusal)
    if isinstance(at_ros.element, ros.ServiceEndpoint):
        return _call(scope, at_jaus, at_ros, owners[0], direction)
    component = at_jaus.owner
    if not isinstance(component, jaus.Component):
        return Options(refusal="only components speak JAUS")
    wanted = _wanted(component, at_jaus.message, direction)
    if not wanted:
        return Options(refusal=_nothing(component, at_jaus.message, direction))
    owners = sorted(owners, key=lambda owner: burden(owner, component, at_ros.owner))

    def options_at(end: Spot) -> list[Option]:
        return [
            option
            for owner in owners
            for offer in wanted
            for option in _crossings(
                scope, owner, component, offer, end, is_chosen=bool(at_jaus.message)
            )
        ]

    # Where no ready map goes to a new topic, a new map may go to one that is there.
    options = options_at(at_ros) or [
        option for end in _ends_of(at_ros, direction) for option in options_at(end)
    ]
    options.sort(key=_order)
    if options:
        return Options(tuple(options))
    if any(_is_carried(owner, component, offer, at_ros) for owner in owners for offer in wanted):
        return Options(refusal="a connection carries this already")
    node = name_of(at_ros.owner)
    reason = f"no ready map has a message of {name_of(component)}, and {node} has no topic for it"
    return Options(refusal=f"{reason}; add one to {node} first, to which a new map can go")


def _ends_of(at_ros: Spot, direction: str) -> list[Spot]:
    """Returns the topics of a node to which a line goes that leads to the node as a whole."""
    node = at_ros.owner
    if at_ros.element is not None or not isinstance(node, ros.Node):
        return []
    ends = node.subscriptions if direction == TO_ROS else node.publishers
    return [replace(at_ros, element=end) for end in ends]


def through(
    scope: Scope, owner: bridge.Bridge, at_bridge: Spot, at_ros: Spot, direction: str
) -> Options:
    """A connection of a bridge gets a further end at the ROS side."""
    connection, end = at_bridge.element, at_ros.element
    refusal = _wrong_end(at_ros, direction)
    if refusal:
        return Options(refusal=refusal)
    if not isinstance(connection, bridge.Connection):
        return _any_of(scope, owner, at_ros, direction)
    name = name_of(connection)
    kind = connection.map.type if connection.map is not None else None
    if connection.direction.name != direction:
        way = "from JAUS to ROS" if is_to_ros(connection) else "from ROS to JAUS"
        return Options(refusal=f"{name} goes {way}; draw the line the other way round")
    if kind is None:
        return Options(refusal=f"{name} has no map yet; choose one in its form")
    if end is None:
        topic = name_of(connection.topics[0]) if connection.topics else name_of(connection)
        own = profile_of(scope, connection.topics[0]) if connection.topics else {}
        to_ros = direction == TO_ROS
        add = _new_end(scope, owner, at_ros.owner, kind, topic, to_ros=to_ros, qos=own)
        noun = "subscription" if direction == TO_ROS else "publisher"
        label = f"new {noun} of {topic}"
        return Options((Option(label, f"{name} carries it", (add,)),))
    if not isinstance(end, ros.TopicEndpoint):
        return Options(refusal=f"{name_of(end)} is a service; {name} carries messages")
    if end.type is None or ros_name(end.type) != ros_name(kind):
        has = ros_name(end.type) if end.type is not None else "no type"
        text = f"{name_of(end)} has {has}, but {name} carries {ros_name(kind)}"
        return Options(refusal=f"{text}; make a connection of its own, from the component")
    topic = _topic(owner, at_ros.owner, end)
    if any(used_topic.name == topic for used_topic in connection.topics):
        return Options(refusal=f"{name} has the topic {topic} already")
    qos = qos_of(profile_of(scope, end))
    added = Add(scope.ref(connection), "topics", "bridge.Topic", {"name": (topic,)}, qos)
    why = f"both have {ros_name(kind)}"
    return Options((Option(f"topic {topic} of {name_of(connection)}", why, (added,)),))


def carried(scope: Scope, owner: bridge.Bridge, at_jaus: Spot, direction: str) -> Options:
    """Returns options to carry the messages of a component, each ready map on its own topic.

    New maps go to topics of nodes, where a message has no ready one.
    """
    component = at_jaus.owner
    if not isinstance(component, jaus.Component):
        return Options(refusal="only components speak JAUS")
    wanted = _wanted(component, at_jaus.message, direction)
    if not wanted:
        return Options(refusal=_nothing(component, at_jaus.message, direction))
    ready_pairs = [
        (offer, map_)
        for offer in wanted
        for map_ in _ready(scope, offer, None)
        if not _is_mapped(scope, owner, component, map_, direction)
    ]
    options = [_by_ready_map(scope, owner, component, offer, map_) for offer, map_ in ready_pairs]
    options = options or [
        option
        for offer in wanted
        if not any(_ready(scope, offer, None)) and not _is_carried(owner, component, offer)
        for node in scope.model.instances(ros.Node, library=False)
        for end in _ends_of(Spot(node), direction)
        for option in _crossings(
            scope, owner, component, offer, end, is_chosen=bool(at_jaus.message)
        )
    ]
    options.sort(key=_order)
    what = at_jaus.message or f"a message of {name_of(component)}"
    reason = f"no ready map has {what} that {name_of(owner)} does not carry already"
    refusal = f"{reason}; add a topic to a node first, to which a new map can go"
    return Options(tuple(options), "" if options else refusal)


def _wanted(component: jaus.Component, message: str, direction: str) -> list[Offer]:
    """Returns the offers of a component for a direction; of one message where one is named."""
    component_offers = offers(component, direction)
    wanted = [
        offer for offer in component_offers if not message or name_of(offer.message) == message
    ]
    return sorted(wanted, key=_is_echo)


def _is_echo(offer: Offer) -> bool:
    """Tells whether a message reports a former command, which few are interested in."""
    what = name_of(offer.message).removeprefix("Report")
    return any(name_of(message) == f"Set{what}" for message in offer.service.inputs)


def _by_ready_map(
    scope: Scope,
    owner: bridge.Bridge,
    component: jaus.Component,
    offer: Offer,
    map_: bridge.AttributeMap,
) -> Option:
    """Returns the way by a ready map whose end at the ROS side is a topic without a node yet."""
    topics = [topic for connection in owner.bridgeConnections for topic in connection.topics]
    name = name_among(snake_case(name_of(offer.message)), (*owner.bridgeConnections, *topics))
    draft = Draft(offer, component, map_.type, map_, name, name, {})
    return _option(owner, component, draft, draft.commands(scope, owner))


def _is_mapped(
    scope: Scope,
    owner: bridge.Bridge,
    component: jaus.Component,
    map_: bridge.AttributeMap,
    direction: str,
) -> bool:
    """Tells whether a bridge has a connection of a component by a map already."""
    return any(
        scope.ref(bridge_connection.map) == scope.ref(map_)
        and bridge_connection.direction.name == direction
        and (not bridge_connection.peers or component in bridge_connection.peers)
        for bridge_connection in owner.bridgeConnections
    )


def further_peer(scope: Scope, at_jaus: Spot, at_bridge: Spot, direction: str) -> Options:
    """A connection of a bridge gets a further peer."""
    connection, peer = at_bridge.element, at_jaus.owner
    if not isinstance(connection, bridge.Connection) or not isinstance(peer, jaus.Component):
        return Options(refusal="draw to a connection of the bridge")
    name = name_of(connection)
    if connection.direction.name != direction:
        way = "to ROS" if is_to_ros(connection) else "to JAUS"
        return Options(refusal=f"{name} goes {way}; draw the line the other way round")
    if any(component is peer for component in connection.peers):
        return Options(refusal=f"{name_of(peer)} is a peer of {name} already")
    message = connection.map.message if connection.map is not None else None
    if message is None:
        return Options(refusal=f"{name} has no map yet; choose one in its form")
    fits = [
        offer
        for offer in offers(peer, direction)
        if find_same(message, [offer.message]) is not None
    ]
    if not fits:
        return Options(refusal=_nothing(peer, name_of(message), direction))
    peers = (*(scope.ref(component) for component in connection.peers), scope.ref(peer))
    option = Option(
        f"{name_of(peer)} as peer of {name_of(connection)}",
        fits[0].why(name_of(peer)),
        (Set(scope.ref(connection), "peers", peers),),
    )
    return Options((option,))


def _nothing(component: jaus.Component, message: str, direction: str) -> str:
    verb = "sends" if direction == TO_ROS else "takes"
    if message:
        return f"{name_of(component)} {verb} no {message}"
    reason = f"{name_of(component)} provides and uses no service with a message that it {verb}"
    return f"{reason}; add a service to it first"


def _any_of(scope: Scope, owner: bridge.Bridge, at_ros: Spot, direction: str) -> Options:
    """Returns the messages of all components of the system for an end, through one bridge."""
    peers = [
        component
        for component in scope.model.instances(jaus.Component, library=False)
        if not isinstance(component, bridge.Bridge)
    ]
    options = [
        option
        for peer in peers
        for offer in offers(peer, direction)
        for option in _crossings(scope, owner, peer, offer, at_ros)
    ]
    options.sort(key=_order)
    if options:
        return Options(tuple(options))
    return Options(refusal="no component has a message for this end; add one with a service")


def _crossings(
    scope: Scope,
    owner: EObject,
    component: jaus.Component,
    offer: Offer,
    at_ros: Spot,
    *,
    is_chosen: bool = False,
) -> Iterator[Option]:
    """Yields the ways of one message: by each ready map, and by a new one.

    The runtime itself takes care of messages of core services, unless one of them is chosen.
    """
    end = at_ros.element
    if isinstance(end, ros.TopicEndpoint) and _is_carried(owner, component, offer, at_ros):
        return
    kind = end.type if isinstance(end, ros.TopicEndpoint) else None
    for map_ in _ready(scope, offer, kind):
        yield _crossing(scope, owner, component, offer, map_.type, map_, at_ros)
    if kind is not None and (is_chosen or not is_served(offer.service)):
        yield _crossing(scope, owner, component, offer, kind, None, at_ros)


def _ready(
    scope: Scope, offer: Offer, kind: ros.MessageType | None
) -> Iterator[bridge.AttributeMap]:
    """Yields the ready maps of a message to topics, of a type if one is given.

    Without those of the library that know joints by invented names: they drop each message.
    """
    for map_ in fitting(scope, offer.message, kind, to_ros=offer.to_ros):
        is_topic = isinstance(map_.type.eContainer(), ros.InterfacePackage)
        if is_topic and not (map_.reportJoins and offer.to_ros) and not are_examples(map_):
            yield map_


def _crossing(
    scope: Scope,
    owner: EObject,
    component: jaus.Component,
    offer: Offer,
    kind: ros.MessageType,
    map_: bridge.AttributeMap | None,
    at_ros: Spot,
) -> Option:
    end = at_ros.element
    name = snake_case(name_of(end if end is not None else offer.message))
    topic = _topic(owner, at_ros.owner, end) if isinstance(end, ros.TopicEndpoint) else name
    qos = profile_of(scope, end) if isinstance(end, ros.TopicEndpoint) else {}
    draft = Draft(offer, component, kind, map_, topic, name, qos)
    commands = draft.commands(scope, owner)
    if not isinstance(end, ros.TopicEndpoint):
        commands.append(_new_end(scope, owner, at_ros.owner, kind, topic, to_ros=offer.to_ros))
    return _option(owner, component, draft, commands, at_ros.owner)


def _option(
    owner: EObject,
    component: jaus.Component,
    draft: Draft,
    commands: Sequence[Command],
    node: EObject | None = None,
) -> Option:
    """Returns a draft as an option: the message, the map, and the reason."""
    offer, map_ = draft.offer, draft.map
    how = f"ready map {name_of(map_)}" if map_ is not None else "new map"
    bridged = name_of(owner) if isinstance(owner, bridge.Bridge) else "a new bridge"
    why = f"{offer.why(name_of(component))}; {_style(offer)} through {bridged}"
    if node is not None and (merits := merits_of(owner, component, node)):
        why += f", which {' and '.join(merits)}"
    if map_ is not None and lacks_stop(offer, map_):
        why += "; nothing stops it when its source is lost: that is for you to decide"
    label = f"{name_of(offer.message)} by {how} ({ros_name(draft.type)})"
    return Option(label, why, commands)


def _is_carried(
    owner: EObject, component: jaus.Component, offer: Offer, at_ros: Spot | None = None
) -> bool:
    """Tells whether a bridge has a connection of these ends, or of the message on any topic."""
    if not isinstance(owner, bridge.Bridge):
        return False
    topic = ""
    if at_ros is not None:
        if not isinstance(at_ros.element, ros.TopicEndpoint):
            return False
        topic = _topic(owner, at_ros.owner, at_ros.element)
    return any(
        bridge_connection.direction.name == offer.direction
        and bridge_connection.map is not None
        and bridge_connection.map.message is not None
        and find_same(offer.message, [bridge_connection.map.message]) is not None
        and (not bridge_connection.peers or component in bridge_connection.peers)
        and (not topic or any(carried.name == topic for carried in bridge_connection.topics))
        for bridge_connection in owner.bridgeConnections
    )


def _order(option: Option) -> tuple[bool, bool]:
    return ("new map" in option.label, "holds" in option.why)


def _style(offer: Offer) -> str:
    if offer.exchange == EVENT:
        return "asked for as a periodic event" if offer.to_ros else "reported to whoever asks"
    return "as messages"


def _wrong_end(at_ros: Spot, direction: str) -> str:
    end = at_ros.element
    if isinstance(end, ros.Publisher) and direction == TO_ROS:
        return f"{name_of(end)} publishes; draw from it to what shall get its messages"
    if isinstance(end, ros.Subscription) and direction == TO_JAUS:
        return f"{name_of(end)} subscribes; draw to it from what sends it messages"
    return ""


def _topic(owner: EObject, node: EObject, end: ros.TopicEndpoint) -> str:
    """Returns how a bridge names the topic of an endpoint."""
    if end.topic:
        return seen_from(owner, node, str(end.topic))
    return resolve_topic(name_of(end), namespace_of(node), name_of(node))


def namespace_of(node: EObject) -> str:
    """Returns the namespace of a node or bridge, empty for none."""
    return str(getattr(node, "namespace", "") or "")


def seen_from(node: EObject, other: EObject, name: str) -> str:
    """Returns how a node or bridge names what another names so."""
    is_same = namespace_of(node).strip("/") == namespace_of(other).strip("/")
    if name.startswith("/") or (is_same and not name.startswith("~")):
        return name
    return resolve_topic(name, namespace_of(other), name_of(other))


def _new_end(
    scope: Scope,
    owner: EObject,
    node: EObject,
    kind: ros.MessageType,
    topic: str,
    *,
    to_ros: bool,
    qos: Mapping[str, str] | None = None,
) -> Add:
    """Returns the command that gives a node the end of a topic, which its bridge names so."""
    feature, cls = (
        ("subscriptions", "ros.Subscription") if to_ros else ("publishers", "ros.Publisher")
    )
    name = name_among(topic.rpartition("/")[2], getattr(node, feature))
    own = seen_from(node, owner, topic)
    values = {"name": (name,), "topic": (own,), "type": (scope.ref(kind),)}
    return Add(scope.ref(node), feature, cls, values, qos_of(qos or {}))


def _call(scope: Scope, at_jaus: Spot, at_ros: Spot, owner: EObject, direction: str) -> Options:
    """A ROS service whose calls a bridge makes JAUS messages of, or the other way round."""
    end: Any = at_ros.element
    serves = isinstance(end, ros.ServiceServer)
    if serves is not (direction == TO_ROS):
        verb = "serves calls" if serves else "calls"
        return Options(refusal=f"{name_of(end)} {verb}; draw the line the other way round")
    if not isinstance(owner, bridge.Bridge):
        return Options(refusal="a ROS service needs a bridge; add one first")
    if end.type is None:
        return Options(refusal=f"{name_of(end)} has no type yet; choose one in its form")
    values = {
        "name": (name_among(name_of(end), owner.serviceConnections),),
        "service": (seen_from(owner, at_ros.owner, str(end.service or name_of(end))),),
        "type": (scope.ref(end.type),),
        "direction": (direction,),
    }
    if direction == TO_JAUS:
        values["peers"] = (scope.ref(at_jaus.owner),)
    add = Add(scope.ref(owner), "serviceConnections", "bridge.RosServiceConnection", values)
    label = f"calls of {name_of(end)} through {name_of(owner)}"
    why = "choose the JAUS message that asks, and the answer, in its form"
    return Options((Option(label, why, (add,)),))

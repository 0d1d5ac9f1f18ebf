"""Connections of bridges as commands, by ready maps or by new ones."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace

from jausml.authoring.editing.commands import NEW, Add, Child, Command, Set, with_created
from jausml.authoring.editing.describing import described
from jausml.authoring.proposals.elements import Scope, literal, values_of
from jausml.authoring.proposals.new_elements import free_address, name_among, participant_name
from jausml.language.metamodel.classes import bridge, jaus, ros, system
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.names import name_of
from jausml.language.semantics.connections.exchanges import EVENT, MESSAGE
from jausml.language.semantics.directions import TO_JAUS, TO_ROS
from jausml.language.semantics.jaus.commands import is_command, is_emergency
from jausml.language.semantics.jaus.core_services import SERVED_BY_RUNTIME
from jausml.language.semantics.jaus.inheritance import lineage, with_inherited
from jausml.language.semantics.jaus.services import (
    ACCESS_CONTROL,
    code,
    find_same,
    provides_access_control,
    query_name,
    signature,
)
from jausml.language.semantics.paths.ros_paths import ros_name

_QUERY = "Query"

_MADE = re.compile(rf"{re.escape(NEW)}(\d+)")


@dataclass(frozen=True)
class Offer:
    """A message that a component sends or takes, and how.

    `is_provided`: whether the component provides the service; else it uses it, and the bridge has
    to provide it.
    """

    message: jaus.MessageDef
    service: jaus.Service
    direction: str
    exchange: str
    is_provided: bool

    @property
    def to_ros(self) -> bool:
        """Whether it goes to ROS."""
        return self.direction == TO_ROS

    def why(self, component: str) -> str:
        """Returns why the component and a bridge can exchange it."""
        name = name_of(self.message)
        verb = "provides" if self.is_provided else "uses"
        says = f"{component} {verb} {name_of(self.service)}"
        if self.is_provided:
            return f"{says}, which {'sends' if self.to_ros else 'takes'} {name}"
        return f"{says}; the bridge provides it and {'takes' if self.to_ros else 'reports'} {name}"


def offers(component: jaus.Component, direction: str) -> Iterator[Offer]:
    """Yields the messages that a component can exchange with a bridge in a direction.

    Queries are asked by the bridge itself and not translated. `direction`: `jausToRos` or
    `rosToJaus`.
    """
    for is_provided, services in ((True, component.provides), (False, component.uses)):
        for service in with_inherited(services):
            is_output = is_provided is (direction == TO_ROS)
            for message in service.outputs if is_output else service.inputs:
                if message.code and not (message.name or "").startswith(_QUERY):
                    yield Offer(
                        message, service, direction, _exchange(message, service), is_provided
                    )


def offer_of(message: jaus.MessageDef, *, to_ros: bool) -> Offer | None:
    """Returns how a bridge exchanges a message with a component; None for one without a service."""
    service = message.eContainer()
    if not isinstance(service, jaus.Service):
        return None
    is_provided = (message in service.outputs) is to_ros
    direction = TO_ROS if to_ros else TO_JAUS
    return Offer(message, service, direction, _exchange(message, service), is_provided)


def _exchange(message: jaus.MessageDef, service: jaus.Service) -> str:
    """Reports that can be asked for cross by events, all else by messages."""
    wanted = query_name(message)
    asked = any(query.name == wanted for ancestor in lineage(service) for query in ancestor.inputs)
    return EVENT if message in service.outputs and asked else MESSAGE


def is_served(service: jaus.Service) -> bool:
    """Tells whether the runtime takes care of a service by itself."""
    return str(service.urn) in SERVED_BY_RUNTIME


@dataclass(frozen=True)
class Draft:
    """A connection of a bridge that is to be.

    Attributes:
        peer: The component at the JAUS side, None for whoever it is.
        joins: Topics of the joins of the map by the names of these.
        hold: Why the last command may stand when its source is lost, as a person says it.
        is_own: Whether the bridge itself is the peer.
    """

    offer: Offer
    peer: jaus.Component | None
    type: ros.MessageType
    map: bridge.AttributeMap | None
    topic: str
    name: str
    qos: Mapping[str, str]
    joins: Mapping[str, str] = field(default_factory=dict)
    hold: str = ""
    is_own: bool = False

    def commands(self, scope: Scope, owner: EObject) -> list[Command]:
        """Returns the commands that make the connection."""
        changes: list[Command] = []
        if isinstance(owner, bridge.Bridge):
            place = scope.ref(owner)
            changes += with_service(scope, owner, self.offer)
        else:
            place = f"{NEW}{0}"
            changes.append(_new_bridge(scope, owner, self.offer))
        map_ref = scope.ref(self.map)
        if self.map is None:
            map_ref = f"{NEW}{sum(isinstance(change, Add) for change in changes)}"
            changes.append(self._new_map(scope, owner, place))
        siblings = owner.bridgeConnections if isinstance(owner, bridge.Bridge) else ()
        changes.append(self.connection(scope, place, map_ref, siblings))
        return changes

    def _new_map(self, scope: Scope, owner: EObject, place: str) -> Add:
        maps = owner.maps if isinstance(owner, bridge.Bridge) else ()
        values = {
            "name": (name_among(self.name, maps),),
            "message": (scope.ref(self.offer.message),),
            "type": (scope.ref(self.type),),
        }
        return Add(place, "maps", "bridge.AttributeMap", values)

    def connection(
        self, scope: Scope, place: str, map_ref: str, siblings: Iterable[EObject] = ()
    ) -> Add:
        """Returns the command that adds the connection alone.

        `place`: ref of the bridge that shall have it; empty for one that is made with it.
        """
        values: dict[str, tuple[str, ...]] = {
            "name": (name_among(self.name, siblings),),
            "map": (map_ref,),
        }
        if not self.offer.to_ros or is_emergency(self.offer.message):
            values["direction"] = (self.offer.direction,)
        if self.offer.exchange != MESSAGE:
            values["exchange"] = (self.offer.exchange,)
        if self.hold:
            values |= {"onSilence": ("hold",), "holdReason": (self.hold,)}
        inner: list[Child] = []
        if self.is_own:
            values["peers"] = (place,)
        elif self.peer is not None and self._names_peer:
            values["peers"] = (scope.ref(self.peer),)
        elif self._names_peer and self.offer.is_provided:
            searched = {"services": (scope.ref(self.offer.service),)}
            inner.append(Child("search", "jaus.PeerSearch", searched))
        is_commanded = not self.offer.to_ros and is_command(self.offer.message)
        if is_commanded and not can_control(self.peer, self.offer.service):
            values["control"] = ("false",)
        inner += self._topics(scope)
        return Add(place, "bridgeConnections", "bridge.Connection", values, tuple(inner))

    def _topics(self, scope: Scope) -> Iterator[Child]:
        """Yields the topic, and those that feed the joins of the map."""
        yield self._topic(self.topic, self.qos)
        if self.map is not None and not self.offer.to_ros:
            for join in self.map.joins:
                if topic := self.joins.get(name_of(join)) or needed_topic(join):
                    yield self._topic(topic, {}, scope.ref(join))

    @staticmethod
    def _topic(name: str, qos: Mapping[str, str], join: str = "") -> Child:
        values = {"name": (name,), **({"join": (join,)} if join else {})}
        return Child("topics", "bridge.Topic", values, qos_of(qos))

    @property
    def _names_peer(self) -> bool:
        """A bridge reports to whoever asks."""
        return self.offer.is_provided or self.offer.to_ros


def map_commands(
    scope: Scope, owner: EObject, map_: bridge.AttributeMap, *, to_ros: bool
) -> list[Command]:
    """Returns the commands for a bridge to carry a map, whose other end is found when it runs."""
    offer = offer_of(map_.message, to_ros=to_ros)
    if offer is None:
        return []
    name = name_of(map_)
    peer = peer_of(scope, offer) if offer.is_provided else None
    draft = Draft(offer, peer, map_.type, map_, name, name, {})
    return draft.commands(scope, owner)


def peer_of(scope: Scope, offer: Offer) -> jaus.Component | None:
    """Returns the first component of the file that has a message at the other end."""
    for component in scope.model.instances(jaus.Component, library=False):
        if isinstance(component, bridge.Bridge):
            continue
        for offered in offers(component, offer.direction):
            if offered.is_provided and name_of(offered.message) == name_of(offer.message):
                return component
    return None


def bridges_of(scope: Scope) -> list[bridge.Bridge]:
    """Returns the bridges of the file that was asked for."""
    own = scope.model.documents[0]
    bridges = scope.model.instances(bridge.Bridge, library=False)
    return [
        model_bridge for model_bridge in bridges if scope.model.document_of(model_bridge) is own
    ]


def system_of(scope: Scope) -> system.System | None:
    """Returns the system of the file that was asked for."""
    systems = (root for root in scope.model.documents[0].roots if isinstance(root, system.System))
    return next(systems, None)


def can_control(peer: jaus.Component | None, service: jaus.Service | None) -> bool:
    """Tells whether a peer grants control; None is one that is found by a service."""
    if peer is not None:
        return provides_access_control(peer)
    return any(ancestor.name == ACCESS_CONTROL for ancestor in lineage(service))


def lacks_stop(offer: Offer, map_: bridge.AttributeMap) -> bool:
    """Tells whether a command that moves the vehicle has no stop in a map, for a lost source.

    So it is with an emergency: what ends it, a person has to say.
    """
    message = offer.message
    if is_emergency(message):
        return True
    moves = offer.exchange == MESSAGE and is_command(message) and message.moves
    return moves and (map_.stopRos if offer.to_ros else map_.stopJaus) is None


def needed_topic(join: bridge.Join) -> str:
    """Returns a topic for a join that cannot do without; empty where its fields are left out."""
    return "" if join.whenStale.name == "leave" else name_of(join)


def qos_of(profile: Mapping[str, str]) -> tuple[Child, ...]:
    """Returns the quality of service of an end as its part; nothing where none is stated."""
    stated = {feature: (value,) for feature, value in profile.items()}
    return (Child("qos", "ros.QoSProfile", stated),) if stated else ()


def profile_of(scope: Scope, end: ros.TopicEndpoint | bridge.Topic) -> dict[str, str]:
    """Returns the quality of service of an endpoint, as far as it is stated."""
    if end.qos is None:
        return {}
    table = scope.model.metamodels.class_of(end.qos)
    return {
        name: literal(values[0])
        for name, feature in table.features.items()
        if (values := values_of(end.qos, feature))
    }


def with_service(scope: Scope, owner: bridge.Bridge, offer: Offer) -> list[Command]:
    """Returns the commands by which a bridge provides or uses the service of a message."""
    feature = "uses" if offer.is_provided else "provides"
    known = list(getattr(owner, feature))
    if has_message(known, offer.message):
        return []
    values = tuple(scope.ref(service) for service in known)
    return [Set(scope.ref(owner), feature, (*values, scope.ref(offer.service)))]


def has_message(services: Iterable[jaus.Service], message: jaus.MessageDef) -> bool:
    """Tells whether services, or those that they inherit, have a message."""
    reached = with_inherited(services)
    messages = [output for service in reached for output in (*service.inputs, *service.outputs)]
    return find_same(message, messages) is not None


def _new_bridge(scope: Scope, owner: EObject, offer: Offer) -> Add:
    feature = "uses" if offer.is_provided else "provides"
    values = {
        "name": (participant_name("bridge", owner),),
        "address": (free_address(scope.model),),
        feature: (scope.ref(offer.service),),
    }
    return Add(scope.ref(owner), "bridges", "bridge.Bridge", values)


def between(
    scope: Scope, message: jaus.MessageDef, kind: ros.MessageType
) -> list[bridge.AttributeMap]:
    """Returns the maps between a message and a type, whatever their directions.

    One of the library gives way to one of its name in the project, which is mostly a copy.
    """
    fitting_maps = (fitting(scope, message, kind, to_ros=way) for way in (True, False))
    attribute_maps = dict.fromkeys(attribute_map for way in fitting_maps for attribute_map in way)
    by_name: dict[str, bridge.AttributeMap] = {}
    for attribute_map in scope.instances(bridge.AttributeMap):
        if attribute_map in attribute_maps:
            by_name.setdefault(name_of(attribute_map), attribute_map)
    return list(by_name.values())


def shifted(commands: Iterable[Command], by: int) -> list[Command]:
    """Returns commands whose refs to what they make hold behind others in a batch."""

    def known(ref: str) -> str:
        return _MADE.sub(lambda match: f"{NEW}{int(match[1]) + by}", ref, count=1)

    return [with_created(command, known) for command in commands]  # type: ignore[arg-type]


def copied(
    scope: Scope, place: str, map_: bridge.AttributeMap, name: str, *, first: int = 0
) -> list[Command]:
    """Returns the commands that copy a map, with its tables, quantities and vectors.

    `place`: ref of the bridge that shall have it. `first`: the number of elements that are made
    before.
    """
    described_map = described([(map_, scope.model_of(map_))], lambda element, _: scope.ref(element))
    return [
        replace(change, owner=place, feature="maps", values={**change.values, "name": (name,)})
        if isinstance(change, Add) and not change.owner
        else change
        for change in shifted(described_map, first)
    ]


def fitting(
    scope: Scope, message: jaus.MessageDef, kind: ros.MessageType | None, *, to_ros: bool
) -> list[bridge.AttributeMap]:
    """Returns the maps between a message and a type that have assignments for a direction.

    `kind`: the ROS type, None for any.
    """
    return [
        attribute_map
        for attribute_map in scope.instances(bridge.AttributeMap)
        if attribute_map.message is not None
        and attribute_map.type is not None
        and (attribute_map.toRos if to_ros else attribute_map.toJaus)
        and code(attribute_map.message) == code(message)
        and signature(attribute_map.message) == signature(message)
        and (kind is None or ros_name(attribute_map.type) == ros_name(kind))
    ]

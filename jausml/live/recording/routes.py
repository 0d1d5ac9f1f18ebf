"""Routes: which message of JAUS becomes which topic, by the bridges of a model.

A recording has what a bridge took and what it sent. So a route goes from each message that a bridge
takes to its topics, and from each that it sends back to the topics from which that came, where the
map has that direction too.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.generation.system import system_of
from jausml.language.metamodel.classes import bridge, system
from jausml.language.model.model import made_model
from jausml.language.semantics.connections.exchanges import TO_ROS
from jausml.language.semantics.connections.report_joins import joined_reports
from jausml.language.semantics.connections.topics import endpoints
from jausml.language.semantics.jaus.services import code
from jausml.live.recording.type_definitions import full_name, modelled_definition
from jausml.live.workers.bridge_code import Maker
from jausml_generators.bridge.views import bridge_views
from jausml_generators.common.components import own_bridges

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.language.metamodel.classes import jaus
    from jausml.language.model import Model
    from jausml_generators.bridge.views import BridgeView

Addresses = frozenset[str]
"""JAUS ids; none means that of anybody."""


@dataclass(frozen=True)
class RecordedTopic:
    """A topic of a recording.

    Attributes:
        type: Full name of its type, e.g. `nav_msgs/msg/Odometry`.
    """

    name: str
    type: str
    definition: str


@dataclass(frozen=True)
class RouteJoin:
    """A joined report of a route.

    Attributes:
        senders: Whose reports are meant; those of the subsystem of the main message by default.
        freshness: Seconds after which the latest report is stale.
        drop: Whether nothing is made without a fresh one.
    """

    name: str
    code: int
    senders: Addresses
    freshness: float
    drop: bool


@dataclass(frozen=True)
class Route:
    """A way of a JAUS message to topics."""

    label: str
    package: str
    base: str
    bridge: str
    connection: str
    code: int
    senders: Addresses
    topics: tuple[RecordedTopic, ...]
    joins: tuple[RouteJoin, ...]


@dataclass(frozen=True)
class Routes:
    """The routes of a model, and the model of bridges that have these routes alone."""

    model: Model
    routes: list[Route]


def routes_of(model: Model) -> Routes:
    """Returns the routes of a model: those of its bridges, or of all its maps when it has none.

    Args:
        model: A model without errors, of which nobody makes anything else: its bridges are changed.

    Raises:
        NoSystemError: It has several systems.
    """
    roots = model.documents[0].roots
    if not any(isinstance(root, system.System) for root in roots):
        model = _of_maps(model)
    sent: dict[bridge.Connection, Addresses] = {}
    for owner in own_bridges(system_of(model)):
        sent.update(_turn(model, owner))
    return Routes(model, [each for view in bridge_views(model) for each in _routes(view, sent)])


def _of_maps(model: Model) -> Model:
    """Makes a model with a bridge that has a connection for each map to ROS."""
    make = Maker(model.metamodels)
    owner = make("bridge.Bridge", name="maps", address="1.1.1")
    whole = make("system.System", name="replay")
    make.own(whole, "bridges", owner)
    libraries = [each for each in model.documents[0].roots if isinstance(each, bridge.MapLibrary)]
    for used in (each for library in libraries for each in library.maps):
        if used.toRos and used.message is not None and used.type is not None:
            make.own(owner, "bridgeConnections", _to_ros(make, used, used.name, [str(used.name)]))
    return made_model(model.metamodels, whole, owner)


def _to_ros(
    make: Maker, used: bridge.AttributeMap, name: str | None, topics: Iterable[str]
) -> bridge.Connection:
    found: bridge.Connection = make("bridge.Connection", name=str(name), direction=TO_ROS)
    make.refer(found, "map", used)
    for topic in topics:
        make.own(found, "topics", make("bridge.Topic", name=topic))
    return found


def _turn(model: Model, owner: bridge.Bridge) -> dict[bridge.Connection, Addresses]:
    """Leaves a bridge the connections to ROS, and makes such of others whose map can be turned.

    Returns:
        The made ones, with the address of the bridge, which sent their messages.
    """
    editable: Any = owner  # its collections are those of pyecore
    editable.serviceConnections.clear()
    editable.actionConnections.clear()
    make = Maker(model.metamodels)
    kept = [each for each in owner.bridgeConnections if _is_to_ros(each)]
    others = [each for each in owner.bridgeConnections if not _is_to_ros(each)]
    used = {each.map for each in kept}
    made = {}
    for each in others:
        editable.bridgeConnections.remove(each)
        if each.map not in used and each.map.toRos:
            used.add(each.map)
            topics = [str(topic.name) for topic in each.topics if topic.join is None]
            turned = _to_ros(make, each.map, each.name, topics)
            make.own(owner, "bridgeConnections", turned)
            made[turned] = frozenset({str(owner.address)})
    return made


def _is_to_ros(connection: bridge.Connection) -> bool:
    return bool(connection.direction.name == TO_ROS)


def _routes(view: BridgeView, sent: dict[bridge.Connection, Addresses]) -> Iterator[Route]:
    topics: dict[object, list[RecordedTopic]] = {}
    for end in endpoints([view.bridge]):
        topic = RecordedTopic(end.topic, full_name(end.type), modelled_definition(end.type))
        topics.setdefault(end.element.eContainer(), []).append(topic)
    for connection, made in zip(view.bridge.bridgeConnections, view.connections, strict=True):
        yield Route(
            label=f"{view.name}.{connection.name}",
            package=view.package,
            base=view.base_name,
            bridge=view.class_name,
            connection=made.name,
            code=code(connection.map.message),
            senders=sent.get(connection) or _addresses(connection.peers),
            topics=tuple(topics.get(connection, ())),
            joins=tuple(_joins(connection)),
        )


def _joins(connection: bridge.Connection) -> Iterator[RouteJoin]:
    for each in joined_reports(connection):
        named = each.source.peers if each.source is not None else ()
        yield RouteJoin(
            name=str(each.join.name),
            code=code(each.join.message),
            senders=_addresses(named),
            freshness=each.join.freshness,
            drop=each.join.whenStale.name == "dropMessage",
        )


def _addresses(peers: Iterable[jaus.Component]) -> Addresses:
    return frozenset(str(each.address) for each in peers)

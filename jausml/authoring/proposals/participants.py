"""New bridges, components and nodes as commands."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import NEW, Add, Child, Set
from jausml.authoring.proposals.bridging import Draft, has_message, peer_of
from jausml.authoring.proposals.elements import service_of, type_of
from jausml.authoring.proposals.fresh import free_name, stated_or_free_address
from jausml.authoring.proposals.named_elements import copied_with_names
from jausml.authoring.proposals.topics import joins_of
from jausml.language.model.names import name_of
from jausml.language.semantics.names import snake_case

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jausml.authoring.editing.commands import Command
    from jausml.authoring.proposals.elements import Scope
    from jausml.authoring.proposals.topics import Crossing, TopicEnd
    from jausml.language.metamodel.classes import bridge, system


def new_bridge(
    scope: Scope,
    whole: system.System,
    name: str,
    chosen: Sequence[Crossing],
    *,
    topics: Sequence[TopicEnd] = (),
    address: str = "",
) -> list[Command]:
    """Returns what makes a bridge with a connection for each chosen way.

    Args:
        topics: All topics, which may feed the joins of maps.
        address: Its JAUS id; empty for one that is free.
    """
    values: dict[str, tuple[str, ...]] = {
        "name": (name,),
        "address": (stated_or_free_address(scope.model, address),),
    }
    for feature, is_used in (("provides", False), ("uses", True)):
        services = [each.offer.service for each in chosen if each.offer.is_provided is is_used]
        if services:
            values[feature] = tuple(dict.fromkeys(map(scope.ref, services)))
    made = Add(scope.ref(whole), "bridges", "bridge.Bridge", values)
    return [made, *_connections(scope, f"{NEW}0", chosen, topics, first=1)]


def new_connections(
    scope: Scope, owner: bridge.Bridge, chosen: Sequence[Crossing], topics: Sequence[TopicEnd] = ()
) -> list[Command]:
    """Returns what adds a connection for each chosen way to a bridge, and the services of them."""
    place = scope.ref(owner)
    made: list[Command] = []
    for feature, is_used in (("provides", False), ("uses", True)):
        known = list(getattr(owner, feature))
        wanted = [each.offer for each in chosen if each.offer.is_provided is is_used]
        missing = [each.service for each in wanted if not has_message(known, each.message)]
        if missing:
            refs = (scope.ref(each) for each in (*known, *missing))
            made.append(Set(place, feature, tuple(dict.fromkeys(refs))))
    return [*made, *_connections(scope, place, chosen, topics, owner)]


def _connections(
    scope: Scope,
    place: str,
    chosen: Sequence[Crossing],
    topics: Sequence[TopicEnd],
    owner: bridge.Bridge | None = None,
    *,
    first: int = 0,
) -> list[Command]:
    """Returns what makes a connection for each way, with the copies of maps that it needs.

    Args:
        owner: The bridge at the place, None for a new one.
        first: The number of elements that are made before.
    """
    found: list[Command] = []
    names = [name_of(each) for each in owner.bridgeConnections] if owner is not None else []
    maps = [name_of(each) for each in owner.maps] if owner is not None else []
    fed: set[str] = set()
    for each in chosen:
        used = scope.ref(each.map)
        if each.has_own_map:
            maps.append(free_name(f"{each.topic.name}_{name_of(each.map)}", maps))
            before = first + sum(isinstance(one, Add) for one in found)
            used = f"{NEW}{before}"
            found += copied_with_names(
                scope, place, each.map, maps[-1], each.names, each.frames, first=before
            )
        names.append(free_name(_connection_name(each, chosen, names), names))
        draft = Draft(
            each.offer,
            peer_of(scope, each.offer) if each.offer.is_provided else None,
            each.map.type,
            each.map,
            each.topic.name,
            names[-1],
            each.qos,
            joins_of(each, topics, fed),
            each.hold_reason,
        )
        found.append(draft.connection(scope, place, used))
    return found


def _connection_name(crossing: Crossing, chosen: Sequence[Crossing], taken: Sequence[str]) -> str:
    """Returns the name of a connection: its topic's, or its map's where a topic has several."""
    own = snake_case(crossing.topic.name)
    is_shared = sum(each.topic.name == crossing.topic.name for each in chosen) > 1
    return snake_case(name_of(crossing.map)) if is_shared or own in taken else own


def new_component(
    scope: Scope,
    whole: system.System,
    name: str,
    *,
    provides: Iterable[str] = (),
    uses: Iterable[str] = (),
    address: str = "",
    simulated: bool = False,
) -> Add:
    """Returns what makes a component."""
    values: dict[str, tuple[str, ...]] = {
        "name": (name,),
        "address": (stated_or_free_address(scope.model, address),),
    }
    for feature, words in (("provides", provides), ("uses", uses)):
        services = [service_of(scope, each) for each in words]
        if services:
            values[feature] = tuple(dict.fromkeys(map(scope.ref, services)))
    if simulated:
        values["simulated"] = ("true",)
    return Add(scope.ref(whole), "components", "jaus.Component", values)


def new_node(
    scope: Scope,
    whole: system.System,
    name: str,
    *,
    publishes: Iterable[tuple[str, str]] = (),
    subscribes: Iterable[tuple[str, str]] = (),
) -> Add:
    """Returns what makes a node of ROS."""
    ends: list[Child] = []
    for feature, kind, topics in (
        ("publishers", "ros.Publisher", publishes),
        ("subscriptions", "ros.Subscription", subscribes),
    ):
        names: list[str] = []
        for topic, word in topics:
            names.append(free_name(topic, names))
            type_ = scope.ref(type_of(scope, word))
            values = {"name": (names[-1],), "topic": (topic,), "type": (type_,)}
            ends.append(Child(feature, kind, values))
    return Add(scope.ref(whole), "nodes", "ros.Node", {"name": (name,)}, tuple(ends))

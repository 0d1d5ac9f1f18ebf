"""Whole bridges as commands: made of the ways that were chosen for topics."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.editing.commands import Add, Child
from jausml.model.names import name_of
from jausml.model.words import snake_case
from jausml.proposals.bridging import Draft, peer_of
from jausml.proposals.fresh import free_address, free_name
from jausml.proposals.topics import joins_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.metamodel.classes import system
    from jausml.proposals.elements import Scope
    from jausml.proposals.topics import Crossing, TopicEnd


def new_bridge(
    scope: Scope,
    whole: system.System,
    name: str,
    chosen: Sequence[Crossing],
    *,
    topics: Sequence[TopicEnd] = (),
    address: str = "",
) -> Add:
    """Returns what makes a bridge with a connection for each chosen way.

    Args:
        scope: The model.
        whole: The system that shall have it.
        name: Its name.
        chosen: The ways.
        topics: All topics, which may feed the joins of maps.
        address: Its JAUS id; empty for one that is free.
    """
    values: dict[str, tuple[str, ...]] = {
        "name": (name,),
        "address": (address or free_address(scope.model),),
    }
    for feature, is_used in (("provides", False), ("uses", True)):
        services = [each.offer.service for each in chosen if each.offer.is_provided is is_used]
        if services:
            values[feature] = tuple(dict.fromkeys(map(scope.ref, services)))
    connections: list[Child] = []
    names: list[str] = []
    fed: set[str] = set()
    for each in chosen:
        names.append(free_name(_connection_name(each, chosen), names))
        draft = Draft(
            each.offer,
            peer_of(scope, each.offer) if each.offer.is_provided else None,
            each.map.type,
            each.map,
            each.topic.name,
            names[-1],
            each.qos,
            joins_of(each, topics, fed),
            each.hold,
        )
        made = draft.connection(scope, "", scope.ref(each.map))
        connections.append(Child(made.feature, made.kind, made.values, made.children))
    return Add(scope.ref(whole), "bridges", "bridge.Bridge", values, tuple(connections))


def _connection_name(crossing: Crossing, chosen: Sequence[Crossing]) -> str:
    """Returns the name of a connection: its topic's, or its map's where a topic has several."""
    is_shared = sum(each.topic.name == crossing.topic.name for each in chosen) > 1
    return snake_case(name_of(crossing.map) if is_shared else crossing.topic.name)

"""Ties: connections that no two bridges can share, and why."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Iterable, Iterator
from typing import TypeAlias

from jausml.language.metamodel.classes import bridge, jaus
from jausml.language.semantics.connections.reports import joined_reports
from jausml.language.semantics.connections.topics import resolve_topic
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.commands import needs_control
from jausml.language.semantics.jaus.inheritance import lineage
from jausml.language.semantics.jaus.services import code
from jausml.language.semantics.paths.scopes import Carrier, carriers_of
from jausml.views.analysis.streams import is_single, keeps_control

Tie: TypeAlias = "tuple[Hashable, str]"
"""A property that connections have in common, and its words."""

_FOUND = "found", "they command who is found at run time, which may be the same component"


def tied(owners: Iterable[bridge.Bridge]) -> list[tuple[str, list[Carrier]]]:
    """Returns the connections that stay together, each time with why."""
    carriers: dict[Hashable, list[Carrier]] = defaultdict(list)
    reasons: dict[Hashable, str] = {}
    for owner in owners:
        for carrier in carriers_of(owner):
            for key, reason in _ties(owner, carrier):
                carriers[key].append(carrier)
                reasons[key] = reason
    return [(reasons[key], some) for key, some in carriers.items() if len(set(some)) > 1]


def commands(carrier: Carrier) -> bool:
    """Tells whether a connection commands its peers, or its bridge."""
    if not isinstance(carrier, bridge.Connection):
        return True
    return keeps_control(carrier) or _is_commanded(carrier)


def serves(service: jaus.Service, carrier: bridge.Connection) -> bool:
    """Tells whether a bridge that provides a service does so by a connection."""
    if is_to_ros(carrier) and not is_single(carrier):
        return False
    wanted = code(carrier.map.message)
    return any(
        code(known) == wanted
        for ancestor in lineage(service)
        for known in (ancestor.inputs if is_to_ros(carrier) else ancestor.outputs)
    )


def _ties(owner: bridge.Bridge, carrier: Carrier) -> Iterator[Tie]:
    if not isinstance(carrier, bridge.Connection):
        # They may ask and command whom topics do, or be asked and commanded as topics are.
        yield from map(_controlled, carrier.peers)
        if is_to_ros(carrier):
            yield from (_provided(owner, service) for service in owner.provides)
            yield _commanded(owner)
        elif carrier.search is not None and carrier.control:
            yield _FOUND
        return
    yield from _joins(owner, carrier)
    for service in owner.provides:
        if serves(service, carrier) or _searches(carrier, service):
            yield _provided(owner, service)
    if keeps_control(carrier):
        if carrier.search is not None or _finds_controlled(owner):
            yield _FOUND
        yield from map(_controlled, carrier.peers)
    elif _is_commanded(carrier):
        yield _commanded(owner)


def _joins(owner: bridge.Bridge, carrier: bridge.Connection) -> Iterator[Tie]:
    """Yields the topics and reports that a connection shares with others."""
    for topic in carrier.topics:
        name = full_name(owner, str(topic.name))
        if topic.join is not None:
            yield ("join", name), f"they join the topic {name}"
        elif is_to_ros(carrier):
            yield ("topic", name), f"they publish {name}, and stop it together"
    for report in joined_reports(carrier):
        message = report.join.message
        yield ("report", code(message), *report.peers), f"they join {message.name}"


def full_name(owner: bridge.Bridge, name: str) -> str:
    """Returns the name from the root that a bridge means by a name."""
    return resolve_topic(name, owner.namespace or "", str(owner.name))


def _is_commanded(carrier: bridge.Connection) -> bool:
    service = carrier.map.message.eContainer()
    if service is None or not (is_to_ros(carrier) and is_single(carrier)):
        return False
    return needs_control(carrier.map.message, service)


def _finds_controlled(owner: bridge.Bridge) -> bool:
    return any(
        keeps_control(carrier)
        if isinstance(carrier, bridge.Connection)
        else carrier.control and not is_to_ros(carrier)
        for carrier in carriers_of(owner)
        if carrier.search is not None
    )


def _commanded(owner: bridge.Bridge) -> Tie:
    return ("commanded", owner), f"whoever controls {owner.name} commands all of them, and its stop"


def _controlled(peer: jaus.Component) -> Tie:
    return ("peer", peer), f"one bridge alone can hold control of {peer.name}, and stop it"


def _provided(owner: bridge.Bridge, service: jaus.Service) -> Tie:
    return ("service", owner, service), f"one bridge provides all of {service.name}"


def _searches(carrier: bridge.Connection, service: jaus.Service) -> bool:
    """Tells whether a search could find the bridge of a service, if it were another one."""
    wanted = carrier.search.services if carrier.search is not None else ()
    urns = {searched.urn for searched in wanted}
    return any(ancestor.urn in urns for ancestor in lineage(service))

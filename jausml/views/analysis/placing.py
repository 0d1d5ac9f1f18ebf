"""Placing: the host on which a part of a bridge has the least to do with other hosts."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.hosts import host_of
from jausml.language.semantics.shaping import passed_rate
from jausml.language.semantics.topics import endpoints, resolve_topic
from jausml.views.analysis.cdr import ros_size
from jausml.views.analysis.streams import is_to_ros

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from jausml.language.metamodel.classes.system import Host, System
    from jausml.views.analysis.assumptions import Assumptions
    from jausml.views.analysis.groups import Group
    from jausml.views.analysis.streams import Traffic


def nearest_host(
    owner: bridge.Bridge,
    groups: Sequence[Group],
    system: System,
    traffic: Traffic,
    assumptions: Assumptions,
) -> Host | None:
    """Returns the host with the fewest bytes to and from other ones; home, if as good."""
    home = host_of(system, owner)
    if home is None:
        return None
    partners = list(_partners(owner, groups, system, traffic, assumptions))
    others = [each for each in system.hosts if each.transport is home.transport and each != home]

    def remote(host: Host) -> float:
        return sum(octets for where, octets in partners if where not in (host, None))

    return min((home, *others), key=remote)


def _partners(
    owner: bridge.Bridge,
    groups: Sequence[Group],
    system: System,
    traffic: Traffic,
    assumptions: Assumptions,
) -> Iterator[tuple[Host | None, float]]:
    """Yields where the other ends of a part are, with bytes each second."""
    nodes = _nodes_by_topic(system)
    for each in (each for group in groups for each in group.connections):
        if not isinstance(each, bridge.Connection):
            continue
        streams = traffic.of(each)
        for stream in streams:
            other = stream.receiver if stream.sender is owner else stream.sender
            where = host_of(system, other) if other is not None else None
            yield where, stream.forth.judp + stream.back.judp
        carried = sum(stream.hertz for stream in streams if stream.kind != "query")
        rate = passed_rate(each, carried) if is_to_ros(each) else assumptions.rate_of(each)
        octets = rate * ros_size(each.map.type, assumptions.length_of(each)).expected
        for topic in each.topics:
            name = resolve_topic(str(topic.name), owner.namespace or "", str(owner.name))
            yield from ((host, octets) for host in nodes.get(name, ()))


def _nodes_by_topic(system: System) -> Mapping[str, list[Host | None]]:
    """Returns the hosts of the nodes at each topic."""
    found: dict[str, list[Host | None]] = defaultdict(list)
    for node in system.nodes:
        for end in endpoints([node]):
            found[end.topic].append(host_of(system, node))
    return found

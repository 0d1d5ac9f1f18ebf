"""The graph of ROS: topics, services and actions with the nodes at their ends. Needs rclpy."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

_OF_ROS = frozenset({"/rosout", "/parameter_events"})
_SERVED_BY_RCL = ("rcl_interfaces/", "type_description_interfaces/")
"""How the types of services begin that each node has: parameters, levels of its log, its types."""

SETTLED = 2.0
"""Seconds without a change after which all is known."""

_POLL = 0.1


@dataclass(frozen=True, order=True)
class RosEndpoint:
    """A publisher or subscription that runs."""

    node: str
    reliability: str
    durability: str


@dataclass(frozen=True, order=True)
class RunningTopic:
    """A topic that runs."""

    name: str
    types: tuple[str, ...]
    publishers: tuple[RosEndpoint, ...]
    subscriptions: tuple[RosEndpoint, ...]


@dataclass(frozen=True, order=True)
class RunningCall:
    """A service or an action that runs."""

    name: str
    types: tuple[str, ...]
    servers: tuple[str, ...]
    clients: tuple[str, ...]


@dataclass(frozen=True)
class RunningGraph:
    """What runs, each in the order of the names; that of ROS itself is left out."""

    topics: tuple[RunningTopic, ...] = ()
    services: tuple[RunningCall, ...] = ()
    actions: tuple[RunningCall, ...] = ()
    nodes: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        """Tells whether anything runs."""
        return bool(self.topics or self.services or self.actions)


def settled_graph(node: Any, end: float) -> RunningGraph:
    """Returns what runs, once nothing has changed for two seconds if there is anything."""
    found = _graph(node)
    since = time.monotonic()
    while time.monotonic() < end and not (found and time.monotonic() - since >= SETTLED):
        time.sleep(_POLL)
        now = _graph(node)
        if now != found:
            found, since = now, time.monotonic()
    return found


def _graph(node: Any) -> RunningGraph:
    topics = (
        RunningTopic(
            name,
            tuple(sorted(types)),
            _ends(node.get_publishers_info_by_topic(name), node),
            _ends(node.get_subscriptions_info_by_topic(name), node),
        )
        for name, types in node.get_topic_names_and_types()
        if name not in _OF_ROS and "/_" not in name
    )
    services, actions = _calls(node)
    nodes = (_full(*each) for each in node.get_node_names_and_namespaces())
    return RunningGraph(
        tuple(sorted(each for each in topics if each.publishers or each.subscriptions)),
        services,
        actions,
        tuple(sorted(each for each in nodes if not each.endswith(f"/{node.get_name()}"))),
    )


def _full(name: str, namespace: str) -> str:
    return f"{namespace.rstrip('/')}/{name}"


def _calls(own: Any) -> tuple[tuple[RunningCall, ...], tuple[RunningCall, ...]]:
    """Returns the services and the actions of all nodes but one."""
    from rclpy.action import graph  # noqa: PLC0415

    services = (own.get_service_names_and_types_by_node, own.get_client_names_and_types_by_node)
    actions = (
        partial(graph.get_action_server_names_and_types_by_node, own),
        partial(graph.get_action_client_names_and_types_by_node, own),
    )
    return _with_ends(own, *services), _with_ends(own, *actions)


def _with_ends(
    own: Any,
    served: Callable[[str, str], Iterable[tuple[str, Sequence[str]]]],
    called: Callable[[str, str], Iterable[tuple[str, Sequence[str]]]],
) -> tuple[RunningCall, ...]:
    """Returns what the nodes serve and call, by two questions to the graph."""
    from rclpy.node import NodeNameNonExistentError  # noqa: PLC0415

    types: dict[str, set[str]] = {}
    ends: dict[tuple[str, bool], set[str]] = {}
    for node, namespace in own.get_node_names_and_namespaces():
        for is_server, ask in ((True, served), (False, called)):
            try:
                found = list(ask(node, namespace)) if node != own.get_name() else []
            except (NodeNameNonExistentError, RuntimeError):
                continue  # It has gone meanwhile.
            for name, kinds in found:
                types.setdefault(name, set()).update(kinds)
                ends.setdefault((name, is_server), set()).add(_full(node, namespace))
    return tuple(
        RunningCall(
            name,
            tuple(sorted(types[name])),
            tuple(sorted(ends.get((name, True), ()))),
            tuple(sorted(ends.get((name, False), ()))),
        )
        for name in sorted(types)
        if "/_" not in name and not all(each.startswith(_SERVED_BY_RCL) for each in types[name])
    )


def _ends(infos: Iterable[Any], own: Any) -> tuple[RosEndpoint, ...]:
    from jausml.runtime.bridge.ros.profiles import qos_of  # noqa: PLC0415

    found = []
    for each in infos:
        qos = qos_of(each.qos_profile)
        full = _full(each.node_name, each.node_namespace)
        if each.node_name != own.get_name():
            found.append(RosEndpoint(full, qos.reliability, qos.durability))
    return tuple(sorted(found))

"""SROS 2 policies: what the nodes of a system may do in the ROS graph, and nothing else."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

from jausml.language.metamodel.classes import ros
from jausml.language.metamodel.classes.bridge import Bridge
from jausml.language.semantics.connections.topics import endpoints, resolve_topic
from jausml.language.semantics.directions import is_to_ros

_Use: TypeAlias = "tuple[str, str]"

_PUBLISHED = ("/parameter_events", "/rosout")
"""The topics that every node publishes besides its own."""

_SERVED = (
    *("~/describe_parameters", "~/get_parameter_types", "~/get_parameters", "~/list_parameters"),
    *("~/set_parameters", "~/set_parameters_atomically", "~/get_type_description"),
)
"""Services of every node: parameters and types."""

_PUBLISHED_BY_BRIDGES = ("/diagnostics", "~/transition_event")
"""The topics that the node of every bridge publishes besides."""

_SERVED_BY_BRIDGES = (
    *("~/change_state", "~/get_available_states", "~/get_available_transitions", "~/get_state"),
    "~/get_transition_graph",
)
"""Services of the node of every bridge: the life cycle."""

_PUBLISH, _SUBSCRIBE = ("topic", "publish"), ("topic", "subscribe")
_REPLY, _REQUEST = ("service", "reply"), ("service", "request")
_EXECUTE, _CALL = ("action", "execute"), ("action", "call")
_USES = (_PUBLISH, _SUBSCRIBE, _REPLY, _REQUEST, _EXECUTE, _CALL)
"""Elements of a policy and the attributes that allow them, in the order of their schema."""


@dataclass(frozen=True)
class Grant:
    """Names that a node may use in one way.

    Attributes:
        element: Element of the policy: `topic`, `service` or `action`.
        names: Full names, sorted.
    """

    element: str
    use: str
    names: tuple[str, ...]


@dataclass(frozen=True)
class PolicyView:
    """The SROS 2 policy of one node: of a bridge, or a ROS 2 node of the model.

    Names are those of the model; a deployment that renames topics, or moves the node into another
    namespace, changes the policy with them.
    """

    source: str
    element: Bridge | ros.Node

    @property
    def element_id(self) -> str:
        """Identity of the model element."""
        return f"policy:{self.element.name}"

    @property
    def name(self) -> str:
        """Name of the node."""
        return str(self.element.name)

    @property
    def namespace(self) -> str:
        """Namespace of the node, from the root."""
        return "/" + (self.element.namespace or "").strip("/")

    @property
    def enclave(self) -> str:
        """Enclave that has the keys of the process: the full name of the node."""
        return self._full(self.name)

    @property
    def grants(self) -> tuple[Grant, ...]:
        """The rights of the node."""
        names: dict[_Use, set[str]] = {use: set() for use in _USES}
        for use, used_names in _uses(self.element):
            names[use] |= set(map(self._full, used_names))
        return tuple(
            Grant(*use, tuple(sorted(granted))) for use, granted in names.items() if granted
        )

    def _full(self, name: str) -> str:
        return resolve_topic(name, self.element.namespace or "", self.name)


def _uses(element: Bridge | ros.Node) -> Iterator[tuple[_Use, Iterable[str]]]:
    """Yields the uses of a node, by the names in the model."""
    ends = list(endpoints([element]))
    yield _PUBLISH, [*_PUBLISHED, *(end.topic for end in ends if end.publishes)]
    yield _SUBSCRIBE, [end.topic for end in ends if not end.publishes]
    yield _REPLY, _SERVED
    yield from _uses_of_node(element) if isinstance(element, ros.Node) else _uses_of_bridge(element)


def _uses_of_node(node: ros.Node) -> Iterator[tuple[_Use, Iterable[str]]]:
    yield _REPLY, [service_server.service for service_server in node.serviceServers]
    yield _REQUEST, [service_client.service for service_client in node.serviceClients]


def _uses_of_bridge(bridge: Bridge) -> Iterator[tuple[_Use, Iterable[str]]]:
    yield _PUBLISH, _PUBLISHED_BY_BRIDGES
    yield _REPLY, _SERVED_BY_BRIDGES
    for service in bridge.serviceConnections:
        yield (_REQUEST if is_to_ros(service) else _REPLY), [service.service]
    for action in bridge.actionConnections:
        yield (_CALL if is_to_ros(action) else _EXECUTE), [action.action]

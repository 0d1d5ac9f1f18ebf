"""SROS 2 policies: what the node of a bridge may do in the ROS graph, and nothing else."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.semantics.topics import endpoints, resolve_topic

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.metamodel.classes.bridge import Bridge
    from jausml.semantics.topics import Endpoint

_PUBLISHED = ("/diagnostics", "/parameter_events", "/rosout", "~/transition_event")
"""What the node of every bridge publishes besides its connections."""

_SERVED = (
    *("~/describe_parameters", "~/get_parameter_types", "~/get_parameters", "~/list_parameters"),
    *("~/set_parameters", "~/set_parameters_atomically", "~/get_type_description"),
    *("~/change_state", "~/get_available_states", "~/get_available_transitions", "~/get_state"),
    "~/get_transition_graph",
)
"""Services of the node of every bridge: parameters, types and the life cycle."""


@dataclass(frozen=True)
class Grant:
    """Names that a node may use in one way.

    Attributes:
        element: Element of the policy: `topic`, `service` or `action`.
        use: Attribute that allows it, e.g. `publish`.
        names: Full names, sorted.
    """

    element: str
    use: str
    names: tuple[str, ...]


@dataclass(frozen=True)
class PolicyView:
    """The SROS 2 policy of one bridge.

    Names are those of the model; a deployment that renames topics, or moves the node into another
    namespace, changes the policy with them.
    """

    source: str
    bridge: Bridge

    @property
    def element_id(self) -> str:
        """Identity of the model element."""
        return f"policy:{self.bridge.name}"

    @property
    def name(self) -> str:
        """Name of the node."""
        return str(self.bridge.name)

    @property
    def namespace(self) -> str:
        """Namespace of the node, from the root."""
        return "/" + (self.bridge.namespace or "").strip("/")

    @property
    def enclave(self) -> str:
        """Enclave that has the keys of the process: the full name of the node."""
        return self._full(self.name)

    @property
    def grants(self) -> tuple[Grant, ...]:
        """What the node may do."""
        ends = list(endpoints([self.bridge]))
        services = {True: list(_SERVED), False: []}
        for service in self.bridge.serviceConnections:
            services[service.direction.name == "rosToJaus"].append(str(service.service))
        actions: dict[bool, list[str]] = {True: [], False: []}
        for action in self.bridge.actionConnections:
            actions[action.direction.name == "rosToJaus"].append(str(action.action))
        found = (
            self._grant("topic", "publish", [*_PUBLISHED, *_topics(ends, publishes=True)]),
            self._grant("topic", "subscribe", _topics(ends, publishes=False)),
            self._grant("service", "reply", services[True]),
            self._grant("service", "request", services[False]),
            self._grant("action", "execute", actions[True]),
            self._grant("action", "call", actions[False]),
        )
        return tuple(each for each in found if each.names)

    def _grant(self, element: str, use: str, names: Iterable[str]) -> Grant:
        return Grant(element, use, tuple(sorted(set(map(self._full, names)))))

    def _full(self, name: str) -> str:
        return resolve_topic(name, self.bridge.namespace or "", self.name)


def _topics(ends: Iterable[Endpoint], *, publishes: bool) -> list[str]:
    return [each.topic for each in ends if each.publishes is publishes]

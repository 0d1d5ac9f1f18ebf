"""What the templates of a ROS 2 node package may ask."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

from jausml.generation.artifact import MethodContract, SkeletonContract
from jausml.generators.common.names import class_name, package_name
from jausml.generators.common.ros import Qos, RosType, import_lines, qos, ros_type



@dataclass(frozen=True)
class TopicView:
    """A publisher or subscription: its names, type and quality of service."""

    name: str
    topic: str
    type: RosType
    qos: Qos
    documentation: str


@dataclass(frozen=True)
class ServiceView:
    """A service server or client."""

    name: str
    service: str
    type: RosType
    documentation: str


@dataclass(frozen=True)
class ParameterView:
    """A parameter: default value as a Python literal and what its descriptor says."""

    name: str
    default: bool | float | str
    python_type: str
    documentation: str
    range_class: str
    range_argument: str
    minimum: float
    maximum: float
    read_only: bool

    @property
    def range_expression(self) -> str:
        """Constructor call of the range."""
        return f"{self.range_class}(from_value={self.minimum!r}, to_value={self.maximum!r})"


@dataclass(frozen=True)
class NodeView:
    """A modelled node.

    Args:
        node: The `ros.Node`.
        system: Name of the system, which is the default of documentation.
        source: Model file.
    """

    node: Any
    system: str
    source: str

    @property
    def element_id(self) -> str:
        """Identity of the model element."""
        return f"node:{self.node.name}"

    @property
    def name(self) -> str:
        """Node name."""
        return str(self.node.name)

    @property
    def package(self) -> str:
        """Package name, which is also the name of the skeleton's module."""
        return package_name(self.name)

    @property
    def class_name(self) -> str:
        """Class of the user's skeleton."""
        return class_name(self.name)

    @property
    def base_name(self) -> str:
        """Class that is generated anew each time."""
        return f"{self.class_name}Base"

    @property
    def namespace(self) -> str:
        """Namespace of the node; empty for the root."""
        return str(self.node.namespace or "")

    @property
    def description(self) -> str:
        """What the model says that the node is for."""
        return self.node.documentation or f"Node of the system {self.system}."

    @property
    def documentation(self) -> str:
        """Summary and description, for docstrings."""
        return f"ROS 2 node {self.name}.\n\n{self.description}"

    @property
    def period(self) -> float:
        """Seconds between two calls of `on_timer`; 0 means no timer."""
        return 1.0 / self.node.frequency if self.node.frequency > 0 else 0.0

    @functools.cached_property
    def publishers(self) -> tuple[TopicView, ...]:
        """Publishers in model order."""
        return tuple(_topic(publisher, "Publishes") for publisher in self.node.publishers)

    @functools.cached_property
    def subscriptions(self) -> tuple[TopicView, ...]:
        """Subscriptions in model order."""
        return tuple(_topic(subscription, "Handles") for subscription in self.node.subscriptions)

    @functools.cached_property
    def service_servers(self) -> tuple[ServiceView, ...]:
        """Service servers in model order."""
        return tuple(_service(server, "Answers") for server in self.node.serviceServers)

    @functools.cached_property
    def service_clients(self) -> tuple[ServiceView, ...]:
        """Service clients in model order."""
        return tuple(_service(client, "Calls") for client in self.node.serviceClients)

    @functools.cached_property
    def parameters(self) -> tuple[ParameterView, ...]:
        """Parameters in model order."""
        return tuple(_parameter(parameter) for parameter in self.node.parameters)

    @property
    def base_imports(self) -> tuple[str, ...]:
        """Import lines of the base class."""
        names = {("rclpy.node", "Node")}
        topics = (*self.publishers, *self.subscriptions)
        services = (*self.service_servers, *self.service_clients)
        for view in (*topics, *services):
            names.add((view.type.module, view.type.name))
        for topic in topics:
            names.update(topic.qos.imports)
        if topics:
            names.add(("rclpy.qos_overriding_options", "QoSOverridingOptions"))
        if self.parameters:
            names.add(("rcl_interfaces.msg", "ParameterDescriptor"))
        names.update(
            ("rcl_interfaces.msg", parameter.range_class)
            for parameter in self.parameters
            if parameter.range_class
        )
        return import_lines(names)

    @property
    def skeleton_imports(self) -> tuple[str, ...]:
        """Import lines of the user's skeleton."""
        views = (*self.subscriptions, *self.service_servers)
        return import_lines((view.type.module, view.type.name) for view in views)

    @property
    def dependencies(self) -> tuple[str, ...]:
        """ROS packages that the package needs at run time, sorted."""
        views = (
            *self.publishers,
            *self.subscriptions,
            *self.service_servers,
            *self.service_clients,
        )
        names = {"rclpy", *(view.type.package for view in views)}
        return tuple(sorted(names | ({"rcl_interfaces"} if self.parameters else set())))

    def contract(self) -> SkeletonContract:
        """Returns what the base expects of the user's class."""
        methods = [
            MethodContract(
                f"on_{topic.name}", ("message",), f"subscription:{topic.name}", _stub(topic)
            )
            for topic in self.subscriptions
        ]
        methods += [
            MethodContract(
                f"on_{server.name}",
                ("request", "response"),
                f"service:{server.name}",
                _service_stub(server),
            )
            for server in self.service_servers
        ]
        if self.period:
            methods.append(MethodContract("on_timer", (), "timer", _TIMER_STUB))
        return SkeletonContract(self.class_name, self.base_name, tuple(methods), ("on_",))


_TIMER_STUB = "    def on_timer(self) -> None:\n        super().on_timer()\n"


def _stub(topic: TopicView) -> str:
    return (
        f"    def on_{topic.name}(self, message: {topic.type.name}) -> None:\n"
        f"        super().on_{topic.name}(message)\n"
    )


def _service_stub(server: ServiceView) -> str:
    name = server.type.name
    return (
        f"    def on_{server.name}(\n"
        f"        self, request: {name}.Request, response: {name}.Response\n"
        f"    ) -> {name}.Response:\n"
        f"        return super().on_{server.name}(request, response)\n"
    )


def _topic(endpoint: Any, verb: str) -> TopicView:
    kind = ros_type(endpoint.type)
    default = f"{verb} {kind.full_name} on the topic '{endpoint.topic}'."
    documentation = endpoint.documentation or default
    return TopicView(endpoint.name, endpoint.topic, kind, qos(endpoint.qos), documentation)


def _service(endpoint: Any, verb: str) -> ServiceView:
    kind = ros_type(endpoint.type)
    default = f"{verb} {kind.full_name} of the service '{endpoint.service}'."
    return ServiceView(endpoint.name, endpoint.service, kind, endpoint.documentation or default)


def _parameter(parameter: Any) -> ParameterView:
    kind = parameter.type.name
    default: bool | float | str = {
        "bool": lambda text: text.strip().lower() == "true",
        "integer": int,
        "double": float,
        "string": str,
    }[kind](parameter.value)
    limited = kind in ("integer", "double") and parameter.minimum < parameter.maximum
    number = int if kind == "integer" else float
    return ParameterView(
        name=parameter.name,
        default=default,
        python_type={"bool": "bool", "integer": "int", "double": "float", "string": "str"}[kind],
        documentation=parameter.documentation or "",
        range_class={"integer": "IntegerRange", "double": "FloatingPointRange"}[kind]
        if limited
        else "",
        range_argument={"integer": "integer_range"}.get(kind, "floating_point_range"),
        minimum=number(parameter.minimum),
        maximum=number(parameter.maximum),
        read_only=parameter.readOnly,
    )

"""Target `ros_node`: one package for each modelled ROS 2 node."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeAlias, TypeVar

from jausml.generation.artifact import MethodContract, SkeletonContract
from jausml.generation.literals import python_literal, python_string
from jausml.generation.python import Imports, Origin, offered
from jausml.generation.target import FileTask, Target, Task, source_of, system_of, templates_beside
from jausml.language.metamodel.classes import ros
from jausml.language.model.model import Model
from jausml_generators.common.ros import (
    LONGEST_DURATION,
    OWN_PARAMETERS,
    Qos,
    RosType,
    local_names,
    parameter_value,
    qos,
    ros_type,
)
from jausml_generators.python.names import Scope, class_name, snake_case
from jausml_generators.python.package import (
    FACE,
    PACKAGE_TEMPLATES,
    VALUES,
    EntryPoint,
    ProgramView,
    laid_out,
    package_tasks,
    program_tasks,
)
from jausml_generators.python.statements import long_string

Endpoint: TypeAlias = "ros.TopicEndpoint | ros.ServiceEndpoint"


NamedT = TypeVar("NamedT", bound="ros.NamedElement")
_LONG = 2**63

_RCLPY = {
    "rclpy": Origin("rclpy"),
    **offered("rcl_interfaces.msg", "FloatingPointRange", "IntegerRange", "ParameterDescriptor"),
    **offered("rclpy.duration", "Duration"),
    **offered("rclpy.node", "Node"),
    **offered("rclpy.qos", "DurabilityPolicy", "HistoryPolicy", "LivelinessPolicy", "QoSProfile"),
    **offered("rclpy.qos", "ReliabilityPolicy"),
    **offered("rclpy.qos_overriding_options", "QoSOverridingOptions"),
    **offered(VALUES, "CheckedPublisher", "checked_answers"),
}
"""The names that modules of a node may import besides messages, which hide none of these."""


@dataclass(frozen=True)
class EndpointView:
    """A publisher, subscription, service server or service client.

    Attributes:
        name: End of its names in Python, e.g. `pose` of `on_pose` and `publisher_pose`.
    """

    name: str
    ros_name: str
    type: RosType
    type_name: str
    qos: Qos
    documentation: str

    @property
    def message_signature(self) -> str:
        """First line of the method that handles messages."""
        return f"def on_{self.name}(self, message: {self.type_name}) -> None:"

    @property
    def request_signature(self) -> str:
        """First line of the method that answers requests."""
        kind = self.type_name
        parameters = f"self, request: {kind}.Request, response: {kind}.Response"
        return f"def on_{self.name}({parameters}) -> {kind}.Response:"


@dataclass(frozen=True)
class ParameterView:
    """A parameter: default value as a Python literal, and its descriptor.

    Attributes:
        name: End of the property that returns the value, e.g. `gain` of `parameter_gain`.
        range_class: Class of the range; empty when there is none.
    """

    name: str
    ros_name: str
    default: bool | float | str
    documentation: str
    range_class: str
    limits: tuple[float, float]
    read_only: bool

    @property
    def python_type(self) -> str:
        """Type of the value in Python."""
        return type(self.default).__name__

    @property
    def summary(self) -> str:
        """Name and documentation, for a docstring."""
        return f"Value of the parameter '{self.ros_name}'.\n\n{self.documentation}"

    @property
    def range_expression(self) -> str:
        """Constructor call of the range."""
        low, high = (python_literal(limit) for limit in self.limits)
        return f"{self.range_class}(from_value={low}, to_value={high})"

    @property
    def range_argument(self) -> str:
        """Argument of the descriptor that takes the range."""
        return snake_case(self.range_class)

    @property
    def description(self) -> str:
        """Text of the descriptor, as a Python string."""
        return long_string(" ".join(self.documentation.split()))


@dataclass(frozen=True)
class NodeView(ProgramView):
    """A modelled node."""

    KIND = "node"

    node: ros.Node
    system: str
    source: str

    @property
    def element(self) -> ros.Node:
        """The model element."""
        return self.node

    @property
    def class_name(self) -> str:
        """Class of the user's skeleton."""
        return class_name(self.name)

    @property
    def full_name(self) -> str:
        """Node name with its namespace, e.g. `/robot/controller`."""
        return "/".join(["", *filter(None, str(self.node.namespace or "").split("/")), self.name])

    @property
    def constructor_arguments(self) -> tuple[str, ...]:
        """Arguments of rclpy's Node."""
        name, namespace = python_string(self.name), self.node.namespace
        return (name, f"namespace={python_string(namespace)}") if namespace else (name,)

    @property
    def description(self) -> str:
        """The documentation of the node."""
        return self.node.documentation or f"Node of the system {self.system}."

    @property
    def documentation(self) -> str:
        """Summary and description, for docstrings."""
        return f"ROS 2 node {self.name}.\n\n{self.description}"

    @property
    def frequency(self) -> float:
        """Calls of `on_timer` each second; 0 means no timer."""
        return float(self.node.frequency)

    @property
    def period(self) -> float:
        """Seconds between two calls of `on_timer`."""
        return min(1.0 / self.frequency, LONGEST_DURATION)

    @property
    def period_ns(self) -> int:
        """Nanoseconds between two calls of `on_timer`, rounded as rclpy does."""
        return int(self.period * 1e9)

    @functools.cached_property
    def publishers(self) -> tuple[EndpointView, ...]:
        """Publishers in model order."""
        return tuple(self._topic(publisher, "Publishes on") for publisher in self.node.publishers)

    @functools.cached_property
    def subscriptions(self) -> tuple[EndpointView, ...]:
        """Subscriptions in model order."""
        return tuple(
            self._topic(subscription, "Handles messages of")
            for subscription in self.node.subscriptions
        )

    @functools.cached_property
    def service_servers(self) -> tuple[EndpointView, ...]:
        """Service servers in model order."""
        return tuple(
            self._service(server, "Answers requests of") for server in self.node.serviceServers
        )

    @functools.cached_property
    def service_clients(self) -> tuple[EndpointView, ...]:
        """Service clients in model order."""
        return tuple(self._service(client, "Calls") for client in self.node.serviceClients)

    @functools.cached_property
    def parameters(self) -> tuple[ParameterView, ...]:
        """Parameters in model order."""
        names = _python_names(self.node.parameters)
        return tuple(_parameter(parameter, names[parameter]) for parameter in self.node.parameters)

    @property
    def base_imports(self) -> Imports:
        """The names that the base may import."""
        types = {name: Origin(kind.module, kind.name) for kind, name in self._type_names.items()}
        return Imports({**_RCLPY, **types})

    @property
    def skeleton_imports(self) -> Imports:
        """The names that the skeleton may import."""
        base = offered(f".{self.package}_base", self.base_name)
        return self.base_imports.and_also(base)

    @property
    def test_imports(self) -> Imports:
        """The names that the tests may import."""
        own = offered(f"{self.package}.{self.package}", self.class_name)
        return Imports({**_RCLPY, **own}, own=self.package)

    @property
    def declared_parameters(self) -> tuple[ParameterView, ...]:
        """Parameters that the base declares: rclpy has declared the others by then."""
        return tuple(
            parameter for parameter in self.parameters if parameter.ros_name not in OWN_PARAMETERS
        )

    @property
    def dependencies(self) -> tuple[str, ...]:
        """Packages that the package needs at run time, sorted."""
        names = {FACE, "rclpy", *(endpoint.type.package for endpoint in self._endpoints)}
        if self.declared_parameters:
            names.add("rcl_interfaces")
        return tuple(sorted(names))

    @property
    def entry_point(self) -> EntryPoint:
        """How its process runs."""
        return EntryPoint(
            title=f"ROS 2 node {self.name}",
            runner="run_node",
            arguments=f"{self.class_name}, arguments",
            end="SIGINT or SIGTERM",
        )

    def contract(self) -> SkeletonContract:
        """Returns the methods that the base expects of the user's class."""
        methods = [
            MethodContract(
                f"on_{topic.name}",
                ("message",),
                f"topic:{topic.ros_name}",
                laid_out(
                    f"    {topic.message_signature}\n        super().on_{topic.name}(message)\n"
                ),
            )
            for topic in self.subscriptions
        ]
        methods += [
            MethodContract(
                f"on_{server.name}",
                ("request", "response"),
                f"service:{server.ros_name}",
                laid_out(
                    f"    {server.request_signature}\n"
                    f"        return super().on_{server.name}(request, response)\n"
                ),
            )
            for server in self.service_servers
        ]
        if self.frequency:
            methods.append(MethodContract("on_timer", (), "timer", _TIMER_STUB))
        return SkeletonContract(self.class_name, self.base_name, tuple(methods), ("on_",))

    @property
    def _endpoints(self) -> tuple[EndpointView, ...]:
        return (*self.publishers, *self.subscriptions, *self.service_servers, *self.service_clients)

    @functools.cached_property
    def _names(self) -> Mapping[Endpoint, str]:
        """Name of each endpoint in Python."""
        node = self.node
        timer = {"on_timer"} if self.frequency else set()
        sending: list[Endpoint] = [*node.publishers, *node.serviceClients]
        receiving: list[Endpoint] = [*node.subscriptions, *node.serviceServers]
        return _python_names(sending) | _python_names(receiving, timer)

    @functools.cached_property
    def _type_names(self) -> Mapping[RosType, str]:
        """Names of the types, the same in base and skeleton."""
        return local_names(
            (ros_type(endpoint.type) for endpoint in self._names),
            frozenset(_RCLPY) | {self.class_name, self.base_name},
        )

    def _topic(self, element: ros.TopicEndpoint, summary: str) -> EndpointView:
        summary = f"{summary} the topic '{element.topic}'."
        return self._endpoint(element, element.topic, qos(element.qos), summary)

    def _service(self, element: ros.ServiceEndpoint, summary: str) -> EndpointView:
        summary = f"{summary} the service '{element.service}'."
        return self._endpoint(element, element.service, Qos(()), summary)

    def _endpoint(
        self, element: Endpoint, ros_name: str, profile: Qos, summary: str
    ) -> EndpointView:
        kind = ros_type(element.type)
        return EndpointView(
            name=self._names[element],
            ros_name=ros_name,
            type=kind,
            type_name=self._type_names[kind],
            qos=profile,
            documentation=f"{summary}\n\n{element.documentation or ''}",
        )


_TIMER_STUB = "    def on_timer(self) -> None:\n        super().on_timer()\n"


def _python_names(elements: Iterable[NamedT], taken: Iterable[str] = ()) -> dict[NamedT, str]:
    """Returns the end of each element's names: behind a prefix no keyword and no builtin is hit."""
    scope = Scope(frozenset(taken))
    names = {element: scope.claim(snake_case(f"on_{element.name}")) for element in elements}
    return {element: name.removeprefix("on_") for element, name in names.items()}


def _parameter(parameter: ros.Parameter, name: str) -> ParameterView:
    default = parameter_value(parameter)
    limits: tuple[float, float] = (parameter.minimum, parameter.maximum)
    range_class = ""
    if parameter.minimum < parameter.maximum:
        range_class = {"integer": "IntegerRange", "double": "FloatingPointRange"}.get(
            parameter.type.name, ""
        )
    if range_class == "IntegerRange":
        limits = (max(math.ceil(limits[0]), -_LONG), min(math.floor(limits[1]), _LONG - 1))
    return ParameterView(
        name=name,
        ros_name=parameter.name,
        default=default,
        documentation=parameter.documentation or "",
        range_class=range_class,
        limits=limits,
        read_only=parameter.readOnly,
    )


def tasks(model: Model) -> list[Task]:
    """Returns the files of every node."""
    system, source = system_of(model), source_of(model)
    nodes = [NodeView(node, system.name, source) for node in system.nodes]
    packages = [
        node.package_view(system, node.description, dependencies=node.dependencies)
        for node in nodes
    ]
    return [
        *package_tasks(packages),
        *program_tasks(nodes, base="base.py.j2", skeleton="skeleton.py.j2"),
        FileTask(
            "test_node.py.j2",
            nodes,
            lambda node: f"{node.package}/test/test_{node.package}.py",
            imports=lambda node: node.test_imports,
        ),
    ]


TARGET = Target(
    name="ros_node",
    description="ROS 2 nodes with skeletons, one ament_python package each.",
    tasks=tasks,
    template_folders=(templates_beside(__file__), PACKAGE_TEMPLATES),
)
"""Base, skeleton, entry point and tests of each node."""

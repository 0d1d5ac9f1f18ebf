"""The ROS node of a bridge in a virtual world."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NoReturn

from ..base.loop import Loop
from ..bridge.ends.actions import ActionClient, GoalTaker, ListAction
from ..bridge.ends.ros_side import RosCodec, RosPublisher
from ..bridge.ends.topics import (
    EndpointHealth,
    Parameter,
    ParameterError,
    RosService,
    Topic,
    TopicCounts,
    TopicFault,
    nearest,
)
from ..bridge.messages.limits import RosTypeError
from ..conversions import Time
from .graph import GraphPublisher, GraphSubscription, RosGraph, type_name
from .network import Link

_DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"


class VirtualRosNode:
    """A node for a bridge, without ROS: topics, actions, parameters, and virtual time.

    Services need ROS: a bridge with services cannot be opened on it.
    """

    # The time of the world is that of the loop: no bridge needs to follow `/clock`.
    is_simulated = False

    def __init__(
        self, graph: RosGraph, name: str, parameters: Mapping[str, Any], link: Link
    ) -> None:
        """Joins the graph with values of parameters by name; see `VirtualWorld.ros_node`."""
        self.name = name
        self._graph = graph
        self._parameters = dict(parameters)
        self._link = link
        self._followers: dict[str, Callable[[Any], None]] = {}
        self._declared: dict[str, Parameter] = {}
        self._health: dict[tuple[Topic, bool], EndpointHealth] = {}
        self._ends: list[GraphPublisher | GraphSubscription] = []
        self._removals: list[Callable[[], None]] = []
        diagnostics = graph.advertise(name, _DIAGNOSTICS, Topic("/diagnostics"))
        self._ends.append(diagnostics)
        self.publish_diagnostics: Callable[[bytes], None] = diagnostics.publish

    def attach(self, loop: Loop) -> None:
        """Raises ValueError for a bridge whose loop is not that of the world."""
        if loop is not self._graph.loop:
            raise ValueError(f"{self.name} is of another world than the transport of its bridge")
        # By then the bridge has declared all its parameters.
        loop.call_soon(self._count_unknown)

    def close(self) -> None:
        """Removes all publishers, subscriptions and action servers; the bridge is closed before."""
        for end in self._ends:
            end.close()
        self._ends.clear()
        for remove in self._removals:
            remove()
        self._removals.clear()

    # ------------------------------------------------------------------ time and parameters

    def now(self) -> Time:
        """Returns the time of day of the world."""
        return Time(*divmod(self._graph.loop.wall(), 10**9))

    def follow_clock(self, take: Callable[[float], None]) -> None:
        """Does nothing: the time of the world is that of the loop."""

    def parameter(self, parameter: Parameter, changed: Callable[[Any], None] | None = None) -> Any:
        """Declares a parameter and returns its value.

        Args:
            changed: Takes each later value; without it the parameter cannot change.

        Raises:
            ParameterError: The value is not valid for the parameter.
        """
        name = parameter.name
        self._declared[name] = parameter
        if changed is not None:
            self._followers[name] = changed
        if name not in self._parameters:
            return parameter.default
        return _converted(parameter, self._parameters[name])

    def check_parameters(self) -> None:
        """Does nothing: each wrong value was an error at once."""

    def set_parameter(self, name: str, value: Any) -> None:
        """Changes a parameter, as `ros2 param set` does.

        Raises:
            ParameterError: There is no such parameter, it cannot change, or the value is not valid.
        """
        parameter = self._declared.get(name)
        if parameter is None:
            raise ParameterError(f"{self.name} has no parameter {name}")
        if name not in self._followers:
            raise ParameterError(f"{name} cannot change while the bridge runs")
        self._parameters[name] = converted = _converted(parameter, value)
        self._followers[name](converted)

    def _count_unknown(self) -> None:
        """Counts values of undeclared parameters, which may be misspelt."""
        for name in self._parameters:
            if name not in self._declared:
                similar = nearest(name, self._declared)
                hint = f"; did you mean {similar}?" if similar else ""
                detail = f"{self.name} has no parameter {name}{hint}"
                self._graph.loop.counters.count("ros.unknown_parameter", detail)

    # ------------------------------------------------------------------ topics

    def codec(self, ros_type: type[Any]) -> RosCodec:
        """Returns the codec for objects of rclpy; RosTypeError without rclpy."""
        try:
            from ..bridge.ros.internals import Codec  # noqa: PLC0415 - light classes do without

            return Codec(ros_type)
        except ImportError as error:
            needed = f"objects of ROS for {type_name(ros_type)} need ROS itself"
            raise RosTypeError(f"{needed}: {error}") from error

    def publisher(
        self, ros_type: type[Any], topic: Topic, on_match: Callable[[], None] | None = None
    ) -> RosPublisher:
        """Creates a publisher; see `RosSide`."""
        resolved = self._resolved(topic)
        end = self._graph.advertise(self.name, ros_type, resolved, on_match)
        self._health[topic, True] = end.health
        self._ends.append(end)
        return end

    def subscribe(
        self, ros_type: type[Any], topic: Topic, take: Callable[[bytes, int], None]
    ) -> TopicCounts:
        """Creates a subscription; see `RosSide`."""
        resolved = self._resolved(topic)
        end = self._graph.attach(self.name, ros_type, resolved, take, self._link)
        self._health[topic, False] = end.health
        self._ends.append(end)
        return end.counts

    @property
    def link(self) -> Link:
        """The properties of the paths to all subscriptions; may be set at any time."""
        return self._link

    @link.setter
    def link(self, link: Link) -> None:
        self._link = link
        for end in self._ends:
            if isinstance(end, GraphSubscription):
                end.link = link

    def faults(self, topic: Topic, *, publishes: bool, alone: bool = False) -> Sequence[TopicFault]:
        """Returns the faults of a publisher or subscription of a topic."""
        return self._health[topic, publishes].faults(alone=alone)

    def _resolved(self, topic: Topic) -> Topic:
        return replace(topic, name=self._full_name(topic.name))

    def _full_name(self, name: str) -> str:
        namespace, _, own = self.name.rpartition("/")
        if name.startswith("/"):
            return name
        if name.startswith("~/"):
            return f"{namespace}/{own}/{name[2:]}"
        return f"{namespace}/{name}"

    def part(self, _load: object) -> Any:
        """Returns the node, which has no separate parts."""
        return self

    # ------------------------------------------------------------------ actions

    def action_client(self, action: ListAction) -> ActionClient:
        """Returns a client of an action."""
        return self._graph.action_client(self._full_name(action.name), self._link)

    def serve_action(self, action: ListAction, taker: GoalTaker) -> None:
        """Sets the server of an action."""
        virtual_action = self._graph.serve_action(self._full_name(action.name), taker)
        self._removals.append(partial(virtual_action.close, taker))

    # ------------------------------------------------------------------ services

    def serve(self, service: RosService, _take: object) -> NoReturn:
        """Raises NotImplementedError: services need ROS."""
        raise _needs_ros(f"service {service.name}")

    def client(self, service: RosService) -> NoReturn:
        """Raises NotImplementedError: services need ROS."""
        raise _needs_ros(f"service {service.name}")


def _needs_ros(end: str) -> NotImplementedError:
    return NotImplementedError(f"{end}: in virtual time there are topics and actions, no services")


def _converted(parameter: Parameter, value: Any) -> Any:
    """Returns a value converted to the type of a parameter; ParameterError if not valid."""
    try:
        return parameter.converted(value)
    except ValueError as error:
        raise ParameterError(str(error)) from error

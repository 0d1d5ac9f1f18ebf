"""Nodes that look at ROS and leave no trace there: its graph, and messages. Needs rclpy."""

from __future__ import annotations

import importlib
import os
import time
from dataclasses import dataclass, field, replace
from functools import partial
from threading import Condition, Thread
from typing import TYPE_CHECKING, Any

from jausml.language.semantics.names import is_identifier

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from typing_extensions import Self


_PUBLISHED: dict[str, dict[str, tuple[str, ...]]] = {
    "msg": {"": ()},
    "srv": {"Event": ("Event",)},
    "action": {"FeedbackMessage": ("Impl", "FeedbackMessage")},
}
"""What of an interface is published: how its type name ends, and where the class is in rclpy."""

_OF_ROS = frozenset({"/rosout", "/parameter_events"})
_SERVED_BY_RCL = ("rcl_interfaces/", "type_description_interfaces/")
"""How the types of services begin that each node has: parameters, levels of its log, its types."""

_DESCRIBES = "start_type_description_service"
"""A parameter of every node (since Jazzy; others ignore it): its service is a trace too, and takes
half of the time that a node takes to start."""

_NAMED = "sensor_msgs/msg/JointState"

_POLL, _SETTLED, _LISTENED = 0.1, 2.0, 5.0
"""Seconds between two looks, without a change after which all is known, and for a message."""


class RosFault(Exception):  # noqa: N818 - a state of the computer, not a fault of ours
    """ROS cannot be used here."""


class QuietNode:
    """A node in a context of its own, without parameters, services or log."""

    def __init__(self, purpose: str) -> None:
        """Does nothing before `open`."""
        self._name = f"jausml_{purpose}_{os.getpid()}"
        self._context: Any = None
        self._executor: Any = None
        self._thread: Thread | None = None
        self.node: Any = None

    def open(self, prepare: Callable[[Any], object] | None = None) -> Self:
        """Enters ROS.

        Raises:
            RosFault: rclpy, or what is needed beside it, is missing or does not work.
        """
        try:
            import rclpy  # noqa: PLC0415 - it is on robots, not everywhere
            from rclpy.context import Context  # noqa: PLC0415
            from rclpy.parameter import Parameter  # noqa: PLC0415

            parameter: Any = Parameter
            self._context = Context()
            rclpy.init(context=self._context, args=[])
            self.node = rclpy.create_node(
                self._name,
                context=self._context,
                start_parameter_services=False,
                enable_rosout=False,
                parameter_overrides=[parameter(_DESCRIBES, value=False)],
            )
            if prepare is not None:
                prepare(self.node)
        except ImportError as error:
            self.close()
            raise RosFault(f"no ROS here: {error}") from error
        except (RuntimeError, OSError) as error:
            self.close()
            raise RosFault(f"ROS does not work here: {error}") from error
        return self

    def spin(self) -> None:
        """Lets callbacks come, on a thread that ends with `close`."""
        from rclpy.executors import SingleThreadedExecutor  # noqa: PLC0415

        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._thread = Thread(target=self._spin, name=self._name, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Leaves ROS."""
        if self._thread is not None:
            self._executor.shutdown()
            self._thread.join()
            self._thread = None
        if self.node is not None:
            self.node.destroy_node()
            self.node = None
        if self._context is not None:
            self._context.try_shutdown()
            self._context = None

    def _spin(self) -> None:
        from rclpy.executors import ExternalShutdownException  # noqa: PLC0415

        try:
            self._executor.spin()
        except ExternalShutdownException:
            return


def message_class(name: str) -> Any:
    """Returns the class of the messages on a topic, None when it is not installed.

    Args:
        name: Name of their type, such as `nav_msgs/msg/Odometry`; what services and actions publish
            too: `std_srvs/srv/SetBool_Event`, `nav2_msgs/action/Wait_FeedbackMessage`.
    """
    package, _, rest = name.partition("/")
    kind, _, own = rest.partition("/")
    base, _, role = own.partition("_")
    if not (is_identifier(package) and is_identifier(base)) or role not in _PUBLISHED.get(kind, ()):
        return None
    try:
        found = getattr(importlib.import_module(f"{package}.{kind}"), base, None)
    except ImportError:
        return None
    for attribute in _PUBLISHED[kind][role]:
        found = getattr(found, attribute, None)
    return found


@dataclass(frozen=True, order=True)
class RosEndpoint:
    """A publisher or subscription that runs."""

    node: str
    reliability: str
    durability: str


@dataclass(frozen=True, order=True)
class RunningTopic:
    """A topic that runs.

    Attributes:
        types: Its types, such as `geometry_msgs/msg/Twist`; more than one is a fault of theirs.
    """

    name: str
    types: tuple[str, ...]
    publishers: tuple[RosEndpoint, ...]
    subscriptions: tuple[RosEndpoint, ...]


@dataclass(frozen=True, order=True)
class RunningCall:
    """A service or an action that runs.

    Attributes:
        types: Its types, such as `std_srvs/srv/Trigger`; more than one is a fault of theirs.
        servers: Names of the nodes that serve it.
        clients: Names of the nodes that call it.
    """

    name: str
    types: tuple[str, ...]
    servers: tuple[str, ...]
    clients: tuple[str, ...]


@dataclass(frozen=True)
class RunningGraph:
    """What runs, each in the order of the names; that of ROS itself is left out.

    Attributes:
        joints: Names of the joints by the topic on which a node publishes them.
    """

    topics: tuple[RunningTopic, ...] = ()
    services: tuple[RunningCall, ...] = ()
    actions: tuple[RunningCall, ...] = ()
    joints: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def __bool__(self) -> bool:
        """Tells whether anything runs."""
        return bool(self.topics or self.services or self.actions)


def running_graph(seconds: float) -> RunningGraph:
    """Returns what runs.

    It looks until nothing has changed for two seconds, if there is anything. Then it waits for
    a message on each topic that names joints, not longer than the time that is left.

    Raises:
        RosFault: ROS cannot be used here.
    """
    end = time.monotonic() + seconds
    quiet = QuietNode("new").open()
    try:
        found = _settled(quiet.node, end)
        named = [each for each in found.topics if each.types == (_NAMED,) and each.publishers]
        return replace(found, joints=_joints(quiet, named, end)) if named else found
    finally:
        quiet.close()


def _settled(node: Any, end: float) -> RunningGraph:
    found = _graph(node)
    since = time.monotonic()
    while time.monotonic() < end and not (found and time.monotonic() - since >= _SETTLED):
        time.sleep(_POLL)
        now = _graph(node)
        if now != found:
            found, since = now, time.monotonic()
    return found


def _joints(
    quiet: QuietNode, topics: Sequence[RunningTopic], end: float
) -> dict[str, tuple[str, ...]]:
    """Returns the names of the first message on each topic, of those on which one comes."""
    kind = message_class(_NAMED)
    if kind is None:
        return {}
    found: dict[str, tuple[str, ...]] = {}
    come = Condition()

    def hear(topic: str) -> None:
        def take(message: Any) -> None:
            with come:
                found.setdefault(topic, tuple(message.name))
                come.notify_all()

        from rclpy.qos import qos_profile_sensor_data  # noqa: PLC0415

        quiet.node.create_subscription(kind, topic, take, qos_profile_sensor_data)

    for each in topics:
        hear(each.name)
    quiet.spin()
    with come:
        left = max(min(end - time.monotonic(), _LISTENED), _SETTLED)
        come.wait_for(lambda: len(found) == len(topics), left)
        return dict(found)


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
    return RunningGraph(
        tuple(sorted(each for each in topics if each.publishers or each.subscriptions)),
        services,
        actions,
    )


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
                ends.setdefault((name, is_server), set()).add(f"{namespace.rstrip('/')}/{node}")
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
        full = f"{each.node_namespace.rstrip('/')}/{each.node_name}"
        if each.node_name != own.get_name():
            found.append(RosEndpoint(full, qos.reliability, qos.durability))
    return tuple(sorted(found))

"""The running graph of ROS, with the first messages and the parameters. Needs rclpy."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from threading import Condition
from typing import Any

from jausml.live.ros.node import QuietNode, message_class
from jausml.runtime.bridge.ends.topics import Qos

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
    """The running topics, services and actions by name, without those of ROS itself."""

    topics: tuple[RunningTopic, ...] = ()
    services: tuple[RunningCall, ...] = ()
    actions: tuple[RunningCall, ...] = ()
    nodes: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        """Tells whether there is any topic, service or action."""
        return bool(self.topics or self.services or self.actions)


def settled_graph(node: Any, end: float) -> RunningGraph:
    """Returns the graph, once nothing has changed for two seconds if there is anything."""
    running_graph = _graph(node)
    since = time.monotonic()
    while time.monotonic() < end and not (running_graph and time.monotonic() - since >= SETTLED):
        time.sleep(_POLL)
        now = _graph(node)
        if now != running_graph:
            running_graph, since = now, time.monotonic()
    return running_graph


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
    nodes = (_full(*namespace) for namespace in node.get_node_names_and_namespaces())
    return RunningGraph(
        tuple(sorted(topic for topic in topics if topic.publishers or topic.subscriptions)),
        services,
        actions,
        tuple(sorted(other for other in nodes if not other.endswith(f"/{node.get_name()}"))),
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
    """Returns the calls that nodes serve and make, by two questions to the graph."""
    from rclpy.node import NodeNameNonExistentError  # noqa: PLC0415

    types: dict[str, set[str]] = {}
    ends: dict[tuple[str, bool], set[str]] = {}
    for node, namespace in own.get_node_names_and_namespaces():
        for is_server, ask in ((True, served), (False, called)):
            try:
                names_and_types = list(ask(node, namespace)) if node != own.get_name() else []
            except (NodeNameNonExistentError, RuntimeError):
                continue  # It has gone meanwhile.
            for name, kinds in names_and_types:
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
        if "/_" not in name
        and not all(type_name.startswith(_SERVED_BY_RCL) for type_name in types[name])
    )


def _ends(infos: Iterable[Any], own: Any) -> tuple[RosEndpoint, ...]:
    from jausml.runtime.bridge.ros.parameters import qos_of  # noqa: PLC0415

    endpoints = []
    for info in infos:
        qos = qos_of(info.qos_profile)
        full = _full(info.node_name, info.node_namespace)
        if info.node_name != own.get_name():
            endpoints.append(RosEndpoint(full, qos.reliability, qos.durability))
    return tuple(sorted(endpoints))


_MOST = 200  # parameters of a node that are read


_PATIENCE = 1.0  # seconds for an answer, before the same is asked again


class ParameterReader:
    """Asks nodes for their parameters."""

    def __init__(
        self, node: Any, nodes: Iterable[str], is_wanted: Callable[[str], bool], come: Condition
    ) -> None:
        from rcl_interfaces.srv import GetParameters, ListParameters  # noqa: PLC0415

        self.found: dict[str, dict[str, Any]] = {}
        self._is_wanted = is_wanted
        self._come = come
        self._get = GetParameters.Request
        self._list = ListParameters.Request
        self._waiting = {
            node_name: (
                node.create_client(ListParameters, f"{node_name}/list_parameters"),
                node.create_client(GetParameters, f"{node_name}/get_parameters"),
            )
            for node_name in nodes
        }
        self._asked_at: dict[str, float] = {}

    @property
    def unread(self) -> tuple[str, ...]:
        """The nodes that have not answered yet."""
        return tuple(sorted(self._waiting))

    def ask(self) -> None:
        """Asks the nodes whose services are there by now and that have not answered in a second.

        A server that has not found the client yet loses its answer.
        """
        now = time.monotonic()
        for name, (lists, gets) in list(self._waiting.items()):
            is_due = now - self._asked_at.get(name, -_PATIENCE) >= _PATIENCE
            if is_due and lists.service_is_ready() and gets.service_is_ready():
                self._asked_at[name] = now
                listed = lists.call_async(self._list())
                listed.add_done_callback(lambda done, of=name: self._listed(of, done.result()))

    def _listed(self, name: str, answer: Any) -> None:
        wanted = [parameter for parameter in answer.result.names if self._is_wanted(parameter)][
            :_MOST
        ]
        if not wanted:
            self._note(name, {})
            return
        if name in self._waiting:  # else its answer to an earlier question has come meanwhile
            got = self._waiting[name][1].call_async(self._get(names=wanted))
            got.add_done_callback(lambda done: self._got(name, wanted, done.result()))

    def _got(self, name: str, wanted: list[str], answer: Any) -> None:
        from rclpy.parameter import parameter_value_to_python  # noqa: PLC0415

        values = map(parameter_value_to_python, answer.values)
        self._note(
            name,
            {name: value for name, value in zip(wanted, values, strict=False) if value is not None},
        )

    def _note(self, name: str, values: dict[str, Any]) -> None:
        with self._come:
            if values:
                self.found[name] = values
            self._waiting.pop(name, None)
            self._come.notify_all()


_JOINTS = "sensor_msgs/msg/JointState"


class Hearing:
    """The first message on each topic whose messages name joints or frames.

    Attributes:
        frames: `header.frame_id` and `child_frame_id` of the messages, by topic; an empty text for
            one that they do not name.
    """

    def __init__(self, node: Any, topics: Iterable[RunningTopic], come: Condition) -> None:
        """Subscribes to what is published."""
        self.joints: dict[str, tuple[str, ...]] = {}
        self.frames: dict[str, tuple[str, str]] = {}
        self._come = come
        self._waiting: set[str] = set()
        for topic in topics:
            cls = (
                message_class(topic.types[0])
                if topic.publishers and len(topic.types) == 1
                else None
            )
            fields = {} if cls is None else cls.get_fields_and_field_types()
            if fields.get("header") == "std_msgs/Header":
                self._waiting.add(topic.name)
                self._subscribe(node, topic, cls)

    @property
    def silent(self) -> tuple[str, ...]:
        """The topics on which nothing has come yet."""
        return tuple(sorted(self._waiting))

    def _subscribe(self, node: Any, topic: RunningTopic, cls: Any) -> None:
        from rclpy.serialization import deserialize_message  # noqa: PLC0415

        def take(data: bytes) -> None:
            # An error of data of another definition of the type would end the thread of all.
            with self._come, suppress(RuntimeError):
                if topic.name not in self._waiting:
                    return  # Images and clouds are large: each is read once.
                self._note(topic, deserialize_message(data, cls))
                self._waiting.discard(topic.name)
                self._come.notify_all()

        profile = offered_profile(topic.publishers, depth=1)
        node.create_subscription(cls, topic.name, take, profile, raw=True)

    def _note(self, topic: RunningTopic, message: Any) -> None:
        if topic.types == (_JOINTS,):
            self.joints[topic.name] = tuple(message.name)
        frames = (message.header.frame_id, getattr(message, "child_frame_id", ""))
        if any(frames):
            self.frames[topic.name] = frames


_LISTENED, _TURN = 5.0, 0.1
"""Seconds for messages and answers, and from one look for what can be asked to the next."""


@dataclass(frozen=True)
class Running:
    """The running system.

    Attributes:
        silent: Topics whose messages would have told such names, and on which nothing came.
        unread: Nodes that do not tell their parameters.
    """

    graph: RunningGraph
    joints: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    frames: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    silent: tuple[str, ...] = ()
    parameters: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    unread: tuple[str, ...] = ()


def what_runs(seconds: float, is_wanted: Callable[[str], bool]) -> Running:
    """Returns the running system.

    It looks until nothing has changed for two seconds, if there is anything. Then it waits for
    messages and answers, not longer than the time that is left.
    """
    end = time.monotonic() + seconds
    quiet = QuietNode("new").open()
    try:
        graph = settled_graph(quiet.node, end)
        return _running(quiet, graph, is_wanted, end) if graph else Running(graph)
    finally:
        quiet.close()


def _running(
    quiet: QuietNode, graph: RunningGraph, is_wanted: Callable[[str], bool], end: float
) -> Running:
    come = Condition()
    heard = Hearing(quiet.node, graph.topics, come)
    read = ParameterReader(quiet.node, graph.nodes, is_wanted, come)
    quiet.spin()
    until = time.monotonic() + max(min(end - time.monotonic(), _LISTENED), SETTLED)
    with come:
        while (heard.silent or read.unread) and time.monotonic() < until:
            read.ask()
            come.wait(_TURN)
        return Running(
            graph,
            dict(heard.joints),
            dict(heard.frames),
            heard.silent,
            dict(read.found),
            read.unread,
        )


def offered_profile(offered: Sequence[Qos | RosEndpoint], depth: int) -> Any:
    """Returns the most of quality of service that all publishers offer, as rclpy has it."""
    from jausml.runtime.bridge.ends.topics import Qos  # noqa: PLC0415
    from jausml.runtime.bridge.ros.parameters import profile_of  # noqa: PLC0415

    is_reliable = all(offer.reliability == "reliable" for offer in offered)
    is_latched = all(offer.durability == "transient_local" for offer in offered)
    reliability = "reliable" if is_reliable else "best_effort"
    durability = "transient_local" if is_latched else "volatile"
    return profile_of(Qos(reliability, durability, depth=depth))

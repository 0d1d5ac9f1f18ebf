"""What runs in ROS, with what first messages and parameters of nodes say. Needs rclpy."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from threading import Condition
from typing import TYPE_CHECKING, Any

from jausml.live.ros.graph import SETTLED, RunningGraph, settled_graph
from jausml.live.ros.node import QuietNode, message_class, offered_profile

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from jausml.live.ros.graph import RunningTopic

_MOST = 200
"""Parameters of a node that are read."""


class ParameterReader:
    """Asks nodes for their parameters."""

    def __init__(
        self, node: Any, nodes: Iterable[str], is_wanted: Callable[[str], bool], come: Condition
    ) -> None:
        """Prepares to ask."""
        from rcl_interfaces.srv import GetParameters, ListParameters  # noqa: PLC0415

        self.found: dict[str, dict[str, Any]] = {}
        self._is_wanted = is_wanted
        self._come = come
        self._get = GetParameters.Request
        self._list = ListParameters.Request
        self._waiting = {
            each: (
                node.create_client(ListParameters, f"{each}/list_parameters"),
                node.create_client(GetParameters, f"{each}/get_parameters"),
            )
            for each in nodes
        }
        self._asked: set[str] = set()

    @property
    def unread(self) -> tuple[str, ...]:
        """The nodes that have not answered yet."""
        return tuple(sorted(self._waiting))

    def ask(self) -> None:
        """Asks the nodes whose services are there by now and that were not asked before."""
        for name, (lists, gets) in list(self._waiting.items()):
            if name not in self._asked and lists.service_is_ready() and gets.service_is_ready():
                self._asked.add(name)
                listed = lists.call_async(self._list())
                listed.add_done_callback(lambda done, of=name: self._listed(of, done.result()))

    def _listed(self, name: str, answer: Any) -> None:
        wanted = [each for each in answer.result.names if self._is_wanted(each)][:_MOST]
        if not wanted:
            self._note(name, {})
            return
        got = self._waiting[name][1].call_async(self._get(names=wanted))
        got.add_done_callback(lambda done: self._got(name, wanted, done.result()))

    def _got(self, name: str, wanted: list[str], answer: Any) -> None:
        from rclpy.parameter import parameter_value_to_python  # noqa: PLC0415

        values = map(parameter_value_to_python, answer.values)
        self._note(name, {n: v for n, v in zip(wanted, values, strict=False) if v is not None})

    def _note(self, name: str, values: dict[str, Any]) -> None:
        with self._come:
            if values:
                self.found[name] = values
            del self._waiting[name]
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
        for each in topics:
            cls = message_class(each.types[0]) if each.publishers and len(each.types) == 1 else None
            if cls is not None and "header" in cls.get_fields_and_field_types():
                self._waiting.add(each.name)
                self._subscribe(node, each, cls)

    @property
    def silent(self) -> tuple[str, ...]:
        """The topics on which nothing has come yet."""
        return tuple(sorted(self._waiting))

    def _subscribe(self, node: Any, topic: RunningTopic, cls: Any) -> None:
        from rclpy.serialization import deserialize_message  # noqa: PLC0415

        def take(data: bytes) -> None:
            with self._come:
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
    """What runs.

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
    """Returns what runs.

    It looks until nothing has changed for two seconds, if there is anything. Then it waits for
    messages and answers, not longer than the time that is left.
    """
    end = time.monotonic() + seconds
    quiet = QuietNode("new").open()
    try:
        graph = settled_graph(quiet.node, end)
        return _told(quiet, graph, is_wanted, end) if graph else Running(graph)
    finally:
        quiet.close()


def _told(
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

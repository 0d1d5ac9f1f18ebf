"""What runs in ROS, with what messages and parameters say of it. Needs rclpy."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from threading import Condition
from typing import TYPE_CHECKING, Any

from jausml.live.ros.graph import SETTLED, RunningGraph, settled_graph
from jausml.live.ros.hearing import Hearing
from jausml.live.ros.node import QuietNode
from jausml.live.ros.parameters import ParameterReader

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

_LISTENED, _TURN = 5.0, 0.1
"""Seconds for messages and answers, and from one look for what can be asked to the next."""


@dataclass(frozen=True)
class Running:
    """What runs.

    Attributes:
        joints: Names of the joints by the topic on which a node publishes them.
        frames: `header.frame_id` and `child_frame_id` of the messages, by topic.
        silent: Topics whose messages would have told such names, and on which nothing came.
        parameters: Values by name, by node.
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

    Args:
        is_wanted: Tells by the name of a parameter whether it is read.

    Raises:
        RosFault: ROS cannot be used here.
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

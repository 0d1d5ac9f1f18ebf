"""What runs in ROS: topics with their types, and who publishes and hears them. Needs rclpy."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.live.ros import QuietNode

if TYPE_CHECKING:
    from collections.abc import Iterable

_OF_ROS = frozenset({"/rosout", "/parameter_events"})
_POLL, _SETTLED = 0.1, 2.0
"""Seconds between two looks, and without a change after which all is known."""


@dataclass(frozen=True, order=True)
class GraphEnd:
    """A publisher or subscription that runs."""

    node: str
    reliability: str
    durability: str


@dataclass(frozen=True, order=True)
class GraphTopic:
    """A topic that runs.

    Attributes:
        types: Its types, such as `geometry_msgs/msg/Twist`; more than one is a fault of theirs.
    """

    name: str
    types: tuple[str, ...]
    publishers: tuple[GraphEnd, ...]
    subscriptions: tuple[GraphEnd, ...]


def running_topics(seconds: float) -> list[GraphTopic]:
    """Returns the topics that run, in the order of their names; those of ROS itself left out.

    It looks until nothing has changed for two seconds, if there is anything.
    """
    quiet = QuietNode("new").open()
    try:
        return _settled(quiet.node, seconds)
    finally:
        quiet.close()


def _settled(node: Any, seconds: float) -> list[GraphTopic]:
    end = time.monotonic() + seconds
    found = _topics(node)
    since = time.monotonic()
    while time.monotonic() < end and not (found and time.monotonic() - since >= _SETTLED):
        time.sleep(_POLL)
        now = _topics(node)
        if now != found:
            found, since = now, time.monotonic()
    return found


def _topics(node: Any) -> list[GraphTopic]:
    found = [
        GraphTopic(
            name,
            tuple(sorted(types)),
            _ends(node.get_publishers_info_by_topic(name), node),
            _ends(node.get_subscriptions_info_by_topic(name), node),
        )
        for name, types in node.get_topic_names_and_types()
        if name not in _OF_ROS and "/_" not in name
    ]
    return sorted(each for each in found if each.publishers or each.subscriptions)


def _ends(infos: Iterable[Any], own: Any) -> tuple[GraphEnd, ...]:
    from jausml.runtime.bridge.ros.profiles import qos_of  # noqa: PLC0415

    found = []
    for each in infos:
        qos = qos_of(each.qos_profile)
        full = f"{each.node_namespace.rstrip('/')}/{each.node_name}"
        if each.node_name != own.get_name():
            found.append(GraphEnd(full, qos.reliability, qos.durability))
    return tuple(sorted(found))

"""Nodes that look at ROS and leave no trace there: topics, their ends, messages. Needs rclpy."""

from __future__ import annotations

import importlib
import os
import time
from dataclasses import dataclass
from threading import Thread
from typing import TYPE_CHECKING, Any

from jausml.language.semantics.names import is_identifier

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from typing_extensions import Self


_PUBLISHED: dict[str, dict[str, tuple[str, ...]]] = {
    "msg": {"": ()},
    "srv": {"Event": ("Event",)},
    "action": {"FeedbackMessage": ("Impl", "FeedbackMessage")},
}
"""What of an interface is published: how its type name ends, and where the class is in rclpy."""

_OF_ROS = frozenset({"/rosout", "/parameter_events"})

_POLL, _SETTLED = 0.1, 2.0
"""Seconds between two looks, and without a change after which all is known."""


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

            self._context = Context()
            rclpy.init(context=self._context, args=[])
            self.node = rclpy.create_node(
                self._name,
                context=self._context,
                start_parameter_services=False,
                enable_rosout=False,
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


def running_topics(seconds: float) -> list[RunningTopic]:
    """Returns the topics that run, in the order of their names; those of ROS itself left out.

    It looks until nothing has changed for two seconds, if there is anything.
    """
    quiet = QuietNode("new").open()
    try:
        return _settled(quiet.node, seconds)
    finally:
        quiet.close()


def _settled(node: Any, seconds: float) -> list[RunningTopic]:
    end = time.monotonic() + seconds
    found = _topics(node)
    since = time.monotonic()
    while time.monotonic() < end and not (found and time.monotonic() - since >= _SETTLED):
        time.sleep(_POLL)
        now = _topics(node)
        if now != found:
            found, since = now, time.monotonic()
    return found


def _topics(node: Any) -> list[RunningTopic]:
    found = [
        RunningTopic(
            name,
            tuple(sorted(types)),
            _ends(node.get_publishers_info_by_topic(name), node),
            _ends(node.get_subscriptions_info_by_topic(name), node),
        )
        for name, types in node.get_topic_names_and_types()
        if name not in _OF_ROS and "/_" not in name
    ]
    return sorted(each for each in found if each.publishers or each.subscriptions)


def _ends(infos: Iterable[Any], own: Any) -> tuple[RosEndpoint, ...]:
    from jausml.runtime.bridge.ros.profiles import qos_of  # noqa: PLC0415

    found = []
    for each in infos:
        qos = qos_of(each.qos_profile)
        full = f"{each.node_namespace.rstrip('/')}/{each.node_name}"
        if each.node_name != own.get_name():
            found.append(RosEndpoint(full, qos.reliability, qos.durability))
    return tuple(sorted(found))

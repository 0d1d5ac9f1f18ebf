"""Nodes that look at ROS and leave no trace there. Needs rclpy."""

from __future__ import annotations

import importlib
import os
from threading import Thread
from typing import TYPE_CHECKING, Any

from jausml.language.semantics.names import is_identifier
from jausml.runtime.bridge.ros.environment import environment_fault

if TYPE_CHECKING:
    from collections.abc import Callable

    from typing_extensions import Self

_PUBLISHED: dict[str, dict[str, tuple[str, ...]]] = {
    "msg": {"": ()},
    "srv": {"Event": ("Event",)},
    "action": {
        "FeedbackMessage": ("Impl", "FeedbackMessage"),
        "SendGoal_Event": ("Impl", "SendGoalService", "Event"),
        "GetResult_Event": ("Impl", "GetResultService", "Event"),
    },
}
"""The published types of an interface: endings of their names, and their classes in rclpy."""

_DESCRIBES = "start_type_description_service"
"""A parameter of every node (since Jazzy; others ignore it): its service is a trace too, and takes
half of the time that a node takes to start."""


class RosFault(Exception):  # noqa: N818 - a state of the computer, not a fault of ours
    """ROS cannot be used here."""


class QuietNode:
    """A node in a context of its own, without parameters, services or log."""

    def __init__(self, purpose: str) -> None:
        self._name = f"jausml_{purpose}_{os.getpid()}"
        self._context: Any = None
        self._executor: Any = None
        self._thread: Thread | None = None
        self.node: Any = None

    def open(self, prepare: Callable[[Any], object] | None = None) -> Self:
        """Enters ROS."""
        fault = environment_fault()
        if fault:
            raise RosFault(fault)
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
        from jausml.runtime.bridge.ros.lifecycle import EndableExecutor  # noqa: PLC0415

        self._executor = EndableExecutor(self._context)
        self._executor.add_node(self.node)
        self._thread = Thread(target=self._spin, name=self._name, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Leaves ROS."""
        if self._thread is not None:
            self._executor.end()
            self._thread.join()
            self._executor.shutdown()
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
        ros_class = getattr(importlib.import_module(f"{package}.{kind}"), base, None)
    except ImportError:
        return None
    for attribute in _PUBLISHED[kind][role]:
        ros_class = getattr(ros_class, attribute, None)
    return ros_class

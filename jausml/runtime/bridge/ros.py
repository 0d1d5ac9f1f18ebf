"""The ROS side of a bridge: the only module of the runtime that imports rclpy.

A bridge sees three things of ROS: it subscribes, it publishes, and somebody waits. How a
subscription takes its messages and who waits for them stays in here.
"""

# ROS is typed in parts; whoever checks generated code reads this module too.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call"

from __future__ import annotations

import logging
import signal
import threading
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import ok, remove_ros_args, try_shutdown

from ..base.counters import LOGGER
from ..conversions import Time

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from .diagnostics import ConnectionStatus
    from .topics import Topic

WAKE_UP_PERIOD = 1.0
"""Longest time in seconds until a node that spins notices a shutdown."""

_LEVELS = {
    "ok": DiagnosticStatus.OK,
    "warning": DiagnosticStatus.WARN,
    "error": DiagnosticStatus.ERROR,
    "stale": DiagnosticStatus.STALE,
}


class RosNode:
    """One rclpy node with a thread that waits for its messages."""

    def __init__(self, name: str, namespace: str, arguments: Sequence[str] | None = None) -> None:
        """Joins ROS.

        Args:
            name: Node name, which `-r __node:=` changes.
            namespace: Namespace; empty means the root.
            arguments: Command line with `--ros-args`; None means none.
        """
        self._context = Context()
        # Signals are left to the process: ROS must outlive the release of JAUS control.
        rclpy.init(
            args=list(arguments or ()),
            context=self._context,
            signal_handler_options=SignalHandlerOptions.NO,
        )
        self._node = rclpy.create_node(name, namespace=namespace, context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._thread = threading.Thread(target=self._spin, name="ros", daemon=True)
        self._log = _RosLogHandler(self._node)
        self._diagnostics = self._node.create_publisher(DiagnosticArray, "/diagnostics", 10)

    @property
    def name(self) -> str:
        """Name of the node with its namespace, e.g. `/fleet/bridge`."""
        return str(self._node.get_fully_qualified_name())

    def now(self) -> Time:
        """Time of the ROS clock, which follows `/clock` when `use_sim_time` is set."""
        return Time(*self._node.get_clock().now().seconds_nanoseconds())

    def parameter(
        self, name: str, default: Any, description: str, limits: tuple[float, float] | None = None
    ) -> Any:
        """Declares a read-only parameter and returns its value.

        Args:
            name: Name of the parameter.
            default: Modelled value; its type is that of the parameter.
            description: Text of the descriptor.
            limits: Least and greatest value of a number.
        """
        descriptor = ParameterDescriptor(description=description, read_only=True)
        if limits is not None and isinstance(default, int):
            low, high = int(limits[0]), int(limits[1])
            descriptor.integer_range = [IntegerRange(from_value=low, to_value=high)]
        elif limits is not None:
            low_high = FloatingPointRange(from_value=limits[0], to_value=limits[1])
            descriptor.floating_point_range = [low_high]
        return self._node.declare_parameter(name, default, descriptor).value

    def publisher(self, message_type: type[Any], topic: Topic) -> Callable[[Any], None]:
        """Makes a publisher and returns what publishes on it, callable from any thread."""
        publish: Callable[[Any], None] = self._node.create_publisher(
            message_type,
            topic.name,
            _profile(topic),
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        ).publish
        return publish

    def subscribe(
        self, message_type: type[Any], topic: Topic, deliver: Callable[[Any], None]
    ) -> None:
        """Makes a subscription; `deliver` runs on the thread that waits for ROS messages."""
        self._node.create_subscription(
            message_type,
            topic.name,
            deliver,
            _profile(topic),
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        )

    def publish_diagnostics(self, statuses: Sequence[ConnectionStatus]) -> None:
        """Publishes one status for each connection on `/diagnostics`."""
        array = DiagnosticArray()
        array.header.stamp = self._node.get_clock().now().to_msg()
        array.status = [
            DiagnosticStatus(
                level=_LEVELS[status.level],
                name=f"{self.name}: {status.name}",
                message=status.message,
                hardware_id=status.hardware_id,
                values=[KeyValue(key=key, value=value) for key, value in status.values],
            )
            for status in statuses
        ]
        self._diagnostics.publish(array)

    def start(self) -> None:
        """Starts to wait for messages, on a thread of its own, and to log through ROS."""
        LOGGER.addHandler(self._log)
        LOGGER.propagate = False
        self._thread.start()

    def close(self) -> None:
        """Stops to wait and leaves ROS."""
        LOGGER.removeHandler(self._log)
        LOGGER.propagate = True
        self._executor.shutdown()
        if self._thread.is_alive():
            self._thread.join()
        self._node.destroy_node()
        try_shutdown(context=self._context)

    def _spin(self) -> None:
        try:
            self._executor.spin()
        except ExternalShutdownException:
            return


def spin(factory: Callable[[], Any], arguments: Sequence[str] | None) -> None:
    """Spins a node until SIGINT or SIGTERM.

    Args:
        factory: Makes the node, after ROS has begun.
        arguments: Command line without the program's name; that of the process when None.
    """
    # ROS itself ends on SIGINT; Python's KeyboardInterrupt would strike anywhere, even in clean-up.
    signal.signal(signal.SIGINT, lambda *_: None)
    rclpy.init(args=None if arguments is None else list(arguments))
    try:
        node = factory()
        # rclpy may begin to wait just after a signal has shut ROS down; nothing else wakes it then.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        node.create_timer(WAKE_UP_PERIOD, lambda: None, clock=steady)
        with suppress(ExternalShutdownException):
            rclpy.spin(node)
        node.destroy_node()
    except RuntimeError:
        # A signal shuts ROS down in the midst of anything, which rclpy may report like this.
        if ok():
            raise
    finally:
        try_shutdown()


def without_ros_arguments(line: Sequence[str]) -> list[str]:
    """Returns a command line, without the program's name, without what is meant for ROS."""
    own: list[str] = remove_ros_args(["", *line])[1:]
    return own


class _RosLogHandler(logging.Handler):
    """Hands the records of the runtime to the logger of the node, and so to /rosout."""

    def __init__(self, node: Any) -> None:
        super().__init__()
        self._logger = node.get_logger()

    def emit(self, record: logging.LogRecord) -> None:
        """Logs one record; rclpy tells severities by the place of the call, hence the branches."""
        text = self.format(record)
        if record.levelno >= logging.ERROR:
            self._logger.error(text)
        elif record.levelno >= logging.WARNING:
            self._logger.warning(text)
        elif record.levelno >= logging.INFO:
            self._logger.info(text)
        else:
            self._logger.debug(text)


def _profile(topic: Topic) -> QoSProfile:
    """The rclpy profile; its policies have the names that the model uses."""
    qos = topic.qos
    profile = QoSProfile(
        reliability=ReliabilityPolicy[qos.reliability.upper()],
        durability=DurabilityPolicy[qos.durability.upper()],
        history=HistoryPolicy[qos.history.upper()],
        depth=qos.depth,
        liveliness=LivelinessPolicy[qos.liveliness.upper()],
    )
    if qos.deadline > 0:
        profile.deadline = Duration(seconds=qos.deadline)
    if qos.lifespan > 0:
        profile.lifespan = Duration(seconds=qos.lifespan)
    if qos.lease_duration > 0:
        profile.liveliness_lease_duration = Duration(seconds=qos.lease_duration)
    return profile

"""The ROS side of a bridge: the only module of the runtime that imports rclpy.

A bridge sees three things of ROS: it subscribes, it publishes, and somebody waits. How a
subscription takes its messages and who waits for them stays in here.
"""

# ROS is typed in parts; whoever checks generated code reads this module too.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call"

from __future__ import annotations

import atexit
import logging
import signal
import threading
import time
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.exceptions import NameValidationException, ParameterException
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSPolicyKind,
    QoSProfile,
    ReliabilityPolicy,
    qos_policy_name_from_kind,
)
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import ok, remove_ros_args, try_shutdown

from ..base.counters import LOGGER
from ..component.process import ignore_signals
from ..conversions import Time
from .errors import RosLostError
from .parameters import ParameterError, nearest
from .quality import EndpointHealth
from .topics import Qos

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from rclpy.publisher import Publisher

    from .diagnostics import ConnectionStatus
    from .parameter import Parameter
    from .quality import TopicFault
    from .topics import Topic

LAST_WORDS = 1.0
"""Longest time in seconds that a node which ends waits for slow subscribers."""

WAKE_UP_PERIOD = 1.0
"""Longest time in seconds until a node that spins notices a shutdown."""

_LEVELS = {
    "ok": DiagnosticStatus.OK,
    "warning": DiagnosticStatus.WARN,
    "error": DiagnosticStatus.ERROR,
    "stale": DiagnosticStatus.STALE,
}

_OVERRIDABLE = (
    QoSPolicyKind.RELIABILITY,
    QoSPolicyKind.DURABILITY,
    QoSPolicyKind.HISTORY,
    QoSPolicyKind.DEPTH,
)
"""Policies that parameters may change; times are the business of the model."""

_UNLIMITED = 2**63 - 1
"""Nanoseconds that ROS reports for a time that nobody limits."""


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
        with _as_parameter_error():
            rclpy.init(
                args=list(arguments or ()),
                context=self._context,
                signal_handler_options=SignalHandlerOptions.NO,
            )
            self._node = rclpy.create_node(name, namespace=namespace, context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._thread: threading.Thread | None = None
        self._is_closing = False
        self._log = _RosLogHandler(self._node)
        self._publishers: list[Publisher] = []
        self._diagnostics = self._node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self._health: dict[tuple[Topic, bool], EndpointHealth] = {}
        self._checks: dict[str, Callable[[Any], object]] = {}
        self._followers: dict[str, Callable[[Any], None]] = {}
        self._node.add_on_set_parameters_callback(self._check_parameters)
        self._node.add_post_set_parameters_callback(self._apply_parameters)

    @property
    def name(self) -> str:
        """Name of the node with its namespace, e.g. `/fleet/bridge`."""
        return str(self._node.get_fully_qualified_name())

    def now(self) -> Time:
        """Time of the ROS clock, which follows `/clock` when `use_sim_time` is set."""
        return Time(*self._node.get_clock().now().seconds_nanoseconds())

    def parameter(self, parameter: Parameter, changed: Callable[[Any], None] | None = None) -> Any:
        """Declares a parameter and returns its value.

        Args:
            parameter: The parameter.
            changed: Takes each later value, on the thread that waits for ROS messages; without it
                the parameter cannot change.

        Raises:
            ParameterError: The command line or a parameter file gives it a value of another type,
                or one that does not do.
        """
        if parameter.check is not None:
            self._checks[parameter.name] = parameter.check
        with _as_parameter_error():
            declared = self._node.declare_parameter(
                parameter.name, parameter.default, _descriptor(parameter, is_fixed=changed is None)
            )
        if changed is not None:
            self._followers[parameter.name] = changed
        return declared.value

    def publisher(
        self, message_type: type[Any], topic: Topic, greet: Callable[[], None] | None = None
    ) -> Callable[[Any], None]:
        """Makes a publisher and returns what publishes on it, callable from any thread.

        Args:
            message_type: Class of the messages.
            topic: The topic.
            greet: Called for each subscriber that is found, on the thread that waits.

        Raises:
            ParameterError: A parameter gives it a name or a policy that ROS refuses.
        """
        with _as_parameter_error(f"topic {topic.name!a}: "):
            health = self._watched(topic, publishes=True)
            made = self._node.create_publisher(
                message_type,
                topic.name,
                _profile(topic.qos),
                event_callbacks=_publisher_events(health, greet),
                qos_overriding_options=_overriding(health),
            )
        health.qos = _qos(made.qos_profile)
        self._publishers.append(made)
        publish: Callable[[Any], None] = made.publish
        return publish

    def subscribe(
        self, message_type: type[Any], topic: Topic, deliver: Callable[[Any], None]
    ) -> None:
        """Makes a subscription; `deliver` runs on the thread that waits for ROS messages.

        Raises:
            ParameterError: A parameter gives it a name or a policy that ROS refuses.
        """
        with _as_parameter_error(f"topic {topic.name!a}: "):
            health = self._watched(topic, publishes=False)
            made = self._node.create_subscription(
                message_type,
                topic.name,
                deliver,
                _profile(topic.qos),
                event_callbacks=_subscription_events(health),
                qos_overriding_options=_overriding(health),
            )
        health.qos = _qos(made.qos_profile)

    def faults(self, topic: Topic, *, publishes: bool) -> list[TopicFault]:
        """Returns why a topic does not work as it should; nothing while it does.

        Args:
            topic: A topic that was subscribed to, or has a publisher.
            publishes: Whether its publisher is meant.
        """
        return self._health[topic, publishes].faults()

    def _watched(self, topic: Topic, *, publishes: bool) -> EndpointHealth:
        """Returns what will know how a publisher or subscription fares."""
        node, name = self._node, self._node.resolve_topic_name(topic.name)
        find = (
            node.get_subscriptions_info_by_topic if publishes else node.get_publishers_info_by_topic
        )
        kin = sum(
            (each.topic, each.publishes) == (name, publishes) for each in self._health.values()
        )
        entity = ("publisher" if publishes else "subscription") + (f"_{kin + 1}" if kin else "")

        def others() -> list[tuple[str, Qos]]:
            return [(_node_name(each), _qos(each.qos_profile)) for each in find(name)]

        health = EndpointHealth(publishes, name, topic.qos, entity, others)
        self._health[topic, publishes] = health
        return health

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

    def start(self, fail: Callable[[BaseException], None]) -> None:
        """Starts to wait for messages, on a thread of its own, and to log through ROS.

        Args:
            fail: Told on that thread why nobody waits any more, unless the node is closed.
        """
        _tell_unknown_parameters(self._node)
        LOGGER.addHandler(self._log)
        LOGGER.propagate = False
        self._thread = threading.Thread(target=self._spin, args=[fail], name="ros", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Stops to wait and leaves ROS, once subscribers have what was published last."""
        self._is_closing = True
        deadline = time.monotonic() + LAST_WORDS
        for publisher in self._publishers if self._context.ok() else ():
            publisher.wait_for_all_acked(Duration(seconds=max(deadline - time.monotonic(), 0.0)))
        LOGGER.removeHandler(self._log)
        LOGGER.propagate = True
        self._executor.shutdown()
        if self._thread is not None:
            self._thread.join()
        self._node.destroy_node()
        try_shutdown(context=self._context)

    def _check_parameters(self, parameters: Sequence[Any]) -> SetParametersResult:
        for each in parameters:
            try:
                self._checks.get(each.name, bool)(each.value)
            except ValueError as error:
                return SetParametersResult(successful=False, reason=f"{each.name}: {error}")
        return SetParametersResult(successful=True)

    def _apply_parameters(self, parameters: Sequence[Any]) -> None:
        for each in parameters:
            if each.name in self._followers:
                self._followers[each.name](each.value)

    def _spin(self, fail: Callable[[BaseException], None]) -> None:
        reason: BaseException = RosLostError("ROS was shut down under the bridge")
        try:
            self._executor.spin()
        except ExternalShutdownException:
            pass
        except BaseException as error:  # SystemExit of overridden methods too
            reason = error
        if not self._is_closing:
            fail(reason)


def spin(factory: Callable[[], Any], arguments: Sequence[str] | None) -> None:
    """Spins a node until SIGINT or SIGTERM.

    Args:
        factory: Makes the node, after ROS has begun.
        arguments: Command line without the program's name; that of the process when None.

    Raises:
        ParameterError: A parameter has a value with which the node cannot be made.
    """
    atexit.register(ignore_signals)
    # ROS itself ends on SIGINT; Python's KeyboardInterrupt would strike anywhere, even in clean-up.
    signal.signal(signal.SIGINT, lambda *_: None)
    with _as_parameter_error():
        rclpy.init(args=None if arguments is None else list(arguments))
    try:
        node = _made(factory)
        _tell_unknown_parameters(node)
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


def _made(factory: Callable[[], Any]) -> Any:
    """Makes a node; errors of the user's code stay as they are."""
    try:
        return factory()
    except ParameterException as error:
        raise ParameterError(" ".join(str(error).split())) from error


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


def _tell_unknown_parameters(node: Any) -> None:
    """Warns of parameters that nobody declared: they are misspelt, or of something else."""
    known = node.list_parameters([], 0).names
    # rclpy keeps what command line and files say here, and has no other way to ask for it.
    for name in node._parameter_overrides:  # noqa: SLF001
        if not node.has_parameter(name):
            meant = nearest(name, known)
            hint = f"; did you mean {meant}?" if meant else ""
            own = node.get_fully_qualified_name()
            LOGGER.warning("%s has no parameter %s%s", own, name, hint)


@contextmanager
def _as_parameter_error(about: str = "") -> Iterator[None]:
    """Gives what ROS refuses of names, files and values one class, and one line of text."""
    try:
        yield
    except (ParameterException, NameValidationException, RuntimeError) as error:
        raise ParameterError(about + " ".join(str(error).split())) from error


def _descriptor(parameter: Parameter, *, is_fixed: bool) -> ParameterDescriptor:
    descriptor = ParameterDescriptor(description=parameter.description, read_only=is_fixed)
    if parameter.limits is None:
        return descriptor
    low, high = parameter.limits
    if isinstance(parameter.default, int):
        descriptor.integer_range = [IntegerRange(from_value=int(low), to_value=int(high))]
    else:
        descriptor.floating_point_range = [FloatingPointRange(from_value=low, to_value=high)]
    return descriptor


def _overriding(health: EndpointHealth) -> QoSOverridingOptions:
    """A second endpoint of a topic has parameters of its own."""
    _, _, number = health.entity.partition("_")
    return QoSOverridingOptions(_OVERRIDABLE, entity_id=number or None)


def _publisher_events(
    health: EndpointHealth, greet: Callable[[], None] | None
) -> PublisherEventCallbacks:
    def matched(event: Any) -> None:
        if event.current_count_change > 0 and greet is not None:
            greet()

    # ROS waits for each event apart, so only for those that may come.
    qos = health.qos
    return PublisherEventCallbacks(
        incompatible_qos=lambda event: health.note_incompatible(_policy(event)),
        deadline=(lambda _: health.note_missed_deadline()) if qos.deadline > 0 else None,
        liveliness=(lambda _: health.note_lost_liveliness()) if qos.lease_duration > 0 else None,
        matched=None if greet is None else matched,
    )


def _subscription_events(health: EndpointHealth) -> SubscriptionEventCallbacks:
    def liveliness(event: Any) -> None:
        if event.alive_count > 0:
            health.note_liveliness()
        elif event.not_alive_count > 0:
            health.note_lost_liveliness()

    qos = health.qos
    return SubscriptionEventCallbacks(
        incompatible_qos=lambda event: health.note_incompatible(_policy(event)),
        deadline=(lambda _: health.note_missed_deadline()) if qos.deadline > 0 else None,
        liveliness=liveliness if qos.lease_duration > 0 else None,
    )


def _policy(event: Any) -> str:
    return str(qos_policy_name_from_kind(event.last_policy_kind))


def _node_name(end: Any) -> str:
    return f"{end.node_namespace.rstrip('/')}/{end.node_name}"


def _profile(qos: Qos) -> QoSProfile:
    """The rclpy profile; its policies have the names that the model uses."""
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


def _qos(profile: QoSProfile) -> Qos:
    """What `_profile` makes a profile of; of another node, history and depth are not known."""
    return Qos(
        reliability=profile.reliability.name.lower(),
        durability=profile.durability.name.lower(),
        deadline=_seconds(profile.deadline),
        lifespan=_seconds(profile.lifespan),
        liveliness=profile.liveliness.name.lower(),
        lease_duration=_seconds(profile.liveliness_lease_duration),
    )


def _seconds(duration: Duration) -> float:
    count = duration.nanoseconds
    return count / 1e9 if 0 < count < _UNLIMITED else 0.0

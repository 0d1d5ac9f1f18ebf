"""The ROS node of a bridge, on rclpy.

The loop waits for topics like for sockets (`topics.py`, `waiting.py`). The executor of rclpy has a
thread of its own for parameters, services and actions.
"""

# rclpy has few types, and type checks of generated code include this module.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call"

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import try_shutdown

from ...base.counters import LOGGER
from ...base.loop import Loop
from ...conversions import Time
from ..ends import parameters
from ..ends.topics import Qos, Topic
from ..messages.limits import RosLostError
from .internals import Codec, require_internals
from .lifecycle import GuardedExecutor, ManagedNode
from .parameters import NodeParameters, as_parameter_error
from .topics import NodeTopics, WaitingName

PartT = TypeVar("PartT")


class RosLogHandler(logging.Handler):
    """Passes log records of the runtime to the logger of the node, and so to /rosout."""

    def __init__(self, node: Any) -> None:
        super().__init__()
        self._logger = node.get_logger()

    def emit(self, record: logging.LogRecord) -> None:
        """Logs a record. rclpy allows one severity for each line of code, hence the branches."""
        text = self.format(record)
        if record.levelno >= logging.ERROR:
            self._logger.error(text)
        elif record.levelno >= logging.WARNING:
            self._logger.warning(text)
        elif record.levelno >= logging.INFO:
            self._logger.info(text)
        else:
            self._logger.debug(text)


class NodePart:
    """A part of a node, which the first call of `RosSide.part` makes."""

    def __init__(self, ros: RosNode) -> None:
        """Makes the part; the node has a loop."""

    def wait(self, deadline: float) -> None:
        """Waits for calls or goals under way, at most until a time of the steady clock."""

    def destroy(self) -> None:
        """Destroys all handles; called on the thread of the executor, or after its end."""


LAST_WORDS = 1.0  # longest seconds that an ending node waits for slow subscribers


class RosNode:
    """One rclpy node, whose topics a loop waits for.

    Attributes:
        node: The node of rclpy.
        executor: The executor of rclpy.
        loop: The loop, once it is attached.
        publisher, subscribe, faults: Methods of `NodeTopics`, once a loop is attached.
        parameter, check_parameters: `declare` and `check` of `NodeParameters`.
        manage, bring_up: Methods of `ManagedNode`.
    """

    def __init__(
        self,
        name: str,
        namespace: str,
        arguments: Sequence[str] | None = None,
        waiting: WaitingName = "automatic",
    ) -> None:
        """Joins ROS.

        Args:
            arguments: Command line with `--ros-args`, which may change the name.
            waiting: How to wait for topics, as the option `--ros-waiting`.

        Raises:
            ParameterError: The command line or a parameter file is wrong.
            RosLostError: rclpy lacks an attribute that the bridge uses.
        """
        self._context = Context()
        # Signals are left to the process: ROS must outlive the release of JAUS control.
        with as_parameter_error():
            rclpy.init(
                args=list(arguments or ()),
                context=self._context,
                signal_handler_options=SignalHandlerOptions.NO,
            )
            self.node = ManagedNode(name, namespace=namespace, context=self._context)
        require_internals(self.node)
        self.executor = GuardedExecutor(self._context)
        self.executor.add_node(self.node)
        self._thread: threading.Thread | None = None
        self._fail: Callable[[BaseException], None] | None = None
        self._is_closing = False
        self.ward: Any = None
        self._log = RosLogHandler(self.node)
        self._diagnostics = self.node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self._waiting_name = waiting
        self.loop: Loop
        self._topics: NodeTopics | None = None
        self._parts: dict[object, Any] = {}
        self._parameters = NodeParameters(self.node, arguments or ())
        self.parameter, self.check_parameters = self._parameters.declare, self._parameters.check
        self.manage, self.bring_up = self.node.manage, self.node.bring_up
        self._clock: Any = self.node.get_clock()  # a ROSClock, as nodes have
        self._is_simulated = False
        self.node.add_post_set_parameters_callback(self._follow_simulation)
        self._follow_simulation()
        self._age_limit = round(
            self.parameter(parameters.QUEUE_AGE.of(parameters.QUEUE_AGE_LIMIT)) * 1e9
        )

    @property
    def name(self) -> str:
        """Name of the node with its namespace, e.g. `/fleet/bridge`."""
        return str(self.node.get_fully_qualified_name())

    def now(self) -> Time:
        """Returns the time of the ROS clock: that of `/clock` if `use_sim_time` is set."""
        if self._is_simulated:
            return Time(*self._clock.now().seconds_nanoseconds())
        return Time(*divmod(time.time_ns(), 10**9))

    @property
    def is_simulated(self) -> bool:
        """Whether the ROS clock follows `/clock`."""
        return self._is_simulated

    def follow_clock(self, take: Callable[[float], None]) -> None:
        """Calls `take` with each time on `/clock` in seconds, on the loop or with its lock."""
        from rosgraph_msgs.msg import Clock  # noqa: PLC0415 - most bridges do not need it

        decode = self.codec(Clock).decode

        def take_clock(data: bytes, _stamp: int) -> None:
            clock = decode(data).clock
            take(clock.sec + clock.nanosec * 1e-9)

        self.subscribe(Clock, Topic("/clock", Qos(reliability="best_effort", depth=1)), take_clock)

    def codec(self, ros_type: type[Any]) -> Codec:
        """Returns the codec of a type; raises ImportError or RosTypeError as `message_class`."""
        return Codec(ros_type)

    # ------------------------------------------------------------------ endpoints

    def attach(self, loop: Loop) -> None:
        """Chooses how to wait; to be called before the first publisher or subscription."""
        self.loop = loop
        self.executor.counters = loop.counters
        self._topics = topics = NodeTopics(
            self.node, self._context, loop, self._waiting_name, self._parameters, self._age_limit
        )
        self.publisher, self.subscribe = topics.publisher, topics.subscribe
        self.faults = topics.faults

    def part(self, load: Callable[[], Callable[[Any], PartT]]) -> PartT:
        """Returns a part of the node, once a loop is attached; see `RosSide.part`."""
        kind = load()
        if kind not in self._parts:
            self._parts[kind] = kind(self)
        part: PartT = self._parts[kind]
        return part

    # ------------------------------------------------------------------ life

    def publish_diagnostics(self, data: bytes) -> None:
        """Publishes a serialized `diagnostic_msgs/msg/DiagnosticArray`."""
        self._diagnostics.publish(data)

    def start(self, fail: Callable[[BaseException], None]) -> None:
        """Starts to wait for messages and requests, and to log to ROS.

        Args:
            fail: Called with the error that ends a thread before `close`, on that thread.
        """
        LOGGER.addHandler(self._log)
        LOGGER.propagate = False
        self._fail = fail
        self.listen()
        self._thread = threading.Thread(target=self._spin, args=[fail], name="ros", daemon=True)
        self._thread.start()

    def listen(self) -> None:
        """Takes messages of new subscriptions from now on; no effect before `start`."""
        if self._topics is not None and self._fail is not None:
            self._topics.listen(self._fail)

    def release(self) -> None:
        """Destroys all topics, once subscribers have the messages published last.

        The caller must not hold the lock of the loop, which callbacks may need. At the end of the
        process, `close` does the same.
        """
        self._finish()
        # While the executor runs, only its thread may destroy handles, which it may be using.
        if self._thread in (None, threading.current_thread()):
            self._destroy()

    def _finish(self) -> None:
        """Waits until subscribers have the published messages, and clients their results."""
        if not self._context.ok():
            return
        deadline = time.monotonic() + LAST_WORDS
        if self._topics is not None:
            self._topics.wait(deadline)
        # Goals end on the thread of the executor, which cannot wait for itself.
        if threading.current_thread() is not self._thread:
            for part in self._parts.values():
                part.wait(deadline)

    def _destroy(self) -> None:
        """Destroys all handles; called on the thread of the executor, or after its end."""
        for part in self._parts.values():
            part.destroy()
        self._parts.clear()
        if self._topics is not None:
            self._topics.destroy()
            self._topics = None
        self._parameters.release()

    # ------------------------------------------------------------------ transitions

    def shut_down(self) -> None:
        """Goes to finalized, unless it is there or ROS has ended."""
        if self._context.ok() and self.node.state != "finalized":
            self.node.trigger_shutdown()

    def close(self) -> None:
        """Leaves ROS, once subscribers have the messages published last.

        The caller must not hold the lock of the loop, which callbacks may need.
        """
        if self._is_closing:
            return
        self._is_closing = True
        LOGGER.removeHandler(self._log)
        LOGGER.propagate = True
        self._finish()
        self.executor.end()
        if self._thread is not None:
            self._thread.join()
        self.executor.shutdown()
        self._destroy()
        self.node.destroy_node()
        try_shutdown(context=self._context)

    def _follow_simulation(self, _: object = None) -> None:
        former, self._is_simulated = self._is_simulated, self._clock.ros_time_is_active
        if self._thread is not None and former is not self._is_simulated:
            LOGGER.warning(
                "use_sim_time: stamps follow at once, rates and time-outs after a new start"
            )

    def _spin(self, fail: Callable[[BaseException], None]) -> None:
        reason: BaseException = RosLostError("ROS was shut down under the bridge")
        try:
            self.executor.spin()
        except ExternalShutdownException:
            pass
        except BaseException as error:  # SystemExit of overridden methods too
            reason = error
        if not self._is_closing:
            fail(reason)

"""The ROS side of a bridge, on rclpy.

The loop waits for topics as it waits for sockets, see `ros_listener.py`; the executor of rclpy has
a thread of its own for parameters, services and `/clock`. Publishers and subscriptions are made
below the classes `Publisher` and `Subscription` of rclpy: the executor would look at each of those
whenever it wakes up.
"""

# ROS is typed in parts; whoever checks generated code reads this module too.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call"

from __future__ import annotations

import threading
import time
from collections import Counter
from typing import TYPE_CHECKING, Any, Literal, Protocol

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions
from rclpy.type_support import check_is_valid_msg_type
from rclpy.utilities import try_shutdown

from ..base.counters import LOGGER
from ..conversions import Time
from . import parameters
from .errors import RosLostError
from .quality import EndpointHealth
from .ros_codec import Codec, message_class
from .ros_events import matched_event, publisher_events, subscription_events
from .ros_internals import internals, require_internals
from .ros_lifecycle import ManagedNode
from .ros_listener import Listener, NoListenerError
from .ros_log import RosLogHandler
from .ros_parameters import NodeParameters, as_parameter_error, tell_unknown
from .ros_profiles import OVERRIDABLE, deep_enough, never_waiting, overridden, profile_of, qos_of
from .ros_publisher import NodePublisher
from .ros_services import NodeServices
from .ros_taking import Subscription
from .ros_wait_set import WaitSets
from .topics import Qos, Topic, TopicCounts

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from ..base.loop import Loop
    from .actions import ActionClient, GoalTaker, ListAction
    from .parameter import Parameter
    from .quality import TopicFault
    from .ros_actions import NodeActions
    from .ros_lifecycle import Managed
    from .ros_services import NodeClient, TakeRequest
    from .service_client import RosService

LAST_WORDS = 1.0
"""Longest time in seconds that a node which ends waits for slow subscribers."""

WaitingName = Literal["automatic", "listener", "wait-set"]
"""How the bridge waits for ROS; `automatic` takes the listener where there is one."""


class Waiting(Protocol):
    """Waits for topics and events, and runs what takes them with the lock of the loop."""

    def subscription(self, subscription: Subscription) -> None:
        """Takes the messages of a subscription, what waits already included."""

    def event(self, event: Any, read: Callable[[], object]) -> None:
        """Runs `read` when an event has something to tell."""

    def start(self, fail: Callable[[BaseException], None]) -> None:
        """Begins; `fail` is told why nobody waits any more."""

    def close(self) -> None:
        """Ends; the handles may be destroyed then."""


class RosNode:
    """One rclpy node, whose topics a loop waits for."""

    def __init__(
        self,
        name: str,
        namespace: str,
        arguments: Sequence[str] | None = None,
        waiting: WaitingName = "automatic",
    ) -> None:
        """Joins ROS.

        Args:
            name: Node name, which `-r __node:=` changes.
            namespace: Namespace; empty means the root.
            arguments: Command line with `--ros-args`; None means none.
            waiting: How to wait for topics.
        """
        self._context = Context()
        # Signals are left to the process: ROS must outlive the release of JAUS control.
        with as_parameter_error():
            rclpy.init(
                args=list(arguments or ()),
                context=self._context,
                signal_handler_options=SignalHandlerOptions.NO,
            )
            self._node = ManagedNode(name, namespace=namespace, context=self._context)
        require_internals(self._node)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._thread: threading.Thread | None = None
        self._fail: Callable[[BaseException], None] | None = None
        self._is_closing = False
        self._log = RosLogHandler(self._node)
        self._diagnostics = self._node.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self._health: dict[tuple[Topic, bool], EndpointHealth] = {}
        self._kin: Counter[tuple[str, bool]] = Counter()  # endpoints that share a topic
        self._publishers: list[Any] = []
        self._subscriptions: list[Any] = []
        self._events: list[Any] = []
        self._waiting_name = waiting
        self._loop: Loop | None = None
        self._actions: NodeActions | None = None
        self._waiting: Waiting | None = None
        self._services: NodeServices | None = None
        self._parameters = NodeParameters(self._node)
        self._clock: Any = self._node.get_clock()  # a ROSClock, as nodes have
        self._is_simulated = False
        self._parameters.follow("use_sim_time", self._follow_simulation)
        self._follow_simulation()
        self._age_limit = round(self.parameter(parameters.queue_age_limit()) * 1e9)

    @property
    def name(self) -> str:
        """Name of the node with its namespace, e.g. `/fleet/bridge`."""
        return str(self._node.get_fully_qualified_name())

    def now(self) -> Time:
        """Time of the ROS clock, which follows `/clock` when `use_sim_time` is set."""
        if self._is_simulated:
            return Time(*self._clock.now().seconds_nanoseconds())
        return Time(*divmod(time.time_ns(), 10**9))

    @property
    def is_simulated(self) -> bool:
        """Whether the ROS clock follows `/clock`."""
        return self._is_simulated

    def follow_clock(self, take: Callable[[float], None]) -> None:
        """Gives each time on `/clock` in seconds to a function, on the loop or with its lock."""
        from rosgraph_msgs.msg import Clock  # noqa: PLC0415 - most bridges are in no simulation

        decode = self.codec(Clock).decode

        def hear(data: bytes, _stamp: int) -> None:
            clock = decode(data).clock
            take(clock.sec + clock.nanosec * 1e-9)

        self.subscribe(Clock, Topic("/clock", Qos(reliability="best_effort", depth=1)), hear)

    def parameter(self, parameter: Parameter, changed: Callable[[Any], None] | None = None) -> Any:
        """Declares a parameter and returns its value.

        Args:
            parameter: The parameter.
            changed: Takes each later value, on the thread of the executor; without it the parameter
                cannot change.

        Raises:
            ParameterError: The command line or a parameter file gives it a value of another type,
                or one that does not do.
        """
        return self._parameters.declare(parameter, changed)

    def codec(self, ros_type: type[Any]) -> Codec:
        """Returns what makes objects of serialized messages, and the reverse.

        Args:
            ros_type: A class of rclpy, or a light class, whose `TYPE` names the type.

        Raises:
            ImportError: ROS has no such type here.
        """
        return Codec(ros_type)

    # ------------------------------------------------------------------ endpoints

    def attach(self, loop: Loop) -> None:
        """Chooses how to wait; to be called before there are publishers and subscriptions.

        Args:
            loop: The loop on which, or with whose lock, messages are taken.

        Raises:
            ParameterError: Only a listener would do, and there is none.
        """
        self._loop = loop
        self._services = NodeServices(self._node, loop)
        if self._waiting_name == "wait-set":
            self._waiting = WaitSets(loop, self._context)
            return
        try:
            self._waiting = self._listener(loop)
        except NoListenerError as error:
            if self._waiting_name == "listener":
                raise parameters.ParameterError(f"--ros-waiting listener: {error}") from error
            LOGGER.warning("waiting for ROS with a wait set, which is slower: %s", error)
            self._waiting = WaitSets(loop, self._context)

    def action_client(self, action: ListAction) -> ActionClient:
        """Makes what sends goals of an action.

        Raises:
            RosTypeError: Its type is not installed as the model has it.
            ParameterError: A parameter gives it a name that ROS refuses.
        """
        return self._node_actions().client(action)

    def serve_action(self, action: ListAction, taker: GoalTaker) -> None:
        """Takes the goals of an action.

        Raises:
            RosTypeError: Its type is not installed as the model has it.
            ParameterError: A parameter gives it a name that ROS refuses.
        """
        self._node_actions().serve(action, taker)

    def _node_actions(self) -> NodeActions:
        # Bridges without actions do not wait for what rclpy imports for them.
        from .ros_actions import NodeActions  # noqa: PLC0415

        if self._loop is None:
            raise RuntimeError("no loop is attached")
        if self._actions is None:
            self._actions = NodeActions(self._node, self._executor, self._loop)
        return self._actions

    def publisher(
        self,
        ros_type: type[Any],
        topic: Topic,
        greet: Callable[[], None] | None = None,
    ) -> NodePublisher:
        """Makes a publisher.

        Args:
            ros_type: A class of rclpy, or a light class, whose `TYPE` names the type.
            topic: The topic.
            greet: Called for each subscriber that is found, on the loop or with its lock.

        Raises:
            ParameterError: A parameter gives it a name or a policy that ROS refuses.
        """
        found = message_class(ros_type)
        health = self._watched(topic, topic.qos, publishes=True)
        health.qos = never_waiting(health.qos)
        handle = self._made(internals.Publisher, found, topic, health)
        self._publishers.append(handle)
        made = NodePublisher(handle, found)

        def matched(state: Any) -> None:
            made.matched = state.current_count
            if state.current_count_change > 0 and greet is not None:
                greet()

        self._wait_for(publisher_events(handle, health, matched))
        return made

    def subscribe(
        self, ros_type: type[Any], topic: Topic, take: Callable[[bytes, int], None]
    ) -> TopicCounts:
        """Makes a subscription; messages are taken after `start`.

        Args:
            ros_type: A class of rclpy, or a light class, whose `TYPE` names the type.
            topic: The topic.
            take: Is given each serialized message, and the time at which it was published, in
                nanoseconds by the clock of its publisher; on the loop or with its lock.

        Returns:
            The counts, which go on.

        Raises:
            ParameterError: A parameter gives it a name or a policy that ROS refuses.
        """
        found, counts = message_class(ros_type), TopicCounts()
        health = self._watched(topic, deep_enough(topic.qos), publishes=False)
        handle = self._made(internals.Subscription, found, topic, health)
        self._subscriptions.append(handle)
        qos = health.qos
        # What is latched is as old as it is.
        age_limit = self._age_limit if qos.durability == "volatile" else 0
        depth = qos.depth if qos.history == "keep_last" else 0
        self._wait_for(subscription_events(handle, health))
        matched = matched_event(handle)
        self._events.append(matched)
        self._present_waiting.subscription(
            Subscription(handle, matched, found, depth, take, age_limit, counts)
        )
        return counts

    def serve(self, service: RosService, take: TakeRequest) -> None:
        """Serves a service; see `RosSide`."""
        self._present_services.serve(service, take)

    def service_client(self, service: RosService) -> NodeClient:
        """Returns what calls a service; see `RosSide`."""
        return self._present_services.client(service)

    @property
    def _present_services(self) -> NodeServices:
        if self._services is None:
            raise RuntimeError("no loop is attached")
        return self._services

    def faults(self, topic: Topic, *, publishes: bool) -> list[TopicFault]:
        """Returns why a topic does not work as it should; nothing while it does.

        Args:
            topic: A topic that was subscribed to, or has a publisher.
            publishes: Whether its publisher is meant.
        """
        return self._health[topic, publishes].faults()

    @property
    def _present_waiting(self) -> Waiting:
        if self._waiting is None:
            raise RuntimeError("no loop is attached")
        return self._waiting

    def _listener(self, loop: Loop) -> Listener:
        """Returns the listener, tried with a subscription and an event that go at once."""
        listener = Listener(loop)
        node = self._node.handle
        with node:
            profile = profile_of(Qos()).get_c_qos_profile()
            trial = internals.Subscription(node, DiagnosticArray, "_trial", profile)
        matched = matched_event(trial)
        try:
            listener.try_out(trial, matched)
        finally:
            matched.destroy_when_not_in_use()
            trial.destroy_when_not_in_use()
        return listener

    def _watched(self, topic: Topic, qos: Qos, *, publishes: bool) -> EndpointHealth:
        """Returns what will know how a publisher or subscription fares, with its final quality."""
        node = self._node
        with as_parameter_error(f"topic {topic.name!a}: "):
            name = node.resolve_topic_name(topic.name)
        find = (
            node.get_subscriptions_info_by_topic if publishes else node.get_publishers_info_by_topic
        )
        kin = self._kin[name, publishes]
        self._kin[name, publishes] += 1
        entity = ("publisher" if publishes else "subscription") + (f"_{kin + 1}" if kin else "")

        def others() -> list[tuple[str, Qos]]:
            return [(_node_name(each), qos_of(each.qos_profile)) for each in find(name)]

        health = EndpointHealth(publishes, name, qos, entity, others)
        health.qos = overridden(health, self._parameters.given, self._parameters.declare)
        self._health[topic, publishes] = health
        return health

    def _made(self, kind: Any, found: type[Any], topic: Topic, health: EndpointHealth) -> Any:
        """Returns the handle of a new publisher or subscription."""
        check_is_valid_msg_type(found)
        with as_parameter_error(f"topic {topic.name!a}: "), self._node.handle:
            profile = profile_of(health.qos).get_c_qos_profile()
            return kind(self._node.handle, found, topic.name, profile)

    def _wait_for(self, events: Iterator[tuple[Any, Callable[[], None]]]) -> None:
        for event, read in events:
            self._events.append(event)
            self._present_waiting.event(event, read)

    # ------------------------------------------------------------------ life

    def publish_diagnostics(self, data: bytes) -> None:
        """Publishes a serialized `diagnostic_msgs/msg/DiagnosticArray`."""
        self._diagnostics.publish(data)

    def start(self, fail: Callable[[BaseException], None]) -> None:
        """Starts to wait for messages and parameters, and to log through ROS.

        Args:
            fail: Told, on the thread concerned, why nobody waits any more, unless the node is
                closed.
        """
        LOGGER.addHandler(self._log)
        LOGGER.propagate = False
        self._fail = fail
        self.listen()
        self._thread = threading.Thread(target=self._spin, args=[fail], name="ros", daemon=True)
        self._thread.start()

    def listen(self) -> None:
        """Begins to take the messages of what was subscribed to; before `start`, that does."""
        if self._waiting is None or self._fail is None:
            return
        possible = (
            each.parameter(policy) for each in self._health.values() for policy in OVERRIDABLE
        )
        tell_unknown(self._node, possible)
        self._waiting.start(self._fail)

    def release(self) -> None:
        """Gives all topics back, once subscribers have what was published last.

        At the end of the process, `close` does. The caller must not hold the lock of the loop:
        whoever waits may need it to finish.
        """
        self._finish()
        # The executor may look at ends just now; while it runs, it alone may destroy them.
        if self._thread in (None, threading.current_thread()):
            self._give_back()

    def _finish(self) -> None:
        """Waits until subscribers have what was published, and clients the ends of their goals."""
        if not self._context.ok():
            return
        deadline = time.monotonic() + LAST_WORDS
        for publisher in self._publishers:
            left = Duration(seconds=max(deadline - time.monotonic(), 0.0))
            publisher.wait_for_all_acked(left.get_c_duration())
        # Goals end on the thread of the executor, which cannot wait for itself.
        if self._actions is not None and threading.current_thread() is not self._thread:
            self._actions.wait(deadline)

    def _give_back(self) -> None:
        """Destroys all ends; to be called on the thread of the executor, or when it is over."""
        if self._actions is not None:
            self._actions.destroy()
            self._actions = None
        if self._waiting is not None:
            self._waiting.close()
            self._waiting = None
        for handle in (*self._events, *self._subscriptions, *self._publishers):
            handle.destroy_when_not_in_use()
        if self._services is not None:
            self._services.destroy()
            self._services = None
        for known in (self._events, self._subscriptions, self._publishers):
            known.clear()
        self._health.clear()
        self._kin.clear()
        self._parameters.release()

    # ------------------------------------------------------------------ transitions

    def manage(self, managed: Managed) -> None:
        """Has transitions of the node act on something from now on."""
        self._node.manage(managed)

    def bring_up(self) -> None:
        """Goes from unconfigured to active.

        Raises:
            BaseException: What keeps it from there.
        """
        self._node.bring_up()

    def shut_down(self) -> None:
        """Goes to finalized, unless it is there or ROS is gone."""
        if self._context.ok() and self._node.state != "finalized":
            self._node.trigger_shutdown()

    def close(self) -> None:
        """Stops to wait and leaves ROS, once subscribers have what was published last.

        The caller must not hold the lock of the loop: whoever waits may need it to finish.
        """
        if self._is_closing:
            return
        self._is_closing = True
        LOGGER.removeHandler(self._log)
        LOGGER.propagate = True
        self._finish()
        self._executor.shutdown()
        if self._thread is not None:
            self._thread.join()
        self._give_back()
        self._node.destroy_node()
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
            self._executor.spin()
        except ExternalShutdownException:
            pass
        except BaseException as error:  # SystemExit of overridden methods too
            reason = error
        if not self._is_closing:
            fail(reason)


def _node_name(end: Any) -> str:
    return f"{end.node_namespace.rstrip('/')}/{end.node_name}"

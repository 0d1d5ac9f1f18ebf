"""Clients and servers of ROS actions, on rclpy.

rclpy has actions done by its executor, so all of it happens on that thread; what concerns the
bridge is handed to the loop. A goal is not executed by a coroutine, which the executor would look
at without a pause: it is marked as executing, and given its result when it is there.
"""

# ROS is typed in parts; whoever checks generated code reads this module too.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call, misc"

from __future__ import annotations

import importlib
import threading
import time
from collections import deque
from functools import partial
from itertools import islice
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalStatus
from action_msgs.srv import CancelGoal
from rclpy.action.client import ActionClient
from rclpy.action.server import ActionServer, CancelResponse, GoalEvent, GoalResponse

from .actions import LONGEST_GOAL, Outcome
from .errors import RosTypeError
from .quality import TopicFault
from .ros_codec import Codec
from .ros_parameters import as_parameter_error

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ..base.loop import Loop
    from .actions import GoalTaker, GoalWatcher, ListAction

_OUTCOMES = {
    GoalStatus.STATUS_SUCCEEDED: Outcome.SUCCEEDED,
    GoalStatus.STATUS_ABORTED: Outcome.ABORTED,
    GoalStatus.STATUS_CANCELED: Outcome.CANCELED,
}

NO_SERVER = "no_action_server"


class ActionMessages:
    """The classes of rclpy of an action, and their members that the bridge knows."""

    def __init__(self, action: ListAction) -> None:
        """Finds them.

        Args:
            action: What the model says of the action.

        Raises:
            RosTypeError: The type is not installed as the model has it.
        """
        self.type = _installed(action.type_name)
        self._codec = Codec(action.element)
        self._action = action
        kind = self._codec.message_class
        element = f"{kind.__module__.split('.')[0]}/{kind.__name__}"
        _require(self.type.Goal, action.goal, f"sequence<{element}", action.type_name)
        _require(self.type.Feedback, action.progress, ("int", "uint"), action.type_name)
        _require(self.type.Result, action.reason, "string", action.type_name)

    def goal(self, elements: Sequence[bytes]) -> Any:
        """Returns a goal with these serialized elements."""
        goal = self.type.Goal()
        _set(goal, self._action.goal, [self._codec.decode(each) for each in elements])
        return goal

    def elements(self, goal: Any) -> list[bytes]:
        """Returns the elements of a goal, serialized: one more than it may have at most."""
        found = attrgetter(self._action.goal)(goal)
        return [self._codec.encode(each) for each in islice(found, LONGEST_GOAL + 1)]

    def feedback(self, number: int) -> Any:
        """Returns a feedback that says how far the list is; None when there is no such number."""
        if not self._action.progress:
            return None
        feedback = self.type.Feedback()
        _set(feedback, self._action.progress, number)
        return feedback

    def progress(self, feedback: Any) -> int | None:
        """Returns how far a feedback says that the list is; None when it does not."""
        path = self._action.progress
        return int(attrgetter(path)(feedback)) if path else None

    def result(self, reason: str) -> Any:
        """Returns a result that gives a reason, if results have a place for one."""
        result = self.type.Result()
        if self._action.reason:
            _set(result, self._action.reason, reason)
        return result

    def reason(self, result: Any) -> str:
        """Returns the reason that a result gives; empty when there is none."""
        return str(attrgetter(self._action.reason)(result)) if self._action.reason else ""


class NodeActions:
    """The actions of one node.

    Attributes:
        node: The node of rclpy.
        loop: What the bridge is told on, or with its lock.
    """

    def __init__(self, node: Any, executor: Any, loop: Loop) -> None:
        """Has no actions yet.

        Args:
            node: The node of rclpy.
            executor: What runs it.
            loop: What the bridge is told on, or with its lock.
        """
        self.loop = loop
        self.node = node
        self._executor = executor
        self._waiting: deque[Callable[[], object]] = deque()
        self._ends: list[Any] = []
        self._open: set[object] = set()
        self._changed = threading.Condition()

    def client(self, action: ListAction) -> NodeActionClient:
        """Returns what sends goals of an action.

        Raises:
            RosTypeError: The type is not installed as the model has it.
            ParameterError: ROS refuses the name.
        """
        client = NodeActionClient(self, ActionMessages(action), action.name)
        self._ends.append(client.handle)
        return client

    def serve(self, action: ListAction, taker: GoalTaker) -> None:
        """Takes the goals of an action.

        Raises:
            RosTypeError: The type is not installed as the model has it.
            ParameterError: ROS refuses the name.
        """
        server = NodeActionServer(self, ActionMessages(action), action.name, taker)
        self._ends.append(server.handle)

    def run(self, callback: Callable[..., object], *arguments: object) -> None:
        """Runs a callback on the thread of the executor, after those asked for earlier.

        The executor begins with the task that it got last, so the order is kept here.
        """
        self._waiting.append(partial(callback, *arguments))
        self._executor.create_task(self._run_next)

    def _run_next(self) -> None:
        self.guarded(self._waiting.popleft())

    def guarded(self, callback: Callable[..., object], *arguments: object) -> None:
        """Runs a callback; an error is counted, for it would end the executor."""
        try:
            callback(*arguments)
        except Exception as error:
            self.loop.counters.count("ros_actions.failed", repr(error), error=error)

    def opened(self, goal: object) -> None:
        """Notes a goal that is under way."""
        with self._changed:
            self._open.add(goal)

    def closed(self, goal: object) -> None:
        """Notes a goal that has ended."""
        with self._changed:
            self._open.discard(goal)
            self._changed.notify_all()

    def wait(self, deadline: float) -> None:
        """Waits until all goals have ended, but not longer than to a time of the steady clock."""
        with self._changed:
            while self._open and (left := deadline - time.monotonic()) > 0:
                self._changed.wait(left)

    def destroy(self) -> None:
        """Leaves ROS; the executor must not run any more."""
        for each in self._ends:
            each.destroy()


class NodeActionClient:
    """Sends goals of one action.

    Attributes:
        handle: The client of rclpy.
        messages: The classes of the action.
        name: Name of the action.
        actions: The actions of the node.
    """

    def __init__(self, actions: NodeActions, messages: ActionMessages, name: str) -> None:
        """Use `NodeActions.client` instead."""
        self.actions = actions
        self.messages = messages
        self.name = name
        with as_parameter_error(f"action {name!a}: "):
            self.handle = ActionClient(actions.node, messages.type, name)

    def send(
        self,
        elements: Sequence[bytes],
        fill: Callable[[Any], object] | None,
        watcher: GoalWatcher,
    ) -> NodeGoal:
        """Sends a goal; see `ActionClient` of actions.py."""
        goal = NodeGoal(self, watcher)
        self.actions.run(goal.send, elements, fill)
        return goal

    def faults(self) -> list[TopicFault]:
        """Returns why goals cannot be sent; nothing while they can."""
        if self.handle.server_is_ready():
            return []
        return [TopicFault(NO_SERVER, f"nobody serves the action {self.name}")]

    def servers(self) -> int:
        """Returns how many servers of the action there are."""
        return int(self.actions.node.count_publishers(f"{self.name}/_action/status"))


class NodeGoal:
    """A goal that was sent: all but the three methods of `SentGoal` runs on the executor."""

    def __init__(self, client: NodeActionClient, watcher: GoalWatcher) -> None:
        """Use `NodeActionClient.send` instead."""
        self._client = client
        self._watcher: GoalWatcher | None = watcher
        self._handle: Any = None
        self._is_cancelled = False
        self._has_ended = False
        self._unsent: tuple[Sequence[bytes], Callable[[Any], object] | None] | None = None
        self._servers = 0

    # ------------------------------------------------------------------ SentGoal, on any thread

    def cancel(self) -> None:
        """Asks that it ends; also when it is accepted later. May be repeated."""
        self._client.actions.run(self._cancel)

    def check(self) -> None:
        """Finds out whether whoever executes it is there."""
        self._client.actions.run(self._check)

    def forget(self) -> None:
        """Tells nothing of it any more; if it is accepted later, it is cancelled."""
        self._watcher = None
        self.cancel()

    # ------------------------------------------------------------------ on the executor

    def send(self, elements: Sequence[bytes], fill: Callable[[Any], object] | None) -> None:
        """Sends it, or waits for somebody to serve the action: `check` tries again."""
        client = self._client
        if self._has_ended or self._is_cancelled:
            self._end(Outcome.CANCELED, "")
            return
        if client.faults():
            self._unsent = (elements, fill)
            return
        self._unsent = None
        try:
            message = client.messages.goal(elements)
            if fill is not None:
                with client.actions.loop.lock:
                    fill(message)
            self._servers = client.servers()
            answer = client.handle.send_goal_async(message, feedback_callback=self._feedback)
        except Exception as error:  # of what the user has written, or of the values it sets
            self._end(Outcome.REFUSED, f"the goal cannot be made: {error!r}")
            return
        client.actions.opened(self)
        answer.add_done_callback(self._guarded(self._answered))

    def _guarded(self, callback: Callable[[Any], None]) -> Callable[[Any], None]:
        return partial(self._client.actions.guarded, callback)

    def _answered(self, future: Any) -> None:
        handle = future.result()
        if not handle.accepted:
            self._end(Outcome.REFUSED, "the action server refused the goal")
            return
        self._handle = handle
        self._ask_for_result()
        if self._is_cancelled:
            self._cancel()
        else:
            self._tell("accepted")

    def _ask_for_result(self) -> None:
        self._handle.get_result_async().add_done_callback(self._guarded(self._resulted))

    def _resulted(self, future: Any) -> None:
        response = future.result()
        outcome = _OUTCOMES.get(response.status)
        if outcome is None:
            self._end(Outcome.LOST, "the action server does not know the goal any more")
        else:
            self._end(outcome, self._client.messages.reason(response.result))

    def _feedback(self, message: Any) -> None:
        number = self._client.messages.progress(message.feedback)
        if number is not None:
            self._tell("progressed", number)

    def _cancel(self) -> None:
        self._is_cancelled = True
        if self._unsent is not None:
            self._unsent = None
            self._end(Outcome.CANCELED, "")
        elif self._handle is not None and not self._has_ended:
            self._handle.cancel_goal_async().add_done_callback(self._guarded(self._cancel_answered))

    def _cancel_answered(self, future: Any) -> None:
        if future.result().return_code == CancelGoal.Response.ERROR_UNKNOWN_GOAL_ID:
            self._end(Outcome.LOST, "the action server does not know the goal any more")

    def _check(self) -> None:
        if self._has_ended:
            return
        if self._unsent is not None:
            self.send(*self._unsent)
            return
        servers = self._client.servers()
        if not servers:
            self._end(Outcome.LOST, "the action server is gone")
        elif servers != self._servers and self._handle is not None:
            # Another one may serve by now, which has never heard of the goal.
            self._servers = servers
            self._ask_for_result()

    def _end(self, outcome: Outcome, reason: str) -> None:
        if not self._has_ended:
            self._has_ended = True
            self._client.actions.closed(self)
            self._tell("ended", outcome, reason)

    def _tell(self, what: str, *arguments: object) -> None:
        watcher = self._watcher
        if watcher is not None:
            self._client.actions.loop.call_soon(partial(getattr(watcher, what), self, *arguments))


class NodeActionServer:
    """Takes the goals of one action.

    Attributes:
        handle: The server of rclpy.
        messages: The classes of the action.
        actions: The actions of the node.
    """

    def __init__(
        self,
        actions: NodeActions,
        messages: ActionMessages,
        name: str,
        taker: GoalTaker,
    ) -> None:
        """Use `NodeActions.serve` instead."""
        self.actions = actions
        self.messages = messages
        self._taker = taker
        self._goals: dict[bytes, NodeServedGoal] = {}
        with as_parameter_error(f"action {name!a}: "):
            self.handle = ActionServer(
                actions.node,
                messages.type,
                name,
                execute_callback=lambda _handle: messages.result(""),
                goal_callback=self._asked,
                handle_accepted_callback=self._accepted,
                cancel_callback=self._cancel_asked,
            )

    def _asked(self, request: Any) -> Any:
        answers: list[bool] = []
        self.actions.guarded(self._ask, request, answers)
        return GoalResponse.ACCEPT if answers == [True] else GoalResponse.REJECT

    def _ask(self, request: Any, answers: list[bool]) -> None:
        elements = self.messages.elements(request)
        with self.actions.loop.lock:
            answers.append(self._taker.accepts(elements, request))

    def _accepted(self, handle: Any) -> None:
        goal = self._goals[bytes(handle.goal_id.uuid)] = NodeServedGoal(self, handle)
        self.actions.opened(goal)
        handle._update_state(GoalEvent.EXECUTE)  # noqa: SLF001 - public ones also end the goal
        self.actions.guarded(self._begin, goal)

    def _begin(self, goal: NodeServedGoal) -> None:
        with self.actions.loop.lock:
            self._taker.begin(goal)

    def _cancel_asked(self, handle: Any) -> Any:
        goal = self._goals.get(bytes(handle.goal_id.uuid))
        if goal is None:
            return CancelResponse.REJECT
        # After this answer, by which the goal becomes one that is being cancelled.
        self.actions.run(self._cancel, goal)
        return CancelResponse.ACCEPT

    def _cancel(self, goal: NodeServedGoal) -> None:
        with self.actions.loop.lock:
            self._taker.cancel(goal)

    def forget(self, handle: Any) -> None:
        """Drops a goal that has its result."""
        goal = self._goals.pop(bytes(handle.goal_id.uuid), None)
        if goal is not None:
            self.actions.closed(goal)


class NodeServedGoal:
    """A goal that a ROS client has sent.

    Attributes:
        request: The goal of rclpy.
    """

    def __init__(self, server: NodeActionServer, handle: Any) -> None:
        """Made by the server."""
        self.request = handle.request
        self._server = server
        self._handle = handle

    def progress(self, number: int) -> None:
        """Publishes feedback."""
        feedback = self._server.messages.feedback(number)
        if feedback is not None:
            self._server.actions.run(self._handle.publish_feedback, feedback)

    def end(self, outcome: Outcome, reason: str = "") -> None:
        """Gives the result: succeeded, aborted or, if its client asked for that, canceled."""
        execute = self._server.handle.notify_execute
        self._server.actions.run(execute, self._handle, partial(self._result, outcome, reason))

    def _result(self, outcome: Outcome, reason: str, handle: Any) -> Any:
        if outcome is Outcome.SUCCEEDED:
            handle.succeed()
        elif outcome is Outcome.CANCELED and handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.abort()
        self._server.forget(handle)
        return self._server.messages.result(reason)


def _installed(name: str) -> Any:
    package, kind, own = name.split("/")
    try:
        return getattr(importlib.import_module(f"{package}.{kind}"), own)
    except (ImportError, AttributeError) as error:
        raise RosTypeError(f"{name} is not installed ({error})") from error


def _require(kind: Any, path: str, types: str | tuple[str, ...], name: str) -> None:
    """Refuses a type that has not what the bridge reads and writes there."""
    if not path:
        return
    parent, _, member = path.rpartition(".")
    try:
        owner = attrgetter(parent)(kind()) if parent else kind
        found = owner.get_fields_and_field_types()[member]
    except (AttributeError, KeyError):
        found = "nothing"
    if not found.startswith(types):
        wanted = types if isinstance(types, str) else " or ".join(types)
        raise RosTypeError(f"{name}: {path} is {found} there, not {wanted}")


def _set(message: Any, path: str, value: object) -> None:
    parent, _, member = path.rpartition(".")
    setattr(attrgetter(parent)(message) if parent else message, member, value)

"""The ROS actions of a bridge, on rclpy: servers, clients, and their goals.

rclpy runs actions on its executor, so the code here runs on that thread (`action_work.py`), and
calls back on the loop, or with its lock.
"""

# rclpy has few types, and type checks of generated code include this module.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call, misc"

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from functools import partial
from hashlib import blake2b
from typing import Any

from action_msgs.msg import GoalStatus, GoalStatusArray
from action_msgs.srv import CancelGoal
from rclpy.action.client import ActionClient
from rclpy.action.server import ActionServer, CancelResponse, GoalEvent, GoalResponse
from rclpy.qos import qos_profile_action_status_default

from ...base.counters import LOGGER
from ..ends.actions import GoalTaker, GoalWatcher, ListAction, Outcome
from ..ends.topics import TopicFault
from .action_work import ActionMessages, ActionWork
from .introspection import introspection
from .node import NodePart, RosNode
from .parameters import as_parameter_error
from .values import checked

MARK_SIZE = 8  # octets of a goal id that all goals of one node to one action share; 8 are random
_UNDER_WAY = frozenset({GoalStatus.STATUS_ACCEPTED, GoalStatus.STATUS_EXECUTING})


class FormerGoals:
    """Cancels goals that an earlier process of the bridge has sent before it crashed.

    The ids of goals begin with a mark of domain, node and action. So no file is needed, and goals
    of other clients are not affected. Everything runs on the executor.
    """

    def __init__(self, work: ActionWork, name: str, service: str) -> None:
        """Subscribes to the states of goals, which are a latched topic of their server."""
        node = work.node
        words = (node.context.get_domain_id(), node.get_fully_qualified_name(), service)
        self._mark = blake2b("\0".join(map(str, words)).encode(), digest_size=MARK_SIZE).digest()
        self._work = work
        self._name = name
        self._client = node.create_client(CancelGoal, service)
        self._subscription = node.create_subscription(
            GoalStatusArray,
            f"{name}/_action/status",
            self._take_states,
            qos_profile_action_status_default,
        )

    def new_id(self) -> bytes:
        """Returns the id for a goal of this process."""
        goal_id = self._mark + os.urandom(16 - MARK_SIZE)
        self._work.own_goals.add(goal_id)
        return goal_id

    def forget(self, goal: bytes) -> None:
        """Forgets a goal of this process that has ended."""
        self._work.own_goals.discard(goal)

    def destroy(self) -> None:
        """Leaves ROS."""
        self._work.node.destroy_subscription(self._subscription)
        self._work.node.destroy_client(self._client)

    def _take_states(self, message: Any) -> None:
        self._work.guarded(self._cancel_former, message)

    def _cancel_former(self, message: Any) -> None:
        for status in message.status_list:
            goal = bytes(status.goal_info.goal_id.uuid)
            is_former = goal.startswith(self._mark) and goal not in self._work.own_goals
            if is_former and status.status in _UNDER_WAY:
                self._work.own_goals.add(goal)  # to be cancelled once
                LOGGER.warning("%s: a goal of a former life is cancelled", self._name)
                request = CancelGoal.Request()
                request.goal_info.goal_id.uuid = list(goal)
                self._client.call_async(request)


_OUTCOMES = {
    GoalStatus.STATUS_SUCCEEDED: Outcome.SUCCEEDED,
    GoalStatus.STATUS_ABORTED: Outcome.ABORTED,
    GoalStatus.STATUS_CANCELED: Outcome.CANCELED,
}

NO_SERVER = "no_action_server"


class NodeActionClient:
    """Sends goals of one action."""

    def __init__(self, work: ActionWork, messages: ActionMessages, name: str) -> None:
        """Made by `NodeActions.action_client`."""
        self.work = work
        self.messages = messages
        self.name = name
        with as_parameter_error(f"action {name!a}: "):
            self.handle = ActionClient(work.node, messages.type, name)
        # Full name of the service that cancels its goals.
        self.cancelling = work.node.resolve_service_name(f"{name}/_action/cancel_goal")
        self.former = FormerGoals(work, name, self.cancelling)

    def send(
        self, elements: Sequence[bytes], fill: Callable[[Any], object] | None, watcher: GoalWatcher
    ) -> NodeGoal:
        """Sends a goal; see `ActionClient` of ends/actions.py."""
        goal = NodeGoal(self, watcher)
        self.work.run(goal.send, elements, fill)
        return goal

    def faults(self) -> list[TopicFault]:
        """Returns that the action has no server, if so."""
        if self.handle.server_is_ready():
            return []
        return [TopicFault(NO_SERVER, f"nobody serves the action {self.name}")]

    def servers(self) -> int:
        """Returns the number of servers of the action."""
        return int(self.work.node.count_publishers(f"{self.name}/_action/status"))


class NodeGoal:
    """A goal of the bridge. All but the three methods of `SentGoal` runs on the executor."""

    def __init__(self, client: NodeActionClient, watcher: GoalWatcher) -> None:
        """Made by `NodeActionClient.send`."""
        self._client = client
        self._watcher: GoalWatcher | None = watcher
        self._handle: Any = None
        self._is_cancelled = False
        self._has_ended = False
        self._unsent: tuple[Sequence[bytes], Callable[[Any], object] | None] | None = None
        self._servers = 0
        self._distances: list[float] = []
        self._id = client.former.new_id()

    # ------------------------------------------------------------------ SentGoal, on any thread

    def cancel(self) -> None:
        """Requests its cancellation, now or when it is accepted; may be repeated."""
        self._client.work.run(self._cancel)

    def check(self) -> None:
        """Ends the goal as lost if its server has gone; sends it if there was no server before."""
        self._client.work.run(self._check)

    def forget(self) -> None:
        """Calls its watcher no more; the goal is cancelled if it is accepted later."""
        self._watcher = None
        self.cancel()

    # ------------------------------------------------------------------ on the executor

    def send(self, elements: Sequence[bytes], fill: Callable[[Any], object] | None) -> None:
        """Sends the goal; without a server, `check` tries again."""
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
                with client.work.loop.lock:
                    fill(message)
            self._distances = client.messages.distances(checked(message))
            self._servers = client.servers()
            self._guard()
            goal_id = CancelGoal.Request().goal_info.goal_id
            goal_id.uuid = list(self._id)
            answer = client.handle.send_goal_async(message, self._take_feedback, goal_id)
        except Exception as error:  # of code of the user, or of values that it sets
            self._end(Outcome.REFUSED, f"the goal cannot be made: {error!r}")
            return
        client.work.add_goal(self)
        answer.add_done_callback(self._guarded(self._take_answer))

    def _guard(self) -> None:
        """Registers the goal with the guardian, before it is sent."""
        work = self._client.work
        if work.ward is not None:
            work.ward.guard_goal(self._id, self._client.cancelling)

    def _guarded(self, callback: Callable[[Any], None]) -> Callable[[Any], None]:
        return partial(self._client.work.guarded, callback)

    def _take_answer(self, future: Any) -> None:
        handle = future.result()
        if not handle.accepted:
            self._end(Outcome.REFUSED, "the action server refused the goal")
            return
        self._handle = handle
        self._ask_for_result()
        if self._is_cancelled:
            self._cancel()
        else:
            self._call_watcher("accepted")

    def _ask_for_result(self) -> None:
        self._handle.get_result_async().add_done_callback(self._guarded(self._take_result))

    def _take_result(self, future: Any) -> None:
        response = future.result()
        outcome = _OUTCOMES.get(response.status)
        if outcome is None:
            self._end(Outcome.LOST, "the action server does not know the goal any more")
        else:
            self._end(outcome, self._client.messages.reason(response.result))

    def _take_feedback(self, message: Any) -> None:
        number = self._client.messages.progress(message.feedback, self._distances)
        if number is not None:
            self._call_watcher("progressed", number)

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
            # Another server may have replaced the one that knew the goal.
            self._servers = servers
            self._ask_for_result()

    def _end(self, outcome: Outcome, reason: str) -> None:
        if not self._has_ended:
            self._has_ended = True
            self._client.work.remove_goal(self)
            self._client.former.forget(self._id)
            if self._client.work.ward is not None:
                self._client.work.ward.close_goal(self._id)
            self._call_watcher("ended", outcome, reason)

    def _call_watcher(self, method: str, *arguments: object) -> None:
        watcher = self._watcher
        if watcher is not None:
            self._client.work.loop.call_soon(partial(getattr(watcher, method), self, *arguments))


class NodeActionServer:
    """Takes the goals of one action.

    A goal is not executed by a coroutine, which the executor would poll without a pause. It is
    marked as executing, and later given its result.
    """

    def __init__(
        self, work: ActionWork, messages: ActionMessages, name: str, taker: GoalTaker
    ) -> None:
        """Made by `NodeActions.serve_action`."""
        self.work = work
        self.messages = messages
        self._taker = taker
        self._goals: dict[bytes, NodeServedGoal] = {}
        with as_parameter_error(f"action {name!a}: "):
            self.handle = ActionServer(
                work.node,
                messages.type,
                name,
                execute_callback=lambda _handle: messages.result(""),
                goal_callback=self._decide,
                handle_accepted_callback=self._execute,
                cancel_callback=self._accept_cancel,
            )

    def _decide(self, request: Any) -> Any:
        answers: list[bool] = []
        self.work.guarded(self._ask, request, answers)
        return GoalResponse.ACCEPT if answers == [True] else GoalResponse.REJECT

    def _ask(self, request: Any, answers: list[bool]) -> None:
        elements = self.messages.elements(request)
        with self.work.loop.lock:
            answers.append(self._taker.accepts(elements, request))

    def _execute(self, handle: Any) -> None:
        goal = self._goals[bytes(handle.goal_id.uuid)] = NodeServedGoal(self, handle)
        self.work.add_goal(goal)
        handle._update_state(GoalEvent.EXECUTE)  # noqa: SLF001 - public methods also end the goal
        self.work.guarded(self._begin, goal)

    def _begin(self, goal: NodeServedGoal) -> None:
        with self.work.loop.lock:
            self._taker.begin(goal)

    def _accept_cancel(self, handle: Any) -> Any:
        goal = self._goals.get(bytes(handle.goal_id.uuid))
        if goal is None:
            return CancelResponse.REJECT
        # After this answer, by which the state of the goal becomes canceling.
        self.work.run(self._cancel, goal)
        return CancelResponse.ACCEPT

    def _cancel(self, goal: NodeServedGoal) -> None:
        with self.work.loop.lock:
            self._taker.cancel(goal)

    def forget(self, handle: Any) -> None:
        """Forgets a goal that has its result."""
        goal = self._goals.pop(bytes(handle.goal_id.uuid), None)
        if goal is not None:
            # After the next task, which sends the result to its client.
            self.work.run(self.work.run, self.work.remove_goal, goal)


class NodeServedGoal:
    """A goal that a ROS client has sent."""

    def __init__(self, server: NodeActionServer, handle: Any) -> None:
        self.request = handle.request
        self._server = server
        self._handle = handle

    def progress(self, number: int) -> None:
        """Publishes feedback."""
        feedback = self._server.messages.feedback(number)
        if feedback is not None:
            self._server.work.run(self._handle.publish_feedback, feedback)

    def end(self, outcome: Outcome, reason: str = "") -> None:
        """Sends the result: succeeded, aborted or, if its client asked for that, canceled."""
        execute = self._server.handle.notify_execute
        self._server.work.run(execute, self._handle, partial(self._result, outcome, reason))

    def _result(self, outcome: Outcome, reason: str, handle: Any) -> Any:
        if outcome is Outcome.SUCCEEDED:
            handle.succeed()
        elif outcome is Outcome.CANCELED and handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.abort()
        self._server.forget(handle)
        return self._server.messages.result(reason)


class NodeActions(NodePart):
    """The actions of one node."""

    def __init__(self, ros: RosNode) -> None:
        self._work = ActionWork(ros.node, ros.executor, ros.loop, ros.ward)
        self._introspection = ros.part(introspection)
        self._ends: list[Any] = []

    def action_client(self, action: ListAction) -> NodeActionClient:
        """Returns a client of an action; raises RosTypeError or ParameterError."""
        client = NodeActionClient(self._work, ActionMessages(action), action.name)
        self._ends += [client.handle, client.former]
        self._introspection.add(client.handle)
        return client

    def serve_action(self, action: ListAction, taker: GoalTaker) -> None:
        """Serves an action; raises RosTypeError or ParameterError."""
        server = NodeActionServer(self._work, ActionMessages(action), action.name, taker)
        self._ends.append(server.handle)
        self._introspection.add(server.handle)

    def wait(self, deadline: float) -> None:
        """Waits until all goals have ended, or until a time of the steady clock."""
        self._work.wait(deadline)

    def destroy(self) -> None:
        """Leaves ROS; the executor must not run any more."""
        for end in self._ends:
            end.destroy()

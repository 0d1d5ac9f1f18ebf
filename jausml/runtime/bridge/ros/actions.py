"""The ROS actions of a bridge, on rclpy.

rclpy has actions done by its executor, so all of it happens on that thread (`ros_action_work.py`);
what concerns the bridge is handed to the loop.
"""

# ROS is typed in parts; whoever checks generated code reads this module too.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call, misc"

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from rclpy.action.server import ActionServer, CancelResponse, GoalEvent, GoalResponse

from ..ends.actions import Outcome
from .action_client import NodeActionClient
from .action_work import ActionMessages, ActionWork
from .parameters import as_parameter_error

if TYPE_CHECKING:
    from ...base.loop import Loop
    from ...guardian.ward import Ward
    from ..ends.actions import GoalTaker, ListAction


class NodeActionServer:
    """Takes the goals of one action.

    A goal is not executed by a coroutine, which the executor would look at without a pause: it is
    marked as executing, and given its result when it is there.
    """

    def __init__(
        self,
        work: ActionWork,
        messages: ActionMessages,
        name: str,
        taker: GoalTaker,
    ) -> None:
        """Use `NodeActions.serve` instead."""
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
                goal_callback=self._asked,
                handle_accepted_callback=self._accepted,
                cancel_callback=self._cancel_asked,
            )

    def _asked(self, request: Any) -> Any:
        answers: list[bool] = []
        self.work.guarded(self._ask, request, answers)
        return GoalResponse.ACCEPT if answers == [True] else GoalResponse.REJECT

    def _ask(self, request: Any, answers: list[bool]) -> None:
        elements = self.messages.elements(request)
        with self.work.loop.lock:
            answers.append(self._taker.accepts(elements, request))

    def _accepted(self, handle: Any) -> None:
        goal = self._goals[bytes(handle.goal_id.uuid)] = NodeServedGoal(self, handle)
        self.work.opened(goal)
        handle._update_state(GoalEvent.EXECUTE)  # noqa: SLF001 - public ones also end the goal
        self.work.guarded(self._begin, goal)

    def _begin(self, goal: NodeServedGoal) -> None:
        with self.work.loop.lock:
            self._taker.begin(goal)

    def _cancel_asked(self, handle: Any) -> Any:
        goal = self._goals.get(bytes(handle.goal_id.uuid))
        if goal is None:
            return CancelResponse.REJECT
        # After this answer, by which the goal becomes one that is being cancelled.
        self.work.run(self._cancel, goal)
        return CancelResponse.ACCEPT

    def _cancel(self, goal: NodeServedGoal) -> None:
        with self.work.loop.lock:
            self._taker.cancel(goal)

    def forget(self, handle: Any) -> None:
        """Drops a goal that has its result."""
        goal = self._goals.pop(bytes(handle.goal_id.uuid), None)
        if goal is not None:
            self.work.closed(goal)


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
        """Gives the result: succeeded, aborted or, if its client asked for that, canceled."""
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


class NodeActions:
    """The actions of one node."""

    def __init__(self, node: Any, executor: Any, loop: Loop, ward: Ward | None) -> None:
        self._work = ActionWork(node, executor, loop, ward)
        self._ends: list[Any] = []

    def client(self, action: ListAction) -> NodeActionClient:
        """Returns what sends goals of an action."""
        client = NodeActionClient(self._work, ActionMessages(action), action.name)
        self._ends += [client.handle, client.former]
        return client

    def serve(self, action: ListAction, taker: GoalTaker) -> None:
        """Takes the goals of an action."""
        server = NodeActionServer(self._work, ActionMessages(action), action.name, taker)
        self._ends.append(server.handle)

    def wait(self, deadline: float) -> None:
        """Waits until all goals have ended, but not longer than to a time of the steady clock."""
        self._work.wait(deadline)

    def destroy(self) -> None:
        """Leaves ROS; the executor must not run any more."""
        for each in self._ends:
            each.destroy()

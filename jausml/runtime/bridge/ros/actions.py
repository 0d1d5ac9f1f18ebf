"""The ROS actions of a bridge, on rclpy.

rclpy has actions done by its executor, so all of it happens on that thread (`ros_action_work.py`);
what concerns the bridge is handed to the loop.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .action_client import NodeActionClient
from .action_messages import ActionMessages
from .action_server import NodeActionServer
from .action_work import ActionWork

if TYPE_CHECKING:
    from ...base.loop import Loop
    from ...guardian.ward import Ward
    from ..ends.actions import GoalTaker, ListAction


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

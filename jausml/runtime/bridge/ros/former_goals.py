"""Goals that a bridge sent in a former life, and that are still followed."""

# ROS is typed in parts; whoever checks generated code reads this module too.
# mypy: disable-error-code="import-not-found, import-untyped, no-untyped-call, misc"

from __future__ import annotations

import os
from hashlib import blake2b
from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalStatus, GoalStatusArray
from action_msgs.srv import CancelGoal
from rclpy.qos import qos_profile_action_status_default

from ...base.counters import LOGGER

if TYPE_CHECKING:
    from .action_work import ActionWork

MARK_SIZE = 8
"""Octets of a goal id that are the same for all goals of one node to one action; 8 are random."""

_GOES_ON = frozenset({GoalStatus.STATUS_ACCEPTED, GoalStatus.STATUS_EXECUTING})


class FormerGoals:
    """Cancels what the bridge sent before it died: nobody follows those goals any more.

    The ids of goals begin with a mark of domain, node and action, so no file is needed, and goals
    of others are left alone. All of it runs on the executor.
    """

    def __init__(self, work: ActionWork, name: str, service: str) -> None:
        """Listens to the states of goals, which their server gives newcomers too."""
        node = work.node
        words = (node.context.get_domain_id(), node.get_fully_qualified_name(), service)
        self._mark = blake2b("\0".join(map(str, words)).encode(), digest_size=MARK_SIZE).digest()
        self._work = work
        self._name = name
        self._own: set[bytes] = set()
        self._client = node.create_client(CancelGoal, service)
        self._subscription = node.create_subscription(
            GoalStatusArray, f"{name}/_action/status", self._take, qos_profile_action_status_default
        )

    def new_id(self) -> bytes:
        """Returns the id of a goal of this life."""
        made = self._mark + os.urandom(16 - MARK_SIZE)
        self._own.add(made)
        return made

    def forget(self, goal: bytes) -> None:
        """Forgets a goal of this life that has ended: its server does not follow it any more."""
        self._own.discard(goal)

    def destroy(self) -> None:
        """Leaves ROS."""
        self._work.node.destroy_subscription(self._subscription)
        self._work.node.destroy_client(self._client)

    def _take(self, message: Any) -> None:
        self._work.guarded(self._look, message)

    def _look(self, message: Any) -> None:
        for each in message.status_list:
            goal = bytes(each.goal_info.goal_id.uuid)
            is_former = goal.startswith(self._mark) and goal not in self._own
            if is_former and each.status in _GOES_ON:
                self._own.add(goal)  # to be cancelled once
                LOGGER.warning("%s: a goal of a former life is cancelled", self._name)
                request = CancelGoal.Request()
                request.goal_info.goal_id.uuid = list(goal)
                self._client.call_async(request)

"""Which goals a bridge takes for those of its former life."""

import needs
import pytest

needs.ask("rclpy")

import rclpy
from action_msgs.msg import GoalStatus, GoalStatusArray
from action_msgs.srv import CancelGoal
from ports import free_domain
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import qos_profile_action_status_default

from jausml.runtime.base.loop import Loop
from jausml.runtime.bridge.ros.action_work import ActionWork
from jausml.runtime.bridge.ros.actions import MARK_SIZE, FormerGoals

from .bridge_support import wait_for

pytestmark = pytest.mark.live

SERVICE = "/follow/_action/cancel_goal"


def test_goals_with_the_mark_that_go_on_are_cancelled_once_and_no_others():
    context = Context()
    rclpy.init(context=context, domain_id=int(free_domain()))
    node = rclpy.create_node("robot", context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    asked = []

    def cancel(request, response):
        asked.append(bytes(request.goal_info.goal_id.uuid))
        return response

    with Loop() as loop:
        work = ActionWork(node, executor, loop, None)
        former = FormerGoals(work, "follow", SERVICE)
        # Lists of another kind may go to the same action.
        other = FormerGoals(work, "follow", SERVICE)
        current, ended = former.new_id(), former.new_id()
        former.forget(ended)
        mark = current[:MARK_SIZE]
        goals = {
            bytes(16): GoalStatus.STATUS_EXECUTING,  # of somebody else
            bytes(8) + mark: GoalStatus.STATUS_EXECUTING,
            current: GoalStatus.STATUS_EXECUTING,
            other.new_id(): GoalStatus.STATUS_EXECUTING,
            mark + b"succeed.": GoalStatus.STATUS_SUCCEEDED,
            mark + b"accepted": GoalStatus.STATUS_ACCEPTED,
            mark + b"executes": GoalStatus.STATUS_EXECUTING,
            mark + b"cancels.": GoalStatus.STATUS_CANCELING,
        }
        states = GoalStatusArray()
        for goal, status in goals.items():
            state = GoalStatus(status=status)
            state.goal_info.goal_id.uuid = list(goal)
            states.status_list.append(state)
        node.create_service(CancelGoal, SERVICE, cancel)
        publisher = node.create_publisher(
            GoalStatusArray, "follow/_action/status", qos_profile_action_status_default
        )
        for _ in range(2):
            publisher.publish(states)
        wait_for(lambda: executor.spin_once(timeout_sec=0.1) or len(asked) > 1, "cancellations")
        for _ in range(20):
            executor.spin_once(timeout_sec=0.01)
        assert sorted(asked) == [mark + b"accepted", mark + b"executes"]
        former.destroy()
        other.destroy()
    node.destroy_node()
    rclpy.try_shutdown(context=context)


def test_marks_differ_by_node_and_action():
    context = Context()
    rclpy.init(context=context, domain_id=int(free_domain()))
    marks = set()
    with Loop() as loop:
        for name in ("robot", "other"):
            node = rclpy.create_node(name, context=context)
            executor = SingleThreadedExecutor(context=context)
            for service in (SERVICE, f"/away{SERVICE}"):
                former = FormerGoals(ActionWork(node, executor, loop, None), "follow", service)
                ids = {former.new_id() for _ in range(8)}
                assert len(ids) == 8
                assert len({goal_id[:MARK_SIZE] for goal_id in ids}) == 1
                marks |= {goal_id[:MARK_SIZE] for goal_id in ids}
                former.destroy()
            node.destroy_node()
    assert len(marks) == 4
    rclpy.try_shutdown(context=context)

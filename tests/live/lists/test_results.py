"""Results of goals: a client has them where the bridge ends as soon as its goals have ended."""

import needs
import pytest

needs.ask("rclpy")

from nav2 import nav2

from jausml.live.ros.node import message_class
from jausml.runtime.bridge.ends.actions import ListAction, Outcome
from jausml.runtime.bridge.ros.actions import NodeActions

from ..bridge_support import wait_for
from .list_system import PATIENCE

pytestmark = pytest.mark.live

ABORTED = 6


class Taker:
    """Takes any goal."""

    goal = None

    def accepts(self, _elements, _request):
        return True

    def begin(self, goal):
        self.goal = goal


def test_a_result_is_sent_before_a_goal_counts_as_ended(node, peer):
    from geometry_msgs.msg import PoseStamped
    from nav2_msgs.action import NavigateThroughPoses
    from rclpy.action import ActionClient

    ros, taker = node(), Taker()
    actions = ros.part(lambda: NodeActions)
    kind = "nav2_msgs/action/NavigateThroughPoses"
    actions.serve_action(ListAction(kind, "through", PoseStamped, "poses"), taker)
    client = ActionClient(peer.node, NavigateThroughPoses, "through")
    wait_for(client.server_is_ready, "the action", PATIENCE)

    def spun(condition):
        ros.executor.spin_once(timeout_sec=0.1)
        return condition()

    goal = NavigateThroughPoses.Goal(poses=[PoseStamped()])
    answer = peer.on_executor(lambda: client.send_goal_async(goal))
    wait_for(lambda: spun(answer.done), "answer to the goal", PATIENCE)
    result = peer.on_executor(answer.result().get_result_async)
    for _ in range(10):  # the executor, which nobody else runs, takes the question for it
        ros.executor.spin_once(timeout_sec=0.1)
    taker.goal.end(Outcome.ABORTED, "it ends")
    wait_for(lambda: spun(lambda: not actions._work._goals), "end of the goal", PATIENCE)
    # Nothing of the node runs any more, as after the end of a bridge.
    wait_for(result.done, "result", PATIENCE)
    assert result.result().status == ABORTED
    client.destroy()


# -- feedback in recordings ------------------------------------------------------------------------


def test_feedback_of_an_action_that_is_installed(monkeypatch):
    monkeypatch.syspath_prepend(nav2())
    found = message_class("nav2_msgs/action/FollowWaypoints_FeedbackMessage")
    assert set(found.get_fields_and_field_types()) == {"goal_id", "feedback"}
    assert message_class("nav2_msgs/action/FollowWaypoints_Feedback") is None
    assert message_class("nav2_msgs/action/FollowWaypoints") is None

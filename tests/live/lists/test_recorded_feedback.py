"""Feedback of actions in recordings: the class by which rclpy gives it."""

import pytest
from nav2 import nav2

from jausml.live.ros.node import message_class

pytestmark = pytest.mark.live


def test_feedback_of_an_action_that_is_installed(monkeypatch):
    monkeypatch.syspath_prepend(nav2())
    found = message_class("nav2_msgs/action/FollowWaypoints_FeedbackMessage")
    assert set(found.get_fields_and_field_types()) == {"goal_id", "feedback"}
    assert message_class("nav2_msgs/action/FollowWaypoints_Feedback") is None
    assert message_class("nav2_msgs/action/FollowWaypoints") is None

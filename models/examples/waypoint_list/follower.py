#!/usr/bin/env python3
"""Follows waypoints as Nav2 does: serves robot/follow_waypoints, reads odom, writes cmd_vel.

`driving.py` says how. Waypoints are in the frame odom. A canceled goal stops the robot.

Usage: python follower.py
"""

from __future__ import annotations

import math
import os
import signal
import threading
from typing import TYPE_CHECKING

import rclpy
from driving import Course
from geometry_msgs.msg import Twist
from nav2_msgs.action import FollowWaypoints
from nav_msgs.msg import Odometry
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

if TYPE_CHECKING:
    from rclpy.action.server import ServerGoalHandle

FRAME = "odom"
"""The only frame that it knows; Nav2 would look for a transform."""
SILENCE = 1.0
"""Seconds without odometry after which a goal is given up."""


class Follower(Node):
    """Serves the action, one goal at a time."""

    def __init__(self) -> None:
        """Waits for goals."""
        super().__init__("follower", namespace="robot")
        group = ReentrantCallbackGroup()
        self._moved = threading.Condition()
        self._count = 0
        self._pose = (0.0, 0.0, 0.0)
        self._commands = self.create_publisher(Twist, "cmd_vel", 1)
        self.create_subscription(Odometry, "odom", self._on_odometry, 1, callback_group=group)
        self._server = ActionServer(
            self,
            FollowWaypoints,
            "follow_waypoints",
            self._follow,
            callback_group=group,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )

    def _on_odometry(self, odometry: Odometry) -> None:
        position, turn = odometry.pose.pose.position, odometry.pose.pose.orientation
        with self._moved:
            self._pose = (position.x, position.y, 2 * math.atan2(turn.z, turn.w))
            self._count += 1
            self._moved.notify_all()

    def _follow(self, handle: ServerGoalHandle) -> FollowWaypoints.Result:
        """Drives to one waypoint after the other, and stops."""
        try:
            reason = self._drive(handle)
        finally:
            self._commands.publish(Twist())
        if not reason:
            handle.succeed()
        elif handle.is_cancel_requested:
            handle.canceled()
        else:
            handle.abort()
        return FollowWaypoints.Result(error_msg=reason)

    def _drive(self, handle: ServerGoalHandle) -> str:
        """Drives along the waypoints of a goal; returns why the robot has not come to its end."""
        poses = handle.request.poses
        for frame in {each.header.frame_id for each in poses} - {FRAME}:
            return f"no transform from {frame} to {FRAME}"
        course = Course([(each.pose.position.x, each.pose.position.y) for each in poses])
        seen, told = 0, -1
        while not course.is_over:
            if course.active != told:
                told = course.active
                handle.publish_feedback(FollowWaypoints.Feedback(current_waypoint=told))
            with self._moved:
                if not self._moved.wait_for(lambda seen=seen: self._count > seen, SILENCE):
                    return "no odometry"
                seen, pose = self._count, self._pose
            if handle.is_cancel_requested:
                return "canceled"
            command = Twist()
            command.linear.x, command.angular.z = course.command(*pose)
            self._commands.publish(command)
        return ""


def main() -> None:
    """Follows until the process is asked to end."""
    # A goal that is under way has a thread of its own, for which nobody waits.
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: os._exit(0))
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(Follower())
    while True:
        # Python looks for signals between two of these; a wait without end would not let it.
        executor.spin_once(timeout_sec=0.5)


if __name__ == "__main__":
    main()

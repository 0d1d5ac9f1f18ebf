#!/usr/bin/env python3
"""Follows waypoints as Nav2 does: serves robot/follow_waypoints, reads odom, writes cmd_vel.

A waypoint is reached within 0.15 m; its orientation is not looked at. A canceled goal stops the
robot. Usage: python follower.py
"""

from __future__ import annotations

import math
import os
import signal
import threading
from typing import TYPE_CHECKING

import rclpy
from geometry_msgs.msg import Point, Twist
from nav2_msgs.action import FollowWaypoints
from nav_msgs.msg import Odometry
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

if TYPE_CHECKING:
    from rclpy.action.server import ServerGoalHandle

REACHED = 0.15
"""Distance in metres at which the robot has reached a waypoint."""
SPEED = 1.0
"""Largest speed, m/s."""
TURN = 2.0
"""Largest yaw rate, rad/s."""
SILENCE = 1.0
"""Seconds without odometry after which a goal is given up."""


def steer(x: float, y: float, psi: float, goal: Point, *, is_last: bool) -> tuple[float, float]:
    """Returns the speed (m/s) and the yaw rate (rad/s) that lead to a waypoint.

    Args:
        x: Position of the robot, m.
        y: The same to the left.
        psi: Its yaw, rad.
        goal: The waypoint, m.
        is_last: Whether the robot shall stop there.
    """
    off = math.remainder(math.atan2(goal.y - y, goal.x - x) - psi, math.tau)
    yaw_rate = min(max(3.0 * off, -TURN), TURN)
    speed = SPEED * max(math.cos(off), 0.0) ** 3
    if is_last:
        speed = min(speed, math.hypot(goal.x - x, goal.y - y) + 0.1)
    return speed, yaw_rate


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
        poses = handle.request.poses
        try:
            for at, pose in enumerate(poses):
                handle.publish_feedback(FollowWaypoints.Feedback(current_waypoint=at))
                reason = self._drive(handle, pose.pose.position, is_last=at == len(poses) - 1)
                if reason:
                    handle.canceled() if handle.is_cancel_requested else handle.abort()
                    return FollowWaypoints.Result(error_msg=reason)
            handle.succeed()
            return FollowWaypoints.Result()
        finally:
            self._commands.publish(Twist())

    def _drive(self, handle: ServerGoalHandle, goal: Point, *, is_last: bool) -> str:
        """Drives to a waypoint; returns why the robot has not reached it."""
        seen = 0
        while True:
            with self._moved:
                if not self._moved.wait_for(lambda seen=seen: self._count > seen, SILENCE):
                    return "no odometry"
                seen = self._count
                x, y, psi = self._pose
            if handle.is_cancel_requested:
                return "canceled"
            if math.hypot(goal.x - x, goal.y - y) < REACHED:
                return ""
            command = Twist()
            command.linear.x, command.angular.z = steer(x, y, psi, goal, is_last=is_last)
            self._commands.publish(command)


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

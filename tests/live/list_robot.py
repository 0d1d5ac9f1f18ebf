"""A ROS robot of the live tests that follows waypoints, one each time the test says so.

It says on stdout what happens, as JSON: goal with the x of its poses, reached, canceled, aborted,
done. On stdin it is told: next, abort, refuse (the goals to come) and accept.
"""

from __future__ import annotations

import json
import queue
import sys
import threading
from contextlib import suppress

import rclpy
from nav2_msgs.action import FollowWaypoints
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


def say(**facts: object) -> None:
    sys.stdout.write(json.dumps(facts) + "\n")
    sys.stdout.flush()


class Robot(Node):
    """Serves follow_waypoints."""

    def __init__(self) -> None:
        super().__init__("list_robot", namespace="robot")
        self.orders: queue.SimpleQueue[str] = queue.SimpleQueue()
        self.refuses = False
        self.group = ReentrantCallbackGroup()
        self.server = ActionServer(
            self,
            FollowWaypoints,
            "follow_waypoints",
            self.follow,
            callback_group=self.group,
            goal_callback=lambda _: GoalResponse.REJECT if self.refuses else GoalResponse.ACCEPT,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )
        threading.Thread(target=self.listen, daemon=True).start()
        self.create_timer(0.05, self.look, callback_group=self.group)
        self.is_known = False
        say(kind="ready")

    def look(self) -> None:
        """Tells once that somebody listens to the feedback: a client is there."""
        if not self.is_known and self.count_subscribers("follow_waypoints/_action/feedback"):
            self.is_known = True
            say(kind="client")

    def listen(self) -> None:
        for line in sys.stdin:
            order = line.strip()
            if order in {"refuse", "accept"}:
                self.refuses = order == "refuse"
                say(kind=order)
            else:
                self.orders.put(order)

    def follow(self, handle):
        poses, frame = handle.request.poses, ""
        if poses:
            frame = poses[0].header.frame_id
        xs = [round(each.pose.position.x, 2) for each in poses]
        say(kind="goal", x=xs, frame=frame, loops=handle.request.number_of_loops)
        for at, pose in enumerate(poses):
            handle.publish_feedback(FollowWaypoints.Feedback(current_waypoint=at))
            order = self.order(handle)
            if order == "cancel":
                handle.canceled()
                say(kind="canceled", at=at)
                return FollowWaypoints.Result(error_msg="canceled")
            if order == "abort":
                handle.abort()
                say(kind="aborted", at=at)
                return FollowWaypoints.Result(error_code=601, error_msg="the wheels came off")
            say(kind="reached", x=round(pose.pose.position.x, 2))
        handle.succeed()
        say(kind="done")
        return FollowWaypoints.Result()

    def order(self, handle) -> str:
        while not handle.is_cancel_requested:
            try:
                return self.orders.get(timeout=0.01)
            except queue.Empty:
                continue
        return "cancel"


if __name__ == "__main__":
    rclpy.init()
    robot = Robot()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(robot)
    with suppress(ExternalShutdownException, KeyboardInterrupt):
        executor.spin()

"""A ROS robot of the live tests that follows waypoints, one each time the test says so.

With the argument `path` it follows a path, and its feedback tells the distance that is left. With
`pose` it goes to one pose.

It says on stdout what happens, as JSON: goal with the x of its poses, reached, canceled, aborted,
done. On stdin it is told: next, abort, refuse (the goals to come) and accept.
"""

import json
import queue
import sys
import threading
from contextlib import suppress

import rclpy
from nav2_msgs.action import FollowPath, FollowWaypoints, NavigateToPose
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


def say(**facts: object) -> None:
    sys.stdout.write(json.dumps(facts) + "\n")
    sys.stdout.flush()


class Robot(Node):
    """Serves follow_waypoints, follow_path or navigate_to_pose."""

    def __init__(self, kind: type, action: str) -> None:
        super().__init__("list_robot", namespace="robot")
        self.kind, self.action = kind, action
        self.orders: queue.SimpleQueue[str] = queue.SimpleQueue()
        self.refuses = False
        self.group = ReentrantCallbackGroup()
        self.server = ActionServer(
            self,
            kind,
            action,
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
        if not self.is_known and self.count_subscribers(f"{self.action}/_action/feedback"):
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
        request, frame = handle.request, ""
        if self.kind is NavigateToPose:
            poses = [request.pose]
        else:
            poses = request.path.poses if self.kind is FollowPath else request.poses
        if poses:
            frame = (request.path if self.kind is FollowPath else poses[0]).header.frame_id
        xs = [round(stamped_pose.pose.position.x, 2) for stamped_pose in poses]
        say(kind="goal", x=xs, frame=frame, loops=getattr(request, "number_of_loops", 0))
        for at, pose in enumerate(poses):
            handle.publish_feedback(self.feedback(at, xs))
            order = self.order(handle)
            if order == "cancel":
                say(kind="canceled", at=at)  # Before the client is told, who sends the next one.
                handle.canceled()
                return self.kind.Result(error_msg="canceled")
            if order == "abort":
                say(kind="aborted", at=at)
                handle.abort()
                return self.kind.Result(error_code=601, error_msg="the wheels came off")
            say(kind="reached", x=round(pose.pose.position.x, 2))
        say(kind="done")
        handle.succeed()
        return self.kind.Result()

    def feedback(self, at: int, xs: list[float]):
        """Tells that an element is under way; where that is a distance, half a metre before it."""
        if self.kind is FollowWaypoints:
            return FollowWaypoints.Feedback(current_waypoint=at)
        if self.kind is NavigateToPose:
            return NavigateToPose.Feedback(distance_remaining=xs[-1])
        return FollowPath.Feedback(distance_to_goal=xs[-1] - xs[at] + 0.5)

    def order(self, handle) -> str:
        while not handle.is_cancel_requested:
            try:
                return self.orders.get(timeout=0.01)
            except queue.Empty:
                continue
        return "cancel"


if __name__ == "__main__":
    rclpy.init()
    kinds = {"path": (FollowPath, "follow_path"), "pose": (NavigateToPose, "navigate_to_pose")}
    robot = Robot(*kinds.get("".join(sys.argv[1:2]), (FollowWaypoints, "follow_waypoints")))
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(robot)
    with suppress(ExternalShutdownException, KeyboardInterrupt):
        executor.spin()

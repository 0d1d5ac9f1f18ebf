"""A ROS node for the faults: commands efforts and tells of its pose; hears the other topics.

Usage: ros_node.py [SECONDS by which its stamps are wrong]
"""

import signal
import sys
import threading

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, Twist, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from stamps import say, say_connection, say_counts, stamp

PERIOD = 0.05
SCALE = 10.0
"""By which the map of the bridge makes an effort of a velocity."""


class Peer(Node):
    """Publishes twenty times a second."""

    def __init__(self):
        super().__init__("rover")
        self.commands = self.create_publisher(Twist, "cmd_vel", 1)
        self.estimates = self.create_publisher(Odometry, "estimate", 10)
        self.create_subscription(Odometry, "odometry_copy", self.on_odometry, 10)
        self.create_subscription(PoseStamped, "pose", self.on_pose, 10)
        self.create_subscription(TwistStamped, "cruise", self.on_cruise, 10)
        self.create_subscription(DiagnosticArray, "/diagnostics", self.on_diagnostics, 10)
        self.offset = Duration(seconds=float(sys.argv[1] if sys.argv[1:] else 0))
        self.create_timer(PERIOD, self.tick)

    def tick(self):
        command, estimate = Twist(), Odometry()
        command.linear.x = stamp() / SCALE
        self.commands.publish(command)
        estimate.header.stamp = (self.get_clock().now() + self.offset).to_msg()
        estimate.pose.pose.position.x = stamp()
        self.estimates.publish(estimate)

    def on_diagnostics(self, message):
        for status in message.status:
            _, _, peer = status.name.partition(": account of ")
            if peer:
                counts = {e.key: int(e.value) for e in status.values if e.value.isdecimal()}
                say_counts(peer, status.hardware_id, counts)
            values = {value.key: value.value for value in status.values}
            if "messages taken" in values:
                say_connection(status.name, values)

    def on_odometry(self, message):
        is_stop = message.child_frame_id == "lost"
        say("odometry", 0.0 if is_stop else message.twist.twist.linear.x)

    def on_pose(self, message):
        say("pose", message.pose.position.x)

    def on_cruise(self, message):
        say("cruise", message.twist.linear.x)


if __name__ == "__main__":
    ended = threading.Event()
    # An exception of a handler would come out of rclpy as any other.
    signal.signal(signal.SIGTERM, lambda *_: ended.set())
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    executor = SingleThreadedExecutor()
    executor.add_node(Peer())
    while not ended.is_set():
        executor.spin_once(timeout_sec=PERIOD)
    rclpy.try_shutdown()

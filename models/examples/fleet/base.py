#!/usr/bin/env python3
"""Stands for the base of a robot: obeys cmd_vel at once, publishes odom, prints what it is told.

The odometry is best effort, as that of most drivers.

Usage: python base.py NAMESPACE [SECONDS]
"""

from __future__ import annotations

import sys
import time

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data


class Base(Node):
    """Publishes ten times a second how fast it was told to be."""

    def __init__(self, namespace: str) -> None:
        """Creates publisher and subscription."""
        super().__init__("base", namespace=namespace)
        self.speed = Twist()
        self.odom = self.create_publisher(Odometry, "odom", qos_profile_sensor_data)
        self.create_subscription(Twist, "cmd_vel", self.obey, 10)
        self.create_timer(0.1, self.publish)

    def obey(self, speed: Twist) -> None:
        """Takes the speed, and shows a new one."""
        if speed.linear.x != self.speed.linear.x:
            print(f"{self.get_namespace()} {speed.linear.x:.2f} m/s", flush=True)
        self.speed = speed

    def publish(self) -> None:
        """Publishes the speed that was asked for."""
        message = Odometry()
        message.header.stamp = self.get_clock().now().to_msg()
        message.header.frame_id, message.child_frame_id = "odom", "base_link"
        message.twist.twist = self.speed
        self.odom.publish(message)


def main() -> None:
    """Drives until the time is over."""
    rclpy.init()
    base = Base(sys.argv[1])
    end = time.monotonic() + (float(sys.argv[2]) if len(sys.argv) > 2 else 120.0)
    while rclpy.ok() and time.monotonic() < end:
        rclpy.spin_once(base, timeout_sec=0.1)


if __name__ == "__main__":
    main()

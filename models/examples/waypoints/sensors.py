#!/usr/bin/env python3
"""Stands for the ROS side of the vehicle: publishes what its sensors say, prints the goals it gets.

The vehicle stands at 48.5 north and 11.25 east, faces north-east with its nose raised by 0.1 rad,
and turns to the left at 0.2 rad/s.

Usage: python sensors.py [SECONDS]
"""

from __future__ import annotations

import contextlib
import math
import sys
import time

import rclpy
from geometry_msgs.msg import PoseStamped, Quaternion
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import Imu, NavSatFix, NavSatStatus
from std_msgs.msg import Float64

NOSE_UP = 0.1
YAW = math.pi / 4


def orientation(pitch: float, yaw: float) -> Quaternion:
    """Returns the turn about z by yaw, then about the new y by pitch."""
    sine, cosine = math.sin(pitch / 2), math.cos(pitch / 2)
    return Quaternion(
        x=-math.sin(yaw / 2) * sine,
        y=math.cos(yaw / 2) * sine,
        z=math.sin(yaw / 2) * cosine,
        w=math.cos(yaw / 2) * cosine,
    )


def diagonal(*variances: float) -> list[float]:
    """Returns the rows of a covariance matrix whose axes do not depend on each other."""
    size = len(variances)
    return [
        variances[row] if row == column else 0.0 for row in range(size) for column in range(size)
    ]


class Sensors(Node):
    """Publishes fix, imu and odom ten times a second."""

    def __init__(self) -> None:
        """Creates the publishers and the subscriptions."""
        super().__init__("sensors", namespace="vehicle")
        self.fix = self.create_publisher(NavSatFix, "fix", 10)
        self.imu = self.create_publisher(Imu, "imu", 10)
        self.odom = self.create_publisher(Odometry, "odom", 10)
        self.create_subscription(NavSatFix, "cmd_fix", self.show_fix, 10)
        self.create_subscription(PoseStamped, "local_goal", self.show_goal, 10)
        self.create_subscription(Float64, "speed", self.show_speed, 10)
        self.create_timer(0.1, self.publish)

    def publish(self) -> None:
        """Publishes what the sensors say now."""
        stamp = self.get_clock().now().to_msg()
        imu = Imu(orientation=orientation(-NOSE_UP, YAW))
        imu.orientation_covariance = diagonal(1e-4, 1e-4, 1e-4)
        fix = NavSatFix(latitude=48.5, longitude=11.25, altitude=520.0)
        fix.status.status = NavSatStatus.STATUS_FIX
        fix.position_covariance = diagonal(1.0, 1.0, 4.0)
        fix.position_covariance_type = NavSatFix.COVARIANCE_TYPE_DIAGONAL_KNOWN
        odom = Odometry()
        odom.twist.twist.angular.z = 0.2
        odom.twist.covariance = diagonal(0.01, 0.01, 0.01, 1e-4, 1e-4, 1e-4)
        for publisher, message in ((self.imu, imu), (self.fix, fix), (self.odom, odom)):
            message.header.stamp = stamp
            publisher.publish(message)

    def show_fix(self, goal: NavSatFix) -> None:
        """Prints a waypoint on the earth."""
        print(f"go to {goal.latitude:.5f} north, {goal.longitude:.5f} east", flush=True)

    def show_goal(self, goal: PoseStamped) -> None:
        """Prints a waypoint in odom."""
        position = goal.pose.position
        side = "left" if position.y > 0 else "right"
        print(f"go {position.x:.2f} m ahead, {abs(position.y):.2f} m to the {side}", flush=True)

    def show_speed(self, speed: Float64) -> None:
        """Prints a speed."""
        print(f"go at {speed.data:.2f} m/s", flush=True)


def main(arguments: list[str]) -> None:
    """Runs the sensors for some seconds, 60 unless the first argument says otherwise."""
    end = time.monotonic() + float(arguments[0] if arguments else 60)
    rclpy.init()
    sensors = Sensors()
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        while time.monotonic() < end and rclpy.ok():
            rclpy.spin_once(sensors, timeout_sec=0.1)
    rclpy.try_shutdown()


if __name__ == "__main__":
    main(sys.argv[1:])

"""A ROS node that drives: repeats a command on every topic that it is given, until it is killed."""

import sys
import time

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64, Float64MultiArray


def moving(name: str) -> Twist | TwistStamped | Float64 | Float64MultiArray | JointState:
    """Returns a command that moves, of the type of the topic."""
    if name.endswith("speed"):
        return Float64(data=2.0)
    if name.endswith("wheels"):
        return Float64MultiArray(data=[2.0, -3.0])
    if name.endswith("velocities"):
        velocities = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]
        arm = [f"joint_{n}" for n in range(1, 7)]
        names = ["pan", "tilt"] if "pan_tilt" in name else arm
        return JointState(name=names, velocity=velocities[: len(names)])
    twist = Twist()
    twist.linear.x, twist.angular.z = 1.0, 0.5
    is_stamped = name.endswith(("stamped", "vector", "effector_velocity"))
    return TwistStamped(twist=twist) if is_stamped else twist


if __name__ == "__main__":
    rclpy.init()
    node = rclpy.create_node("driver")
    commands = [
        (node.create_publisher(type(moving(name)), name, 10), moving(name)) for name in sys.argv[1:]
    ]
    while True:
        for publisher, message in commands:
            publisher.publish(message)
        time.sleep(0.05)

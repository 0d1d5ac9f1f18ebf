"""The robot of the story: seven topics and a service, as its maker left them."""

import sys

import rclpy
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import BatteryState, Imu, JointState, LaserScan, NavSatFix
from std_srvs.srv import Trigger

JOINTS = ["shoulder", "elbow", "wrist"]
SENSORS = {"odom": Odometry, "imu/data": Imu, "fix": NavSatFix, "battery": BatteryState}


def main() -> None:
    """Runs until it is interrupted."""
    rclpy.init()
    node = rclpy.create_node("abyss")
    senders = {
        name: node.create_publisher(kind, name, qos_profile_sensor_data)
        for name, kind in (*SENSORS.items(), ("sonar", LaserScan))
    }
    joints = node.create_publisher(JointState, "joint_states", 10)

    def drop(_, response):
        response.success, response.message = True, "gone"
        return response

    def speak():
        odometry = Odometry()
        odometry.header.stamp = node.get_clock().now().to_msg()
        odometry.pose.pose.orientation.w = 1.0
        odometry.twist.twist.linear.x, odometry.twist.twist.linear.y = 1.5, 0.25
        senders["odom"].publish(odometry)
        battery = BatteryState(percentage=0.8, voltage=25.0)
        battery.header.stamp = odometry.header.stamp
        senders["battery"].publish(battery)
        state = JointState(name=JOINTS, position=[0.25, -0.5, 0.0])
        state.header.stamp = odometry.header.stamp
        joints.publish(state)

    node.create_service(Trigger, "drop_weight", drop)
    node.create_subscription(TwistStamped, "cmd_vel", lambda _: None, 1)
    node.create_timer(0.2, speak)
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        sys.exit(0)


if __name__ == "__main__":
    main()

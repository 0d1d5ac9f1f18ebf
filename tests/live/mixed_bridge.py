"""The test bridge with overridden translations: some on light classes, some on those of ROS."""

from geometry_msgs.msg import Twist
from jausml_runtime import ros_classes, run_bridge
from loop_bridge import ros_types
from loop_bridge.loop_bridge import LoopBridge
from nav_msgs.msg import Odometry

MARK = 100.0


class MixedBridge(LoopBridge):
    """Marks what it translates by itself; odometry, drive and the stop are on classes of ROS."""

    def translate_speed(self, source):
        target = super().translate_speed(source)
        assert isinstance(target, ros_types.Float64)
        target.data += MARK
        return target

    @ros_classes
    def translate_odometry(self, source):
        light = super().translate_odometry(source)
        target = Odometry(child_frame_id="mixed")
        target.header.frame_id = light.header.frame_id
        target.twist.twist.linear.x = light.twist.twist.linear.x + MARK
        return target

    @ros_classes
    def translate_drive(self, source):
        assert isinstance(source, Twist)
        target = super().translate_drive(source)
        target.propulsive_linear_effort_x = -target.propulsive_linear_effort_x
        return target


if __name__ == "__main__":
    raise SystemExit(run_bridge(MixedBridge()))

"""Keeps the lateral acceleration comfortable: commands the cruise speed or less."""

from __future__ import annotations

from catvehicle import velocity
from catvehicle.parameters import VehicleParameters
from catvehicle.path import StraightArcStraight
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64

from .velocity_controller_base import VelocityControllerBase


class VelocityController(VelocityControllerBase):
    """Commands a speed for each dead-reckoned pose."""

    def __init__(self) -> None:
        super().__init__()
        parameters = VehicleParameters()
        self._path = StraightArcStraight.right_turn(parameters)
        self._controller = velocity.VelocityController(parameters)
        self._cruise_speed = 0.0
        self._measured_angle = 0.0
        self._commanded_angle = 0.0

    def on_cruise_speed(self, message: TwistStamped) -> None:
        """Keeps the speed that the operator allows, m/s; 0 until there is an operator."""
        self._cruise_speed = max(message.twist.linear.x, 0.0)

    def on_steering_angle(self, message: Float64) -> None:
        """Keeps the tyre angle that the vehicle reports, rad."""
        self._measured_angle = message.data

    def on_steering_command(self, message: Float64) -> None:
        """Keeps the tyre angle that the steering controller asks for, rad."""
        self._commanded_angle = message.data

    def on_dead_reckoning(self, message: Odometry) -> None:
        """Answers each pose with a speed."""
        position = message.pose.pose.position
        remaining = self._path.remaining(position.x, position.y)
        comfortable = self._controller.command(
            self._measured_angle, self._commanded_angle, remaining
        )
        command = TwistStamped()
        command.header = message.header
        command.twist.linear.x = min(self._cruise_speed, comfortable)
        self.publish_speed_command(command)

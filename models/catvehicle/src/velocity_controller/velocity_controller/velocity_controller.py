"""Keeps the lateral acceleration comfortable: commands the cruise speed or less."""

from __future__ import annotations

from catvehicle.logic import SpeedLogic
from catvehicle.parameters import VehicleParameters
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from std_msgs.msg import Float64

from .velocity_controller_base import VelocityControllerBase


class VelocityController(VelocityControllerBase):
    """The velocity law behind topics: a speed for each dead-reckoned pose."""

    def __init__(self) -> None:
        super().__init__()
        self._logic = SpeedLogic(VehicleParameters())

    def on_cruise_speed(self, message: TwistStamped) -> None:
        """Keeps the speed that the operator allows, m/s; 0 until there is an operator."""
        self._logic.take_cruise_speed(message.twist.linear.x)

    def on_steering_angle(self, message: Float64) -> None:
        """Keeps the tyre angle that the vehicle reports, rad."""
        self._logic.take_measured_angle(message.data)

    def on_steering_command(self, message: Float64) -> None:
        """Keeps the tyre angle that the steering controller asks for, rad."""
        self._logic.take_commanded_angle(message.data)

    def on_dead_reckoning(self, message: Odometry) -> None:
        """Answers each pose with a speed."""
        position = message.pose.pose.position
        command = TwistStamped()
        command.header = message.header
        command.twist.linear.x = self._logic.command(position.x, position.y)
        self.publish_speed_command(command)

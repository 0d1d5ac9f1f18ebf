#!/usr/bin/env python3
"""Stands for Gazebo and ros_gz_bridge: a car in simulated time, in one process of rclpy.

What it takes and gives has the names, types and meaning of Gazebo's plug-in AckermannSteering of a
model NAME behind ros_gz_bridge:

- /clock, rosgraph_msgs/Clock: the time of the simulation, after each step;
- /model/NAME/cmd_vel, geometry_msgs/Twist: linear.x in m/s, angular.z the yaw rate in rad/s, which
  become a radius of the turn; the last command holds;
- /model/NAME/odometry, nav_msgs/Odometry: pose since the start and twist, 50 times a second of the
  simulation, from NAME/odom to NAME/base_link;
- /model/NAME/tf, tf2_msgs/TFMessage: the same pose, where tf2_msgs is installed.

The car is the plant of models/catvehicle, which does not drive backwards. Usage, where 0.5 is half
the pace of real time:

    python stand_in.py --ros-args -p real_time_factor:=0.5

The factor may be changed while it runs; 0 is a pause. The parameter `log` names a file to which
each step is written.
"""

from __future__ import annotations

import importlib.util
import math
import signal
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import rclpy
from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped, Twist
from nav_msgs.msg import Odometry
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.clock import Clock as NodeClock
from rclpy.clock import ClockType
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rosgraph_msgs.msg import Clock

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "catvehicle" / "src" / "catvehicle"))

from catvehicle.events import EventLog
from catvehicle.parameters import VehicleParameters
from catvehicle.plant import BicyclePlant

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rclpy.parameter import Parameter

STEP = 0.01
"""Seconds of the simulation in a step; Gazebo's default is 0.001."""
ODOMETRY_STEPS = 2
"""Steps in each odometry: 50 a second, the default of the plug-in."""
TICK = 0.005
"""Seconds of real time between two looks whether steps are due."""
MOST_DUE = 0.1
"""Seconds of the simulation that are made up for; what a machine loses beyond them stays lost."""
STRAIGHT = 0.001
"""Yaw rate in rad/s below which the plug-in drives straight on."""


class StandIn(Node):
    """Simulates the car."""

    def __init__(self) -> None:
        """Begins at time 0 with a car at rest in the origin."""
        super().__init__("simulator")
        any_number = ParameterDescriptor(dynamic_typing=True)
        self.declare_parameter("real_time_factor", 1.0, any_number)
        name = self.declare_parameter("model", "catvehicle").value
        log = self.declare_parameter("log", "").value
        self._factor = _factor(self.get_parameter("real_time_factor").value)
        self.add_on_set_parameters_callback(self._on_parameters)
        self._model = name
        self._car = VehicleParameters()
        self._plant = BicyclePlant(self._car)
        self._steps = 0
        self._due = 0.0
        self._looked = time.monotonic()
        self._steps_log = EventLog(Path(log) if log else None)
        self._steps_log.write(
            "real_s", "time_s", "factor", "x_m", "y_m", "psi_rad", "v_m_s", "delta_rad"
        )
        self._clock_messages = self.create_publisher(Clock, "/clock", 10)
        self._odometry = self.create_publisher(Odometry, f"/model/{name}/odometry", 10)
        self._transforms = self._publisher_of_transforms()
        self.create_subscription(Twist, f"/model/{name}/cmd_vel", self._on_command, 10)
        self.create_timer(TICK, self._look, clock=NodeClock(clock_type=ClockType.STEADY_TIME))

    def _publisher_of_transforms(self) -> Any:
        """Returns what publishes transforms; None without tf2_msgs."""
        if importlib.util.find_spec("tf2_msgs") is None:
            return None
        from tf2_msgs.msg import TFMessage  # noqa: PLC0415 - may be missing

        publisher = self.create_publisher(TFMessage, f"/model/{self._model}/tf", 10)
        return lambda transform: publisher.publish(TFMessage(transforms=[transform]))

    def _on_parameters(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        for each in parameters:
            if each.name == "real_time_factor":
                try:
                    self._factor = _factor(each.value)
                except ValueError as error:
                    return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _on_command(self, command: Twist) -> None:
        """Takes a speed and a yaw rate, which mean a tyre angle, as the plug-in does."""
        speed, yaw_rate = command.linear.x, command.angular.z
        if not (math.isfinite(speed) and math.isfinite(yaw_rate)):
            self.get_logger().warning("a command is not finite; the last one holds")
            return
        self._plant.command(speed, tyre_angle(speed, yaw_rate, self._car))

    def _look(self) -> None:
        """Makes the steps that are due."""
        now = time.monotonic()
        self._due = min(self._due + (now - self._looked) * self._factor, MOST_DUE)
        self._looked = now
        while self._due >= STEP:
            self._due -= STEP
            self._step(now)

    def _step(self, now: float) -> None:
        state = self._plant.advance(STEP)
        self._steps += 1
        stamp = _stamp(self._steps)
        self._clock_messages.publish(Clock(clock=stamp))
        self._steps_log.write(
            now, self._steps * STEP, self._factor, state.x, state.y, state.psi, state.v, state.delta
        )
        if self._steps % ODOMETRY_STEPS == 0:
            self._publish_odometry(stamp)

    def _publish_odometry(self, stamp: Time) -> None:
        state = self._plant.state
        odometry = Odometry(child_frame_id=f"{self._model}/base_link")
        odometry.header.stamp = stamp
        odometry.header.frame_id = f"{self._model}/odom"
        position, orientation = odometry.pose.pose.position, odometry.pose.pose.orientation
        position.x, position.y = state.x, state.y
        orientation.z, orientation.w = math.sin(state.psi / 2), math.cos(state.psi / 2)
        odometry.twist.twist.linear.x = state.v
        odometry.twist.twist.angular.z = self._plant.yaw_rate
        self._odometry.publish(odometry)
        if self._transforms is not None:
            transform = TransformStamped(
                header=odometry.header, child_frame_id=odometry.child_frame_id
            )
            translation = transform.transform.translation
            translation.x, translation.y = state.x, state.y
            transform.transform.rotation = orientation
            self._transforms(transform)


def tyre_angle(speed: float, yaw_rate: float, parameters: VehicleParameters) -> float:
    """Returns the tyre angle (rad, positive left) that the plug-in makes of a command.

    The radius of the turn is speed / yaw rate, and no smaller than the tyres allow. A yaw rate
    without a speed turns the tyres as far as they go.
    """
    if abs(yaw_rate) < STRAIGHT:
        return 0.0
    smallest = parameters.wheelbase / math.sin(parameters.steering_limit)
    radius = speed / yaw_rate
    if abs(radius) < smallest:
        radius = math.copysign(smallest, yaw_rate if speed == 0.0 else radius)
    return math.atan(parameters.wheelbase / radius)


def _factor(value: object) -> float:
    """Returns a real-time factor.

    Raises:
        ValueError: It is no number, or less than 0.
    """
    if not isinstance(value, (int, float)) or not (math.isfinite(value) and value >= 0.0):
        raise ValueError(f"real_time_factor is {value!r}, which is no number from 0 on")
    return float(value)


def _stamp(steps: int) -> Time:
    seconds, nanoseconds = divmod(round(steps * STEP * 1e9), 10**9)
    return Time(sec=seconds, nanosec=nanoseconds)


def main() -> None:
    """Simulates until the process is asked to end.

    Raises:
        SystemExit: A parameter is wrong; the text says which.
    """
    # By handlers of its own: those of rclpy pull the context away below a node that spins.
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: sys.exit(0))
    try:
        node = StandIn()
    except ValueError as error:
        sys.exit(str(error))
    rclpy.spin(node)


if __name__ == "__main__":
    main()

"""Stand-ins of the ROS nodes: the same control laws behind the topics of a virtual world.

Each takes and gives serialized messages, as its node of rclpy does, and adds nothing to the logic
of `catvehicle.logic`. What a node needs to compute takes no virtual time.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from catvehicle.logic import SpeedLogic, SpeedReport, SteeringLogic

from experiments.right_turn.data import Step

if TYPE_CHECKING:
    from collections.abc import Callable

    from catvehicle.logic import SteeringStep
    from catvehicle.parameters import VehicleParameters


@dataclass(frozen=True)
class Ros:
    """The ROS of a virtual world, as stand-ins use it.

    Attributes:
        world: The virtual world.
        types: Module of the light classes of the generated bridge.
        link: Way of each message to a node.
        sensing: Quality of service of what the vehicle reports.
    """

    world: Any
    types: Any
    link: Any
    sensing: Any


class StandIn:
    """What stand-ins have in common: topics, and an end."""

    def __init__(self, ros: Ros) -> None:
        """Begin without topics."""
        self._ros = ros
        self._types = ros.types
        self._subscriptions: list[Any] = []

    def stop(self) -> None:
        """End the node, as a crash does: at once and without a word."""
        for subscription in self._subscriptions:
            subscription.close()
        self._subscriptions.clear()

    def _listen(
        self, topic: str, ros_type: Any, take: Callable[[Any], None], qos: Any = None
    ) -> None:
        def taken(data: bytes) -> None:
            take(ros_type.from_cdr(data))

        ros = self._ros
        self._subscriptions.append(
            ros.world.ros.subscribe(topic, ros_type, taken, qos=qos, link=ros.link)
        )

    def _say(self, topic: str, message: Any) -> None:
        self._ros.world.ros.publish(topic, type(message), message.to_cdr())


class SteeringNode(StandIn):
    """The node `steering_controller`."""

    def __init__(
        self, ros: Ros, parameters: VehicleParameters, note: Callable[[Step], None]
    ) -> None:
        """Begin to listen.

        Args:
            ros: Carries the messages.
            parameters: What the controller takes the vehicle for.
            note: Is told each step.
        """
        super().__init__(ros)
        self._note = note
        self._logic = SteeringLogic(parameters)
        self._listen("/odometry", ros.types.Odometry, self._odometry, ros.sensing)
        self._listen("/steering_angle", ros.types.Float64, self._angle, ros.sensing)

    def _odometry(self, message: Any) -> None:
        stamp = message.header.stamp
        report = SpeedReport(
            stamp.sec * 1000 + stamp.nanosec // 1_000_000,
            message.twist.twist.linear.x,
            self._ros.world.now(),
        )
        self._answer(self._logic.take_speed(report))

    def _angle(self, message: Any) -> None:
        self._logic.take_angle(message.data, self._ros.world.now())

    def _answer(self, step: SteeringStep) -> None:
        report, now = step.report, self._ros.world.now()
        self._note(Step(report.stamp_ms, report.received, now, step.command))
        self._say("/steering_command", self._types.Float64(step.command))
        estimate = self._types.Odometry()
        seconds, milliseconds = divmod(report.stamp_ms, 1000)
        estimate.header.stamp = self._types.Time(seconds, milliseconds * 1_000_000)
        estimate.twist.twist.linear.x = report.speed
        estimate.pose.pose.position.x = step.pose.x
        estimate.pose.pose.position.y = step.pose.y
        estimate.pose.pose.orientation.z = math.sin(step.pose.psi / 2)
        estimate.pose.pose.orientation.w = math.cos(step.pose.psi / 2)
        self._say("/dead_reckoning", estimate)


class SpeedNode(StandIn):
    """The node `velocity_controller`."""

    def __init__(self, ros: Ros, parameters: VehicleParameters) -> None:
        """Begin to listen.

        Args:
            ros: Carries the messages.
            parameters: What the controller takes the vehicle for.
        """
        super().__init__(ros)
        self._logic = logic = SpeedLogic(parameters)
        types = ros.types
        self._listen(
            "/cruise_speed",
            types.TwistStamped,
            lambda message: logic.take_cruise_speed(_speed(message)),
        )
        self._listen(
            "/steering_angle",
            types.Float64,
            lambda message: logic.take_measured_angle(message.data),
            ros.sensing,
        )
        self._listen(
            "/steering_command",
            types.Float64,
            lambda message: logic.take_commanded_angle(message.data),
        )
        self._listen("/dead_reckoning", types.Odometry, self._pose)

    def _pose(self, message: Any) -> None:
        position = message.pose.pose.position
        command = self._types.TwistStamped()
        command.header = message.header
        command.twist.linear.x = self._logic.command(position.x, position.y)
        self._say("/speed_command", command)


def _speed(message: Any) -> float:
    speed: float = message.twist.linear.x
    return speed

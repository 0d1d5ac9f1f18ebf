"""Vehicle science of the CAT Vehicle example: plant, path, controllers and metrics.

Everything here is free of processes, sockets and ROS, and uses the standard library only. Drawing
lives in `catvehicle.figure`, which needs matplotlib and is therefore not imported here.

Frames follow ROS REP-103: x forward, y left, yaw (psi) counter-clockwise, so a right turn has a
negative steering angle, a negative yaw rate and a falling psi. Units are metres, seconds and
radians. The reference point of every pose is the centre of the rear axle.
"""

from __future__ import annotations

from .deadreckoning import DeadReckoning
from .metrics import LogWriter, Sample, Table, read_log, write_log
from .parameters import ParameterRow, VehicleParameters
from .path import PathPoint, Pose, StraightArcStraight, wrap_angle
from .plant import BicyclePlant, VehicleState
from .steering import SteeringController
from .velocity import VelocityController

__all__ = [
    "BicyclePlant",
    "DeadReckoning",
    "LogWriter",
    "ParameterRow",
    "PathPoint",
    "Pose",
    "Sample",
    "SteeringController",
    "StraightArcStraight",
    "Table",
    "VehicleParameters",
    "VehicleState",
    "VelocityController",
    "read_log",
    "wrap_angle",
    "write_log",
]

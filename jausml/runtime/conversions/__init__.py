"""Value conversions of attribute maps, as pure functions.

Each literal of `ConversionKind` in bridge.ecore has the function of the same name here, but for
`expression`, which generated code computes in place, and `user`, which the user writes. The
positional parameters are the inputs and then the arguments that the literal is annotated with.
"""

from .grids import cost_to_occupancy, occupancy_to_cost, reverse_rows
from .numbers import (
    clamp,
    covariance_to_rms,
    deadband,
    degrees_to_radians,
    linear,
    look_up,
    negate,
    percent_to_value,
    radians_to_degrees,
    scale,
    square,
    square_root,
    value_to_percent,
    with_units,
)
from .orientations import (
    enu_quaternion_to_ned_angles,
    enu_quaternion_to_ned_heading,
    enu_yaw_to_ned_heading,
    flu_quaternion_to_frd_angles,
    flu_quaternion_to_frd_pitch,
    flu_quaternion_to_frd_roll,
    flu_quaternion_to_frd_yaw,
    frd_angles_to_flu_quaternion,
    frd_yaw_to_flu_quaternion,
    ned_angles_to_enu_quaternion,
    ned_heading_to_enu_quaternion,
    ned_heading_to_enu_yaw,
    wrap_angle,
)
from .times import time_to_timestamp, timestamp_to_time
from .types import (
    Angles,
    ConversionError,
    Quaternion,
    QuaternionLike,
    Time,
    TimeLike,
    TimeStamp,
    TimeStampLike,
)

__all__ = [
    "Angles",
    "ConversionError",
    "Quaternion",
    "QuaternionLike",
    "Time",
    "TimeLike",
    "TimeStamp",
    "TimeStampLike",
    "clamp",
    "cost_to_occupancy",
    "covariance_to_rms",
    "deadband",
    "degrees_to_radians",
    "enu_quaternion_to_ned_angles",
    "enu_quaternion_to_ned_heading",
    "enu_yaw_to_ned_heading",
    "flu_quaternion_to_frd_angles",
    "flu_quaternion_to_frd_pitch",
    "flu_quaternion_to_frd_roll",
    "flu_quaternion_to_frd_yaw",
    "frd_angles_to_flu_quaternion",
    "frd_yaw_to_flu_quaternion",
    "linear",
    "look_up",
    "ned_angles_to_enu_quaternion",
    "ned_heading_to_enu_quaternion",
    "ned_heading_to_enu_yaw",
    "negate",
    "occupancy_to_cost",
    "percent_to_value",
    "radians_to_degrees",
    "reverse_rows",
    "scale",
    "square",
    "square_root",
    "time_to_timestamp",
    "timestamp_to_time",
    "value_to_percent",
    "with_units",
    "wrap_angle",
]

"""Value conversions of attribute maps, as pure functions.

Each literal of `ConversionKind` in bridge.ecore has a function of the same name here, except
`expression` and `with_units`, which need none, and `user`, whose function the user writes. The
positional parameters are the inputs and then the arguments of the conversion.
"""

from .numbers import clamp as clamp
from .numbers import covariance_to_rms as covariance_to_rms
from .numbers import deadband as deadband
from .numbers import degrees_to_radians as degrees_to_radians
from .numbers import limit as limit
from .numbers import linear as linear
from .numbers import look_up as look_up
from .numbers import negate as negate
from .numbers import percent_to_value as percent_to_value
from .numbers import radians_to_degrees as radians_to_degrees
from .numbers import scale as scale
from .numbers import square as square
from .numbers import square_root as square_root
from .numbers import value_to_percent as value_to_percent
from .orientations import enu_quaternion_to_ned_angles as enu_quaternion_to_ned_angles
from .orientations import enu_quaternion_to_ned_heading as enu_quaternion_to_ned_heading
from .orientations import enu_yaw_to_ned_heading as enu_yaw_to_ned_heading
from .orientations import flu_quaternion_to_frd_angles as flu_quaternion_to_frd_angles
from .orientations import flu_quaternion_to_frd_pitch as flu_quaternion_to_frd_pitch
from .orientations import flu_quaternion_to_frd_roll as flu_quaternion_to_frd_roll
from .orientations import flu_quaternion_to_frd_yaw as flu_quaternion_to_frd_yaw
from .orientations import frd_angles_to_flu_quaternion as frd_angles_to_flu_quaternion
from .orientations import frd_yaw_to_flu_quaternion as frd_yaw_to_flu_quaternion
from .orientations import ned_angles_to_enu_quaternion as ned_angles_to_enu_quaternion
from .orientations import ned_heading_to_enu_quaternion as ned_heading_to_enu_quaternion
from .orientations import ned_heading_to_enu_yaw as ned_heading_to_enu_yaw
from .orientations import wrap_angle as wrap_angle
from .rasters import cost_to_occupancy as cost_to_occupancy
from .rasters import occupancy_to_cost as occupancy_to_cost
from .rasters import pixels_to_pnm as pixels_to_pnm
from .rasters import pnm_to_pixels as pnm_to_pixels
from .rasters import reverse_rows as reverse_rows
from .times import time_to_timestamp as time_to_timestamp
from .times import timestamp_to_time as timestamp_to_time
from .types import Angles as Angles
from .types import ConversionError as ConversionError
from .types import Pixels as Pixels
from .types import Quaternion as Quaternion
from .types import QuaternionLike as QuaternionLike
from .types import Time as Time
from .types import TimeLike as TimeLike
from .types import TimeStamp as TimeStamp
from .types import TimeStampLike as TimeStampLike

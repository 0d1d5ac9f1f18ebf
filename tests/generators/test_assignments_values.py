"""Generated translations of single values, with absolute results."""

import math

import needs
import pytest

from tests.generators.assignment_support import connections, generated

needs.ask("rclpy")

from geometry_msgs.msg import PoseStamped, Quaternion, Twist
from nav_msgs.msg import Odometry
from std_msgs.msg import UInt8, UInt16

TEXT = """
attitude { JAUS ReportLocalPose  ROS nav_msgs/Odometry
  quantity reach { value: 50 units: "m" }
  JAUS->ROS (
    X -> pose.pose.position.x { whenAbsent: useDefault defaultValue: "-1.5" }
    Y -> pose.pose.position.y : negate { whenAbsent: lastValue }
    Roll, Pitch, Yaw -> pose.pose.orientation : frd_angles_to_flu_quaternion
      { whenAbsent: useDefault defaultValue: 0 }
    X, Y -> twist.twist.linear.x : expression("if(X > 0, X / Y, hypot(X, Y))")
  )
  ROS->JAUS (
    pose.pose.orientation -> Roll, Pitch, Yaw : flu_quaternion_to_frd_angles
      { outOfRange: dropField }
    pose.pose.position.x -> X : clamp(-100, 100)
    pose.covariance[0], pose.covariance[7], pose.covariance[14] -> Position_RMS : covariance_to_rms
      { outOfRange: dropField }
    pose.pose.position.z -> Z : negate, value_to_percent(reach), with_units("m")
    header.stamp -> TimeStamp : time_to_timestamp
  )
}

gear { JAUS Gearbox ( uint8 gear  uint8 mode  float32 angle )  ROS std_msgs/UInt8
  table gears ( 0 <-> 10  1 <-> 20  2 <-> 30  3 <-> 30 )
  JAUS->ROS ( gear -> data : look_up(gears) )
  ROS->JAUS ( data -> gear : look_up(gears)  data -> mode : user(choose_mode) )
}

turn { JAUS Turning ( float32 rate { units: "degree per second" } )  ROS geometry_msgs/Twist
  JAUS->ROS ( rate -> angular.z )
  ROS->JAUS ( angular.z -> rate )
}

tilt { JAUS Tilting ( float32 tilt )  ROS geometry_msgs/PoseStamped
  ROS->JAUS ( pose.orientation -> tilt : user(tilt) )
}

fix { JAUS Fixed ( int8 state )  ROS sensor_msgs/NavSatFix
  table states ( 0 <-> STATUS_FIX  1 <-> STATUS_SBAS_FIX )
  JAUS->ROS (
    state -> status.status : look_up(states)
    "SERVICE_GLONASS" -> status.service
    "NaN" -> altitude
  )
}

counts { JAUS Counting ( uint8 few  uint64 many  int16 level )  ROS geometry_msgs/Twist
  JAUS->ROS (
    few -> linear.x : deadband(0.5)
    many -> linear.y : square
    level -> linear.z : with_units("m/s"), negate
    many -> angular.x : negate, square, square, square, square, scale(0.5)
    many -> angular.y : expression("value")
    few -> angular.z : clamp(0, 9)
  )
}

digits { JAUS Digits ( uint64 digits )  ROS std_msgs/UInt64
  JAUS->ROS ( digits -> data : clamp(0, 1e19) )
}

area { JAUS Area ( uint64 edge )  ROS std_msgs/UInt64  JAUS->ROS ( edge -> data : square ) }
mark { JAUS Mark ( uint16 mark )  ROS std_msgs/UInt8  JAUS->ROS ( mark -> data ) }
marking { JAUS Marking ( uint8 mark )  ROS std_msgs/UInt16  ROS->JAUS ( data -> mark ) }

depth { JAUS Depth ( uint16 depth { units: "meter" } )  ROS std_msgs/UInt8
  JAUS->ROS ( depth -> data )
}

sounding { JAUS Sounding ( uint8 depth { units: "meter" } )  ROS std_msgs/UInt16
  ROS->JAUS ( data -> depth )
}

height { JAUS Height ( uint16 height )  ROS std_msgs/Int8
  JAUS->ROS ( height -> data : user(fold) )
}

echo { JAUS Echo ( float64 level )  ROS std_msgs/Float32  JAUS->ROS ( level -> data : negate ) }

lamps { JAUS SetIlluminationState  ROS std_msgs/UInt8
  table lamp ( OFF <-> 0  ON <-> 1 )
  ROS->JAUS ( data -> illumination.Headlights : look_up(lamp) )
}

bridge valued {
  address: 1.1.2  frequency: 12.5  quantity reach { value: 8000 units: "cm" }
  connection polled { map: attitude exchange: query topic of_attitude {} }
  connection often { map: attitude exchange: periodicEvent rate: 50 topic of_attitude {} }
  connection lamps {
    map: lamps direction: rosToJaus onSilence: hold holdReason: "lamps stay lit" topic of_lamps {}
  }
  CONNECTIONS
}
""".replace(
    "CONNECTIONS",
    connections(
        "attitude gear turn fix counts digits area mark depth height echo",
        "attitude gear turn tilt marking sounding",
    ),
)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    return generated(TEXT, tmp_path_factory.mktemp("values"), "valued")


@pytest.mark.slow
def test_text_is_clean(made):
    made.check_text()


# ------------------------------------------------------------------ several values at once


def quarter_turn_left():
    return Quaternion(z=math.sqrt(0.5), w=math.sqrt(0.5))


def test_several_targets_take_the_results_of_one_conversion(made):
    source = Odometry()
    source.pose.pose.orientation = quarter_turn_left()
    report = made.bridge.translate_attitude_out(source)
    assert (report.roll, report.pitch) == (0.0, 0.0)
    assert report.yaw == pytest.approx(-math.pi / 2)


def test_each_target_has_its_own_policy(made):
    report = made.bridge.translate_attitude_out(Odometry())  # a quaternion of length 1
    source = Odometry()
    source.pose.pose.orientation = Quaternion(x=0.0, y=0.0, z=0.0, w=0.0)
    lost = made.bridge.translate_attitude_out(source)
    assert (report.roll, report.pitch, report.yaw) == (0.0, 0.0, 0.0)
    assert (lost.roll, lost.pitch, lost.yaw) == (None, None, None)
    assert type(lost).decode(lost.encode()).yaw is None


def test_variances_become_one_figure(made):
    source = Odometry()
    source.pose.covariance[0], source.pose.covariance[7] = 9.0, 16.0
    assert made.bridge.translate_attitude_out(source).position_rms == pytest.approx(5 / 3**0.5)
    source.pose.covariance[0] = -1.0
    assert made.bridge.translate_attitude_out(source).position_rms is None


# ------------------------------------------------------------------ absent sources


def test_default_stands_for_an_absent_source(made):
    report = made.messages.ReportLocalPose
    translate = made.bridge.translate_attitude
    assert translate(report()).pose.pose.position.x == -1.5
    assert translate(report(x=4.0)).pose.pose.position.x == 4.0


def test_default_stands_for_each_absent_source_of_several(made):
    report = made.messages.ReportLocalPose
    orientation = made.bridge.translate_attitude(report(yaw=-math.pi / 2)).pose.pose.orientation
    assert orientation.z == pytest.approx(math.sqrt(0.5))
    assert orientation.w == pytest.approx(math.sqrt(0.5))
    untouched = made.bridge.translate_attitude(report()).pose.pose.orientation
    assert (untouched.x, untouched.y, untouched.z, untouched.w) == (0.0, 0.0, 0.0, 1.0)


def test_last_value_stands_for_an_absent_source(made):
    bridge, report = type(made.bridge)(), made.messages.ReportLocalPose
    values = [report(), report(y=2.0), report(), report(y=-3.0), report()]
    found = [bridge.translate_attitude(value).pose.pose.position.y for value in values]
    assert found == [0.0, -2.0, -2.0, 3.0, 3.0]


# ------------------------------------------------------------------ tables, units, expressions


def test_tables_know_both_directions(made):
    to_ros, to_jaus = made.bridge.translate_gear, made.bridge.translate_gear_out
    assert [to_ros(made.messages.Gearbox(gear=number)).data for number in range(4)] == [
        10, 20, 30, 30,
    ]  # fmt: skip
    with pytest.raises(NotImplementedError, match="convert_choose_mode is not written yet"):
        to_jaus(UInt8(data=30))
    assert "GEARS_TO_JAUS: dict[int, int] = {10: 0, 20: 1, 30: 2}\n" in made.base


def test_what_a_table_lacks_is_counted(made):
    with pytest.raises(made.error("ConversionError"), match="4"):
        made.bridge.translate_gear(made.messages.Gearbox(gear=4))


def test_names_of_values_are_resolved(made):
    target = made.bridge.translate_fix(made.messages.Fixed(state=1))
    assert (target.status.status, target.status.service) == (1, 2)
    assert math.isnan(target.altitude)
    lamps = [
        made.bridge.translate_lamps(UInt8(data=lamp)).illumination.headlights for lamp in (0, 1)
    ]
    assert lamps == [0, 1]


def test_units_differ_by_a_factor_that_nobody_writes(made):
    turning = made.messages.Turning(rate=180.0)
    assert made.bridge.translate_turn(turning).angular.z == pytest.approx(math.pi)
    source = Twist()
    source.angular.z = math.pi / 2
    assert made.bridge.translate_turn_out(source).rate == pytest.approx(90.0)
    assert "# degree per second to rad/s\n" in made.base


def test_quantities_of_the_bridge_come_before_those_of_maps(made):
    source = Odometry()
    source.pose.pose.position.z = -40.0
    assert made.bridge.translate_attitude_out(source).z == pytest.approx(50.0)


def test_quantities_are_parameters(made):
    (parameter,) = made.bridge.parameters
    assert (parameter.name, parameter.attribute) == ("reach", "reach")
    assert parameter.description == "reach (m)."
    assert made.bridge.reach == 80.0


def test_rates_that_are_not_stated_are_that_of_the_bridge(made):
    assert made.bridge.settings.frequency == 12.5
    assert (made.bridge.polled.rate, made.bridge.often.rate) == (0.0, 50.0)


def test_expressions(made):
    report = made.messages.ReportLocalPose
    values = [(6.0, 4.0), (-3.0, 4.0)]
    found = [
        made.bridge.translate_attitude(report(x=x, y=y)).twist.twist.linear.x for x, y in values
    ]
    assert found == [1.5, 5.0]
    with pytest.raises(made.error("ConversionError"), match="divide"):
        made.bridge.translate_attitude(report(x=1.0, y=0.0))


def test_integers_become_real_numbers_on_their_way_to_real_fields(made):
    """ROS takes no int for a float, and integers of Python grow without end."""
    source = made.messages.Counting(few=7, many=2**64 - 1, level=-3)
    target = made.bridge.translate_counts(source)
    assert (target.linear.x, target.linear.y, target.linear.z) == (7.0, 2.0**128, 3.0)
    assert (target.angular.x, target.angular.y, target.angular.z) == (math.inf, 2.0**64, 7.0)
    numbers = [
        getattr(vector, axis) for vector in (target.linear, target.angular) for axis in "xyz"
    ]
    assert {type(number) for number in numbers} == {float}


def test_integers_keep_their_digits_on_their_way_to_integers(made):
    source = made.messages.Digits(digits=2**53 + 1)
    assert made.bridge.translate_digits(source).data == 2**53 + 1


def test_products_of_integers_are_real_numbers_on_their_way_to_integers_too(made):
    """So they are as long as a number, however many conversions follow each other."""
    source = made.messages.Area(edge=2**31 + 1)
    assert made.bridge.translate_area(source).data == 2**62 + 2**32


def test_what_measures_is_clamped_and_what_identifies_drops_the_message(made):
    """A clamped number of a waypoint is that of another one."""

    class Mine(type(made.bridge)):
        def convert_fold(self, value):
            return -value

    bridge, messages = Mine(), made.messages
    assert bridge.translate_depth(messages.Depth(depth=300)).data == 255
    assert bridge.translate_sounding_out(UInt16(data=300)).depth == 255
    assert bridge.translate_height(messages.Height(height=300)).data == -128
    for identifies in (
        lambda: bridge.translate_mark(messages.Mark(mark=300)),
        lambda: bridge.translate_marking_out(UInt16(data=300)),
    ):
        with pytest.raises(made.error("OutOfRangeError"), match="300"):
            identifies()
    assert bridge.translate_mark(messages.Mark(mark=255)).data == 255
    assert bridge.translate_marking_out(UInt16(data=255)).mark == 255


def test_what_a_peer_sends_that_is_no_number_drops_the_message(made):
    """The codec hands it on, and a conversion would make a plausible number of some of it."""
    for rate in (math.inf, -math.inf, math.nan):
        with pytest.raises(made.error("OutOfRangeError"), match="rate"):
            made.bridge.translate_turn(made.messages.Turning(rate=rate))


def test_what_a_conversion_makes_fits_single_precision(made):
    largest = 3.4028234663852886e38
    for level in (1e300, 1.0, -1e300):
        target = made.bridge.translate_echo(made.messages.Echo(level=level))
        assert target.data == max(-largest, min(-level, largest))


def test_user_conversions_stand_in_the_skeleton(made):
    methods = {
        contract_method.name: contract_method for contract_method in made.skeleton.contract.methods
    }
    method = methods["convert_choose_mode"]
    assert method.parameters == ("value",)
    assert not method.optional
    assert method.identity == "conversion:choose_mode"
    assert "    def convert_choose_mode(self, value: int) -> int:\n" in made.skeleton.text

    class Mine(type(made.bridge)):
        def convert_choose_mode(self, value):
            return value // 10

    target = Mine().translate_gear_out(UInt8(data=20))
    assert (target.gear, target.mode) == (1, 2)


def test_user_conversions_may_take_orientations(made):
    class Mine(type(made.bridge)):
        def convert_tilt(self, value):
            return value.x

    source = PoseStamped()
    source.pose.orientation = Quaternion(x=0.25, z=0.5)
    target = Mine().translate_tilt_out(source)
    assert target.tilt == 0.25
    assert "\nfrom jausml_runtime import conversions\n" in made.skeleton.text

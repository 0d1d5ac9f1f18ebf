"""Generated translations of plain lists, arrays and lists in lists, with absolute results."""

import needs
import pytest

from tests.generators.assignment_support import connections, generated

needs.ask("rclpy")

from sensor_msgs.msg import Imu, LaserEcho, MultiEchoLaserScan
from std_msgs.msg import Float64MultiArray

TEXT = """
service_set shapes {
  service Shapes {
    urn: "urn:example:Shapes"
    inputs: new message_def QueryNumbers {
      code: "0x2201"  body: new record QueryRec { fixed_field PresenceVector { type: uint8 } }
    }
    outputs: new message_def ReportNumbers {
      code: "0xD201"
      body: new sequence NumbersSeq {
        presenceVector: uint8
        list Numbers {
          optional: true  countType: uint8  maximumCount: 4
          element: new record NumberRec { fixed_field Number { type: float32 } }
        }
        record Rest {
          fixed_field Scale { type: float64 }
          array Codes { element: new fixed_field Code { type: int16 }  dimensions: 3, 3 }
        }
      }
    }
    outputs: new message_def ReportStates {
      code: "0xD203"
      body: new record StatesRec {
        presenceVector: uint8
        array States {
          optional: true
          element: new bit_field State { subFields: { name: Gear  lowBit: 0  highBit: 3 } }
          dimensions: 2
        }
      }
    }
    outputs: new message_def ReportRows {
      code: "0xD202"
      body: new list Rows {
        countType: uint8
        element: new list Row {
          countType: uint8
          element: new record Cell { fixed_field Height { type: float64 units: "meter" } }
        }
      }
    }
  }
}

numbers { JAUS ReportNumbers  ROS std_msgs/Float64MultiArray
  JAUS->ROS ( Numbers -> data {
      Number, /Rest.Scale -> . : expression("Number * Scale")
    } )
  ROS->JAUS ( data -> Numbers { . -> Number }  0.5 -> Rest.Scale )
}

steps { JAUS ReportNumbers  ROS std_msgs/Float64MultiArray
  JAUS->ROS ( Numbers -> data {
      Number, /Numbers[1].Number -> . : expression("value1 - value2") {
        whenAbsent: useDefault  defaultValue: 1
      }
    } )
}

codes { JAUS ReportNumbers  ROS sensor_msgs/Imu
  JAUS->ROS (
    Rest.Codes -> angular_velocity_covariance { . -> . }
    Rest.Codes[1][2] -> linear_acceleration.x
    Numbers[1].Number -> linear_acceleration.y { whenAbsent: dropMessage }
  )
  ROS->JAUS (
    angular_velocity_covariance -> Rest.Codes {
      whenAbsent: leave
      index, . -> . : expression("value2 + index")
    }
    linear_acceleration.x -> Numbers[0].Number { whenAbsent: leave }
    linear_acceleration.y -> Numbers[1].Number { whenAbsent: leave }
  )
}

states { JAUS ReportStates  ROS sensor_msgs/Imu
  ROS->JAUS ( linear_acceleration.x -> States[1].Gear )
}

rows { JAUS ReportRows  ROS sensor_msgs/MultiEchoLaserScan
  JAUS->ROS ( Rows -> ranges { . -> echoes { Height -> . } } )
  ROS->JAUS ( ranges -> Rows { echoes -> . { . -> Height { whenAbsent: leave } } } )
}

bridge shaped {
  address: 1.1.2
  connection few { map: numbers direction: rosToJaus outOfRange: error topic of_numbers {} }
  connection polled { map: numbers exchange: query topic of_numbers {} }
  CONNECTIONS
}
""".replace("CONNECTIONS", connections("numbers steps codes rows", "numbers codes states rows"))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    return generated(TEXT, tmp_path_factory.mktemp("shapes"), "shaped")


@pytest.mark.slow
def test_text_is_clean(made):
    made.check_text()


def numbers(made, *values, scale=1.0, codes=(0,) * 9):
    report = made.messages.ReportNumbers
    listed = [report.NumberRec(value) for value in values]
    return report(numbers=listed, rest=report.Rest(scale, list(codes)))


# ------------------------------------------------------------------ plain numbers


def test_elements_see_the_message_around_them(made):
    target = made.bridge.translate_numbers(numbers(made, 1.0, 2.0, scale=4.0))
    assert list(target.data) == [4.0, 8.0]


def test_an_element_of_the_message_that_is_not_there_counts_as_the_default(made):
    assert list(made.bridge.translate_steps(numbers(made, 5.0, 3.0)).data) == [2.0, 0.0]
    assert list(made.bridge.translate_steps(numbers(made, 5.0)).data) == [4.0]


def test_an_absent_list_leaves_the_target(made):
    assert list(made.bridge.translate_numbers(made.messages.ReportNumbers()).data) == []


def test_numbers_become_records(made):
    target = made.bridge.translate_numbers_out(Float64MultiArray(data=[0.5, 1.5]))
    assert [number.number for number in target.numbers] == [0.5, 1.5]
    assert target.rest.scale == 0.5
    assert made.bridge.translate_numbers_out(Float64MultiArray()).numbers == []


@pytest.mark.parametrize(("name", "policy"), [("numbers_out", "not_clampable"), ("few", "error")])
def test_too_many_elements_follow_the_policy(made, name, policy):
    translate = getattr(made.bridge, f"translate_{name}")
    assert len(translate(Float64MultiArray(data=[0.0] * 4)).numbers) == 4
    with pytest.raises(made.error("OutOfRangeError")) as caught:
        translate(Float64MultiArray(data=[0.0] * 5))
    assert (caught.value.field, caught.value.policy) == ("Numbers", policy)


def test_elements_have_limits(made):
    target = made.bridge.translate_numbers_out(Float64MultiArray(data=[1e300]))
    assert target.numbers[0].number == pytest.approx(3.4028234663852886e38)


def test_queries_ask_for_the_lists_that_are_read(made):
    assert "query=QueryNumbers(presence_vector=0x0001)," in made.base


# ------------------------------------------------------------------ arrays and indices


def test_arrays_keep_their_order(made):
    source = Imu()
    source.angular_velocity_covariance = [10.0 * number for number in range(9)]
    target = made.bridge.translate_codes_out(source)
    assert target.rest.codes == [11 * number for number in range(9)]
    assert type(target).decode(target.encode()) == target


def test_indices_count_from_0_and_the_first_dimension_varies_slowest(made):
    message = numbers(made, 7.0, 8.0, codes=range(9))
    target = made.bridge.translate_codes(message)
    assert target.linear_acceleration.x == 5.0
    assert target.linear_acceleration.y == 8.0
    assert list(target.angular_velocity_covariance) == [float(number) for number in range(9)]


@pytest.mark.parametrize("values", [(), (1.0,)])
def test_an_element_that_is_not_there_is_absent(made, values):
    with pytest.raises(made.error("AbsentFieldError"), match=r"Numbers\[1\]"):
        made.bridge.translate_codes(numbers(made, *values))


def test_elements_are_made_in_order(made):
    source = Imu()
    source.linear_acceleration.x, source.linear_acceleration.y = 1.0, 2.0
    target = made.bridge.translate_codes_out(source)
    assert [number.number for number in target.numbers] == [1.0, 2.0]


def test_an_array_that_may_be_absent_is_made_whole(made):
    source = Imu()
    source.linear_acceleration.x = 2.0
    target = made.bridge.translate_states_out(source)
    assert [state.gear for state in target.states] == [0, 2]
    assert type(target).decode(target.encode()) == target


# ------------------------------------------------------------------ lists in lists


def test_lists_in_lists(made):
    source = MultiEchoLaserScan()
    source.ranges = [LaserEcho(echoes=[1.0, 2.0]), LaserEcho(), LaserEcho(echoes=[3.0])]
    target = made.bridge.translate_rows_out(source)
    assert [[cell.height for cell in row.row] for row in target.rows] == [[1.0, 2.0], [], [3.0]]
    back = made.bridge.translate_rows(type(target).decode(target.encode()))
    assert [list(echo.echoes) for echo in back.ranges] == [[1.0, 2.0], [], [3.0]]

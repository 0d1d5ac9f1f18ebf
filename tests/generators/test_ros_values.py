"""What users give to rclpy: the values that light classes would send, or the same error."""

import needs
import pytest
from for_each import for_each
from hypothesis import given
from hypothesis import strategies as st
from light_support import library

needs.ask("rclpy")

from action_msgs.msg import GoalStatusArray
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseStamped, PoseWithCovariance, Quaternion, Twist, Vector3
from nav_msgs.msg import Path
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import BatteryState, JointState, PointCloud2, PointField
from shape_msgs.msg import SolidPrimitive
from std_msgs.msg import Bool, Float32, Int8, String, UInt64
from std_srvs.srv import SetBool

from jausml.runtime.bridge.ros.internals import Codec
from jausml.runtime.bridge.ros.values import checked_answers, is_of_any_size
from jausml.runtime.wire import EncodeError


def sent(message):
    """What arrives of a message that a user made."""
    kind = type(message)
    return deserialize_message(Codec(kind).encode(message), kind)


def test_an_integer_in_a_field_of_real_numbers_is_the_number():
    assert sent(Twist(linear=Vector3(x=-1, y=True))) == Twist(linear=Vector3(x=-1.0, y=1.0))
    assert sent(Float32(data=3)).data == 3.0
    assert sent(Bool(data=1)).data is True
    assert list(sent(JointState(position=[1, 2])).position) == [1.0, 2.0]


POSES = Path(poses=[PoseStamped(), PoseStamped()])
POSES.poses[1].pose.position.z = "high"

WRONG = {
    "data: 200": Int8(data=200),
    "data: 1.0": Int8(data=1.0),
    "data: -1": UInt64(data=-1),
    "data: None": Float32(data=None),
    "data: 1e": Float32(data=1e39),
    "data: b'text'": String(data=b"text"),
    "name.1: 7": JointState(name=["a", 7]),
    "linear.x: '1'": Twist(linear=Vector3(x="1")),
    "linear: .*Vector3 of geometry_msgs expected": Twist(linear=Quaternion()),
    "poses.1.pose.position.z: 'high'": POSES,
    "covariance: .* 35 elements, not 36": PoseWithCovariance(covariance=[0.0] * 35),
    "dimensions: .* 4 elements, more than 3": SolidPrimitive(dimensions=[1.0] * 4),
    "status_list.0: 5": GoalStatusArray(status_list=[5]),
}


@for_each("words", WRONG)
def test_a_value_that_does_not_fit_is_an_error_that_names_its_field(words):
    with pytest.raises(EncodeError, match=f"^({words})"):
        sent(WRONG[words])


def test_answers_of_a_service_are_checked():
    def answer(request, response):
        response.success = request.data
        response.message = "done" if request.data else 7
        return response

    served = checked_answers(answer)
    assert served(SetBool.Request(data=1), SetBool.Response()).success is True
    with pytest.raises(EncodeError, match="message: 7 does not fit"):
        served(SetBool.Request(), SetBool.Response())


KINDS = (Twist, JointState, BatteryState, PointCloud2, PointField, SolidPrimitive, DiagnosticStatus)
ROUGH = st.one_of(
    st.booleans(),
    st.integers(-(2**64), 2**64),
    st.integers(-129, 256),
    st.floats(allow_nan=False),
    st.none(),
    st.text("a\N{EURO SIGN}", max_size=3),
    st.binary(max_size=2),
    st.lists(st.one_of(st.integers(-3, 300), st.floats(width=32, allow_nan=False)), max_size=4),
    st.lists(st.text("ab", max_size=2), max_size=2),
)


@given(data=st.data())
@pytest.mark.parametrize("kind", KINDS)
def test_rough_values_are_those_of_light_classes(kind, data):
    light = library().kind(f"{kind.__module__.split('.')[0]}/msg/{kind.__name__}")
    name = data.draw(st.sampled_from([*light.LAYOUT]))
    value = data.draw(ROUGH)
    real, plain = kind(), light()
    try:
        setattr(real, name, value)
        expected = setattr(plain, name, value) or plain.to_cdr()
    except (EncodeError, TypeError, ValueError, OverflowError):
        # rclpy makes arrays of numbers at once; the others are refused when they are encoded.
        if getattr(real, name) is value:
            with pytest.raises(EncodeError):
                Codec(kind).encode(real)
        return
    assert light.from_cdr(Codec(kind).encode(real)) == light.from_cdr(expected)


def test_messages_of_any_size_are_known():
    assert [*map(is_of_any_size, (PointCloud2, Path, Twist, BatteryState))] == [
        True, True, False, True,
    ]  # fmt: skip

"""Markers: a ROS field that says that it has no value is as absent as a JAUS field left out."""

import importlib
import math
from array import array
from functools import partial
from typing import Any

import pytest
from generated import run_in
from hypothesis import given
from hypothesis import strategies as st

from tests.generators.assignment_support import Generated, generated

GUARDS = ("generators/jausml_generators/cpp", "jausml/language/semantics/paths/markers.py")

MODEL = """
interface_package mark_msgs {
  message_type Part {
    primitive_field note { type: string }
    primitive_field charge { type: float32 marker { condition: "value != value" value: NaN } }
  }
  message_type State {
    primitive_field status {
      type: int8 defaultValue: "0" marker { condition: "value == -2" value: "-2" }
    }
    primitive_field latitude { marker { condition: "status < 0" } }
    primitive_field voltage { type: float32 marker { condition: "value != value" value: NaN } }
    primitive_field spread { arrayKind: fixedArray arraySize: 4
      marker { condition: "spread[0] == 0 and spread[3] == 0" } }
    message_field stamp { messageType: `builtin_interfaces.Time`
      marker { meaning: none condition: "stamp.sec == 0 and stamp.nanosec == 0" } }
    primitive_field ticks { type: int64 marker { condition: "value == 9007199254740992" } }
    primitive_field turning { type: float32
      marker { meaning: unlimited condition: "turning == 0" } }
    primitive_field most { type: float32 }
    primitive_field ranges { type: float32 arrayKind: unboundedSequence
      marker { meaning: none condition: "value > most or not isfinite(value)" value: "Infinity" } }
    message_field parts { messageType: Part arrayKind: unboundedSequence }
  }
}

service_set mark {
  service Mark {
    urn: "urn:example:Mark"
    inputs: new message_def SetMark {
      code: "0xD301"
      body: new record MarkRec {
        presenceVector: uint16
        fixed_field Status { type: int8 optional: true }
        fixed_field Latitude { type: float64 optional: true }
        fixed_field Voltage { type: float64 optional: true }
        fixed_field X { type: uint16 optional: true
          scale: { lower: -100 upper: 100 } units: "meter" }
        fixed_field Speed_X { type: uint16 optional: true
          scale: { lower: -100 upper: 100 } units: "meter per second" }
        fixed_field Spread { type: float64 optional: true }
        fixed_field Charge { type: float64 optional: true }
        bit_field TimeStamp { type: uint32 optional: true
          sub_field Milliseconds { lowBit: 0 highBit: 9 }
          sub_field Seconds { lowBit: 10 highBit: 15 }  sub_field Minutes { lowBit: 16 highBit: 21 }
          sub_field Hour { lowBit: 22 highBit: 26 }  sub_field Day { lowBit: 27 highBit: 31 }
        }
        fixed_field Ticks { type: int64 optional: true }
        fixed_field Turning { type: float64 optional: true }
        fixed_field Total { type: float64 optional: true }
        list Ranges { countType: uint8
          record RangeRec { presenceVector: uint8
            fixed_field Range { type: float64 optional: true }  fixed_field Ok { type: uint8 }
          }
        }
      }
    }
  }
}

plain { JAUS SetMark  ROS mark_msgs/State
  ROS->JAUS (
    status -> Status
    latitude -> Latitude
    voltage -> Voltage
    spread[0] -> Spread : square_root
    stamp -> TimeStamp : time_to_timestamp
    turning -> Turning
  )
  JAUS->ROS (
    ignore status
    Latitude -> latitude
    Voltage -> voltage
    Turning -> turning
    TimeStamp -> stamp : timestamp_to_time { whenAbsent: receptionTime }
  )
}

more { JAUS SetMark  ROS mark_msgs/State
  ROS->JAUS (
    parts[0].charge -> Charge
    ticks -> Ticks
    latitude, voltage -> Total : expression("latitude + voltage") {
      whenAbsent: useDefault defaultValue: "1"
    }
    ranges -> Ranges {
      . -> Range
      . -> Ok : expression("value > 1") { whenAbsent: useDefault defaultValue: "7" }
    }
  )
  JAUS->ROS ( Ranges -> ranges { Range -> . }  Ranges -> parts { Range -> charge } )
}

places { JAUS SetMark  ROS geometry_msgs/Vector3  ROS->JAUS ( x -> X  y -> Speed_X ) }
kept { JAUS SetMark  ROS geometry_msgs/Vector3  ROS->JAUS ( x -> X { outOfRange: clamp } ) }

strict { JAUS SetMark  ROS mark_msgs/State
  ROS->JAUS (
    latitude -> Latitude { whenAbsent: dropMessage }
    voltage -> Voltage { whenAbsent: lastValue }
    stamp -> TimeStamp : time_to_timestamp { whenAbsent: receptionTime }
    status -> Status { whenAbsent: useDefault defaultValue: "5" }
    parts[0].charge, voltage -> Total : expression("charge + voltage") {
      whenAbsent: useDefault defaultValue: "1"
    }
  )
  JAUS->ROS ( Status -> status { whenAbsent: leave }  Voltage -> voltage { whenAbsent: lastValue } )
}

bridge marked_bridge {
  address: 1.1.2
  connection up { map: plain topic a {} }
  connection down { map: plain direction: rosToJaus topic a {} }
  connection more_up { map: more topic c {} }
  connection more_down { map: more direction: rosToJaus topic c {} }
  connection places { map: places topic d {} }
  connection kept { map: kept topic d {} }
  connection strict_up { map: strict topic b {} }
  connection strict_down { map: strict direction: rosToJaus topic b {} }
}
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Generated:
    return generated(MODEL, tmp_path_factory.mktemp("marked_bridge"), "marked_bridge")


def types(made: Generated) -> Any:
    return importlib.import_module(f"{made.package}.ros_types")


def state(made: Generated, **fields: Any) -> Any:
    """A state without any marker, but for some fields."""
    found = types(made).State()
    found.spread = array("d", [4.0, 0.0, 0.0, 1.0])
    found.stamp.sec, found.turning, found.most = 1_700_000_000, 0.5, 10.0
    for name, value in fields.items():
        owner, last = found, name.split("__")
        for part in last[:-1]:
            owner = getattr(owner, part)
        setattr(owner, last[-1], value)
    return found


def absent(message: Any) -> set[str]:
    """The optional fields that a JAUS message leaves out."""
    return {slot for slot in message.__slots__ if getattr(message, slot) is None}


def test_text_is_clean(made):
    made.check_text()


def test_the_generated_tests_know_markers(made):
    tests = "".join(artifact.text for path, artifact in made.artifacts.items() if "/test/" in path)
    for name in ("down_voltage_without_voltage", "down_time_stamp_without_stamp"):
        assert f"def test_{name}(" in tests
    assert "def test_strict_down_needs_status(" in tests
    line = ("-m", "pytest", "-q", "-p", "no:cacheprovider", "test")
    run_in(made.folder, *line, cwd=made.folder / made.package)


@pytest.mark.parametrize(
    ("fields", "names"),
    [
        ({}, set()),
        ({"status": -1}, {"latitude"}),
        ({"status": -2}, {"latitude", "status"}),
        ({"voltage": math.nan}, {"voltage"}),
        ({"spread": [0.0, 7.0, 7.0, 0.0]}, {"spread"}),
        ({"stamp__sec": 0}, {"time_stamp"}),
        ({"stamp__sec": 0, "stamp__nanosec": 1}, set()),
        ({"turning": 0.0}, {"turning"}),
    ],
)
def test_what_a_marker_says_is_absent(made, fields, names):
    others = {"charge", "ticks", "total", "x", "speed_x"}
    found = absent(made.bridge.translate_down(state(made, **fields)))
    assert found - others == names


def test_an_absent_source_counts_as_its_default_in_an_expression(made):
    down = made.bridge.translate_more_down
    assert down(state(made, latitude=5.0, voltage=2.0)).total == 7.0
    assert down(state(made, latitude=5.0, voltage=math.nan)).total == 6.0
    assert down(state(made, latitude=5.0, voltage=2.0, status=-1)).total == 3.0
    assert down(state(made, voltage=math.nan, status=-1)).total is None


def test_elements_have_their_own_markers(made):
    down = made.bridge.translate_more_down
    found = down(state(made, ranges=[0.5, 2.0, 11.0, math.inf, math.nan])).ranges
    assert [(reading.range_, reading.ok) for reading in found] == [
        (0.5, 0), (2.0, 1), (None, 7), (None, 7), (None, 7)
    ]  # fmt: skip
    part = types(made).Part
    assert down(state(made)).charge is None
    assert down(state(made, parts=[part(charge=math.nan)])).charge is None
    assert down(state(made, parts=[part(charge=3.0)])).charge == 3.0


def test_policies_hold_for_markers(made):
    moment = importlib.import_module("jausml_runtime.conversions").Time(1_700_000_000, 0)
    made.bridge.now = lambda: moment
    down = made.bridge.translate_strict_down
    with pytest.raises(made.error("AbsentFieldError")):
        down(state(made, status=-1))
    found = down(state(made, latitude=3.0, voltage=math.nan, stamp__sec=0))
    assert (found.latitude, found.voltage, found.status) == (3.0, None, 0)
    assert (found.time_stamp.day, found.time_stamp.hour) == (14, 22)
    assert down(state(made, voltage=4.0)).voltage == 4.0
    assert down(state(made, voltage=math.nan)).voltage == 4.0


def test_what_is_absent_or_not_set_is_said_by_markers(made):
    message = made.messages.SetMark
    moment = importlib.import_module("jausml_runtime.conversions").Time(7, 8)
    made.bridge.now = lambda: moment
    found = made.bridge.translate_up(message())
    assert found.status == -2  # nothing sets it
    assert math.isnan(found.voltage)
    assert (found.stamp.sec, found.stamp.nanosec) == (7, 8)
    assert made.bridge.translate_up(message(voltage=2.0)).voltage == 2.0
    strict = made.bridge.translate_strict_up
    assert strict(message()).status == 0  # left on purpose
    assert math.isnan(strict(message()).voltage)
    assert [strict(message(voltage=2.0)).voltage, strict(message()).voltage] == [2.0, 2.0]


def test_elements_say_that_they_have_no_value(made):
    record = made.messages.SetMark.RangeRec
    message = made.messages.SetMark(ranges=[record(range_=2.0), record()])
    found = made.bridge.translate_more_up(message)
    assert list(found.ranges) == [2.0, math.inf]
    assert found.parts[0].charge == 2.0
    assert math.isnan(found.parts[1].charge)


def test_a_value_does_not_become_no_limit(made):
    up, message = made.bridge.translate_up, made.messages.SetMark
    assert up(message(turning=0.25)).turning == 0.25
    assert up(message()).turning == 0.0
    with pytest.raises(made.error("OutOfRangeError")) as caught:
        up(message(turning=0.0))
    assert (caught.value.field, caught.value.policy) == ("turning", "not_clampable")


def test_a_place_is_not_moved_into_its_range(made):
    vector = types(made).Vector3
    assert made.bridge.translate_places(vector(x=100.0, y=101.0)).speed_x == 100.0
    with pytest.raises(made.error("OutOfRangeError"), match="101") as caught:
        made.bridge.translate_places(vector(x=101.0))
    assert (caught.value.field, caught.value.policy) == ("X", "drop_message")
    assert made.bridge.translate_kept(vector(x=101.0)).x == 100.0


@pytest.fixture(scope="module")
def compiled(made: Generated) -> Generated:
    made.build()
    return made


def by_python(made: Generated, name: str, data: bytes) -> bytes | str:
    """What the method makes of bytes, or the name of its error."""
    kind = made.messages.SetMark if name.endswith("up") else types(made).State
    source = kind.decode(data) if name.endswith("up") else kind.from_cdr(data)
    try:
        target = getattr(made.bridge, f"translate_{name}")(source)
    except (made.error("AbsentFieldError"), made.error("OutOfRangeError")) as error:
        return type(error).__name__
    encoded: bytes = target.to_cdr() if name.endswith("up") else target.encode()
    return encoded


SPECIAL = st.sampled_from([0.0, 1.0, -1.0, 10.0, 11.0, math.nan, math.inf, -math.inf])
SINGLES = st.floats(width=32) | SPECIAL
STATES = st.fixed_dictionaries(
    {
        "status": st.sampled_from([-128, -2, -1, 0, 1]),
        "latitude": SINGLES,
        "voltage": SINGLES,
        "turning": SINGLES,
        "ranges": st.lists(SINGLES, max_size=5).map(partial(array, "f")),
        "spread": st.lists(SPECIAL, min_size=4, max_size=4).map(partial(array, "d")),
        "ticks": st.sampled_from([0, 2**53 - 1, 2**53, 2**53 + 1, 2**53 + 2, 2**63 - 1]),
        "stamp__sec": st.sampled_from([0, 1, 1_700_000_000]),
        "stamp__nanosec": st.sampled_from([0, 5]),
    }
)


@pytest.mark.needs("compiler")
@given(fields=STATES)
def test_all_forms_say_the_same(compiled, fields):
    compiled.bridge.now = lambda: importlib.import_module("jausml_runtime.conversions").Time(7, 8)
    source = state(compiled, **fields)
    source.parts = [types(compiled).Part(charge=charge) for charge in fields["ranges"]]
    sources = {"down": source.to_cdr(), "more_down": source.to_cdr()}
    made = {
        translation: by_python(compiled, translation, data) for translation, data in sources.items()
    }
    sources |= {
        name: data
        for name, data in (("up", made["down"]), ("more_up", made["more_down"]))
        if isinstance(data, bytes)
    }
    for name, data in sources.items():
        expected = by_python(compiled, name, data)
        assert compiled.compiled(name)(data) in (None, expected)


@pytest.mark.needs("compiler")
def test_the_core_asks_markers_itself(compiled):
    part = types(compiled).Part(charge=math.nan)
    source = state(compiled, status=-1, voltage=math.nan, ranges=array("f", [2.0, 11.0]))
    source.parts = [part]
    for name in ("down", "more_down"):
        assert compiled.compiled(name)(source.to_cdr()) is not None
    message = compiled.bridge.translate_more_down(source).encode()
    assert compiled.compiled("more_up")(message) is not None

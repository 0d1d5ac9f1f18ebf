"""Lists, element by element: what is made of them, by the method and by the compiled core."""

import importlib
import math
import re
import struct
from collections.abc import Callable
from functools import cache, partial
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jausml.generation.native import compiler
from tests.generators.assignment_support import Generated, connections, generated

TEXT = """
service Lists

scan { JAUS SetScan ( uint16 [<=20] distances { lower: 0  upper: 65.535 } ) { code: 0xD101 }
  ROS sensor_msgs/ChannelFloat32
  JAUS->ROS ( distances -> values { value -> . } )
  ROS->JAUS ( values -> distances { . -> value { outOfRange: clamp } } )
}

strict_scan { JAUS SetScan  ROS sensor_msgs/ChannelFloat32
  JAUS->ROS ( distances -> values { value -> . : negate } )
  ROS->JAUS ( values -> distances { . -> value : negate { outOfRange: dropMessage } } )
}

joints { JAUS SetJoints ( float32 [<=20] joints ) { code: 0xD102 }  ROS sensor_msgs/JointState
  JAUS->ROS ( joints -> position { value -> . : linear(-0.5, 3) } )
  ROS->JAUS ( position -> joints { . -> value : linear(1e30, 2.5) { outOfRange: clamp } } )
}

bounds { JAUS SetBounds ( uint32 [<=20] bounds { lower: -100000  upper: 100000 } ) { code: 0xD103 }
  ROS sensor_msgs/JointState
  JAUS->ROS ( bounds -> effort { value -> . } )
  ROS->JAUS ( effort -> bounds { . -> value { outOfRange: error } } )
}

struct [
  uint32 stamp  float32 x  float32 y  float64 z  uint16 roll { lower: -3.2  upper: 3.2 }
  uint16 pitch { lower: -3.2  upper: 3.2 }  uint16 yaw { lower: -3.2  upper: 3.2 }
] pose

poses { JAUS SetPoses ( pose [<=60] poses ) { code: 0xD105 }  ROS nav_msgs/Path
  JAUS->ROS (
    poses -> poses {
      "odom" -> header.frame_id
      x -> pose.position.x
      y -> pose.position.y : negate
      z -> pose.position.z
      roll, pitch, yaw -> pose.orientation : frd_angles_to_flu_quaternion
    }
  )
  ROS->JAUS (
    poses -> poses {
      header.stamp.sec -> stamp { outOfRange: clamp }
      pose.position.x -> x { outOfRange: clamp }
      pose.position.y -> y : negate { outOfRange: clamp }
      pose.position.z -> z { outOfRange: dropMessage }
      pose.orientation -> roll, pitch, yaw : flu_quaternion_to_frd_angles
    }
  )
}

earth { JAUS SetPoses  ROS nav_msgs/Path
  JAUS->ROS (
    poses -> poses {
      x -> pose.position.x : linear(2, 0.5)
      roll, pitch, yaw -> pose.orientation : ned_angles_to_enu_quaternion
    }
  )
  ROS->JAUS (
    poses -> poses {
      pose.position.x -> x : linear(1e30, 0.5) { outOfRange: clamp }
      pose.orientation -> roll, pitch, yaw : enu_quaternion_to_ned_angles
    }
  )
}

struct [
  uint32 range { lower: 0  upper: 1000 }  uint8 valid { lower: 0  upper: 1 }
  uint16 bearing { lower: -3.141592653589793  upper: 3.141592653589793 }  uint8 fixed
] beam

beams { JAUS SetBeams ( beam [<=60] beams ) { code: 0xD106 }  ROS sensor_msgs/LaserScan
  JAUS->ROS ( beams -> ranges { range, valid -> . : expression("if(valid == 0, 0, range)") } )
  ROS->JAUS (
    ranges -> beams {
      ., /range_min, /range_max -> range
        : expression("if(value1 >= range_min and value1 <= range_max, value1, 0)")
      ., /range_min -> valid : expression("value1 >= range_min or value1 == 1")
      index, /angle_min, /angle_increment -> bearing
        : expression("-angle_min - index * angle_increment"), wrap_angle
      7 -> fixed
    }
  )
}

cells { JAUS SetCells ( uint16 [<=60] cells { lower: -200  upper: 200 } ) { code: 0xD107 }
  ROS nav_msgs/OccupancyGrid
  JAUS->ROS ( cells -> data { value -> . { outOfRange: clamp } } )
  ROS->JAUS ( data -> cells { ., index -> value : expression("value1 + 0.25 * index") } )
}

gains { JAUS SetGains ( int16 [3] gains { optional: true } ) { code: 0xD108 }
  ROS sensor_msgs/ChannelFloat32
  ROS->JAUS ( values[0] -> gains[1] )
}

formulas { JAUS SetFormulas ( float64 first  float64 second ) { code: 0xD109 }
  ROS sensor_msgs/ChannelFloat32
  ROS->JAUS (
    values[0] -> first : expression("value + 1"), expression("2 * value")
    values[0], values[1] -> second : expression("value1 - value2"), expression("value ^ 2")
  )
}

bridge compiled_lists {
  address: 1.1.2
  CONNECTIONS
}
""".replace(
    "CONNECTIONS",
    connections(
        "scan strict_scan joints bounds poses earth beams cells",
        "scan strict_scan joints bounds poses earth beams formulas gains cells",
        ("_up", "_down"),
    ),
)
CONNECTIONS = re.findall(r"connection (\w+)", TEXT)
ODD = [0.0, -0.0, math.nan, math.inf, -math.inf, 65.535, 65.5354, 3.4e38, -1.0, 1e-45, 100000.0]
LISTS = [
    [], [1.25], [0.0005, 0.0015, 0.0025, 32.7675, 65.535], [-0.0005, -0.0015, -3.0],
    *([1.0, number, 2.0] for number in ODD), [number * 0.01 for number in range(6)],
]  # fmt: skip


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Generated:
    return generated(TEXT, tmp_path_factory.mktemp("compiled_lists"), "compiled_lists")


def translated(made: Generated, name: str, data: bytes) -> bytes:
    """What the method of a connection makes of bytes."""
    translate = getattr(made.bridge, f"translate_{name}")
    base = vars(importlib.import_module(f"{made.package}.{made.package}_base"))
    kind = translate.__annotations__["source"]
    source = base.get(kind) or getattr(made.messages, kind)
    if hasattr(source, "from_cdr"):
        encoded: bytes = translate(source.from_cdr(data)).encode()
        return encoded
    serialized: bytes = translate(source.decode(data)).to_cdr()
    return serialized


def outcome(made: Generated, name: str, translate: Callable[[], Any]) -> tuple[Any, Any]:
    """The result or the error, and what the limits counted."""
    counts = getattr(made.bridge, name).statistics.out_of_range
    counts.clear()
    try:
        result = translate()
    except made.error("JausError") as error:
        result = type(error), str(error)
    return result, dict(counts)


@cache
def functions(made: Generated) -> dict[str, Callable[[bytes], bytes | None]]:
    """The compiled forms by connection; none without a compiler."""
    if compiler() is None:
        return {}
    made.build()
    return {name: made.compiled(name) for name in CONNECTIONS}


def check(made: Generated, name: str, data: bytes) -> Any:
    """The compiled form makes what the method does, or gives way; returns that."""
    found = outcome(made, name, partial(translated, made, name, data))
    function = functions(made).get(name)
    if function is not None:
        assert outcome(made, name, partial(function, data)) in (found, (None, {}))
    return found[0]


@pytest.mark.slow
def test_text_is_clean(made):
    made.check_text()


def scan(order: str, values: list[float]) -> bytes:
    head = b"\0\1\0\0" if order == "<" else b"\0\0\0\0"
    name = struct.pack(f"{order}Ixxxx", 1)
    return head + name + struct.pack(f"{order}I{len(values)}f", len(values), *values)


def joints(order: str, positions: list[float], efforts: list[float]) -> bytes:
    out = bytearray(struct.pack(f"{order}iIIxxxxI", 1, 2, 1, 0))
    for values in (positions, [], efforts):
        out += struct.pack(f"{order}I", len(values))
        if values:
            out += bytes(-len(out) % 8)
        out += struct.pack(f"{order}{len(values)}d", *values)
    return (b"\0\1\0\0" if order == "<" else b"\0\0\0\0") + bytes(out)


ORDERS = st.sampled_from("<>")
SINGLES = st.lists(st.floats(0, 70, width=32) | st.floats(width=32) | st.sampled_from(ODD[:7]))
DOUBLES = st.lists(st.floats(-1e5, 1e5) | st.floats() | st.sampled_from(ODD))


@settings(max_examples=60, deadline=None)
@given(values=SINGLES, order=ORDERS)
def test_any_single_precision(made, values, order):
    check(made, "scan_down", scan(order, values))
    check(made, "strict_scan_down", scan(order, values))


@settings(max_examples=60, deadline=None)
@given(values=DOUBLES, order=ORDERS)
def test_any_double_precision(made, values, order):
    check(made, "joints_down", joints(order, values, []))
    check(made, "bounds_down", joints(order, [], values))


def test_an_array_that_may_be_absent_is_made_for_one_element(made):
    result = check(made, "gains_down", scan("<", [2.0]))
    assert result == struct.pack("<HB3h", 0xD108, 1, 0, 2, 0)


def test_a_formula_takes_the_whole_result_of_the_one_before(made):
    result = check(made, "formulas_down", scan("<", [2.0, 5.0]))
    assert result == struct.pack("<Hdd", 0xD109, 6.0, 9.0)


def test_each_that_does_not_fit_is_counted(made):
    data = scan("<", [1.0, math.inf, -2.0, 65.0, 70.0])
    result, counts = outcome(made, "scan_down", partial(translated, made, "scan_down", data))
    assert result == struct.pack("<HB5H", 0xD101, 5, 1000, 65535, 0, 65000, 65535)
    assert sum(counts.values()) == 3


def test_metres_as_millimetres(made):
    result = check(made, "scan_down", scan("<", [0.0, 0.5, 65.5]))
    assert result == struct.pack("<HBHHH", 0xD101, 3, 0, 500, 65500)


@pytest.mark.parametrize("name", ["scan_up", "strict_scan_up"])
@pytest.mark.parametrize("values", [[], [0], [65535], [1, 2, 3, 40000, 65535], [7] * 6])
def test_steps_to_single_precision(made, name, values):
    count = len(values)
    check(made, name, struct.pack(f"<HB{count}H", 0xD101, count, *values))


@pytest.mark.parametrize("values", [[], [0], [2**32 - 1], [1, 2**31, 3], [7] * 6])
def test_steps_to_double_precision(made, values):
    count = len(values)
    check(made, "bounds_up", struct.pack(f"<HB{count}I", 0xD103, count, *values))


@pytest.mark.parametrize("values", LISTS)
def test_single_to_double_precision(made, values):
    count = len(values)
    check(made, "joints_up", struct.pack(f"<HB{count}f", 0xD102, count, *values))


POSE = "IffdHHH"
COUNTS = st.integers(0, 60) | st.sampled_from([15, 16, 17, 60])
NUMBERS = (
    st.floats(-1e4, 1e4) | st.floats(width=32) | st.sampled_from([*ODD, 3.5e38, -1e300, 1e-320])
)
PLACES = st.floats(-1e4, 1e4, width=32) | st.floats(width=32)


def poses_to_ros(rows: list[Any]) -> bytes:
    poses = b"".join(struct.pack(f"<{POSE}", *row) for row in rows)
    return struct.pack("<HB", 0xD105, len(rows)) + poses


def path(order: str, poses: list[Any]) -> bytes:
    """A path: second, text, three numbers of the place and four of the orientation of each."""
    out = bytearray(struct.pack(f"{order}iIIxxxxI", 1, 2, 1, len(poses)))
    for second, text, *numbers in poses:
        frame = text.encode() + b"\0"
        out += bytes(-len(out) % 4)
        out += struct.pack(f"{order}iII", second, 4, len(frame)) + frame
        out += bytes(-len(out) % 8)
        out += struct.pack(f"{order}7d", *numbers)
    return (b"\0\1\0\0" if order == "<" else b"\0\0\0\0") + bytes(out)


def turned(angle: float) -> list[float]:
    return [0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2)]


def usual(n: int) -> list[Any]:
    return [n, "odom", 0.5 * n, -2.0, 0.1, 0.1, -0.2, math.sin(0.1 * n), math.cos(0.1 * n)]


def changed(rows: list[Any], changes: list[tuple[int, int, Any]]) -> list[Any]:
    """Rows with other values in some places."""
    for row, place, value in changes:
        if rows:
            rows[row % len(rows)][place] = value
    return rows


INTEGERS = st.integers(0, 0xFFFF)
UP_CHANGES = st.lists(
    st.tuples(st.integers(0, 60), st.integers(1, 2), PLACES)
    | st.tuples(st.integers(0, 60), st.just(3), NUMBERS)
    | st.tuples(st.integers(0, 60), st.integers(4, 6), INTEGERS),
    max_size=3,
)
NAMES = st.sampled_from(["odom", "", "base_link", "\u00e4" * 9])


@settings(max_examples=20, deadline=None)
@given(count=COUNTS, level=st.booleans(), changes=UP_CHANGES, frame=NAMES)
def test_paths_to_ros(made, count, level, changes, frame):
    made.bridge.poses_up_frame_id = frame
    tilts = [0x8000 if level else 0x7000 + 31 * n for n in range(count)]
    rows = [[n, 1.5 * n, -2.0, 1e-3, tilt, tilt, 999 * n] for n, tilt in enumerate(tilts)]
    data = poses_to_ros(changed(rows, changes))
    check(made, "poses_up", data)
    check(made, "earth_up", data)


DOWN_CHANGES = st.lists(
    st.tuples(st.integers(0, 60), st.integers(2, 8), NUMBERS)
    | st.tuples(st.integers(0, 60), st.just(0), st.integers(-(2**31), 2**31 - 1))
    | st.tuples(st.integers(0, 60), st.just(1), NAMES),
    max_size=3,
)


@settings(max_examples=100, deadline=None)
@given(count=COUNTS, level=st.booleans(), changes=DOWN_CHANGES, order=ORDERS)
def test_paths_to_jaus(made, count, level, changes, order):
    rows = [usual(n) for n in range(count)]
    if level:
        rows = [[*row[:5], *turned(0.1 * n)] for n, row in enumerate(rows)]
    data = path(order, changed(rows, changes))
    check(made, "poses_down", data)
    check(made, "earth_down", data)


@pytest.mark.parametrize("quaternion", [[0.0] * 4, [0.0, 1.0, 0.0, 1.0], [0.0, -1.0, 0.0, 1.0]])
def test_orientations_that_are_none_or_vertical(made, quaternion):
    rows = [usual(n) for n in range(20)]
    rows[7][5:] = quaternion
    check(made, "poses_down", path("<", rows))
    check(made, "earth_down", path("<", rows))


@pytest.mark.parametrize("signs", [(0.0, 0.0), (-0.0, 0.0), (0.0, -0.0)])
def test_zeros_with_signs(made, signs):
    rows = [[n, "odom", 0.0, 0.0, 0.0, *signs, *turned(0.3 * n)[2:]] for n in range(20)]
    rows[3][5], rows[5][6] = -0.0, -0.0
    check(made, "poses_down", path("<", rows))


def test_bytes_that_end_too_early(made):
    data = path("<", [usual(n) for n in range(17)])
    for size in (*range(4, 300, 7), *range(len(data) - 80, len(data))):
        error, _ = check(made, "poses_down", data[:size])
        assert error is made.error("DecodeError")


@pytest.mark.needs("compiler")
def test_usual_lists_are_made_by_the_core(made):
    data = path("<", [usual(n) for n in range(17)])
    assert functions(made)["poses_down"](data) == translated(made, "poses_down", data)
    data = poses_to_ros([[n, 0.5, -2.0, 1.0, 0x7000, 0x8000, n] for n in range(17)])
    assert functions(made)["poses_up"](data) == translated(made, "poses_up", data)


def laser(order: str, head: list[float], values: list[float]) -> bytes:
    start, step, least, most = head
    texts = struct.pack(f"{order}iIIxxxx", 1, 2, 1)
    rest = struct.pack(f"{order}7fI", start, 0, step, 0, 0, least, most, len(values))
    tail = struct.pack(f"{order}{len(values)}fI", *values, 0)
    return (b"\0\1\0\0" if order == "<" else b"\0\0\0\0") + texts + rest + tail


RANGES = st.lists(st.floats(0, 40, width=32) | PLACES, max_size=60) | st.lists(
    st.floats(0, 40, width=32), min_size=16, max_size=60
)
HEADS = st.sampled_from([[-1.5, 0.05, 0.25, 30.0], [9.0, -3.0, 0.0, 2000.0]]) | st.lists(
    PLACES, min_size=4, max_size=4
)


@settings(max_examples=100, deadline=None)
@given(head=HEADS, values=RANGES, order=ORDERS)
def test_scans_to_jaus(made, head, values, order):
    check(made, "beams_down", laser(order, head, values))


BEAMS = st.tuples(st.integers(0, 2**32 - 1), st.integers(0, 1), INTEGERS, st.integers(0, 255))


@settings(max_examples=60, deadline=None)
@given(beams=st.lists(BEAMS, max_size=60), valid=st.integers(0, 255))
def test_scans_to_ros(made, beams, valid):
    rows = b"".join(struct.pack("<IBHB", *beam) for beam in beams)
    if valid == 200 and rows:
        rows = rows[:4] + bytes([valid]) + rows[5:]
    check(made, "beams_up", struct.pack("<HB", 0xD106, len(beams)) + rows)


STEPS = st.lists(st.integers(0x3333, 0xCCCC), max_size=60) | st.lists(INTEGERS, max_size=60)


@settings(max_examples=60, deadline=None)
@given(steps=STEPS)
def test_numbers_to_integers(made, steps):
    count = len(steps)
    check(made, "cells_up", struct.pack(f"<HB{count}H", 0xD107, count, *steps))


@settings(max_examples=60, deadline=None)
@given(cells=st.lists(st.integers(-128, 127), max_size=60), order=ORDERS)
def test_integers_to_numbers(made, cells, order):
    head = struct.pack(f"{order}iIIxxxxiIfIIxxxx7dI", 1, 2, 1, *[0] * 12, len(cells))
    data = struct.pack(f"{len(cells)}b", *cells)
    check(made, "cells_down", (b"\0\1\0\0" if order == "<" else b"\0\0\0\0") + head + data)

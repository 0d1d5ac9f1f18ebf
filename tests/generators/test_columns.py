"""Long lists of records, which are translated as a whole, column by column."""

from __future__ import annotations

import math
import struct
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.generators.assignment_support import generated
from tests.generators.list_ways import check, outcome, ways

if TYPE_CHECKING:
    from tests.generators.assignment_support import Generated

TEXT = """
service Columns

struct [
  uint32 stamp
  float32 x
  float32 y
  float64 z
  uint16 roll { lower: -3.2  upper: 3.2 }
  uint16 pitch { lower: -3.2  upper: 3.2 }
  uint16 yaw { lower: -3.2  upper: 3.2 }
] pose

path {
  JAUS SetPath ( pose [<=60] poses ) { code: 0xD101 }
  ROS nav_msgs/Path
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

earth {
  JAUS SetPath
  ROS nav_msgs/Path
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
  uint32 range { lower: 0  upper: 1000 }
  uint8 valid { lower: 0  upper: 1 }
  uint16 bearing { lower: -3.141592653589793  upper: 3.141592653589793 }
  uint8 fixed
] beam

beams {
  JAUS SetBeams ( beam [<=60] beams ) { code: 0xD102 }
  ROS sensor_msgs/LaserScan
  JAUS->ROS (
    beams -> ranges { range, valid -> . : expression("if(valid == 0, 0, range)") }
  )
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

cells {
  JAUS SetCells ( uint16 [<=60] cells { lower: -200  upper: 200 } ) { code: 0xD103 }
  ROS nav_msgs/OccupancyGrid
  JAUS->ROS ( cells -> data { value -> . { outOfRange: clamp } } )
  ROS->JAUS ( data -> cells { ., index -> value : expression("value1 + 0.25 * index") } )
}

bridge long_lists {
  address: 1.1.2
  connection path_up { map: path topic a {} }
  connection path_down { map: path direction: rosToJaus topic a {} }
  connection earth_up { map: earth topic b {} }
  connection earth_down { map: earth direction: rosToJaus topic b {} }
  connection beams_up { map: beams topic c {} }
  connection beams_down { map: beams direction: rosToJaus topic c {} }
  connection cells_up { map: cells topic d {} }
  connection cells_down { map: cells direction: rosToJaus topic d {} }
}
"""
POSE = "IffdHHH"
COUNTS = st.integers(0, 60) | st.sampled_from([15, 16, 17, 60])
ODD = [0.0, -0.0, math.nan, math.inf, -math.inf, 3.4e38, 3.5e38, -1e300, 1e-320, 4e8]
REALS = st.floats(-1e4, 1e4) | st.floats(width=32) | st.sampled_from(ODD)
SINGLES = st.floats(-1e4, 1e4, width=32) | st.floats(width=32)
ORDERS = st.sampled_from("<>")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Generated:
    return generated(TEXT, tmp_path_factory.mktemp("long_lists"), "long_lists")


@pytest.mark.slow
def test_text_is_clean(made: Generated) -> None:
    made.check_text()


def test_each_has_columns(made: Generated) -> None:
    methods = made.base.split("\n    def translate_")[1:]
    assert len(methods) == 8
    single = {m.partition("(")[0] for m in methods if not (".each(" in m or ".each_counted(" in m)}
    # Values of ROS may be none by their markers: where no default stands for them, each is asked.
    assert single == {"beams_down", "cells_down", "earth_down", "path_down"}


def poses_to_ros(rows: list[Any]) -> bytes:
    poses = b"".join(struct.pack(f"<{POSE}", *row) for row in rows)
    return struct.pack("<HB", 0xD101, len(rows)) + poses


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
    st.tuples(st.integers(0, 60), st.integers(1, 2), SINGLES)
    | st.tuples(st.integers(0, 60), st.just(3), REALS)
    | st.tuples(st.integers(0, 60), st.integers(4, 6), INTEGERS),
    max_size=3,
)
FRAMES = st.sampled_from(["odom", "", "base_link", "\u00e4" * 9])


@settings(max_examples=20, deadline=None)
@given(count=COUNTS, level=st.booleans(), changes=UP_CHANGES, frame=FRAMES)
def test_paths_to_ros(
    made: Generated, count: int, level: bool, changes: list[Any], frame: str
) -> None:
    made.bridge.path_up_frame_id = frame
    tilts = [0x8000 if level else 0x7000 + 31 * n for n in range(count)]
    rows = [[n, 1.5 * n, -2.0, 1e-3, tilt, tilt, 999 * n] for n, tilt in enumerate(tilts)]
    data = poses_to_ros(changed(rows, changes))
    check(made, "path_up", data)
    check(made, "earth_up", data)


DOWN_CHANGES = st.lists(
    st.tuples(st.integers(0, 60), st.integers(2, 8), REALS)
    | st.tuples(st.integers(0, 60), st.just(0), st.integers(-(2**31), 2**31 - 1))
    | st.tuples(st.integers(0, 60), st.just(1), FRAMES),
    max_size=3,
)


@settings(max_examples=100, deadline=None)
@given(count=COUNTS, level=st.booleans(), changes=DOWN_CHANGES, order=ORDERS)
def test_paths_to_jaus(
    made: Generated, count: int, level: bool, changes: list[Any], order: str
) -> None:
    rows = [usual(n) for n in range(count)]
    if level:
        rows = [[*row[:5], *turned(0.1 * n)] for n, row in enumerate(rows)]
    data = path(order, changed(rows, changes))
    check(made, "path_down", data)
    check(made, "earth_down", data)


@pytest.mark.parametrize("quaternion", [[0.0] * 4, [0.0, 1.0, 0.0, 1.0], [0.0, -1.0, 0.0, 1.0]])
def test_orientations_that_are_none_or_vertical(made: Generated, quaternion: list[float]) -> None:
    rows = [usual(n) for n in range(20)]
    rows[7][5:] = quaternion
    check(made, "path_down", path("<", rows))
    check(made, "earth_down", path("<", rows))


@pytest.mark.parametrize("signs", [(0.0, 0.0), (-0.0, 0.0), (0.0, -0.0)])
def test_zeros_with_signs(made: Generated, signs: tuple[float, float]) -> None:
    rows = [[n, "odom", 0.0, 0.0, 0.0, *signs, *turned(0.3 * n)[2:]] for n in range(20)]
    rows[3][5], rows[5][6] = -0.0, -0.0
    check(made, "path_down", path("<", rows))


def test_each_out_of_range_is_counted_as_in_the_loop(made: Generated) -> None:
    rows = [usual(n) for n in range(20)]
    rows[2][2] = rows[9][2] = 1e39
    whole, _ = ways(made, "path_down")
    result, counts = outcome(made, "path_down", whole, path("<", rows))
    assert sum(counts.values()) == 2
    assert (
        struct.unpack_from(f"<{POSE}", result, 3 + 2 * 26)[1]
        == struct.unpack("<f", b"\xff\xff\x7f\x7f")[0]
    )


def test_path_as_bytes(made: Generated) -> None:
    whole, _ = ways(made, "path_down")
    rows = [[n, "odom", 0.5 * n, -2.0, 0.1, 0.0, 0.0, 0.0, 1.0] for n in range(20)]
    result = whole(path("<", rows))
    assert result[:3] == struct.pack("<HB", 0xD101, 20)
    last = struct.unpack_from(f"<{POSE}", result, 3 + 19 * 26)
    assert last == (19, 9.5, 2.0, 0.1, 0x8000, 0x8000, 0x8000)


def test_bytes_that_end_too_early(made: Generated) -> None:
    data = path("<", [usual(n) for n in range(17)])
    whole, one_by_one = ways(made, "path_down")
    for size in (*range(4, 300, 7), *range(len(data) - 80, len(data))):
        found = outcome(made, "path_down", whole, data[:size])[0]
        assert found[0] is outcome(made, "path_down", one_by_one, data[:size])[0][0]


def scan(order: str, head: list[float], values: list[float]) -> bytes:
    start, step, least, most = head
    texts = struct.pack(f"{order}iIIxxxx", 1, 2, 1)
    rest = struct.pack(f"{order}7fI", start, 0, step, 0, 0, least, most, len(values))
    tail = struct.pack(f"{order}{len(values)}fI", *values, 0)
    return (b"\0\1\0\0" if order == "<" else b"\0\0\0\0") + texts + rest + tail


RANGES = st.lists(st.floats(0, 40, width=32) | SINGLES, max_size=60) | st.lists(
    st.floats(0, 40, width=32), min_size=16, max_size=60
)
HEADS = st.sampled_from([[-1.5, 0.05, 0.25, 30.0], [9.0, -3.0, 0.0, 2000.0]]) | st.lists(
    SINGLES, min_size=4, max_size=4
)


@settings(max_examples=100, deadline=None)
@given(head=HEADS, values=RANGES, order=ORDERS)
def test_scans_to_jaus(made: Generated, head: list[float], values: list[float], order: str) -> None:
    check(made, "beams_down", scan(order, head, values))


BEAMS = st.tuples(st.integers(0, 2**32 - 1), st.integers(0, 1), INTEGERS, st.integers(0, 255))


@settings(max_examples=60, deadline=None)
@given(beams=st.lists(BEAMS, max_size=60), valid=st.integers(0, 255))
def test_scans_to_ros(made: Generated, beams: list[Any], valid: int) -> None:
    rows = b"".join(struct.pack("<IBHB", *each) for each in beams)
    if valid == 200 and rows:
        rows = rows[:4] + bytes([valid]) + rows[5:]
    check(made, "beams_up", struct.pack("<HB", 0xD102, len(beams)) + rows)


STEPS = st.lists(st.integers(0x3333, 0xCCCC), max_size=60) | st.lists(INTEGERS, max_size=60)


@settings(max_examples=60, deadline=None)
@given(steps=STEPS)
def test_numbers_to_integers(made: Generated, steps: list[int]) -> None:
    count = len(steps)
    check(made, "cells_up", struct.pack(f"<HB{count}H", 0xD103, count, *steps))


@settings(max_examples=60, deadline=None)
@given(cells=st.lists(st.integers(-128, 127), max_size=60), order=ORDERS)
def test_integers_to_numbers(made: Generated, cells: list[int], order: str) -> None:
    head = struct.pack(f"{order}iIIxxxxiIfIIxxxx7dI", 1, 2, 1, *[0] * 12, len(cells))
    data = struct.pack(f"{len(cells)}b", *cells)
    check(made, "cells_down", (b"\0\1\0\0" if order == "<" else b"\0\0\0\0") + head + data)

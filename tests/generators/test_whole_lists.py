"""Lists that are translated as a whole: numbers, and elements that lie alike, or do not."""

from __future__ import annotations

import importlib
import math
import struct
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sweeps import sweep

from tests.generators.assignment_support import generated
from tests.generators.list_ways import check, outcome, ways

if TYPE_CHECKING:
    from tests.generators.assignment_support import Generated

TEXT = """
service Lists

struct [
  float32 x
  float32 y
  uint16 yaw { lower: -3.2  upper: 3.2 }
] pose

scan {
  JAUS SetScan (
    uint16 [<=20] distances { lower: 0  upper: 65.535 }
  ) { code: 0xD101 }
  ROS sensor_msgs/ChannelFloat32
  JAUS->ROS ( distances -> values { value -> . } )
  ROS->JAUS ( values -> distances { . -> value { outOfRange: clamp } } )
}

strict_scan {
  JAUS SetScan
  ROS sensor_msgs/ChannelFloat32
  JAUS->ROS ( distances -> values { value -> . : negate } )
  ROS->JAUS ( values -> distances { . -> value : negate { outOfRange: dropMessage } } )
}

joints {
  JAUS SetJoints (
    float32 [<=20] joints
  ) { code: 0xD102 }
  ROS sensor_msgs/JointState
  JAUS->ROS ( joints -> position { value -> . : linear(-0.5, 3) } )
  ROS->JAUS ( position -> joints { . -> value : linear(1e30, 2.5) { outOfRange: clamp } } )
}

bounds {
  JAUS SetBounds (
    uint32 [<=20] bounds { lower: -100000  upper: 100000 }
  ) { code: 0xD103 }
  ROS sensor_msgs/JointState
  JAUS->ROS ( bounds -> effort { value -> . } )
  ROS->JAUS ( effort -> bounds { . -> value { outOfRange: error } } )
}

path {
  JAUS SetPath ( pose [<=20] poses ) { code: 0xD104 }
  ROS nav_msgs/Path
  JAUS->ROS (
    poses -> poses {
      "odom" -> header.frame_id
      x -> pose.position.x
      y -> pose.position.y : negate
      yaw -> pose.position.z
    }
  )
  ROS->JAUS (
    poses -> poses {
      pose.position.x -> x { outOfRange: clamp }
      pose.position.y -> y : negate { outOfRange: clamp }
      pose.position.z -> yaw { outOfRange: clamp }
    }
  )
}

bridge whole_lists {
  address: 1.1.2
  connection scan_up { map: scan topic a {} }
  connection scan_down { map: scan direction: rosToJaus topic a {} }
  connection strict_scan_up { map: strict_scan topic b {} }
  connection strict_scan_down { map: strict_scan direction: rosToJaus topic b {} }
  connection joints_up { map: joints topic c {} }
  connection joints_down { map: joints direction: rosToJaus topic c {} }
  connection bounds_up { map: bounds topic d {} }
  connection bounds_down { map: bounds direction: rosToJaus topic d {} }
  connection path_up { map: path topic e {} }
  connection path_down { map: path direction: rosToJaus topic e {} }
}
"""
ODD = [0.0, -0.0, math.nan, math.inf, -math.inf, 65.535, 65.5354, 3.4e38, -1.0, 1e-45, 100000.0]
LISTS = [
    [],
    [1.25],
    [0.0005, 0.0015, 0.0025, 32.7675, 65.535],
    [-0.0005, -0.0015, -3.0],
    *([1.0, each, 2.0] for each in ODD),
    [each * 0.01 for each in range(6)],
]
REALS = [*LISTS, [1e300], [3.4028235e8, 1.0], [3.5e38], [3.5e8], [5e-324, 1.0]]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Generated:
    return generated(TEXT, tmp_path_factory.mktemp("whole_lists"), "whole_lists")


@pytest.mark.slow
def test_text_is_clean(made: Generated) -> None:
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


@pytest.mark.parametrize("order", sweep(["<", ">"], every=2))
@pytest.mark.parametrize("values", LISTS)
@pytest.mark.parametrize("name", ["scan_down", "strict_scan_down"])
def test_single_precision_to_steps(
    made: Generated, name: str, values: list[float], order: str
) -> None:
    check(made, name, scan(order, values))


ORDERS = st.sampled_from("<>")
SINGLES = st.lists(st.floats(0, 70, width=32) | st.floats(width=32) | st.sampled_from(ODD[:7]))
DOUBLES = st.lists(st.floats(-1e5, 1e5) | st.floats() | st.sampled_from(ODD))


@settings(max_examples=60, deadline=None)
@given(values=SINGLES, order=ORDERS)
def test_any_single_precision(made: Generated, values: list[float], order: str) -> None:
    check(made, "scan_down", scan(order, values))
    check(made, "strict_scan_down", scan(order, values))


@settings(max_examples=60, deadline=None)
@given(values=DOUBLES, order=ORDERS)
def test_any_double_precision(made: Generated, values: list[float], order: str) -> None:
    check(made, "joints_down", joints(order, values, []))
    check(made, "bounds_down", joints(order, [], values))


def test_no_loop_runs_over_numbers(made: Generated) -> None:
    scans = made.base[made.base.index("def translate_scan_up(") :]
    assert "for item in" not in scans[: scans.index("def translate_joints_up(")]


def test_each_that_does_not_fit_is_counted(made: Generated) -> None:
    whole, _ = ways(made, "scan_down")
    values = [1.0, math.inf, -2.0, 65.0, 70.0]
    result, counts = outcome(made, "scan_down", whole, scan("<", values))
    assert result == struct.pack("<HB5H", 0xD101, 5, 1000, 65535, 0, 65000, 65535)
    assert sum(counts.values()) == 3


def test_numbers_that_signal(made: Generated) -> None:
    data = scan("<", [1.0, 2.0]).replace(struct.pack("<f", 2.0), b"\1\0\xa0\x7f")
    check(made, "scan_down", data)


def test_metres_as_millimetres(made: Generated) -> None:
    result = check(made, "scan_down", scan("<", [0.0, 0.5, 65.5]))
    assert result == struct.pack("<HBHHH", 0xD101, 3, 0, 500, 65500)


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("values", REALS)
def test_double_precision(made: Generated, values: list[float], order: str) -> None:
    check(made, "joints_down", joints(order, values, []))
    check(made, "bounds_down", joints(order, [], values))


@pytest.mark.parametrize("name", ["scan_up", "strict_scan_up"])
@pytest.mark.parametrize("values", [[], [0], [65535], [1, 2, 3, 40000, 65535], [7] * 6])
def test_steps_to_single_precision(made: Generated, name: str, values: list[int]) -> None:
    count = len(values)
    check(made, name, struct.pack(f"<HB{count}H", 0xD101, count, *values))


@pytest.mark.parametrize("values", [[], [0], [2**32 - 1], [1, 2**31, 3], [7] * 6])
def test_steps_to_double_precision(made: Generated, values: list[int]) -> None:
    count = len(values)
    check(made, "bounds_up", struct.pack(f"<HB{count}I", 0xD103, count, *values))


@pytest.mark.parametrize("values", LISTS)
def test_single_to_double_precision(made: Generated, values: list[float]) -> None:
    count = len(values)
    check(made, "joints_up", struct.pack(f"<HB{count}f", 0xD102, count, *values))


def path(order: str, poses: list[tuple[str, float, float, float]]) -> bytes:
    out = bytearray(struct.pack(f"{order}iIIxxxxI", 1, 2, 1, len(poses)))
    for text, *position in poses:
        frame = text.encode() + b"\0"
        out += bytes(-len(out) % 4)
        out += struct.pack(f"{order}iII", 3, 4, len(frame)) + frame
        out += bytes(-len(out) % 8)
        out += struct.pack(f"{order}7d", *position, 0.0, 0.0, 0.0, 1.0)
    return (b"\0\1\0\0" if order == "<" else b"\0\0\0\0") + bytes(out)


FRAMES = [
    [],
    ["odom"],
    ["odom", "odom", "odom"],
    ["", "", ""],
    ["odom", "map", "odometry"],
    ["odom", "base_link_of_another", "odom"],
    ["a", "ab", "abc", "abcd", "abcde"],
    ["base_link", "base_link", "x"],
    ["odom"] * 6,
]


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("frames", FRAMES)
def test_paths_to_jaus(made: Generated, frames: list[str], order: str) -> None:
    poses = [(text, 1.5 * n, -2.0, 0.1) for n, text in enumerate(frames)]
    data = path(order, poses)
    check(made, "path_down", data)
    for size in range(4, len(data), 3):
        whole, one_by_one = ways(made, "path_down")
        cut = data[:size]
        found = outcome(made, "path_down", whole, cut)[0]
        assert found[0] is outcome(made, "path_down", one_by_one, cut)[0][0]


@pytest.mark.parametrize("odd", [*ODD, 1e300, -1e300, 3.3, -3.3])
@pytest.mark.parametrize("place", [1, 2, 3])
def test_odd_values_in_a_path(made: Generated, odd: float, place: int) -> None:
    poses: list[Any] = [["odom", 1.0, 2.0, 3.0] for _ in range(3)]
    poses[1][place] = odd
    check(made, "path_down", path("<", poses))


@pytest.mark.parametrize("frame", ["odom", "", "base_link", "ä" * 9])
@pytest.mark.parametrize("count", [0, 1, 3, 5, 6])
def test_paths_to_ros(made: Generated, frame: str, count: int) -> None:
    made.bridge.path_up_frame_id = frame
    poses = b"".join(struct.pack("<ffH", 1.5 * n, -2.0, 1000 * n) for n in range(count))
    check(made, "path_up", struct.pack("<HB", 0xD104, count) + poses)


@pytest.mark.parametrize("odd", [math.nan, math.inf, -math.inf])
def test_odd_values_in_a_path_to_ros(made: Generated, odd: float) -> None:
    poses = b"".join(struct.pack("<ffH", *each, 9) for each in ((1.0, 2.0), (odd, odd)))
    check(made, "path_up", struct.pack("<HB", 0xD104, 2) + poses)


def test_package_needs_numpy(made: Generated) -> None:
    text = made.artifacts["whole_lists/package.xml"].text
    assert "<exec_depend>python3-numpy</exec_depend>" in text


@settings(max_examples=60, deadline=None)
@given(
    count=st.integers(0, 20),
    frame=st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=9),
    header=st.text("ab", max_size=9),
    order=ORDERS,
)
def test_what_is_not_looked_at_is_passed_on_as_it_is(
    made: Generated, count: int, frame: str, header: str, order: str
) -> None:
    types = importlib.import_module(f"{made.package}.ros_types")
    data = path(order, [(frame, 1.5 * n, -2.0, 0.25) for n in range(count)])
    untouched, touched = types.Path.from_cdr(data), types.Path.from_cdr(data)
    made_of_elements = types.Path(touched.header, list(touched.poses))
    # The text before the list decides where its first element begins, and how that is padded.
    untouched.header.frame_id = made_of_elements.header.frame_id = header
    assert untouched.to_cdr() == made_of_elements.to_cdr()
    assert types.Path.from_cdr(untouched.to_cdr()) == made_of_elements


def test_what_a_translation_makes_is_written_wherever_it_begins(made: Generated) -> None:
    poses = b"".join(struct.pack("<ffH", 1.5 * n, -2.0, 1000 * n) for n in range(9))
    message = made.messages.SetPath.decode(struct.pack("<HB", 0xD104, 9) + poses)
    for text in ("", "o", "odo", "odom", "odometry"):
        target = made.bridge.translate_path_up(message)
        target.header.frame_id = text
        listed = type(target)(target.header, list(made.bridge.translate_path_up(message).poses))
        assert target.to_cdr() == listed.to_cdr()

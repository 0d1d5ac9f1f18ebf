"""The compiled core of a bridge: when it is used, and what it leaves to Python."""

import importlib
import math
import os
import re
import shutil
import struct
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import pytest
from scripts import succeeded

from jausml.generation.native import FLAGS, LIBRARY, SOURCE, compiler
from tests.generators.assignment_support import Generated, generated

GUARDS = ("generators/jausml_generators/cpp", "jausml/runtime/bridge/messages/compiled.py")

# Names that C++ or its library has, and those of the core itself.
MODEL = """
service_set core {
  service Core {
    urn: "urn:example:Core"
    inputs: new message_def SetCore {
      code: "0xD301"
      body: new record CoreRec {
        presenceVector: uint16
        fixed_field class { type: uint32 scale: { lower: -100 upper: 100 } }
        fixed_field delete { type: float64 optional: true }
        fixed_field int { type: uint16 optional: true scale: { lower: 0 upper: 10 } }
        fixed_field std { type: float32 optional: true }
        variable_length_string errno {
          optional: true countType: uint8 maximumLength: 20
        }
        fixed_field check { type: uint8 optional: true }
        fixed_field Target { type: int64 optional: true }
        variable_field Either {
          optional: true
          alternative whole { index: 0 type: int64 }
          alternative part { index: 1 type: float64 }
          alternative much { index: 2 type: uint64 }
        }
      }
    }
  }
}

speed {
  JAUS SetCore
  ROS geometry_msgs/TwistStamped
  quantity top_speed { value: 10 }
  JAUS->ROS (
    clock -> header.stamp
    "base_link" -> header.frame_id
    class -> twist.linear.x : value_to_percent(top_speed), with_units("m/s")
    delete -> twist.linear.y : negate
    int, std -> twist.linear.z : expression("int * 2 + std ^ 2 / (1 + abs(int))") {
      whenAbsent: useDefault  defaultValue: "1"
    }
    Target -> twist.angular.x : negate
    check -> twist.angular.y : expression("check > 3 and not (check == 7)")
  )
  ROS->JAUS (
    twist.linear.x -> class : scale(2) { outOfRange: clamp }
    twist.linear.y -> delete : negate { outOfRange: dropMessage }
    twist.linear.z -> int { outOfRange: dropField }
    twist.angular.x -> std { outOfRange: dropMessage }
    header.frame_id -> errno { outOfRange: dropMessage }
    twist.angular.y -> check { outOfRange: error }
  )
}

count {
  JAUS SetCore
  ROS std_msgs/Int64
  JAUS->ROS ( Either.whole -> data )
  ROS->JAUS ( data -> Either.whole )
}

much {
  JAUS SetCore
  ROS std_msgs/Float64
  JAUS->ROS ( Either.much -> data )
}

most {
  JAUS SetCore
  ROS std_msgs/UInt64
  JAUS->ROS ( 18446744073709551615 -> data )
}

masses {
  JAUS SetMasses ( float32 [2] masses ) { code: 0xD302 }
  ROS mass_msgs/Masses ( uint64 [2] masses )
  ROS->JAUS ( masses -> masses { . -> . : expression("value - 1") } )
}

bridge compiled_core {
  address: 1.1.2
  connection masses { map: masses direction: rosToJaus topic e {} }
  connection much { map: much topic c {} }
  connection most { map: most topic d {} }
  connection count_up { map: count topic b {} }
  connection count_down { map: count direction: rosToJaus topic b {} }
  connection speed_up { map: speed topic a {} }
  connection speed_down { map: speed direction: rosToJaus topic a {} }
}
"""

LITTLE = bytes.fromhex("00010000")

pytestmark = pytest.mark.needs("compiler")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Generated:
    found = generated(MODEL, tmp_path_factory.mktemp("compiled_core"), "compiled_core")
    found.build()
    # Both forms are compared, which a clock between them would spoil.
    found.bridge.now = lambda: importlib.import_module("jausml_runtime.conversions").Time(7, 8)
    return found


def twist(frame: str = "base_link", order: str = "<", **parts: float) -> bytes:
    """A TwistStamped; `x` to `c` are its six numbers."""
    text = frame.encode() + b"\0"
    head = struct.pack(f"{order}iII", 5, 6, len(text)) + text
    head += bytes(-len(head) % 8)
    numbers = [parts.get(axis, 0.0) for axis in "xyzabc"]
    mark = b"\0\1\0\0" if order == "<" else b"\0\0\0\0"
    return mark + head + struct.pack(f"{order}6d", *numbers)


def core_message(made: Generated, **fields: Any) -> bytes:
    encoded: bytes = made.messages.SetCore(**fields).encode()
    return encoded


def by_python(made: Generated, name: str, data: bytes) -> Any:
    """What the method makes of bytes, and what is counted."""
    counts = getattr(made.bridge, name).statistics.out_of_range
    counts.clear()
    if name == "speed_up":
        result = made.bridge.translate_speed_up(made.messages.SetCore.decode(data)).to_cdr()
    else:
        types = importlib.import_module("compiled_core.ros_types")
        result = made.bridge.translate_speed_down(types.TwistStamped.from_cdr(data)).encode()
    return result, dict(counts)


def test_a_command_as_bytes(made):
    data = twist("map", x=25.0, y=4.0, z=5.0, a=2.5, b=9.0)
    # Code, presence of the first five, 50 of -100 .. 100, -4, 5 of 0 .. 10, 2.5, "map", 9.
    expected = "01d3 1f00 ffffffbf 00000000000010c0 0080 00002040 03 6d6170 09"
    found = made.compiled("speed_down")(data)
    assert found is not None
    assert found.hex(" ") == bytes.fromhex(expected).hex(" ")


def test_both_forms_make_the_same(made):
    for fields in (
        {"class_": 25.0},
        {"class_": -100.0, "delete": 1.5, "int": 5.0, "std": 2.0, "errno": "abc", "check": 7},
        {"class_": 0.0, "delete": -0.0, "check": 4, "target": 2**63 - 1},
        {"class_": 0.0, "target": -(2**63) + 1, "std": 3.0, "int": 0.0},
    ):
        names = {attribute(made, name): value for name, value in fields.items()}
        data = core_message(made, **names)
        assert by_python(made, "speed_up", data) == (made.compiled("speed_up")(data), {})
    for parts in ({}, {"x": 12.5, "y": -3.0, "z": 9.99, "a": 1e-40, "b": 255.4}, {"b": 2.5}):
        data = twist("odom", **parts)
        assert by_python(made, "speed_down", data) == (made.compiled("speed_down")(data), {})


def test_integers_beside_reals_keep_their_digits(made):
    up, down = made.compiled("count_up"), made.compiled("count_down")
    either = made.messages.SetCore.Either
    for whole in (0, -(2**52) - 1, 2**52 + 1):
        message = core_message(made, class_=0.0, either=either(0, whole))
        assert up(message) == LITTLE + whole.to_bytes(8, "little", signed=True)
        assert down(up(message))[-8:] == message[-8:]
    for whole in (-(2**53) - 1, 2**53 + 1, 2**63 - 1):
        message = core_message(made, class_=0.0, either=either(0, whole))
        assert up(message) is None
        assert down(LITTLE + whole.to_bytes(8, "little", signed=True)) is None


def test_integers_of_64_bits_are_left_to_python(made):
    assert not hasattr(made.bridge.translate_most, "compiled")
    much, either = made.compiled("much"), made.messages.SetCore.Either
    assert much(core_message(made, class_=0.0, either=either(2, 5))) == LITTLE + struct.pack(
        "<d", 5
    )
    assert much(core_message(made, class_=0.0, either=either(2, 2**64 - 1))) is None
    masses = made.compiled("masses")
    assert masses(LITTLE + struct.pack("<2Q", 3, 5)) == struct.pack("<H2f", 0xD302, 2, 4)
    assert masses(LITTLE + struct.pack("<2Q", 3, 2**64 - 1)) is None


def attribute(made: Generated, name: str) -> str:
    """The name that a field has in Python."""
    names = [slot.rstrip("_") for slot in made.messages.SetCore.__slots__]
    return str(made.messages.SetCore.__slots__[names.index(name.rstrip("_"))])


@pytest.mark.parametrize(
    ("what", "data"),
    [
        ("a value beyond its range, which is cut off", twist(x=51.0)),
        ("a value that drops the message", twist(a=math.inf)),
        ("a double that is no number", twist(y=math.nan)),
        ("a double that is not finite", twist(y=math.inf)),
        ("a field that is left out since it is too large", twist(z=10.5)),
        ("an error", twist(b=256.0)),
        ("a text beyond ASCII", twist("größe")),
        ("a text that is too long", twist("x" * 21)),
        ("the other order of bytes", twist(order=">")),
        ("no encapsulation", b"\1\1\0\0" + twist()[4:]),
        ("bytes that end too early", twist()[:-1]),
        ("nothing", b""),
    ],
    ids=lambda parameter: parameter if isinstance(parameter, str) else "",
)
def test_what_is_not_usual_is_left_to_python(made, what, data):
    counts = made.bridge.speed_down.statistics.out_of_range
    counts.clear()
    assert made.compiled("speed_down")(data) is None, what
    assert counts == {}


def test_what_is_unknown_is_left_out_and_counted(made):
    data = twist(z=math.nan)
    counts = made.bridge.speed_down.statistics.out_of_range
    expected = by_python(made, "speed_down", data)
    assert expected[1] == {("drop_field", "int"): 1}
    counts.clear()
    assert (made.compiled("speed_down")(data), dict(counts)) == expected


def test_what_changes_while_the_bridge_runs(made):
    data = core_message(made, **{attribute(made, "class"): 5.0})
    call, bridge = made.compiled("speed_up"), made.bridge
    speed, frame = bridge.top_speed, bridge.speed_up_frame_id
    try:
        bridge.top_speed, bridge.speed_up_frame_id = 20.0, "map"
        assert call(data) == by_python(made, "speed_up", data)[0]
        for wrong in (20, "20", None):
            bridge.top_speed = wrong
            assert call(data) is None
        bridge.top_speed, bridge.speed_up_frame_id = 20.0, "größe"
        assert call(data) is None
        bridge.top_speed, bridge.speed_up_frame_id = 0.0, "map"
        assert call(data) is None  # nothing is a percentage of zero
    finally:
        bridge.top_speed, bridge.speed_up_frame_id = speed, frame


def test_an_override_has_no_compiled_form(made):
    class Mine(type(made.bridge)):  # type: ignore[misc]
        def translate_speed_up(self, source: Any) -> Any:
            return super().translate_speed_up(source)

    assert not hasattr(Mine.translate_speed_up, "compiled")
    assert hasattr(Mine.translate_speed_down, "compiled")


@pytest.mark.parametrize(
    ("wanted", "told"), [(True, "no compiled core: it is not built;"), (False, "core is off;")]
)
def test_the_log_says_what_python_costs(made, tmp_path, caplog, wanted, told):
    class Unbuilt(type(made.bridge)):  # type: ignore[misc]
        core = type(made.bridge.core)(str(tmp_path / "base.py"), made.bridge.core.digest)

    caplog.set_level("INFO")
    Unbuilt()._load_core(wanted)
    assert told in caplog.text
    assert "20 to 100 times as much" in caplog.text


def test_forms_that_differ_are_told(made):
    """By the check that stands in the generated tests for each connection."""
    differing_forms = importlib.import_module("jausml_runtime").differing_forms
    conversion_error = made.error("ConversionError")

    def told(change: Callable[[Any], Any]) -> list[str]:
        class Mine(type(made.bridge)):  # type: ignore[misc]
            def translate_speed_up(self, source: Any) -> Any:
                return change(super().translate_speed_up(source))

        vars(Mine.translate_speed_up)["compiled"] = made.bridge.translate_speed_up.compiled
        mine = Mine()
        mine.top_speed = 10.0
        source = made.messages.SetCore(**{attribute(made, "class"): 5.0})
        found: list[str] = differing_forms(mine, mine.translate_speed_up, mine.speed_up, source)
        return found

    def another(target: Any) -> Any:
        target.twist.linear.x += 1.0
        return target

    def fails(_target: Any) -> Any:
        raise conversion_error("no")

    assert told(lambda target: target) == []
    (line,) = told(another)
    assert ": by Python: 00010000" in line
    assert ", compiled: 00010000" in line
    (line,) = told(lambda _target: None)
    assert ": by Python: None, compiled: 00010000" in line
    (line,) = told(fails)
    assert ": by Python: ConversionError, compiled: 00010000" in line


def test_a_library_of_another_text_is_not_used(made, tmp_path):
    module = importlib.import_module(type(made.bridge.core).__module__)
    package = tmp_path / "compiled_core"
    package.mkdir()
    core = module.Core(str(package / "base.py"), made.bridge.core.digest)
    with pytest.raises(module.NoCoreError, match="not built"):
        core.load()
    (package / LIBRARY).write_bytes(b"no library")
    with pytest.raises(module.NoCoreError):
        core.load()
    shutil.copy(made.folder / made.package / made.package / LIBRARY, package / "_core.so")
    assert core.load() is not None
    other = module.Core(core.module, "0" * len(core.digest))
    with pytest.raises(module.NoCoreError, match="another model"):
        other.load()


def test_names_of_models_are_no_code(made):
    text = made.artifacts["compiled_core/core/core.cpp"].text
    assert "class_" in text
    assert "delete_" in text
    assert max(map(len, text.splitlines())) <= 100
    succeeded(
        [
            str(compiler()),
            *FLAGS,
            *("-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only"),
            str(made.folder / made.package / SOURCE),
        ]
    )


BROKEN = """
import ctypes, random, sys
library = ctypes.CDLL(sys.argv[1])
chance = random.Random(5)
class Bytes(ctypes.Structure):
    _fields_ = [("data", ctypes.c_char_p), ("size", ctypes.c_size_t)]
class Live(ctypes.Structure):
    _fields_ = [("q", ctypes.POINTER(ctypes.c_double)), ("t", ctypes.POINTER(Bytes)),
                ("j", ctypes.POINTER(Bytes)), ("sec", ctypes.c_int64), ("nanosec", ctypes.c_int64)]
class Made(ctypes.Structure):
    _fields_ = [("data", ctypes.c_void_p), ("unknown", ctypes.c_uint64)]
live = Live((ctypes.c_double * 1)(3.0), (Bytes * 1)(Bytes(b"odom", 4)), None, 5, 6)
made, taken, left = Made(), 0, 0
for name, *samples in eval(sys.argv[2]):
    call = getattr(library, name)
    call.restype = ctypes.c_int64
    for sample in map(bytes.fromhex, samples):
        for _ in range(1500):
            data = bytearray(sample)
            for _ in range(chance.randrange(4)):
                data[chance.randrange(len(data))] = chance.choice([0, 1, 127, 128, 240, 255])
            data = bytes(data[: chance.choice([len(data)] * 3 + [chance.randrange(len(data))])])
            whole = ctypes.create_string_buffer(data, max(1, len(data)))
            size = call(whole, ctypes.c_size_t(len(data)), ctypes.byref(live), ctypes.byref(made))
            taken, left = taken + (size >= 0), left + (size < 0)
            assert size < 0 or len(ctypes.string_at(made.data, size)) == size
print(taken, left)
"""


@pytest.mark.needs("sanitizers", "preloaded sanitizer")
@pytest.mark.slow
def test_no_bytes_do_what_c_leaves_undefined(made, tmp_path):
    program = str(compiler())
    found = subprocess.run(
        [program, "-print-file-name=libasan.so"], capture_output=True, text=True
    ).stdout.strip()
    library = tmp_path / "_core.so"
    flags = ["-O0", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g1"]
    source = made.folder / made.package / SOURCE
    subprocess.run([program, *FLAGS, *flags, "-o", library, source], check=True)
    full = {"class": 1.0, "delete": 2.0, "int": 3.0, "std": 4.0, "errno": "abc", "check": 5}
    message = core_message(made, **{attribute(made, e): v for e, v in full.items()})
    samples = [
        ("speed_to_ros", message.hex(), core_message(made).hex()),
        ("speed_to_jaus", twist("odom", x=1.0, y=math.nan, b=3.0).hex()),
    ]
    done = succeeded(
        [sys.executable, "-c", BROKEN, str(library), repr(samples)],
        env={**os.environ, "LD_PRELOAD": found, "ASAN_OPTIONS": "detect_leaks=0"},
    )
    taken, left = map(int, re.findall("[0-9]+", done.stdout))
    assert taken > 200
    assert left > 200

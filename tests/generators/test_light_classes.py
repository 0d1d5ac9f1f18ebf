"""Light classes: the bytes of rclpy for every type of the library, and sound with any bytes."""

import functools
import importlib
import os
import random
import sys
from array import array
from contextlib import suppress

import needs
import numpy
import pytest
from for_each import for_each
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from light_support import (
    EXTREMES,
    ROOT,
    extremes,
    library,
    light_module,
    masked,
    real_class,
    real_object,
    values_of,
    written,
)
from scripts import succeeded

from jausml.generation.errors import GenerationError
from jausml.runtime.bridge.light_message import differences, installed_class, is_light
from jausml.runtime.bridge.messages.limits import RosTypeError
from jausml.runtime.wire import DecodeError, EncodeError

FEW = settings(
    deadline=None, max_examples=15, suppress_health_check=[HealthCheck.too_slow], derandomize=True
)


def types_made():
    """Returns the module of each type by its name."""
    return {name: made for made in (library(), extremes()) for name in made.types}


@functools.cache
def types_installed():
    return [name for name, ros_type in library().types.items() if real_class(ros_type) is not None]


@pytest.mark.slow
@for_each("name", types_made, shards=16, slow=True)
@FEW
@given(data=st.data())
def test_values_return_from_both_byte_orders_and_their_bytes_are_those_of_rclpy(name, data):
    made = types_made()[name]
    message = made.types[name]
    values = data.draw(values_of(message))
    light = made.object(name, values)
    little, padding = written(message, values, "<")
    big, _ = written(message, values, ">")
    assert light.to_cdr() == little
    kind = type(light)
    assert kind.from_cdr(little) == light
    assert kind.from_cdr(big) == light
    assert kind.from_cdr(big).to_cdr() == little
    if name in types_installed():
        assert_bytes_of_rclpy(light, real_object(message, values), padding)


def assert_bytes_of_rclpy(light, real, padding):
    serialization = importlib.import_module("rclpy.serialization")
    ours, theirs = light.to_cdr(), serialization.serialize_message(real)
    # rclpy leaves padding as it is, and adds some where sequences are empty.
    assert ours == masked(theirs, padding, len(ours))
    assert len(theirs) >= len(ours)
    assert serialization.deserialize_message(ours, type(real)) == real
    assert type(light).from_cdr(theirs) == light


def test_what_rclpy_serializes_is_sent_without_what_stands_behind_it():
    """It estimates the length first; a recording with the rest is no message to other readers."""
    needs.ask("rclpy")
    from rclpy.serialization import serialize_message

    from jausml.runtime.bridge.connections.translations import ros_encoder
    from jausml.runtime.bridge.ros.internals import Codec

    class Ros:
        codec = Codec

    name = "sensor_msgs/msg/JointState"
    real = real_class(library().types[name])(name=["hip"], position=[1.0])
    kind = library().kind(name)
    sent = ros_encoder(Ros(), kind)(real)
    assert len(serialize_message(real)) > len(sent) == len(kind.from_cdr(sent).to_cdr())


@for_each("name", types_installed)
def test_a_new_message_is_that_of_rclpy(name):
    needs.ask("rclpy")
    from rclpy import serialization

    real, light = real_class(library().types[name])(), library().kind(name)()
    assert serialization.deserialize_message(light.to_cdr(), type(real)) == real
    assert installed_class(type(light)) is type(real)


# ------------------------------------------------------------------ bytes of strangers


@for_each("name", types_made, shards=16, slow=True)
@settings(FEW, max_examples=10)
@given(data=st.data())
def test_any_bytes_are_a_message_or_an_error(name, data):
    made = types_made()[name]
    values = data.draw(values_of(made.types[name]))
    whole = written(made.types[name], values, data.draw(st.sampled_from("<>")))[0]
    # Values take long to draw, and damage is done at once: each is damaged in several ways.
    chance = random.Random(data.draw(st.integers(0, 0xFFFF)))
    for _ in range(6):
        raw = bytearray(whole)
        for _ in range(chance.randrange(4)):
            raw[chance.randrange(4, len(raw))] = chance.randrange(256)
        for payload in (bytes(raw[: chance.randrange(len(raw) + 1)]), bytes(raw)):
            assert_message_or_error(made.kind(name), payload)


def assert_message_or_error(kind, raw):
    try:
        found = kind.from_cdr(raw)
    except DecodeError:
        return
    # What was understood can be written, and is the same again.
    if "\N{REPLACEMENT CHARACTER}" in repr(found):  # what is no text is longer as one
        with suppress(EncodeError):
            found.to_cdr()
        return
    assert repr(kind.from_cdr(found.to_cdr())) == repr(found)


@for_each("name", types_made)
def test_a_message_that_ends_early_is_refused(name):
    made = types_made()[name]
    raw = made.kind(name)().to_cdr()
    for length in range(len(raw)):
        with pytest.raises(DecodeError):
            made.kind(name).from_cdr(raw[:length])


@for_each(
    ("name", "raw"),
    [
        # Four billion texts, numbers, messages: refused before anything is made of them.
        ("std_msgs/msg/String", "00010000 ffffffff 61"),
        ("std_msgs/msg/ByteMultiArray", "00010000 00000000 00000000 ffffffff"),
        ("nav_msgs/msg/Path", "00010000 00000000 00000000 01000000 00000000 ffffffff"),
        ("sensor_msgs/msg/JointState", "00010000 00000000 00000000 01000000 00000000 ffffffff"),
        # Other encapsulations: parameter lists, XCDR2.
        ("std_msgs/msg/Bool", "00030000 01"),
        ("std_msgs/msg/Bool", "00070000 01"),
        ("std_msgs/msg/Bool", ""),
    ],
)
def test_hostile_bytes_are_refused(name, raw):
    with pytest.raises(DecodeError):
        library().kind(name).from_cdr(bytes.fromhex(raw))


def test_a_bounded_sequence_with_more_elements_is_refused():
    numbers = extremes().kind("extreme_msgs/msg/Numbers")
    raw = bytearray(numbers().to_cdr())
    place = 4 + 4  # first, flags, then the count of `bytes`
    raw[place] = 5
    with pytest.raises(DecodeError, match="5 elements, more than 4"):
        numbers.from_cdr(bytes(raw) + bytes(8))


def test_text_is_utf_8_up_to_its_zero():
    text = library().kind("std_msgs/msg/String")
    assert text.from_cdr(bytes.fromhex("00010000 00000000")).data == ""
    with pytest.raises(DecodeError, match="no zero at its end"):
        text.from_cdr(bytes.fromhex("00010000 03000000 616263"))
    assert text.from_cdr(bytes.fromhex("00010000 02000000 ff00")).data == "\ufffd"


# ------------------------------------------------------------------ values that do not fit


@for_each(
    ("name", "field", "value"),
    [
        ("std_msgs/msg/UInt8", "data", 256),
        ("std_msgs/msg/UInt8", "data", 1.5),
        ("std_msgs/msg/UInt8", "data", None),
        ("std_msgs/msg/Float32", "data", 1e39),
        ("std_msgs/msg/String", "data", 5),
        ("std_msgs/msg/String", "data", "\ud800"),
        ("std_msgs/msg/Float32MultiArray", "data", [1e39]),
        ("std_msgs/msg/Int16MultiArray", "data", [40000]),
        ("std_msgs/msg/UInt8MultiArray", "data", [256]),
        ("std_msgs/msg/UInt8MultiArray", "data", "text"),
        ("geometry_msgs/msg/PoseWithCovariance", "covariance", [0.0] * 35),
        ("geometry_msgs/msg/PoseWithCovariance", "pose", None),
        ("nav_msgs/msg/Path", "poses", [None]),
        ("extreme_msgs/msg/Texts", "bounded", "sixsix"),
        ("extreme_msgs/msg/Texts", "some", ["", "", "", ""]),
        ("extreme_msgs/msg/Texts", "three", ["", ""]),
        ("extreme_msgs/msg/Numbers", "octets", b"12345"),
        ("extreme_msgs/msg/Numbers", "shorts", [1, 2, 3, 4]),
        ("extreme_msgs/msg/Holder", "pair", []),
    ],
)
def test_what_does_not_fit_is_an_error(name, field, value):
    message = types_made()[name].kind(name)()
    setattr(message, field, value)
    with pytest.raises(EncodeError):
        message.to_cdr()


@for_each("value", [[1.0, 2.0], (1.0, 2.0), array("f", [1.0, 2.0]), array("d", [1.0, 2.0]), [1, 2]])
def test_elements_may_stand_in_any_sequence(value):
    kind = library().kind("std_msgs/msg/Float32MultiArray")
    assert kind(data=value).to_cdr() == kind(data=[1.0, 2.0]).to_cdr()
    assert kind.from_cdr(kind(data=value).to_cdr()).data == array("f", [1.0, 2.0])


def test_numpy_arrays_are_sequences():
    for name, dtype in (("Float32MultiArray", "f4"), ("UInt8MultiArray", "u1")):
        kind = library().kind(f"std_msgs/msg/{name}")
        value = numpy.array([1, 2], dtype=dtype)
        assert kind(data=value).to_cdr() == kind(data=[1, 2]).to_cdr()


# ------------------------------------------------------------------ objects


def test_messages_are_plain_objects():
    point = library().kind("geometry_msgs/msg/Point")
    stamped = library().kind("geometry_msgs/msg/PointStamped")
    message = stamped(point=point(x=1.0))
    assert message.header is not stamped().header
    assert message == stamped(point=point(x=1.0))
    assert message != stamped()
    assert message != 1
    assert repr(message.point) == "geometry_msgs.msg.Point(x=1.0, y=0.0, z=0.0)"
    with pytest.raises(AttributeError):
        message.point.w = 1.0
    with pytest.raises(TypeError):
        hash(message)
    assert is_light(stamped)
    assert not is_light(int)


def test_constants_and_defaults_are_those_of_the_model():
    assert library().kind("sensor_msgs/msg/NavSatStatus").STATUS_GBAS_FIX == 2
    assert library().kind("geometry_msgs/msg/Quaternion")().w == 1.0
    numbers = extremes().kind("extreme_msgs/msg/Numbers")
    assert (numbers.TYPE, numbers.TYPE_) == ("extreme_msgs/msg/Numbers", 7)
    assert (numbers.LIMIT, numbers.WORD) == (2.5, 'a "word"')
    assert (numbers().cdr, list(numbers().gains)) == (1.5, [0.5, 2.0])
    assert extremes().kind("extreme_msgs/msg/Texts")().three == ["", "", ""]


def test_a_byte_may_be_given_as_rclpy_has_it():
    numbers = extremes().kind("extreme_msgs/msg/Numbers")
    ours = numbers(first=b"\7", octets=[b"\1", 2])
    assert ours.to_cdr() == numbers(first=7, octets=b"\1\2").to_cdr()


def test_objects_of_ros_may_stand_inside():
    needs.ask("rclpy")
    path, stamped = library().kind("nav_msgs/msg/Path"), "geometry_msgs/msg/PoseStamped"
    real = real_class(library().types[stamped])()
    real.pose.position.x = 2.0
    own = library().kind(stamped)()
    own.pose.position.x = 2.0
    assert path(header=real.header, poses=[real]).to_cdr() == path(poses=[own]).to_cdr()


def test_the_module_is_clean(tmp_path):
    for made in (library(), extremes()):
        file = tmp_path / "ros_types.py"
        file.write_text(made.text, encoding="utf-8")
        config = ["--config", str(ROOT / "pyproject.toml"), "--no-cache"]
        for check in (["format", "--check"], ["check"]):
            succeeded([sys.executable, "-m", "ruff", *check, *config, str(file)])


@pytest.mark.slow
def test_the_module_passes_the_type_checker(tmp_path):
    for number, made in enumerate((library(), extremes())):
        text = made.text.replace("from jausml_runtime.", "from jausml.runtime.")
        (tmp_path / f"types_{number}.py").write_text(text, encoding="utf-8")
    succeeded(
        [
            *(sys.executable, "-m", "mypy", "--explicit-package-bases"),
            *("--config-file", str(ROOT / "pyproject.toml")),
            *("--cache-dir", str(ROOT / ".mypy_cache"), "."),
        ],
        cwd=tmp_path,
        env={**os.environ, "MYPYPATH": str(ROOT)},
    )


# ------------------------------------------------------------------ models that cannot be


def changed(tmp_path, old, new):
    text = EXTREMES.read_text(encoding="utf-8")
    assert old in text
    model = tmp_path / "changed.xmi"
    model.write_text(text.replace(old, new), encoding="utf-8")
    return light_module([model], "changed")


def test_a_message_in_itself_is_an_error(tmp_path):
    old = 'name="voids" arrayKind="unboundedSequence" messageType="Nothing"'
    new = 'name="voids" arrayKind="unboundedSequence" messageType="Holder"'
    with pytest.raises(GenerationError, match=r"extreme_msgs/Holder contains itself"):
        changed(tmp_path, old, new)


# ------------------------------------------------------------------ installed types


class Real:
    """Stands for an installed class: what differs is only its fields."""

    def __init__(self, fields):
        self._fields = fields

    def get_fields_and_field_types(self):
        return self._fields


@for_each(
    ("fields", "found"),
    [
        ({"x": "double", "y": "double", "z": "double"}, []),
        ({"x": "double", "y": "float", "z": "double"},
            ["geometry_msgs/msg/Point: y is double in the model and is float there"]),
        ({"x": "double", "y": "double"},
            ["geometry_msgs/msg/Point: z is double in the model and is not there"]),
        ({"x": "double", "y": "double", "z": "double", "w": "uint8[4]"},
            ["geometry_msgs/msg/Point: w is not in the model and uint8[4] there"]),
        ({"x": "double", "z": "double", "y": "double"},
            ["geometry_msgs/msg/Point: the fields are in another order there"]),
    ],
)  # fmt: skip
def test_differences_are_told(fields, found):
    assert differences(library().kind("geometry_msgs/msg/Point"), Real(fields)) == found


def test_differences_inside_are_told():
    holder = extremes().kind("extreme_msgs/msg/Holder")
    found = differences(holder, Real(dict(holder.LAYOUT)))
    assert any("extreme_msgs/msg/Numbers: " in difference for difference in found)


def test_a_package_that_is_not_installed_is_one_error_with_its_cure():
    cure = "; install extreme_msgs, or add it"
    with pytest.raises(RosTypeError, match=rf"extreme_msgs/msg/Holder is not installed .*{cure}"):
        installed_class(extremes().kind("extreme_msgs/msg/Holder"))


def test_a_type_that_is_installed_otherwise_is_one_error_with_its_cure(monkeypatch):
    needs.ask("rclpy")
    point = library().kind("geometry_msgs/msg/Point")
    monkeypatch.setattr(point, "LAYOUT", {**point.LAYOUT, "z": "float"})
    pose = library().kind("geometry_msgs/msg/Pose")
    with pytest.raises(RosTypeError, match=r"z is float in the model and is double there.*import"):
        installed_class(pose)

"""Flat writing of ROS messages, against rclpy."""

from __future__ import annotations

import importlib
import importlib.util
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from jausml.language.metamodel.classes import ros
from jausml.language.model import read_models
from jausml.runtime.bridge.messages.layouts import CdrLayouts
from jausml.runtime.wire import EncodeError
from jausml_generators.bridge.flat.cdr_writing import CdrWriting
from jausml_generators.bridge.flat.constants import Constants
from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.python.names import Scope

LIBRARY = Path(__file__).resolve().parents[2] / "models" / "library" / "ros"
TYPES = {
    f"{kind.eContainer().name}/{kind.name}": kind
    for kind in read_models(sorted(LIBRARY.glob("*.xmi"))).model.instances(ros.MessageType)
    if isinstance(kind.eContainer(), ros.InterfacePackage)
}
INSTALLED = [name for name in TYPES if importlib.util.find_spec(name.partition("/")[0]) is not None]
FEW = settings(
    max_examples=15, deadline=None, database=None, suppress_health_check=list(HealthCheck)
)
INTEGERS = {f"{sign}int{bits}": bits for sign in ("", "u") for bits in (8, 16, 32, 64)}


def ros_class(name: str) -> Any:
    package, _, own = name.partition("/")
    return getattr(importlib.import_module(f"{package}.msg"), own)


def primitive(field: Any) -> st.SearchStrategy[Any]:
    """Returns the values of a primitive type."""
    name = field.type.name
    if name in INTEGERS:
        bits = INTEGERS[name]
        low = 0 if name.startswith("u") else -(2 ** (bits - 1))
        return st.integers(low, low + 2**bits - 1)
    if name in {"byte", "char"}:
        return st.integers(0, 255)
    if name == "bool":
        return st.booleans()
    if name == "string":
        return st.text(st.characters(exclude_characters="\0", codec="utf-8"), max_size=9)
    return st.floats(width=32 if name == "float32" else 64, allow_nan=False)


def single(field: Any) -> st.SearchStrategy[Any]:
    return whole(field.messageType) if hasattr(field, "messageType") else primitive(field)


def whole(kind: ros.MessageType) -> st.SearchStrategy[dict[str, Any]]:
    """Returns the values of all fields of a type, by name."""
    fields = {}
    for field in kind.fields:
        value, size = single(field), field.arraySize
        if field.arrayKind.name == "fixedArray":
            value = st.lists(value, min_size=size, max_size=size)
        elif field.arrayKind.name != "single":
            value = st.lists(value, max_size=min(size or 3, 3))
        fields[field.name] = st.none() | value
    return st.fixed_dictionaries(fields)


def fill(message: Any, kind: ros.MessageType, values: dict[str, Any]) -> Any:
    """Sets the fields of a message of rclpy."""
    for field in kind.fields:
        value = values[field.name]
        if value is None:
            continue
        if hasattr(field, "messageType"):
            make = ros_class(f"{field.messageType.eContainer().name}/{field.messageType.name}")
            inner = value if isinstance(value, list) else [value]
            made = [fill(make(), field.messageType, each) for each in inner]
            value = made if isinstance(value, list) else made[0]
        elif field.type.name == "byte":
            is_list = isinstance(value, list)
            value = [bytes([each]) for each in value] if is_list else bytes([value])
        setattr(message, field.name, value)
    return message


class Case:
    """A function that writes messages, from values by path."""

    def __init__(self, kind: ros.MessageType, values: dict[str, Any]) -> None:
        self.arguments: dict[str, Any] = {}
        self.lines: list[str] = []
        self.constants = Constants()
        self.scope = Scope(frozenset({"struct"}))
        self.writing = CdrWriting(kind, self.constants, self.scope)
        self._put(self.writing, kind, values, "")

    def run(self) -> bytes:
        lines = [*self.lines, *self.writing.lines()]
        arguments = ", ".join(self.arguments)
        text = "\n".join(
            [*self.constants.lines, f"def write({arguments}):", *("    " + each for each in lines)]
        )
        space: dict[str, Any] = {
            "struct": struct,
            "CdrLayouts": CdrLayouts,
            "EncodeError": EncodeError,
        }
        exec(text, space)  # noqa: S102 - the code under test
        made: bytes = space["write"](**self.arguments)
        return made

    def _argument(self, value: Any) -> str:
        name = self.scope.claim("given")
        self.arguments[name] = value
        return name

    def _put(self, writing: Any, kind: Any, values: dict[str, Any], start: str) -> None:
        for field in kind.fields:
            value, path = values[field.name], f"{start}{field.name}"
            is_sequence = field.arrayKind.name not in {"single", "fixedArray"}
            if value is None:
                if not isinstance(field, ros.MessageField) and not is_sequence:
                    writing.put(path, self._argument(None), conditional=True) if (
                        field.arrayKind.name == "single"
                    ) else None
            elif isinstance(field, ros.MessageField) and is_sequence:
                self._sequence(writing, field, path, value)
            elif isinstance(field, ros.MessageField):
                inner = value if isinstance(value, list) else [value]
                for index, each in enumerate(inner):
                    place = f"{path}[{index}]" if isinstance(value, list) else path
                    self._put(writing, field.messageType, each, f"{place}.")
            elif field.type.name == "string" and field.arrayKind.name == "fixedArray":
                for index, each in enumerate(value):
                    writing.put(f"{path}[{index}]", self._argument(each))
            else:
                is_octets = is_sequence and field.type.name in {"byte", "char", "uint8"}
                writing.put(path, self._argument(bytes(value) if is_octets else value))

    def _sequence(self, writing: Any, field: Any, path: str, rows: list[dict[str, Any]]) -> None:
        sequence = writing.sequence(path)
        row = self.scope.claim("row")
        rows_name = self._argument(rows)
        names: list[tuple[str, str]] = []
        self._put_row(sequence.element, field.messageType, "", names, row)
        body = [f"{name} = {code}" for name, code in names]
        self.lines += sequence.begin()
        self.lines.append(f"for {row} in {rows_name}:")
        self.lines += ["    " + line for line in [*body, *sequence.append()]]

    def _put_row(self, element: Any, kind: Any, start: str, names: Any, code: str) -> None:
        for field in kind.fields:
            place = f'({code} or {{}}).get("{field.name}")'
            if field.arrayKind.name in {"boundedSequence", "unboundedSequence"}:
                raise NotFlatError("sequences in elements")
            if isinstance(field, ros.MessageField) and field.arrayKind.name == "single":
                self._put_row(element, field.messageType, f"{start}{field.name}.", names, place)
            elif field.arrayKind.name == "single":
                name = self.scope.claim(field.name)
                names.append((name, place))
                element.put(f"{start}{field.name}", name, conditional=True)
            elif isinstance(field, ros.MessageField) or field.type.name == "string":
                raise NotFlatError("arrays of no numbers in elements")
            else:
                for index in range(field.arraySize):
                    name = self.scope.claim(field.name)
                    names.append((name, f"({place} or [0] * 99)[{index}]"))
                    element.put(f"{start}{field.name}[{index}]", name)


def differs_in_padding_alone(flat: bytes, message: Any) -> None:
    from rclpy.serialization import deserialize_message, serialize_message

    other = serialize_message(message)
    # rclpy adds bytes at the end: to a multiple of four, and for empty sequences of wide numbers.
    assert 0 <= len(other) - len(flat) < 32
    assert flat[:4] == other[:4]
    assert deserialize_message(flat, type(message)) == message
    # What rclpy leaves as it was is padding, which is zero here.
    assert all(mine == 0 for mine, its in zip(flat, other, strict=False) if mine != its)


@pytest.mark.parametrize("name", INSTALLED)
def test_the_bytes_of_rclpy(name: str) -> None:
    kind = TYPES[name]
    empty = {field.name: None for field in kind.fields}

    @FEW
    @given(whole(kind))
    @example(empty)
    def same(values: dict[str, Any]) -> None:
        try:
            case = Case(kind, values)
        except NotFlatError:
            return
        differs_in_padding_alone(case.run(), fill(ros_class(name)(), kind, values))

    same()


def written(kind: str, given: dict[str, str], space: dict[str, Any]) -> bytes:
    """Returns the bytes of a message with expressions as values."""
    constants, scope = Constants(), Scope(frozenset({*space, "struct"}))
    writing = CdrWriting(TYPES[kind], constants, scope)
    for path, code in given.items():
        writing.put(path, code)
    return run(constants, writing.lines(), space)


def run(constants: Constants, lines: list[str], space: dict[str, Any]) -> bytes:
    text = "\n".join(
        [*constants.lines, f"def write({', '.join(space)}):", *("    " + line for line in lines)]
    )
    names: dict[str, Any] = {"struct": struct, "CdrLayouts": CdrLayouts, "EncodeError": EncodeError}
    exec(text, names)  # noqa: S102 - the code under test
    made: bytes = names["write"](**space)
    return made


def test_a_message_of_fixed_size_is_one_struct() -> None:
    constants = Constants()
    writing = CdrWriting(TYPES["geometry_msgs/Twist"], constants, Scope())
    writing.put("linear.x", "speed")
    assert "    return _LAYOUT_1.pack(256, speed)" in writing.lines()
    assert constants.lines == ('_LAYOUT_1 = struct.Struct("<Id40x")',)


def test_texts_that_are_known_are_part_of_the_struct() -> None:
    from geometry_msgs.msg import PointStamped

    constants = Constants()
    writing = CdrWriting(TYPES["geometry_msgs/PointStamped"], constants, Scope())
    writing.put("header.frame_id", '"map"')
    writing.put("point.x", "x")
    message = PointStamped()
    message.header.frame_id, message.point.x = "map", 2.5
    assert "CdrLayouts" not in str(constants.lines)
    differs_in_padding_alone(run(constants, writing.lines(), {"x": 2.5}), message)


@pytest.mark.parametrize(
    ("kind", "given", "space"),
    [
        ("std_msgs/UInt8", {"data": "x"}, {"x": 256}),
        ("std_msgs/UInt8", {"data": "x"}, {"x": -1}),
        ("std_msgs/UInt8", {"data": "x"}, {"x": 1.5}),
        ("std_msgs/Float32", {"data": "x"}, {"x": 1e39}),
        ("std_msgs/Float64", {"data": "x"}, {"x": "one"}),
        ("std_msgs/String", {"data": "x"}, {"x": 7}),
        ("std_msgs/String", {"data": "x"}, {"x": "\ud800"}),
        ("geometry_msgs/PoseWithCovariance", {"covariance": "x"}, {"x": [0.0] * 35}),
        ("geometry_msgs/Polygon", {"points": "x"}, {"x": 3}),
        ("sensor_msgs/JointState", {"name": "x"}, {"x": ["a", 1]}),
        ("sensor_msgs/JointState", {"position": "x"}, {"x": [1.0, None]}),
    ],
)
def test_values_that_do_not_fit_are_refused(
    kind: str, given: dict[str, str], space: dict[str, Any]
) -> None:
    with pytest.raises((EncodeError, NotFlatError)):
        written(kind, given, space)


def test_numbers_at_once() -> None:
    from sensor_msgs.msg import LaserScan

    ranges = np.linspace(0.0, 7.0, 360, dtype="<f4")
    constants, scope = Constants(), Scope(frozenset({"ranges", "frame"}))
    writing = CdrWriting(TYPES["sensor_msgs/LaserScan"], constants, scope)
    writing.put("header.frame_id", "frame")
    writing.sequence("ranges").vector("ranges")
    lines = writing.lines()
    for frame in ("", "laser", "front_laser"):
        message = LaserScan()
        message.header.frame_id, message.ranges = frame, ranges.tolist()
        made = run(constants, lines, {"ranges": ranges, "frame": frame})
        differs_in_padding_alone(made, message)


def test_wide_numbers_at_once() -> None:
    from std_msgs.msg import Float64MultiArray

    for count in range(4):
        numbers = np.arange(count, dtype="<f8")
        constants = Constants()
        writing = CdrWriting(TYPES["std_msgs/Float64MultiArray"], constants, Scope())
        writing.sequence("data").vector("numbers")
        made = run(constants, writing.lines(), {"numbers": numbers})
        differs_in_padding_alone(made, Float64MultiArray(data=numbers.tolist()))


def test_paths_that_lead_nowhere_are_refused() -> None:
    writing = CdrWriting(TYPES["nav_msgs/Path"], Constants(), Scope())
    for path in ("speed", "poses[0]", "header", "header.frame_id[0]"):
        with pytest.raises(NotFlatError):
            writing.put(path, "x")
    for path in ("header", "header.frame_id", "speed"):
        with pytest.raises(NotFlatError):
            writing.sequence(path)


def test_layouts_are_kept_within_bounds() -> None:
    layouts = CdrLayouts("I", "s", "d")
    for length in range(2000):
        assert layouts[4, length].size == (13 + length + 7) // 8 * 8 + 8 - 4
    assert len(layouts) <= 256

"""One class for the time stamp of AS5710, and one of its own for every other layout."""

import itertools
from dataclasses import replace
from typing import Any

import pytest
from codec_support import LIBRARY, LIBRARY_FILES, ROOT, library, load, render, shipped_sets
from for_each import for_each
from generated import model_of, texts_of
from hypothesis import given
from hypothesis import strategies as st

from jausml.language import wire
from jausml.language.metamodel.classes import jaus
from jausml.runtime.messages import ReportTime, SetTime
from jausml.runtime.wire import EncodeError, Message, StampedMessage, TimeStamp
from jausml_generators.bridge.target import TARGET as BRIDGES
from jausml_generators.jaus_component.target import TARGET as COMPONENTS
from jausml_generators.messages.target import TARGET as MESSAGES
from jausml_generators.python.codec.classes import BitFieldClass
from jausml_generators.python.codec.message_builder import MessageBuilder
from jausml_generators.ros_node.target import TARGET as NODES


def set_time() -> wire.Message:
    """The layout of SetTime."""
    model = model_of(LIBRARY / LIBRARY_FILES["core-v1.1"])
    messages = model.instances(jaus.MessageDef)
    return wire.resolve(next(message for message in messages if message.name == "SetTime"))


LAYOUT = set_time()
STAMP = next(member for member in LAYOUT.body.kind.members if member.name == "TimeStamp")
SYSTEMS = (
    "models/catvehicle/catvehicle.xmi",
    "models/examples/winch/winch.xmi",
    "models/minimal/minimal.xmi",
)
PARTS = ("milliseconds", "seconds", "minutes", "hour", "day")


def with_stamp(**changes: Any) -> Any:
    """The layout of SetTime with another TimeStamp."""
    record = LAYOUT.body.kind
    members = tuple(
        replace(member, **changes) if member is STAMP else member for member in record.members
    )
    return replace(LAYOUT, body=replace(LAYOUT.body, kind=replace(record, members=members)))


def with_group(index: int, **changes: Any) -> Any:
    """The layout of SetTime with another group of bits in its TimeStamp."""
    groups = list(STAMP.kind.groups)
    groups[index] = replace(groups[index], **changes)
    return with_stamp(kind=replace(STAMP.kind, groups=tuple(groups)))


def generated_anew() -> Any:
    """The class that is generated for the layout when the runtime is not asked."""
    view = MessageBuilder(LAYOUT, "SetTime").build()
    nested = tuple(
        replace(inner, is_inherited=False) if isinstance(inner, BitFieldClass) else inner
        for inner in view.nested
    )
    return load(render((replace(view, nested=nested),)), "time_stamp_anew").SetTime.TimeStamp


ANEW = generated_anew()


def packed(cls: Any, parts: tuple[Any, ...]) -> int | str:
    """The integer of a stamp, or why there is none."""
    try:
        integer: int = cls(*parts).to_integer()
    except EncodeError as error:
        return str(error)
    return integer


def test_messages_share_the_class_and_offer_it():
    assert SetTime.TimeStamp is ReportTime.TimeStamp is TimeStamp
    assert ANEW is not TimeStamp
    stamp = ReportTime.TimeStamp(milliseconds=1, day=2)
    assert SetTime(time_stamp=stamp) == SetTime(time_stamp=TimeStamp(1, 0, 0, 0, 2))
    assert SetTime.decode(SetTime(time_stamp=stamp).encode()).time_stamp == stamp
    assert repr(stamp) == "TimeStamp(milliseconds=1, seconds=0, minutes=0, hour=0, day=2)"


def test_the_class_has_the_attributes_and_defaults_of_a_generated_one():
    assert TimeStamp.__slots__ == ANEW.__slots__ == PARTS
    assert repr(ANEW()) == f"SetTime.{TimeStamp()!r}"


@given(st.integers(0, 2**32 - 1))
def test_it_reads_the_bits_as_a_generated_one_does(bits):
    ours, theirs = TimeStamp.from_integer(bits), ANEW.from_integer(bits)
    values = tuple(getattr(ours, part) for part in PARTS)
    assert values == tuple(getattr(theirs, part) for part in PARTS)
    assert packed(TimeStamp, values) == packed(ANEW, values)


VALUES = (-1, 0, 1, 23, 24, 31, 32, 59, 60, 999, 1000, None, "x")


@for_each(("index", "value"), itertools.product(range(len(PARTS)), VALUES))
def test_it_refuses_what_a_generated_one_refuses(index, value):
    parts: list[Any] = [1] * 5
    parts[index] = value
    assert packed(TimeStamp, tuple(parts)) == packed(ANEW, tuple(parts))


@for_each(
    "layout",
    [
        with_group(0, name="Millis"),
        with_group(1, low=10, high=14),
        with_group(2, legal=replace(STAMP.kind.groups[2].legal, ranges=((0, 60),))),
        with_group(3, legal=replace(STAMP.kind.groups[3].legal, ranges=((0, 11), (13, 23)))),
        with_group(4, legal=replace(STAMP.kind.groups[4].legal, offset=1)),
        with_stamp(kind=replace(STAMP.kind, groups=STAMP.kind.groups[::-1])),
        with_stamp(name="Moment"),
    ],
)
def test_another_layout_has_a_class_of_its_own(layout):
    view = MessageBuilder(layout, "SetTime").build()
    cls: Any = load(render((view,)), "time_stamp_of_another_layout").SetTime
    assert cls.__base__ is Message
    nested = cls.Moment if hasattr(cls, "Moment") else cls.TimeStamp
    assert nested is not TimeStamp
    assert nested.__qualname__.startswith("SetTime.")


def test_a_stamp_that_is_always_there_is_made_with_its_message():
    view = MessageBuilder(with_stamp(bit=0), "SetTime").build()
    cls: Any = load(render((view,)), "time_stamp_always").SetTime
    assert cls().time_stamp == TimeStamp()
    assert issubclass(cls, StampedMessage)


@for_each("set_name", shipped_sets())
def test_no_message_of_the_library_has_a_class_of_its_own(set_name):
    assert "class TimeStamp" not in library(set_name)[1]


@pytest.mark.parametrize("system", SYSTEMS)
def test_no_package_of_the_shipped_systems_has_a_class_of_its_own(system):
    files = texts_of(model_of(ROOT / system), (COMPONENTS, BRIDGES, NODES, MESSAGES))
    texts = [text for path, text in files.items() if path.endswith(".py")]
    assert texts
    assert not [text for text in texts if "class TimeStamp" in text]

"""Messages are compared and shown as the dataclasses that they are, by functions they all share."""

import dataclasses
import inspect

import pytest

from jausml.runtime import messages
from jausml.runtime.messages import QueryStatus, ReportStatus, SetEmergency
from jausml.runtime.wire import Message

CLASSES = [
    message_class
    for _, message_class in inspect.getmembers(messages, inspect.isclass)
    if issubclass(message_class, Message) and dataclasses.is_dataclass(message_class)
]


def as_the_standard_library_has_it(cls):
    """A dataclass of the same fields that has functions of its own for all it can do."""
    fields = [
        (field.name, field.type, dataclasses.field(default=None))
        for field in dataclasses.fields(cls)
    ]
    made = dataclasses.make_dataclass(cls.__name__, fields)
    made.__qualname__ = cls.__qualname__
    return made


def test_each_message_is_shown_as_a_dataclass_is():
    assert len(CLASSES) > 40
    for cls in CLASSES:
        message = cls()
        values = {field.name: getattr(message, field.name) for field in dataclasses.fields(cls)}
        assert repr(message) == repr(as_the_standard_library_has_it(cls)(**values))


def test_each_field_counts():
    for cls in CLASSES:
        assert cls() == cls()
        for field in dataclasses.fields(cls):
            other = cls()
            setattr(other, field.name, object())
            assert other != cls(), (cls, field.name)
            assert other == dataclasses.replace(other)


def test_another_class_is_another_message():
    class Own(ReportStatus):
        """A class of a user."""

    assert Own(1, 0) == Own(1, 0)
    assert Own(1, 0) != ReportStatus(1, 0)
    assert ReportStatus(1, 0) != SetEmergency(1)
    assert ReportStatus(1, 0) != (1, 0)
    assert ReportStatus(1, 0).__eq__((1, 0)) is NotImplemented
    assert QueryStatus() == QueryStatus()
    assert repr(Own(1, 0)).endswith("Own(status=1, reserved=0)")


def test_what_can_be_changed_is_no_key():
    with pytest.raises(TypeError):
        hash(ReportStatus(1, 0))
    with pytest.raises(TypeError):
        hash(QueryStatus())


def test_what_holds_itself_can_be_shown():
    message = ReportStatus(1, 0)
    message.reserved = message
    assert repr(message) == "ReportStatus(status=1, reserved=...)"

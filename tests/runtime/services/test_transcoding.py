"""Marks of translations."""

from __future__ import annotations

from functools import wraps

from jausml.runtime import ros_classes, transcoded
from jausml.runtime.bridge.connections.transcoding import transcoder_of, uses_ros_classes


def factory(_bridge, _connection):
    return lambda data: data


class Generated:
    @transcoded(factory)
    def translate_numbers(self, source):
        return source


class Overridden(Generated):
    def translate_numbers(self, source):
        return super().translate_numbers(source)


class Real(Generated):
    @ros_classes
    def translate_numbers(self, source):
        return super().translate_numbers(source)


class Wrapped(Generated):
    """An override that takes over all attributes of what it overrides."""

    @wraps(Generated.translate_numbers)
    def translate_numbers(self, source):
        return source + 1


def test_a_mark_changes_nothing_else():
    assert Generated().translate_numbers(5) == 5
    assert Generated.translate_numbers.__name__ == "translate_numbers"


def test_an_override_has_no_flat_form():
    assert transcoder_of(Generated().translate_numbers) is factory
    assert transcoder_of(Overridden().translate_numbers) is None
    assert transcoder_of(Real().translate_numbers) is None
    assert transcoder_of(Wrapped().translate_numbers) is None


def test_classes_of_ros_are_asked_for():
    assert uses_ros_classes(Real().translate_numbers)
    assert not uses_ros_classes(Overridden().translate_numbers)
    assert not uses_ros_classes(Generated().translate_numbers)

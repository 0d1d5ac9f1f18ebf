"""Marks of translations."""

from jausml.runtime import ros_classes
from jausml.runtime.bridge.connections.translations import uses_ros_classes


class Generated:
    def translate_numbers(self, source):
        return source


class Overridden(Generated):
    def translate_numbers(self, source):
        return super().translate_numbers(source)


class Real(Generated):
    @ros_classes
    def translate_numbers(self, source):
        return super().translate_numbers(source)


def test_a_mark_changes_nothing_else():
    assert Real().translate_numbers(5) == 5
    assert Real.translate_numbers.__name__ == "translate_numbers"


def test_classes_of_ros_are_asked_for():
    assert uses_ros_classes(Real().translate_numbers)
    assert not uses_ros_classes(Overridden().translate_numbers)
    assert not uses_ros_classes(Generated().translate_numbers)

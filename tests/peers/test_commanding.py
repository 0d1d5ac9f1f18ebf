"""When a command that is repeated is due."""

import pytest

from jausml.live.peers.requesting import Course


def times(course, late):
    """Returns when messages are due, each of which is sent so much later."""
    due, found = 0.0, []
    while due is not None:
        found.append(due)
        due = course.next_due(due, due + late)
    return found


@pytest.mark.parametrize("late", [0.0, 0.004, 0.09])
def test_lateness_does_not_add_up(late):
    found = times(Course(rate=10, duration=2.0), late)
    assert found == pytest.approx([0.1 * number for number in range(20)])


def test_what_was_missed_is_left_out():
    assert times(Course(rate=10, duration=1.0), 0.25) == pytest.approx([0.0, 0.3, 0.6, 0.9])


def test_once_without_a_rate():
    assert times(Course(duration=5.0), 0.1) == [0.0]

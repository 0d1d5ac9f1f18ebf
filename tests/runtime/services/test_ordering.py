"""Which messages are late, by the sequence numbers of their sources."""

import pytest

from jausml.runtime.base.address import JausAddress
from jausml.runtime.transports.delivery import FARTHEST, LATEST, Arrival, Ordering

ONE, OTHER = JausAddress(1, 1, 1), JausAddress(1, 1, 2)


class Line:
    """Messages of some sources, on a clock that the test turns."""

    def __init__(self):
        self.time = 100.0
        self.arrival = Arrival()
        self.ordering = Ordering(self.arrival, lambda: self.time)

    def is_late(self, number, sender=ONE, *, is_sure=False, origin=("127.0.0.1", 3794)):
        self.arrival.number, self.arrival.wants_acknowledgement = number, is_sure
        self.arrival.origin = origin
        return self.ordering.is_late(sender)


@pytest.fixture
def line():
    return Line()


def test_numbers_go_up_and_round(line):
    assert not any(line.is_late(number) for number in (65000, 65001, 65535, 0, 5))
    assert line.is_late(65534)
    assert line.is_late(4)
    assert not line.is_late(6)


def test_sources_count_by_themselves(line):
    assert not line.is_late(100)
    assert not line.is_late(50, OTHER)
    assert not line.is_late(51, OTHER)
    assert line.is_late(99)


def test_what_asks_for_acknowledgement_is_not_late_by_others(line):
    """A stop that got lost is repeated, while its source commands again."""
    assert not line.is_late(100)
    assert not line.is_late(98, is_sure=True)
    assert line.is_late(99)


@pytest.mark.parametrize("stop", [102, 0, 1, 0xFFFF])
def test_what_is_repeated_does_not_undo_a_stop_after_it(line, stop):
    assert not line.is_late(stop, is_sure=True)
    assert line.is_late(stop - 2 & 0xFFFF, is_sure=True)
    assert not line.is_late(stop + 1 & 0xFFFF)
    assert line.is_late(stop - 1 & 0xFFFF, is_sure=True)
    assert not line.is_late(stop + 4 & 0xFFFF)
    assert not line.is_late(stop + 3 & 0xFFFF, is_sure=True)
    assert line.is_late(stop + 2 & 0xFFFF, is_sure=True)


def test_what_is_repeated_is_compared_with_a_repetition_that_was_taken(line):
    assert not line.is_late(105)
    assert not line.is_late(103, is_sure=True)
    assert line.is_late(102, is_sure=True)
    assert not line.is_late(104, is_sure=True)


def test_an_acknowledgement_that_was_wanted_long_ago_is_not_compared(line):
    """After 65,536 messages the numbers are the same again."""
    assert not line.is_late(200, is_sure=True)
    for number in range(201, 0x10000 + 300):
        assert not line.is_late(number & 0xFFFF)
    assert not line.is_late(190, is_sure=True)


def test_a_new_process_is_not_compared_with_what_was_acknowledged_before(line):
    assert not line.is_late(500, is_sure=True)
    assert not line.is_late(100, origin=("127.0.0.1", 40_000))
    assert not line.is_late(99, is_sure=True, origin=("127.0.0.1", 40_000))
    line.time += LATEST
    assert not line.is_late(3, is_sure=True, origin=("127.0.0.1", 40_000))


def test_what_was_sent_before_a_stop_does_not_undo_it(line):
    assert not line.is_late(100)
    assert not line.is_late(103, is_sure=True)
    assert line.is_late(102)
    assert not line.is_late(104)


def test_where_the_transport_keeps_the_order_nothing_is_late(line):
    assert not line.is_late(100)
    assert not line.is_late(None)


def test_a_source_that_begins_anew_is_believed_soon(line):
    """A process of Junior begins at 1 again; dropping its messages must come to an end."""
    assert not line.is_late(500)
    assert line.is_late(1)
    line.time += LATEST
    assert not line.is_late(2)
    assert not line.is_late(3)


def test_who_is_heard_from_elsewhere_is_a_new_process(line):
    """An operator's next command comes at once, and its number may be just below the last one's."""
    assert not line.is_late(500)
    assert not line.is_late(499, origin=("127.0.0.1", 40_000))
    assert line.is_late(498, origin=("127.0.0.1", 40_000))


def test_a_number_far_behind_is_that_of_a_new_process(line):
    assert not line.is_late(30_000)
    assert line.is_late(30_000 - FARTHEST)
    assert not line.is_late(30_000 - FARTHEST - 1)


def test_many_sources_do_not_fill_the_memory(line):
    for number in range(1, 2000):
        assert not line.is_late(number, JausAddress(number, 1, 1))
    assert len(line.ordering._latest) <= 256

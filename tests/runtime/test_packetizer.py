"""Each destination gets consecutive numbers."""

import itertools

import pytest

from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.transports.packets.outgoing import Packetizer

SENDER, OTHER, HERE = JausAddress(2, 1, 1), JausAddress(3, 1, 1), JausAddress(9, 1, 1)


@pytest.fixture
def packetizer() -> Packetizer:
    starts = itertools.count(100, 5000)
    return Packetizer(1000, draw=lambda _limit: next(starts))


def test_what_goes_to_others_leaves_no_gap(packetizer):
    taken = [
        packetizer.reserve(SENDER, address, amount)
        for address, amount in ((HERE, 1), (OTHER, 3), (HERE, 2), (BROADCAST, 1), (HERE, 1))
    ]
    assert taken == [100, 5100, 101, 10_100, 103]
    assert packetizer.sent(SENDER) == {HERE: 4, OTHER: 3}
    assert packetizer.sent(OTHER) == {}


def test_all_wildcards_are_numbered_together(packetizer):
    everybody = (BROADCAST, JausAddress(1, 255, 255), JausAddress(1, 1, 255))
    assert [packetizer.reserve(SENDER, address, 1) for address in everybody] == [100, 101, 102]


def test_strangers_do_not_fill_the_memory(packetizer):
    first = packetizer.numbers(SENDER, HERE)
    for number in range(10_000):
        packetizer.numbers(SENDER, JausAddress(1 + number // 250, 1, 1 + number % 250))
    assert len(packetizer.sent(SENDER)) < 4100
    assert packetizer.numbers(SENDER, HERE) is first


def test_the_next_number_of_a_pair_is_told_and_not_taken():
    packetizer = Packetizer(100, lambda _most: 65535)
    assert packetizer.next_number(SENDER, HERE) == 65535
    assert packetizer.reserve(SENDER, HERE, 1) == 65535
    assert packetizer.next_number(SENDER, HERE) == 0
    assert packetizer.reserve(SENDER, HERE, 1) == 0

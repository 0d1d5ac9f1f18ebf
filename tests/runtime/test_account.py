"""What is said of lost messages, against what was lost."""

import random
from collections.abc import Iterable
from typing import NamedTuple

from hypothesis import given
from hypothesis import strategies as st

from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.transports.packets.duplicates import SPAN, Account, DuplicateWindow
from jausml.runtime.transports.packets.packet import Packet

SENDER, OTHER, HERE = JausAddress(2, 1, 1), JausAddress(3, 1, 1), JausAddress(9, 1, 1)


def packet(number: int, payload: bytes = b"\x02\x40", source: JausAddress = SENDER) -> Packet:
    return Packet(HERE, source, payload, number & 0xFFFF)


def account_of(window: DuplicateWindow, sender: JausAddress = SENDER) -> Account:
    (found,) = [account for source, _, account in window.accounts() if source == sender]
    return found


class Truth(NamedTuple):
    """What a network did.

    Attributes:
        arrivals: Numbers as they arrive, those that come twice twice.
        sent: How many numbers were sent up to the last that came.
        came: How many of them arrived at least once.
    """

    arrivals: list[int]
    sent: int
    came: int


def network(
    rng: random.Random, count: int, first: int, *, drop: float, repeat: float, jitter: int
) -> Truth:
    """Sends `count` packets, each delayed by up to `jitter` places; the first and last arrive."""
    due: list[tuple[float, int]] = []
    came = 0
    for place in range(count):
        is_end = place in (0, count - 1)
        if not is_end and rng.random() < drop:
            continue
        came += 1
        delay = 0 if is_end else rng.randint(0, jitter)
        due.append((place + delay, place))
        if rng.random() < repeat:
            due.append((place + delay + 0.5, place))
    return Truth([first + place for _, place in sorted(due)], count, came)


def play(window: DuplicateWindow, arrivals: Iterable[int], every: int = 100) -> None:
    """Lets numbers arrive, and looks now and then."""
    for index, number in enumerate(arrivals):
        window.is_duplicate(packet(number), index / 1000)
        if index % every == 0:
            list(window.accounts())


@given(
    st.integers(0, 2**32),
    st.integers(2, 3000),
    st.integers(0, 0xFFFF),
    st.sampled_from([0.0, 0.1, 0.3, 0.9]),
    st.sampled_from([0.0, 0.3]),
    st.sampled_from([0, 1, 5, 40]),
    st.sampled_from([1, 100, 10_000]),
)
def test_what_was_lost_repeated_reordered_and_wrapped_adds_up(
    seed, count, first, drop, repeat, jitter, every
):
    truth = network(random.Random(seed), count, first, drop=drop, repeat=repeat, jitter=jitter)
    window = DuplicateWindow(history=64)
    play(window, truth.arrivals, every)
    account = account_of(window)
    assert (account.came, account.lost) == (truth.came, truth.sent - truth.came)
    assert account.restarts == 0
    assert (account.late > 0) <= (jitter > 0)


@given(st.integers(0, 0xFFFF), st.integers(SPAN + 1, 0x10000 - 2 * SPAN), st.integers(0, 2**32))
def test_a_sender_that_begins_anew_is_counted_on(first, jump, seed):
    rng = random.Random(seed)
    fates = {"drop": 0.2, "repeat": 0.1, "jitter": 0}
    before = network(rng, 300, first, **fates)
    after = network(rng, 300, first + 300 + jump, **fates)
    window = DuplicateWindow(history=64)
    play(window, [*before.arrivals, *after.arrivals])
    account = account_of(window)
    assert account.restarts == 1
    assert (account.came, account.came + account.lost) == (before.came + after.came, 600)


def test_a_sender_whose_numbers_always_begin_at_one():
    """As those of each process of Junior do."""
    window = DuplicateWindow()
    for life in range(3):
        for number in range(1, 201):
            text = f"\x02\x40{life}".encode()
            assert not window.is_duplicate(packet(number, text), float(life))
    account = account_of(window)
    assert (account.came, account.lost, account.restarts) == (600, 0, 2)


def test_what_is_repeated_for_long_is_no_new_life():
    """As by a sender that hears no acknowledgement."""
    window = DuplicateWindow(seconds=1.5)
    for number in range(100):
        window.is_duplicate(packet(number), 0.0)
    for number in range(90, 96):
        assert not window.is_duplicate(packet(number), 2.0)
    window.is_duplicate(packet(100), 2.0)
    account = account_of(window)
    assert (account.came, account.lost, account.repeated, account.restarts) == (101, 0, 6, 0)


def test_what_comes_again_soon_is_counted():
    window = DuplicateWindow(seconds=1.5)
    for number in range(100):
        assert not window.is_duplicate(packet(number), 0.0)
    for number in (95, 96, 96):
        assert window.is_duplicate(packet(number), 1.0)
    account = account_of(window)
    assert (account.came, account.duplicates, account.repeated) == (100, 3, 0)


def test_few_that_come_again_after_they_were_forgotten_are_no_new_life():
    window = DuplicateWindow(history=10)
    for number in range(100):
        window.is_duplicate(packet(number), 0.0)
    for number in (50, 51):
        assert not window.is_duplicate(packet(number), 2.0)
    window.is_duplicate(packet(100), 2.0)
    account = account_of(window)
    assert (account.came, account.lost, account.repeated, account.restarts) == (101, 0, 2, 0)


def test_a_late_one_is_lost_no_more():
    window = DuplicateWindow()
    for number in (0, 2, 3):
        window.is_duplicate(packet(number), 0.0)
    assert account_of(window).lost == 1
    window.is_duplicate(packet(1), 0.0)
    account = account_of(window)
    assert (account.came, account.lost, account.late) == (4, 0, 1)


def test_a_flood_between_two_looks_is_counted():
    """The memory is smaller than what comes between two looks."""
    window = DuplicateWindow()
    play(window, (number for number in range(20_001) if number % 10 == 0), every=10**9)
    account = account_of(window)
    assert (account.came, account.lost) == (2001, 18_000)


def test_a_sender_that_is_forgotten_begins_anew():
    window = DuplicateWindow(sources=1)
    window.is_duplicate(packet(1), 0.0)
    window.is_duplicate(packet(1, source=OTHER), 0.0)
    window.is_duplicate(packet(9), 0.0)
    assert [(source, account.came) for source, _, account in window.accounts()] == [(SENDER, 1)]


def test_a_packet_to_everybody_is_no_gap():
    window = DuplicateWindow()
    for number in range(3):
        window.is_duplicate(packet(number), 0.0)
        window.is_duplicate(Packet(BROADCAST, SENDER, b"\x02\x40", number + 50), 0.0)
    account = account_of(window)
    assert (account.came, account.lost) == (3, 0)


def hear(window: DuplicateWindow, number: int, now: float, destination: JausAddress = HERE) -> None:
    payload = f"\x02\x40{now}".encode()
    window.is_duplicate(Packet(destination, SENDER, payload, number & 0xFFFF), now)


def test_what_was_lost_is_an_upper_bound_until_a_packet_to_everybody_came():
    window = DuplicateWindow()
    for number in range(10):
        hear(window, number, number / 10)
    assert not account_of(window).is_exact
    hear(window, 30_000, 1.0, BROADCAST)
    assert account_of(window).is_exact


def test_the_numbers_of_packets_to_everybody_may_be_the_smaller_ones():
    window = DuplicateWindow()
    hear(window, 30_000, 0.0)
    hear(window, 5, 0.1, BROADCAST)
    assert account_of(window).is_exact


@given(st.integers(0, 0xFFFF), st.integers(1, SPAN // 4), st.integers(0, 2**32))
def test_a_sender_with_one_count_for_all_is_never_taken_for_exact(first, stride, seed):
    """Between any two of its packets to us it sends up to so many to others."""
    rng, window, number = random.Random(seed), DuplicateWindow(), first
    for place in range(60):
        number += rng.randint(1, stride)
        hear(window, number, place * 0.5, BROADCAST if rng.random() < 0.2 else HERE)
        assert not any(account.is_exact for _, _, account in window.accounts())


def test_packets_that_are_far_apart_in_time_tell_nothing():
    window = DuplicateWindow()
    hear(window, 30_000, 0.0, BROADCAST)
    hear(window, 1, 60.0)
    assert not account_of(window).is_exact


def test_a_new_life_may_number_otherwise():
    window = DuplicateWindow()
    hear(window, 30_000, 0.0, BROADCAST)
    hear(window, 1, 0.1)
    assert account_of(window).is_exact
    for number in range(20_000, 20_010):
        hear(window, number, 60.0)
    account = account_of(window)
    assert (account.restarts, account.is_exact) == (1, False)

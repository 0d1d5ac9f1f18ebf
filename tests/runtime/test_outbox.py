"""What is under way to a destination, and in which order, with a clock that the test moves."""

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.quirks import Quirk, Quirks
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.transports.delivery import Carrier
from jausml.runtime.transports.packets.messenger import Bursts, Messenger
from jausml.runtime.transports.packets.packet import AckNak, DataFlags, Packet, Priority

from .conftest import FakeClock

OWN = JausAddress(100, 1, 1)
NEIGHBOUR = JausAddress(100, 1, 2)
PEER = JausAddress(300, 1, 1)
OTHER = JausAddress(300, 1, 2)
STATUS = b"\x02\x40"
PACKET = 100


class Recording(Carrier[str]):
    """Keeps what was put on the network."""

    def __init__(self) -> None:
        self.packets: list[Packet] = []

    def transmit(self, packet: Packet) -> bool:
        self.packets.append(packet)
        return True

    def answer(self, packet: Packet, origin: str) -> None:
        raise AssertionError((packet, origin))


class Line:
    """A messenger, what it put on the network, and the results that it reported."""

    def __init__(self, clock, draw=None) -> None:
        self.clock = clock
        self.loop = Loop(clock, Counters(clock))
        self.carrier = Recording()
        settings = TransportSettings(fragment_size=PACKET)
        self.quirks = Quirks()
        self.messenger = Messenger(settings, self.loop, self.carrier, self.quirks, draw)
        self.results: dict[str, bool] = {}

    def send(
        self,
        name,
        packets=1,
        *,
        code=STATUS,
        own=OWN,
        to=PEER,
        acknowledge=True,
        priority=Priority.STANDARD,
        supersedes=False,
    ):
        payload = (code + name.encode()).ljust(PACKET * (packets - 1) + 50, b".")
        self.messenger.send(
            own,
            to,
            payload,
            priority,
            acknowledge,
            lambda ok: self.results.update({name: ok}),
            supersedes,
        )

    def out(self) -> str:
        """The first letters of what was put on the network since the last time."""
        taken, self.carrier.packets = self.carrier.packets, []
        return "".join(
            "-" if packet.data_flags >= DataFlags.MIDDLE else chr(packet.payload[2])
            for packet in taken
        )

    def acknowledge(self, *packets: Packet) -> None:
        for packet in packets:
            self.messenger.outbox.acknowledged(packet.source, packet.sequence, packet.destination)
        self.pass_time(0)

    def close(self) -> None:
        self.messenger.close()
        self.loop.stop()

    def pass_time(self, seconds: float) -> None:
        self.clock.time += seconds
        while self.loop.run_once(0):
            pass


@pytest.fixture
def line(clock):
    """A messenger without a network."""
    made = Line(clock)
    yield made
    made.close()


def test_large_messages_to_one_destination_go_one_after_the_other(line):
    for name in "abc":
        line.send(name, packets=3, own=OWN if name == "a" else NEIGHBOUR)
    sent = []
    while line.carrier.packets:
        (packet,) = line.carrier.packets
        sent.append(line.out())
        line.acknowledge(packet)
    assert "".join(sent) == "a--b--c--"
    assert line.results == {"a": True, "b": True, "c": True}


def test_messages_of_one_packet_and_to_others_do_not_wait(line):
    for name in "ab":
        line.send(name, packets=3)
    line.send("c")
    line.send("d", packets=3, to=OTHER)
    assert line.out() == "acd"


def test_few_messages_are_under_way_at_once_unless_they_are_urgent(line):
    for _ in range(40):
        line.send("a")
    line.send("s", priority=Priority.SAFETY_CRITICAL)
    first = list(line.carrier.packets)
    assert line.out() == "a" * 32 + "s"
    line.acknowledge(*first[:3])
    assert line.out() == "a" * 2  # the urgent one had taken a place
    line.acknowledge(*first[3:])
    assert line.out() == "a" * 6


def test_equal_numbers_to_several_destinations_are_acknowledged_apart(clock):
    """Each destination is numbered by itself."""
    line = Line(clock, draw=lambda _limit: 7)
    everybody = JausAddress(300, 255, 255)
    for name, to in (("a", PEER), ("b", OTHER), ("c", everybody)):
        line.send(name, to=to)
    assert {packet.sequence for packet in line.carrier.packets} == {7}
    at_peer, at_other, at_all = line.carrier.packets
    line.acknowledge(at_other)
    assert line.results == {"b": True}
    line.acknowledge(at_peer)
    line.messenger.outbox.acknowledged(OWN, at_all.sequence, JausAddress(300, 1, 3))
    line.pass_time(0)
    assert line.results == {"a": True, "b": True, "c": True}
    line.close()


def test_a_message_of_few_packets_needs_no_acknowledgement(line):
    line.send("a", packets=10, acknowledge=False)
    assert {packet.acknowledge for packet in line.carrier.packets} == {AckNak.NONE}
    assert line.out() == "a" + "-" * 9
    line.pass_time(0)
    assert line.results == {"a": True}


def test_a_message_of_many_packets_is_acknowledged_and_eight_are_under_way(line):
    line.send("a", packets=12, acknowledge=False)
    first = list(line.carrier.packets)
    assert line.out() == "a" + "-" * 7
    assert {packet.acknowledge for packet in first} == {AckNak.REQUESTED}
    line.acknowledge(*first)
    rest = list(line.carrier.packets)
    assert line.out() == "-" * 4
    line.acknowledge(*rest)
    assert line.results == {"a": True}


def at_once(line, *, loses=False) -> int:
    """Sends a message of 40 packets, and returns how many of them went before an answer."""
    line.send("a", packets=40, acknowledge=False)
    sent = first = list(line.carrier.packets)
    if loses:
        line.pass_time(0.11)
    while sent:
        line.carrier.packets = []
        line.acknowledge(*sent)
        sent = list(line.carrier.packets)
    assert line.results.pop("a")
    return len(first)


def test_who_loses_nothing_of_large_messages_gets_more_packets_at_once(line):
    assert [at_once(line) for _ in range(5)] == [8, 16, 32, 40, 40]
    line.send("b", packets=40, to=OTHER, acknowledge=False)
    assert len(line.carrier.packets) == 8  # each destination is learnt apart


def test_after_a_loss_as_many_packets_go_at_once_as_arrived_before(line):
    assert [at_once(line) for _ in range(2)] == [8, 16]
    assert at_once(line, loses=True) == 32
    assert [at_once(line) for _ in range(3)] == [16, 16, 16]
    assert at_once(line, loses=True) == 16
    assert [at_once(line, loses=True) for _ in range(2)] == [8, 8]


def test_messages_of_few_packets_wait_for_a_larger_one_and_for_each_other(line):
    line.send("a", packets=12, acknowledge=False)
    line.send("b", packets=2, acknowledge=False)
    line.send("c", acknowledge=False)
    assert line.out() == "a" + "-" * 7 + "c"


def test_packets_of_several_messages_in_a_row_are_counted_together(line, clock):
    line.send("a", packets=6, acknowledge=False)
    line.send("b", packets=6, acknowledge=False)
    kinds = [packet.acknowledge for packet in line.carrier.packets]
    assert kinds == [AckNak.NONE] * 6 + [AckNak.REQUESTED] * 6
    bursts = Bursts()
    assert bursts.fits(PEER, 6, clock.time)
    assert not bursts.fits(PEER, 6, clock.time)
    assert bursts.fits(OTHER, 6, clock.time)
    assert bursts.fits(PEER, 6, clock.time + 0.001)


def test_what_waits_for_a_silent_destination_is_given_up_with_it(line):
    line.send("a", packets=3)
    line.send("b", packets=3)
    line.send("o", to=OTHER)
    for _ in range(3):
        line.pass_time(0.11)
    assert line.results == {}
    line.pass_time(0.11)
    assert line.results == {"a": False, "b": False, "o": False}
    assert line.out() == "ao" * 4
    assert not line.messenger.outbox


def test_what_waits_for_a_destination_that_is_heard_gets_its_turn(line):
    line.send("a", packets=3)
    line.send("b", packets=3)
    for _ in range(3):
        line.pass_time(0.11)
    line.send("c")
    line.acknowledge(line.carrier.packets[-1])
    line.pass_time(0.11)
    assert line.results == {"c": True}
    for _ in range(9):
        line.pass_time(0.11)
    assert line.results == {"c": True, "a": False}
    assert line.out() == "aaaac" + "a" * 9 + "b"


def test_what_nobody_insists_on_does_not_grow_old_while_it_waits(line):
    """The receiver of a stream is better served with the next message than with an old one."""
    line.send("a", packets=12)
    for name in "bcd":
        line.send(name, packets=12, acknowledge=name == "c")
    line.pass_time(0)
    for _ in range(12):
        line.pass_time(0.09)
        line.acknowledge(line.carrier.packets[-1])
    line.send("e", packets=12, acknowledge=False)
    assert line.out() == "a" + "-" * 11 + "c"
    assert line.results == {"a": True, "b": False}
    assert line.loop.counters.drops() == {"transport.too_late": 1}


def test_too_much_is_refused_but_a_message_alone_is_not(line):
    line.send("a", packets=180_000)
    line.send("b", packets=2)
    line.send("c", packets=2, acknowledge=False)
    line.pass_time(0)
    assert line.results == {"b": False, "c": False}
    assert line.loop.counters.drops() == {"transport.too_many_unacknowledged": 2}


def test_messages_of_too_many_small_packets_go_in_larger_ones(line):
    """Junior holds 50 packets of an unfinished message."""
    for size, packets, largest in [(4000, 40, 100), (8000, 40, 200), (163_160, 40, 4079)]:
        made = line.messenger.packetizer.packets(
            OWN, PEER, bytes(size), Priority.STANDARD, AckNak.NONE
        )
        assert (len(made), max(len(packet.payload) for packet in made)) == (packets, largest)


STEPS = st.lists(
    st.one_of(
        st.tuples(
            st.just("send"),
            st.sampled_from([PEER, OTHER]),
            st.sampled_from([1, 1, 2, 3, 12]),
            st.booleans(),
            st.sampled_from([Priority.STANDARD, Priority.SAFETY_CRITICAL]),
        ),
        st.tuples(st.just("acknowledge"), st.integers(0, 60)),
        st.tuples(st.just("wait"), st.sampled_from([0.0, 0.05, 0.11])),
    ),
    max_size=120,
)


@given(STEPS)
def test_each_result_comes_once_and_large_messages_never_mix(steps):
    line = Line(FakeClock())
    results: list[int] = []
    sent: list[Packet] = []
    for number, step in enumerate(steps):
        if step[0] == "send":
            _, to, packets, acknowledge, priority = step
            line.messenger.send(
                OWN,
                to,
                STATUS + bytes([number]) * (PACKET * packets - 2),
                priority,
                acknowledge,
                lambda _, number=number: results.append(number),
            )
        elif step[0] == "wait":
            line.pass_time(step[1])
        sent += line.carrier.packets
        line.carrier.packets = []
        if step[0] == "acknowledge" and sent:
            line.acknowledge(sent[-1 - step[1] % len(sent)])
            sent += line.carrier.packets
            line.carrier.packets = []
    for _ in range(400):
        line.pass_time(0.11)
        sent += line.carrier.packets
        line.carrier.packets = []
    wanted = [number for number, step in enumerate(steps) if step[0] == "send"]
    assert sorted(results) == wanted
    assert (len(line.messenger.outbox), line.messenger.outbox._size) == (0, 0)
    for to in (PEER, OTHER):
        order = [
            packet.payload[-1]
            for packet in sent
            if packet.destination == to and packet.data_flags and packet.acknowledge
        ]
        assert order == sorted(order)
    line.close()


def lossy(line, seed, count=10):
    """Sends messages of five packets on a line that loses one frame in five, each way.

    A packet of 4 kB is three frames on the way there, its acknowledgement one on the way back.
    """
    chance = random.Random(seed)
    names = [chr(ord("a") + number) for number in range(count)]
    for name in names:
        line.send(name, packets=5)
        for _ in range(5):
            carry(line, chance)
    for _ in range(3000):
        carry(line, chance)
    assert set(line.results) == set(names)
    return sum(line.results.values())


def carry(line, chance):
    packets, line.carrier.packets = line.carrier.packets, []
    line.pass_time(0.01)
    for packet in packets:
        if all(chance.random() > 0.2 for _ in range(4)):
            line.acknowledge(packet)


def test_one_lost_message_does_not_take_those_behind_it_along(clock):
    arrived = []
    for seed in range(20):
        line = Line(clock)
        arrived.append(lossy(line, seed))
        line.close()
    assert sum(arrived) / len(arrived) >= 8.5


COMMAND = b"\x0a\x00"


def test_a_stop_withdraws_what_was_commanded_before_and_goes_in_front(line):
    for name in "ab" * 20:
        line.send(name, code=COMMAND)
    for name in "cd" * 20:
        line.send(name)
    assert line.out() == "ab" * 16
    line.send("s", code=COMMAND, supersedes=True)
    line.pass_time(0)
    assert line.results == {"a": False, "b": False}
    assert sorted(line.out()) == sorted("cd" * 16 + "s")
    (stop,) = (
        flight
        for flight in line.messenger.outbox._flights.values()
        if flight.packet.payload.startswith(COMMAND)
    )
    line.acknowledge(stop.packet)
    assert line.results.pop("s")
    for _ in range(100):
        line.pass_time(0.05)
    assert set(line.out()) == {"c", "d"}
    assert len(line.messenger.outbox) == 0


def test_a_stop_waits_for_no_place_that_others_have(line):
    for _ in range(40):
        line.send("a")
    line.out()
    line.send("s", code=COMMAND, supersedes=True)
    assert line.out() == "s"


@pytest.mark.parametrize("packets", [1, 3])
def test_what_is_withdrawn_is_neither_sent_nor_repeated(line, packets):
    for name in ("a", "b"):
        line.send(name, packets=packets)
    line.send("n", own=NEIGHBOUR)
    line.send("o", to=OTHER)
    line.out()
    line.messenger.outbox.withdraw(OWN, PEER, STATUS + b"a")
    line.messenger.outbox.withdraw(OWN, PEER, STATUS + b"x")
    line.messenger.outbox.withdraw(OWN, JausAddress(9, 9, 9), STATUS)
    line.pass_time(0)
    assert line.results == {"a": False}
    line.pass_time(0.11)
    assert set(line.out()) == {"b", "n", "o"}
    line.messenger.outbox.withdraw(OWN, PEER, STATUS)
    line.pass_time(0.11)
    assert line.results == {"a": False, "b": False}
    assert set(line.out()) == {"n", "o"}


def test_what_is_withdrawn_has_no_part_in_what_is_known_of_a_peer(line):
    for name in "abcd":
        line.send(name)
        answer(line, name)
        line.messenger.outbox.withdraw(OWN, PEER, STATUS)
        line.pass_time(1.0)
    assert line.quirks.of(PEER) == ()


def answer(line, name=""):
    line.messenger.outbox.answered(OWN, PEER, STATUS + name.encode())


def test_what_is_answered_is_not_repeated(line):
    line.send("a")
    line.send("b")
    line.send("c", to=OTHER)
    answer(line, "a")
    assert line.results == {}  # the acknowledgement may be on its way
    line.pass_time(0.11)
    assert line.results == {"a": True}
    assert line.out() == "abcbc"


def test_an_acknowledgement_that_comes_behind_the_answer_counts_as_ever(line):
    line.send("a")
    (packet,) = line.carrier.packets
    answer(line)
    line.acknowledge(packet)
    assert line.results == {"a": True}
    line.pass_time(0.11)
    assert line.quirks.of(PEER) == ()
    (traffic,) = traffic_to(line, PEER)
    assert (traffic.outcome.acknowledged, traffic.outcome.answered) == (1, 0)


def test_an_answer_ends_no_large_message_and_nothing_of_others(line):
    line.send("a", packets=2)
    line.send("b", own=NEIGHBOUR)
    answer(line)
    line.pass_time(0.11)
    assert line.results == {}
    assert line.out() == "abab"


@pytest.mark.parametrize("acknowledged", [False, True])
def test_who_answers_and_never_acknowledges_is_known_for_it(line, acknowledged):
    line.send("a")
    if acknowledged:
        line.acknowledge(*line.carrier.packets)
    else:
        answer(line)
    names = "bcd" if acknowledged else "bc"
    for name in names:
        line.pass_time(0.11)
        assert not line.quirks.has(PEER, Quirk.NO_ACKNOWLEDGEMENTS)
        line.send(name)
        answer(line)
    line.pass_time(0.11)
    assert line.results == dict.fromkeys(f"a{names}", True)
    assert line.quirks.has(PEER, Quirk.NO_ACKNOWLEDGEMENTS) is not acknowledged


def traffic_to(line, peer):
    if OWN not in line.messenger.inbox.receivers:
        line.messenger.inbox.attach(OWN, lambda *_: None)
    return [account for account in line.messenger.traffic() if account.peer == peer]


def test_who_begins_its_numbers_anew_more_than_once_is_known_for_it(line):
    traffic_to(line, PEER)
    for life in range(4):
        for number in range(1, 11):
            packet = Packet(OWN, PEER, STATUS + bytes([life, number]), number)
            line.messenger.inbox.take(packet, "here", line.clock.time)
            line.pass_time(0.1)
        (traffic,) = [account for account in line.messenger.traffic() if account.peer == PEER]
        assert (traffic.account.came, traffic.account.restarts) == (10 * (life + 1), life)
        assert line.quirks.has(PEER, Quirk.NUMBERS_ANEW) is (life > 1)

"""Messages of several packets, and those of Junior whose flags are all set."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.transports.packets.inbox import FlaglessMessages
from jausml.runtime.transports.packets.packet import AckNak, Broadcast, DataFlags, Packet, Priority
from jausml.runtime.transports.packets.reassembly import Reassembly

ROBOT = JausAddress(100, 1, 1)
OCU = JausAddress(200, 1, 1)


def fragments(
    count: int, first: int, fill: int = 0, source: JausAddress = OCU, size: int = 3
) -> list[Packet]:
    flags = [DataFlags.FIRST, *[DataFlags.MIDDLE] * (count - 2), DataFlags.LAST]
    return [
        Packet(
            ROBOT,
            source,
            bytes([fill, index & 0xFF, *([0] * (size - 2))]),
            first + index & 0xFFFF,
            Priority.HIGH,
            data_flags=flag,
        )
        for index, flag in enumerate(flags)
    ]


def whole(packets: list[Packet]) -> Packet:
    payload = b"".join(packet.payload for packet in packets)
    return packets[0]._replace(payload=payload, data_flags=DataFlags.SINGLE)


@pytest.fixture
def counters() -> Counters:
    return Counters()


@pytest.fixture
def reassembly(counters: Counters) -> Reassembly:
    return Reassembly(3.0, 1 << 16, counters)


@given(
    st.lists(st.tuples(st.integers(2, 6), st.sampled_from([OCU, ROBOT])), min_size=1, max_size=4),
    st.integers(0, 65535),
    st.data(),
)
def test_messages_are_whole_in_whatever_order_their_fragments_come(shapes, start, data):
    reassembly = Reassembly(3.0, 1 << 16, Counters())
    streams = []
    for fill, (count, source) in enumerate(shapes):
        streams.append(fragments(count, start, fill, source))
        start += count
    arrivals = data.draw(st.permutations([packet for stream in streams for packet in stream]))
    results = [reassembly.add(packet, 0.0) for packet in arrivals]
    completed = [result for result in results if result is not None]
    assert sorted(completed) == sorted(whole(stream) for stream in streams)
    assert reassembly.size == 0


def test_neighbouring_messages_are_not_joined(reassembly):
    one, two = fragments(3, 10, fill=1), fragments(3, 13, fill=2)
    for packet in (one[0], one[2], two[0], two[2], two[1]):
        result = reassembly.add(packet, 0.0)
    assert result == whole(two)
    assert reassembly.add(one[1], 0.0) == whole(one)


def test_a_stray_fragment_after_the_last_one_is_no_part_of_the_message(reassembly):
    first, last = fragments(2, 9)
    stray = last._replace(sequence=11, data_flags=DataFlags.MIDDLE)
    assert [reassembly.add(packet, 0.0) for packet in (last, stray, first)] == [
        None,
        None,
        whole([first, last]),
    ]


def test_an_active_source_outlasts_the_others(counters):
    reassembly = Reassembly(3.0, 1 << 16, counters)
    stream = fragments(50, 0)
    for subsystem, packet in enumerate(stream[:-1], start=1):
        reassembly.add(packet, 0.0)
        for component in range(1, 20):
            source = JausAddress(subsystem, 2, component)
            reassembly.add(fragments(2, 0, source=source, size=4000)[0], 0.0)
    assert counters.snapshot()["transport.reassembly_overflow"] > 100
    assert reassembly.add(stream[-1], 0.0) == whole(stream)


def test_a_repeated_fragment_changes_nothing(reassembly):
    stream = fragments(3, 10)
    for packet in (stream[0], stream[0], stream[1], stream[1]):
        assert reassembly.add(packet, 0.0) is None
    assert reassembly.add(stream[2], 0.0) == whole(stream)


@pytest.mark.parametrize("left", [range(9), range(1, 9), range(4, 9)])
def test_fragments_of_a_source_that_restarted_are_no_part_of_its_next_message(
    reassembly, counters, left
):
    """Its numbers begin anew; what its former self left behind may lack its first packets."""
    before, after, later = (fragments(10, 1 + n // 2 * 10, fill=n) for n in range(3))
    for index in left:
        assert reassembly.add(before[index], 0.0) is None
    results = [reassembly.add(packet, 0.1) for packet in after]
    if left.start == 0:
        assert results[-1] == whole(after)
    else:
        assert set(results) == {None}
    assert counters.snapshot()["transport.reassembly_stale"] == 1
    assert [reassembly.add(packet, 0.2) for packet in later][-1] == whole(later)
    reassembly.expire(9.0)
    assert (reassembly.size, len(reassembly)) == (0, 0)


def test_fragments_without_progress_are_discarded(reassembly, counters):
    lost, slow = fragments(3, 10), fragments(3, 50)
    reassembly.add(lost[0], 0.0)
    reassembly.add(slow[0], 0.0)
    reassembly.add(slow[1], 2.0)
    reassembly.expire(3.0)
    assert counters.drops() == {"transport.reassembly_timeout": 1}
    assert reassembly.add(slow[2], 3.0) == whole(slow)
    assert reassembly.add(lost[1], 3.0) is None
    assert reassembly.add(lost[2], 3.0) is None
    reassembly.expire(6.0)
    assert reassembly.size == 0


def test_one_source_cannot_take_all_memory(reassembly, counters):
    other = fragments(2, 0, source=ROBOT)
    reassembly.add(other[0], 0.0)
    for packet in fragments(40, 0, size=4000)[:-1]:
        reassembly.add(packet, 0.0)
        assert reassembly.size < (1 << 16) + 5000
    assert counters.snapshot()["transport.reassembly_overflow"] >= 1
    assert reassembly.add(other[1], 0.0) == whole(other)


def test_many_sources_cannot_take_all_memory(counters):
    reassembly = Reassembly(3.0, 1 << 16, counters)
    for subsystem in range(1, 2000):
        source = JausAddress(subsystem, 1, 1)
        reassembly.add(fragments(2, 0, source=source, size=4000)[0], 0.0)
        assert reassembly.size <= 4 << 16
        assert len(reassembly._held) <= 256
    assert counters.snapshot()["transport.reassembly_overflow"] > 1900


@given(
    st.lists(
        st.builds(
            Packet,
            st.just(ROBOT),
            st.sampled_from([OCU, ROBOT]),
            st.binary(max_size=4),
            st.integers(0, 12).map(lambda number: number - 6 & 0xFFFF),
            data_flags=st.sampled_from([DataFlags.FIRST, DataFlags.MIDDLE, DataFlags.LAST]),
        ),
        max_size=60,
    )
)
def test_contradicting_fragments_never_raise_and_leave_nothing_behind(packets):
    reassembly = Reassembly(3.0, 4096, Counters())
    for index, packet in enumerate(packets):
        reassembly.add(packet, index * 0.2)
        if index % 5 == 0:
            reassembly.expire(index * 0.2)
    reassembly.expire(1000.0)
    assert reassembly.size == 0
    assert not reassembly._held


@pytest.mark.parametrize("begin", [DataFlags.FIRST, DataFlags.MIDDLE])
def test_a_full_circle_of_numbers_does_not_close(counters, begin):
    reassembly = Reassembly(3.0, 1 << 30, counters)
    for number in range(65536):
        flags = DataFlags.MIDDLE if number else begin
        packet = Packet(ROBOT, OCU, b"", number, data_flags=flags)
        assert reassembly.add(packet, 0.0) is None
    assert counters.snapshot()["transport.reassembly_overflow"] == 1
    reassembly.expire(9.0)
    assert reassembly.size == 0


PEER = JausAddress(200, 1, 1)
OTHER = JausAddress(201, 1, 1)
CHUNK = 4079


def flagless(size: int = 7, source: JausAddress = PEER, **fields) -> Packet:
    flags = {
        "priority": Priority.SAFETY_CRITICAL,
        "broadcast": Broadcast.RESERVED,
        "acknowledge": AckNak.ACK,
        "data_flags": DataFlags.LAST,
    }
    return Packet(JausAddress(100, 1, 1), source, bytes(size), 5, **{**flags, **fields})


def test_a_short_one_is_a_message_of_low_priority():
    message = FlaglessMessages(3.0).whole(flagless(), 0.0)
    assert message == Packet(JausAddress(100, 1, 1), PEER, bytes(7), 5, Priority.LOW)


def test_the_longest_that_is_whole():
    messages = FlaglessMessages(3.0)
    assert messages.whole(flagless(CHUNK - 1), 0.0) is not None
    assert messages.whole(flagless(CHUNK), 0.0) is None


def test_other_flags_are_of_an_acknowledgement():
    messages = FlaglessMessages(3.0)
    for fields in (
        {"priority": Priority.HIGH},
        {"broadcast": Broadcast.GLOBAL},
        {"data_flags": DataFlags.SINGLE},
    ):
        assert messages.whole(flagless(**fields), 0.0) is None


def test_a_full_one_casts_doubt_on_its_source_for_a_while():
    messages = FlaglessMessages(3.0)
    messages.whole(flagless(CHUNK), 10.0)
    assert messages.whole(flagless(), 10.1) is None
    assert messages.whole(flagless(source=OTHER), 10.1) is not None
    assert messages.whole(flagless(), 12.9) is None
    assert messages.whole(flagless(), 13.0) is not None


def test_a_flood_of_sources_is_forgotten_but_for_the_latest():
    messages = FlaglessMessages(3.0)
    sources = [JausAddress(number, 1, 1) for number in range(1, 301)]
    for source in sources:
        messages.whole(flagless(CHUNK, source), 0.0)
    doubted = [
        address for address in sources if messages.whole(flagless(source=address), 1.0) is None
    ]
    assert doubted == sources[-256:]

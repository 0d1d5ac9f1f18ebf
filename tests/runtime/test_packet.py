"""Packets as they stand in datagrams, and their numbers, which count for each destination."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st
from wire_vectors import golden_vectors

from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.transports.packets.outgoing import Packetizer
from jausml.runtime.transports.packets.packet import (
    MAX_PAYLOAD,
    AckNak,
    Broadcast,
    DataFlags,
    Packet,
    Priority,
    parse_datagram,
)

ROBOT = JausAddress(100, 1, 2)
OCU = JausAddress(200, 1, 2)
ADDRESSES = st.builds(JausAddress, st.integers(0, 65535), st.integers(0, 255), st.integers(0, 255))
PACKETS = st.builds(
    Packet,
    ADDRESSES,
    ADDRESSES,
    st.binary(max_size=64),
    st.integers(0, 0xFFFF),
    st.sampled_from(Priority),
    st.sampled_from(Broadcast),
    st.sampled_from(AckNak),
    st.sampled_from(DataFlags),
    st.just(0),
)


def message(sequence: int = 7, payload: bytes = b"\x02\x40hi") -> Packet:
    return Packet(ROBOT, OCU, payload, sequence)


def parse(data: bytes) -> tuple[list[Packet], dict[str, int]]:
    counters = Counters()
    return parse_datagram(data, counters), counters.snapshot()


@pytest.mark.beside("golden/judp_datagrams.jsonl")
def test_captured_datagrams_read_as_stated_and_encode_to_the_same_bytes():
    lines = golden_vectors("judp_datagrams.jsonl")
    assert len(lines) > 50
    for line in lines:
        data, header = bytes.fromhex(line["hex"]), line["header"]
        packets, counts = parse(data)
        if data[0] != 2:
            assert (packets, counts) == ([], {"judp.version_1": 1})
            continue
        (packet,) = packets
        assert counts == {}
        assert packet == Packet(
            JausAddress(**header["destination"]),
            JausAddress(**header["source"]),
            bytes.fromhex(header["payload"]),
            header["sequence"],
            Priority(header["priority"]),
            Broadcast(header["broadcast"]),
            AckNak(header["ack_nak"]),
            DataFlags(header["data_flags"]),
            header["message_type"],
        )
        assert packet.encode() == data


@given(st.lists(PACKETS, min_size=1, max_size=5))
def test_every_message_of_a_datagram_is_read(packets):
    data = b"\x02" + b"".join(packet.encode()[1:] for packet in packets)
    assert parse(data) == (packets, {})


@pytest.mark.parametrize(
    ("data", "counter"),
    [
        (b"", "judp.truncated"),
        (b"\x02", "judp.truncated"),
        (b"\x03" + message().encode()[1:], "judp.bad_version"),
        (b"\x01" + message().encode()[1:], "judp.version_1"),
        (b"JAUS01.0" + bytes(16), "judp.reference_architecture"),
        (b"JAUS", "judp.bad_version"),
        (message().encode()[:-1], "judp.truncated"),
        (message().encode()[:14], "judp.truncated"),
        (message().encode()[:5], "judp.truncated"),
        (b"\x02\x00\x0d\x00" + message().encode()[4:], "transport.bad_size"),
        (b"\x02\x00\x00\x00" + message().encode()[4:], "transport.bad_size"),
        (message()._replace(message_type=1).encode(), "transport.bad_message_type"),
        (message()._replace(message_type=32).encode(), "transport.bad_message_type"),
        (b"\x02\xc0" + message().encode()[2:], "transport.compressed"),
        (b"\x02\x40\x0e\x00" + bytes(11), "transport.bad_size"),
    ],
)
def test_an_unreadable_datagram_is_dropped_and_counted(data, counter):
    assert parse(data) == ([], {counter: 1})


@pytest.mark.parametrize("tail", [b"\x00", b"garbage", bytes(40), message(8).encode()])
def test_bytes_after_a_good_message_are_ignored(tail):
    assert parse(message().encode() + tail) == ([message()], {"judp.trailing_bytes": 1})


def test_a_reserved_message_type_does_not_hide_the_next_message():
    reserved = message()._replace(message_type=5)
    data = reserved.encode() + message(8).encode()[1:]
    assert parse(data) == ([message(8)], {"transport.bad_message_type": 1})


def with_compression(kind: int, *, fields: bytes) -> bytes:
    plain = message().encode()
    size = (len(plain) - 1 + len(fields)).to_bytes(2, "little")
    return b"\x02" + bytes([kind]) + size + fields + plain[4:]


@pytest.mark.parametrize(
    ("kind", "fields", "count"),
    [
        pytest.param(0x40, b"\x01\x0c", {}, id="as the standard has it"),
        pytest.param(0x80, b"\x00\x00", {}, id="confirmed"),
        pytest.param(0x40, b"", {}, id="flags without their bytes, which Junior ignores"),
        pytest.param(0x01, b"\x01\x00", {}, id="Junior's place of the flags"),
        pytest.param(0x02, b"\x01\x00", {}, id="Junior's place of the flags, confirmed"),
        pytest.param(
            0x03, b"\x01\x00", {"transport.bad_message_type": 1}, id="compressed or type 3"
        ),
        pytest.param(0x01, b"", {"transport.bad_message_type": 1}, id="reserved type"),
        pytest.param(0x41, b"\x01\x0c", {"transport.bad_message_type": 1}, id="both"),
        pytest.param(0xC0, b"\x01\x0c", {"transport.compressed": 1}, id="compressed"),
    ],
)
def test_header_compression_is_read_where_there_is_no_doubt(kind, fields, count):
    expected = [] if count else [message()]
    assert parse(with_compression(kind, fields=fields)) == (expected, count)


def test_an_older_protocol_is_named_in_the_log(caplog):
    counters = Counters()
    for _ in range(100):
        parse_datagram(b"\x01" + bytes(30), counters)
        parse_datagram(b"JAUS01.0" + bytes(16), counters)
    assert [record.getMessage().split(";")[0] for record in caplog.records] == [
        "judp.version_1 (1 times): a peer speaks AS5669 version 1, which AS5669A replaced",
        "judp.reference_architecture (1 times): a peer speaks JAUS Reference Architecture 3 (OPC)",
    ]


@given(st.binary(max_size=200))
def test_arbitrary_bytes_never_raise(data):
    for candidate in (data, b"\x02" + data):
        packets, counts = parse(candidate)
        assert sum(len(packet.payload) + 14 for packet in packets) <= len(candidate)
        assert packets or counts


@given(st.lists(PACKETS, min_size=1, max_size=3), st.data())
def test_damaged_datagrams_never_raise(packets, data):
    wire = bytearray(b"\x02" + b"".join(packet.encode()[1:] for packet in packets))
    for _ in range(data.draw(st.integers(1, 4))):
        wire[data.draw(st.integers(0, len(wire) - 1))] = data.draw(st.integers(0, 255))
    cut = data.draw(st.integers(0, len(wire)))
    parse(bytes(wire))
    parse(bytes(wire[:cut]))


def test_what_the_wire_cannot_carry_is_refused():
    with pytest.raises(ValueError, match="one datagram"):
        message(payload=bytes(MAX_PAYLOAD + 1)).encode()
    with pytest.raises(ValueError, match="out of range"):
        message(sequence=65536).encode()
    with pytest.raises(ValueError, match="out of range"):
        message()._replace(message_type=64).encode()
    (read,), _ = parse(message(payload=bytes(MAX_PAYLOAD)).encode())
    assert len(read.payload) == MAX_PAYLOAD


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

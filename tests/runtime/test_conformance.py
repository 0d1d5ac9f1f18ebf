"""What a receiver of AS5669A does, line by line, over real sockets.

``RECEIVED`` has a row for each thing that a peer may send, with what Junior, the stack met most
often, does about it. Ours is equal or better; where the standard and Junior differ, ours follows
the standard and accepts the peer as well. ``remark`` says what is better, and why.
"""

import socket
from dataclasses import dataclass, field

import pytest

from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.transports.packets.packet import AckNak, Broadcast, DataFlags, Packet, Priority

from .conftest import wait_until
from .transport_support import DRIVER, PEER, SENSOR, STATUS

pytestmark = pytest.mark.ports

ELSEWHERE = JausAddress(100, 1, 9)
LAST = b"\xff\xd0"


def packet(payload: bytes = STATUS, sequence: int = 1, **fields) -> Packet:
    return Packet(fields.pop("destination", DRIVER), PEER, payload, sequence, **fields)


def message(*arguments, **fields) -> bytes:
    """Returns a message without the version byte of its datagram."""
    return packet(*arguments, **fields).encode()[1:]


def with_compression(kind: int, fields: bytes) -> bytes:
    plain = message()
    return (
        b"\x02"
        + bytes([kind])
        + (len(plain) + len(fields)).to_bytes(2, "little")
        + (fields + plain[3:])
    )


def with_flags(flags: int, payload: bytes = STATUS, sequence: int = 1) -> bytes:
    data = bytearray(packet(payload, sequence).encode())
    data[4] = flags
    return bytes(data)


def first(sequence: int = 7, **fields) -> bytes:
    return packet(b"\x02\x40ab", sequence, data_flags=DataFlags.FIRST, **fields).encode()


def last(payload: bytes = b"c", sequence: int = 8, **fields) -> bytes:
    return packet(payload, sequence, data_flags=DataFlags.LAST, **fields).encode()


@dataclass(frozen=True)
class Row:
    """One thing that a peer sends.

    Attributes:
        clause: Subject and, in short, what is sent.
        junior: What Junior does.
        datagrams: What is sent.
        delivered: Payloads that components receive.
        acknowledged: Components whose acknowledgements the peer receives.
        counted: Counters that tell what was dropped.
        remark: Why ours differs.
    """

    clause: str
    junior: str
    datagrams: list[bytes]
    delivered: list[bytes]
    acknowledged: list[JausAddress] = field(default_factory=list)
    counted: dict[str, int] = field(default_factory=dict)
    remark: str = ""


RECEIVED = [
    Row("datagram: two messages, one version byte", "both delivered",
        [b"\x02" + message() + message(STATUS + b"2", 2)], [STATUS, STATUS + b"2"]),
    Row("datagram: two messages, a version byte before each", "only the first",
        [b"\x02" + message() + b"\x02" + message(STATUS + b"2", 2)], [STATUS],
        counted={"judp.trailing_bytes": 1}, remark="the rest is counted"),
    Row("datagram: bytes after the message", "message delivered, rest ignored",
        [packet().encode() + b"garbage"], [STATUS], counted={"judp.trailing_bytes": 1},
        remark="the rest is counted"),
    Row("datagram: a size larger than the datagram", "dropped", [packet().encode()[:-1]], [],
        counted={"judp.truncated": 1}),
    Row("datagram: version 3", "dropped", [b"\x03" + message()], [],
        counted={"judp.bad_version": 1}),
    Row("message type 1", "lost", [packet(message_type=1).encode()], [],
        counted={"transport.bad_message_type": 1},
        remark="the standard reserves the type: dropped knowingly, and counted"),
    Row("header compression: bits 6-7 without the two bytes", "delivered",
        [with_compression(0x40, b""), with_compression(0x80, b"")], [STATUS],
        counted={"transport.duplicate": 1},
        remark="accepted, since the addresses show that the bytes are missing"),
    Row("header compression: bits 6-7 with the two bytes", "lost",
        [with_compression(0x40, b"\x01\x00")], [STATUS],
        remark="this is the standard's layout: the message is not compressed yet"),
    Row("header compression: bits 0-1 with the two bytes", "delivered",
        [with_compression(0x01, b"\x01\x00")], [STATUS],
        remark="Junior's layout; accepted, since the addresses show it"),
    Row("header compression: a compressed message", "not tried",
        [with_compression(0xC0, b"\x01\x00")], [], counted={"transport.compressed": 1},
        remark="nobody offers compression, so nobody may send it"),
    Row("fragments: last one first", "reassembled", [last(b"cd"), first()], [b"\x02\x40abcd"]),
    Row("fragments: numbers 65535, 0", "reassembled", [first(65535), last(b"cd", 0)],
        [b"\x02\x40abcd"]),
    Row("fragments: of two destinations with consecutive numbers", "not tried",
        [first(destination=SENSOR), last(b"cd")], [],
        remark="a message has one destination; what misses its other fragments is discarded"),
    Row("fragments: each with a request for acknowledgement", "each acknowledged",
        [first(acknowledge=AckNak.REQUESTED), last(acknowledge=AckNak.REQUESTED)],
        [b"\x02\x40abc"], acknowledged=[DRIVER, DRIVER]),
    Row("fragments: of a broadcast", "refuses to send them",
        [first(destination=BROADCAST), last(destination=BROADCAST)],
        [b"\x02\x40abc", b"\x02\x40abc"],
        remark="never sent, but there is no doubt what a peer means that does"),
    Row("acknowledgement: a negative one", "dropped in silence",
        [packet(b"", acknowledge=AckNak.NAK).encode()], [], counted={"transport.nak": 1},
        remark="counted"),
    Row("acknowledgement: of nothing", "dropped in silence",
        [packet(b"", acknowledge=AckNak.ACK).encode()], [],
        counted={"transport.unmatched_acknowledgement": 1}, remark="counted"),
    Row("acknowledgement: with a payload", "dropped", [packet(acknowledge=AckNak.ACK).encode()], [],
        counted={"transport.bad_acknowledgement": 1}, remark="an acknowledgement is 14 bytes"),
    Row("flags: all set, as Junior sends for its priority 0", "dropped as an acknowledgement",
        [with_flags(0xFF)], [STATUS], counted={"transport.flagless": 1},
        remark="nothing else has these flags; the log says what to change at the sender"),
    Row("flags: all set, twice the same number", "dropped as an acknowledgement",
        [with_flags(0xFF), with_flags(0xFF)], [STATUS],
        counted={"transport.flagless": 2, "transport.duplicate": 1}),
    Row("flags: all set, the fragments of a long message", "dropped as an acknowledgement",
        [with_flags(0xFF, STATUS.ljust(4079), 7), with_flags(0xFF, STATUS, 8)], [],
        counted={"transport.bad_acknowledgement": 2},
        remark="nothing tells where a message begins and ends"),
    Row("flags: all set, no payload", "dropped in silence", [with_flags(0xFF, b"")], [],
        counted={"transport.unmatched_acknowledgement": 1}),
    Row("flags: all set, half a message code", "dropped as an acknowledgement",
        [with_flags(0xFF, b"\x02")], [], counted={"transport.bad_acknowledgement": 1}),
    Row("broadcast flag 0 with a wildcard destination", "delivered",
        [packet(destination=BROADCAST).encode()], [STATUS, STATUS]),
    Row("broadcast flag 3, reserved", "not tried", [with_flags(0x0D)], [STATUS],
        remark="the destination decides"),
    Row("wildcard destination with a request for acknowledgement",
        "delivered, one acknowledgement of each matching component",
        [packet(destination=BROADCAST, acknowledge=AckNak.REQUESTED).encode()], [STATUS, STATUS],
        acknowledged=[DRIVER, SENSOR]),
    Row("wildcard of another subsystem", "ignored",
        [packet(destination=JausAddress(101, 255, 255)).encode()], [],
        counted={"transport.not_for_us": 1}, remark="counted"),
    Row("request for acknowledgement, destination not here", "no acknowledgement",
        [packet(destination=ELSEWHERE, acknowledge=AckNak.REQUESTED).encode()], [],
        counted={"transport.not_for_us": 1}),
    Row("the same number of the same source again", "dropped, acknowledged again",
        [packet(acknowledge=AckNak.REQUESTED).encode()] * 2, [STATUS],
        acknowledged=[DRIVER, DRIVER], counted={"transport.duplicate": 1}),
    Row("the same number to another component", "dropped",
        [packet().encode(), packet(destination=SENSOR).encode()], [STATUS, STATUS],
        remark="a source that restarts may begin its numbers anew"),
    Row("a datagram longer than Junior's buffer", "cut and lost",
        [packet(b"\x02\x40" + bytes(60_000)).encode()], [b"\x02\x40" + bytes(60_000)],
        remark="accepted up to what UDP carries; never sent"),
    Row("AS5669 version 1", "delivered by its own rules",
        [bytes.fromhex("0100000012060264000201c8000101650002001a000102")], [],
        counted={"judp.version_1": 1}, remark="another protocol; the log names it"),
    Row("JAUS Reference Architecture", "delivered by its own rules", [b"JAUS01.0" + bytes(18)], [],
        counted={"judp.reference_architecture": 1}, remark="another protocol; the log names it"),
    Row("source: a wildcard, or zero", "not tried", [Packet(DRIVER, BROADCAST, STATUS, 1).encode(),
        Packet(DRIVER, JausAddress(0, 0, 0), STATUS, 2).encode()], [],
        counted={"transport.bad_source": 2}, remark="answers could go nowhere"),
    Row("source: an id with a byte 0xFF", "cannot connect",
        [Packet(DRIVER, JausAddress(511, 1, 1), STATUS, 1).encode()], [STATUS],
        remark="a valid id of the standard"),
]  # fmt: skip


@pytest.mark.parametrize("row", RECEIVED, ids=[row.clause for row in RECEIVED])
def test_what_is_received(row, station, peer):
    here = station().attach(DRIVER, SENSOR)
    for data in row.datagrams:
        peer.send(data)
    peer.send(packet(LAST, 30_000))
    wait_until(lambda: LAST in here.payloads)
    assert here.payloads[:-1] == row.delivered
    answers = [peer.receive() for _ in row.acknowledged]
    assert [answer.source for answer in answers] == row.acknowledged
    assert all(answer.acknowledge is AckNak.ACK and not answer.payload for answer in answers)
    assert peer.is_quiet()
    traffic = ("judp.received", "judp.sent", "transport.fragments", "transport.reassembled")
    counts = here.loop.counters.snapshot()
    dropped = {name: n for name, n in counts.items() if not name.startswith(traffic)}
    assert dropped == row.counted


def raw(peer) -> bytes:
    peer.unicast.settimeout(5)
    return peer.unicast.recv(65535)


class TestAcknowledgement:
    @pytest.mark.parametrize("priority", list(Priority))
    def test_it_is_fourteen_bytes_with_the_number_and_priority_of_the_request(
        self, station, peer, priority
    ):
        station().attach(DRIVER)
        peer.send(packet(sequence=0x1234, priority=priority, acknowledge=AckNak.REQUESTED))
        expected = f"02000e00{0x30 | priority:02x}01012c01010164003412"
        assert raw(peer).hex() == expected

    def test_it_consumes_no_number(self, station, peer):
        here = station(address_book={PEER: peer.endpoint}).attach(DRIVER)
        peer.send(packet(sequence=1))
        wait_until(lambda: here.received)
        here.transport.send(DRIVER, PEER, STATUS)
        first = peer.receive().sequence
        peer.send(packet(sequence=77, acknowledge=AckNak.REQUESTED))
        assert peer.receive().sequence == 77
        here.transport.send(DRIVER, PEER, STATUS)
        assert peer.receive().sequence == first + 1 & 0xFFFF


class TestSent:
    def test_one_message_in_each_datagram_and_none_longer_than_peers_take(self, station, peer):
        here = station().attach(DRIVER)
        peer.send(packet())
        wait_until(lambda: here.received)
        for size in (2, 4079, 4080, 20_000):
            here.transport.send(DRIVER, PEER, bytes(size))
        sizes = []
        for _ in range(1 + 1 + 2 + 5):
            data = raw(peer)
            assert data[0] == 2
            assert int.from_bytes(data[2:4], "little") == len(data) - 1
            assert data[1] == 0  # no message type, no header compression
            sizes.append(len(data))
        assert sizes == [17, 4094, 4094, 16, 4094, 4094, 4094, 4094, 3699]

    def test_multicasts_pass_sixteen_routers(self, station):
        here = station()
        sock = here.transport._port.unicast
        assert sock.getsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL) == 16

    @pytest.mark.parametrize(
        "destination", [BROADCAST, JausAddress(100, 255, 255), JausAddress(300, 1, 255)]
    )
    def test_a_wildcard_of_any_reach_is_marked_global(self, station, peer, destination):
        station().transport.send(DRIVER, destination, STATUS)
        sent = peer.overhear()
        assert (sent.destination, sent.broadcast) == (destination, Broadcast.GLOBAL)
        assert sent.acknowledge is AckNak.NONE

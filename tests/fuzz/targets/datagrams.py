"""The receive path of JUDP without sockets: nothing raises, nothing piles up, all is counted.

The first byte of an input chooses where the rest, a datagram, comes from.
"""

from functools import cache

from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.settings import MAX_FRAGMENT_SIZE, Endpoint, TransportSettings
from jausml.runtime.transports.packets.packet import AckNak, DataFlags, Packet, parse_datagram
from jausml.runtime.transports.ports import FRAME, present_frame, read_forwarded, read_present
from jausml.runtime.transports.udp.judp import JudpTransport

SETTINGS = TransportSettings(reassembly_limit=1 << 16, duplicate_history=64)
OWN = (JausAddress(100, 1, 1), JausAddress(100, 1, 2))
PEER = JausAddress(200, 1, 1)
STEP_S = 0.005
FLAGS = 4
TURN_EVERY = 64

ORIGINS: tuple[tuple[Endpoint, bool], ...] = (
    (("192.0.2.1", 3794), False),
    (("192.0.2.1", 3794), True),
    ((SETTINGS.interface, 5), False),
    ((SETTINGS.interface, SETTINGS.port), False),
)

ENDS = (
    "transport.own_source",
    "transport.bad_source",
    "transport.not_for_us",
    "judp.forwarded",
    "transport.nak",
    "transport.acknowledgement",
    "transport.bad_acknowledgement",
    "transport.unmatched_acknowledgement",
    "transport.no_message_code",
    "transport.duplicate",
    "transport.fragments",
)
"""Counters of how a message ends that is not delivered at once."""


class ReceivePath:
    """A transport with two components, and the books that must balance."""

    def __init__(self) -> None:
        """Starts with nothing received."""
        self.now = 0.0
        self.inputs = 0
        self.messages = 0
        self.delivered = 0
        self._latest: bytes | None = None
        self.loop = Loop(clock=lambda: self.now)
        self.transport = JudpTransport(SETTINGS, self.loop)
        for address in OWN:
            self.transport.attach(address, self._receive)
        # Numbers that a packet waits for, so that acknowledgements may match.
        self.transport.send(OWN[0], PEER, b"\x02\x40", acknowledge=True)

    def _receive(self, payload: bytes, _source: JausAddress) -> None:
        if payload is not self._latest:  # a broadcast reaches both components
            self.delivered += 1
        self._latest = payload

    def feed(self, data: bytes) -> None:
        """Takes a datagram and balance the books."""
        origin, datagram = data[0] if data else 0, data[1:]
        sender, by_multicast = ORIGINS[origin % len(ORIGINS)]
        before, delivered = self.loop.counters.snapshot(), self.delivered
        messages, unreadable = expected(datagram, sender)
        self.transport.receive_datagram(datagram, sender, by_multicast=by_multicast)
        after = self.loop.counters.snapshot()
        grown = {name: count - before.get(name, 0) for name, count in after.items()}
        ends = sum(grown.get(name, 0) for name in ENDS)
        at_once = self.delivered - delivered - grown.get("transport.reassembled", 0)
        assert at_once + ends == messages, f"{messages} messages, but {at_once} + {ends} ended"
        for name, count in unreadable.items():
            assert grown.get(name, 0) == count, f"{name} counted {grown.get(name)} times"
        assert messages or unreadable, "a datagram left no trace"
        assert grown.get("transport.receiver_failed", 0) == 0
        self.messages += messages
        self.inputs += 1
        self.now += STEP_S
        if self.inputs % TURN_EVERY == 0:
            self.loop.run_once(0)
            self.check_bounds()

    def check_bounds(self) -> None:
        """Checks that what is kept is bounded, and that no fragment got lost."""
        inbox = self.transport.inbox
        assert len(self.transport.address_book.learnt) <= 1024
        assert len(inbox.duplicates) <= 256 * SETTINGS.duplicate_history
        assert inbox.reassembly.size <= 4 * SETTINGS.reassembly_limit
        counts = self.loop.counters.snapshot()
        gone = counts.get("transport.fragments_assembled", 0) + counts.get(
            "transport.fragments_discarded", 0
        )
        assert counts.get("transport.fragments", 0) == gone + len(inbox.reassembly)
        assert counts.get("loop.callback_failed", 0) == 0


def expected(datagram: bytes, sender: Endpoint) -> tuple[int, dict[str, int]]:
    """Returns how many messages a datagram has, and what must be counted of the rest."""
    if datagram.startswith(FRAME) and sender[0] == SETTINGS.interface:
        inner = None
        if sender == (SETTINGS.interface, SETTINGS.port):
            inner = read_forwarded(datagram)
        if inner is None:
            is_present = read_present(datagram) is not None
            return 0, {"judp.present" if is_present else "judp.bad_version": 1}
        datagram = inner[1]
    counters = Counters()
    return len(parse_datagram(datagram, counters)), counters.snapshot()


@cache
def path() -> ReceivePath:
    """Returns the receive path that all inputs of the process go through."""
    return ReceivePath()


def one_input(data: bytes) -> None:
    """Takes one datagram.

    Raises:
        AssertionError: A message neither reached a component nor was counted, or something
            grows without bound.
    """
    path().feed(data)


def all_flags(packet: Packet) -> bytes:
    """Returns a datagram with all flags set, as Junior sends for its priority 0."""
    datagram = bytearray(packet.encode())
    datagram[FLAGS] = 0xFF
    return bytes(datagram)


def seeds() -> list[bytes]:
    """Returns one datagram of each kind."""
    status = b"\x02\x40" + bytes(5)
    plain = Packet(OWN[0], PEER, status, 7)
    flags = (DataFlags.FIRST, DataFlags.MIDDLE, DataFlags.MIDDLE, DataFlags.LAST)
    packets = [
        plain,
        plain._replace(acknowledge=AckNak.REQUESTED, sequence=8),
        plain._replace(payload=b"", acknowledge=AckNak.ACK),
        plain._replace(payload=b"", acknowledge=AckNak.NAK),
        plain._replace(destination=BROADCAST, sequence=9),
        plain._replace(destination=JausAddress(100, 1, 255), sequence=10),
        plain._replace(destination=PEER, source=JausAddress(300, 2, 1)),
        *[plain._replace(data_flags=flag, sequence=20 + n) for n, flag in enumerate(flags)],
        *[plain._replace(source=JausAddress(1 + n, 1, 1), sequence=n) for n in range(8)],
    ]
    datagrams = [packet.encode() for packet in packets]
    datagrams += [
        b"",
        datagrams[0] + datagrams[1][1:],
        datagrams[0] + b"garbage",
        b"\x02\x40" + datagrams[0][2:4] + b"\x01\x0c" + datagrams[0][4:],
        all_flags(plain._replace(sequence=11)),
        all_flags(plain._replace(payload=bytes(MAX_FRAGMENT_SIZE), sequence=12)),
        b"\x01" + bytes(20),
        b"JAUS01.0" + bytes(16),
        present_frame([PEER]),
        b"\x00F\x7f\x00\x00\x01\x0e\xd2" + datagrams[0],
    ]
    return [bytes([origin]) + datagram for datagram in datagrams for origin in range(len(ORIGINS))]


def report() -> str:
    """Returns what became of everything."""
    this = path()
    counts = " ".join(f"{name}={n}" for name, n in this.loop.counters.snapshot().items())
    return f"{this.messages} messages, {this.delivered} delivered; {counts}"

"""The usual datagram is taken on its bytes; it has the effects that it has as a packet."""

from __future__ import annotations

import socket
import sys
import time
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from ports import free_port

from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.transports.packets.packet import AckNak, Broadcast, DataFlags, Packet, Priority
from jausml.runtime.transports.ports import FRAME
from jausml.runtime.transports.udp.judp import JudpTransport
from jausml.runtime.transports.udp.reading import KernelDrops

if TYPE_CHECKING:
    from jausml.runtime.transports.delivery import ReceivedMessage

pytestmark = pytest.mark.ports

FIRST, SECOND, OTHER = JausAddress(1, 1, 1), JausAddress(1, 1, 2), JausAddress(1, 2, 1)
PEERS = JausAddress(7, 1, 1), JausAddress(7, 1, 2)
FAILS = b"\x03\x40fails"
LARGE = b"\x04\x40" + bytes(1024)

PACKETS = st.builds(
    Packet,
    destination=st.sampled_from([FIRST] * 6 + [SECOND, OTHER, BROADCAST, JausAddress(1, 255, 1)]),
    source=st.sampled_from([*PEERS] * 4 + [FIRST, SECOND, JausAddress(7, 0, 1), BROADCAST]),
    payload=st.sampled_from([b"\x02\x40a", b"\x02\x40b", b"\x02\x40", LARGE, FAILS, b"", b"\x02"]),
    sequence=st.sampled_from([0, 1, 2, 65535]),
    priority=st.sampled_from(Priority),
    broadcast=st.sampled_from(Broadcast),
    acknowledge=st.sampled_from([AckNak.NONE] * 3 + [AckNak.REQUESTED] * 3 + [*AckNak]),
    data_flags=st.sampled_from([DataFlags.SINGLE] * 6 + [*DataFlags]),
    message_type=st.sampled_from([0] * 9 + [1]),
)


@st.composite
def damaged(draw: st.DrawFn) -> bytes:
    data = bytearray(draw(PACKETS).encode())
    for _ in range(draw(st.integers(0, 2))):
        data[draw(st.integers(0, min(16, len(data) - 1)))] = draw(st.integers(0, 255))
    kept = draw(st.sampled_from([len(data), len(data) - 1, 14, 3, 1]))
    return bytes(data[:kept]) + draw(st.sampled_from([b"", b"\x00", bytes(14)]))


DATAGRAMS = st.one_of(
    *[PACKETS.map(Packet.encode)] * 4,
    st.tuples(PACKETS, PACKETS).map(lambda two: two[0].encode() + two[1].encode()[1:]),
    damaged(),
)


@st.composite
def fragments(draw: st.DrawFn) -> list[bytes]:
    """The packets of a message, most often in their order and each of them once."""
    first, count = draw(st.sampled_from([0, 7, 65534])), draw(st.integers(2, 4))
    source, payload = draw(st.sampled_from(PEERS)), draw(st.sampled_from([b"\x02\x40a", LARGE]))
    places = [DataFlags.FIRST, *[DataFlags.MIDDLE] * (count - 2), DataFlags.LAST]
    packets = [
        Packet(FIRST, source, payload, first + number & 0xFFFF, data_flags=place).encode()
        for number, place in enumerate(places)
    ]
    order = list(range(count))
    return [packets[each] for each in draw(st.just(order) | st.lists(st.sampled_from(order)))]


STEPS = st.lists(
    st.one_of(
        *[st.tuples(st.just(0), fragments())] * 2,
        *[st.tuples(st.sampled_from([0, 0, 0, 1]), DATAGRAMS)] * 6,
        st.tuples(st.just("pause"), st.sampled_from([0.3, 1.0, 4.0])),
        st.tuples(st.just("attach"), st.sampled_from([SECOND, PEERS[1]])),
        st.tuples(st.just("detach"), st.sampled_from([FIRST, SECOND])),
    ),
    max_size=30,
)


class Host:
    """A transport on a clock of its own, two sockets that send to it, and what happened."""

    def __init__(self, stack: ExitStack, *, by_packets: bool, history: int = 3) -> None:
        self.time = 1000.0
        self.loop = stack.enter_context(Loop(clock=lambda: self.time))
        self.peers = [stack.enter_context(_socket()) for _ in range(2)]
        settings = TransportSettings(port=free_port(), duplicate_history=history)
        self.transport = JudpTransport(settings, self.loop)
        self.transport.open()
        stack.callback(self.transport.close)
        self.delivered: list[Any] = []
        self.attach(FIRST)
        self._unicast = self.transport._port.unicast
        self._by_packets = by_packets
        if by_packets:
            self.loop.unregister(self._unicast)

    def attach(self, address: JausAddress) -> None:
        def take(payload: bytes, source: JausAddress) -> None:
            self.delivered.append((str(address), payload, str(source)))
            if payload == FAILS:
                raise RuntimeError("on purpose")

        def receive(message: ReceivedMessage) -> None:
            take(message.payload, message.source)

        if address not in self.transport.inbox.receivers:
            self.transport.attach(address, receive, take)

    def step(self, kind: Any, value: Any) -> None:
        if kind == "pause":
            self.time += value
        elif kind == "attach":
            self.attach(value)
        elif kind == "detach":
            self.transport.detach(value)
        else:
            for data in [value] if isinstance(value, bytes) else value:
                self.peers[kind].sendto(data, self._unicast.getsockname())
        if self._by_packets:
            for data, sender in _drain(self._unicast):
                self.loop.counters.add("judp.received")
                self.transport.receive_datagram(data, sender)
        while self.loop.run_once(0):
            pass

    def effects(self) -> Any:
        """Everything that a datagram may change, but the ports, which no two hosts share."""
        book = self.transport.address_book.learnt
        places = [peer.getsockname() for peer in self.peers]
        answers = [[_portless(data) for data, _ in _drain(peer)] for peer in self.peers]
        inbox = self.transport.inbox
        return {
            "delivered": self.delivered,
            "counters": self.loop.counters.snapshot(),
            "answers": answers,
            "numbers": [(source, list(seen)) for source, seen in inbox.duplicates.seen.items()],
            "fragments": inbox.fragments,
            "book": [
                (str(each), places.index(entry.endpoint), entry.heard)
                for each, entry in book.items()
            ],
        }


def _socket() -> socket.socket:
    made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    made.bind(("127.0.0.1", 0))
    made.setblocking(False)
    return made


def _portless(data: bytes) -> bytes:
    """Return a datagram without the endpoint of whom it is forwarded for."""
    return data[len(FRAME) + 7 :] if data.startswith(FRAME + b"F") else data


def _drain(sock: socket.socket) -> list[tuple[bytes, Any]]:
    arrived = []
    while True:
        try:
            arrived.append(sock.recvfrom(65535))
        except BlockingIOError:
            return arrived


@given(steps=STEPS)
def test_datagrams_have_the_same_effects_on_bytes_and_as_packets(steps: list[Any]) -> None:
    with ExitStack() as stack:
        on_bytes, as_packets = (Host(stack, by_packets=each) for each in (False, True))
        for step in steps:
            for host in (on_bytes, as_packets):
                host.step(*step)
        assert on_bytes.effects() == as_packets.effects()


def test_the_account_costs_a_message_nothing() -> None:
    with ExitStack() as stack:
        host = Host(stack, by_packets=False, history=512)
        host.step(0, Packet(FIRST, PEERS[0], b"\x02\x40", 0).encode())
        called = set()

        def note(frame: Any, event: str, _argument: object) -> None:
            if event == "call":
                called.add(Path(frame.f_code.co_filename).name)

        sys.setprofile(note)
        try:
            for number in range(1, 300):  # there is room for more
                host.step(0, Packet(FIRST, PEERS[0], b"\x02\x40", 2 * number).encode())
        finally:
            sys.setprofile(None)
        assert "reading.py" in called
        assert called.isdisjoint({"account.py", "duplicates.py"})
        ((_, _, account),) = host.transport.inbox.duplicates.accounts()
        assert (account.came, account.lost) == (300, 299)


class TestUsual:
    """That the way on bytes is taken at all."""

    @pytest.fixture
    def host(self) -> Any:
        with ExitStack() as stack:
            made = Host(stack, by_packets=False)
            made.others = []
            otherwise = made.transport.receive_datagram
            made.transport.receive_datagram = lambda *arguments, **how: (
                made.others.append(arguments) or otherwise(*arguments, **how)
            )
            made.loop.unregister(made._unicast)
            made.transport._watch(made._unicast)
            yield made

    @pytest.mark.parametrize("acknowledge", [AckNak.NONE, AckNak.REQUESTED])
    @pytest.mark.parametrize("payload", [b"\x02\x40", LARGE])
    def test_a_known_peer(self, host: Any, acknowledge: AckNak, payload: bytes) -> None:
        for number in range(5):
            packet = Packet(FIRST, PEERS[0], payload, number, acknowledge=acknowledge)
            host.step(0, packet.encode())
            host.step(0, packet.encode())
        # The first one, by which the peer got known, and those that came again.
        assert len(host.others) == 1 + 5
        effects = host.effects()
        assert len(effects["delivered"]) == 5
        assert effects["counters"]["transport.duplicate"] == 5
        assert len(effects["answers"][0]) == (10 if acknowledge else 0)

    @pytest.mark.parametrize("flags", [DataFlags.SINGLE, DataFlags.MIDDLE])
    def test_what_is_known_of_a_way_does_not_outlive_what_it_rests_on(
        self, host: Any, flags: DataFlags
    ) -> None:
        numbers = iter(range(100))

        def is_usual() -> bool:
            host.others.clear()
            packet = Packet(FIRST, PEERS[0], b"\x02\x40", next(numbers), data_flags=flags)
            host.step(0, packet.encode())
            return not host.others

        def flood(count: int) -> None:
            for number in range(count):
                packet = Packet(FIRST, JausAddress(9, 1 + number // 200, 1 + number % 200), LARGE)
                host.transport.receive_datagram(packet.encode(), ("127.0.0.9", 9))

        assert not is_usual()
        assert is_usual()
        flood(256)  # the window forgets it
        assert not is_usual()
        assert is_usual()
        flood(1024)  # the address book forgets it
        assert not is_usual()
        assert is_usual()
        host.attach(PEERS[0])
        assert not is_usual()
        assert not is_usual()
        host.transport.detach(PEERS[0])
        assert not is_usual()
        assert is_usual()
        host.transport.detach(FIRST)
        assert not is_usual()

    def test_ways_without_end_are_forgotten(self, host: Any) -> None:
        for number in range(2100):
            packet = Packet(FIRST, JausAddress(9, 1 + number % 250, 1), b"\x02\x40", number)
            host.step(0, packet._replace(priority=Priority(number // 250 % 4)).encode())
        assert len(host.transport.inbox.usual) <= 1024


def test_what_the_kernel_drops_is_counted(caplog: pytest.LogCaptureFixture) -> None:
    with ExitStack() as stack:
        host = Host(stack, by_packets=False)
        host._unicast.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1)
        packet = Packet(FIRST, PEERS[0], b"\x02\x40", 0).encode()
        for _ in range(50):
            host.peers[0].sendto(packet, host._unicast.getsockname())
        while host.loop.run_once(0):
            pass
        host.step("pause", 1.1)
        counters = host.loop.counters.snapshot()
        assert counters["judp.kernel_dropped"] == 50 - counters["judp.received"]
        assert "the receive buffer was full" in caplog.text


@pytest.mark.parametrize("option", [socket.SO_TYPE, 9999])  # answers otherwise, or not at all
def test_where_the_kernel_is_not_asked_it_tells_with_datagrams(
    option: int, caplog: pytest.LogCaptureFixture
) -> None:
    counters = Counters()
    drops = KernelDrops(counters)
    with _socket() as here, _socket() as there:
        receive = drops.receiver(here, option)
        here.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1)
        for _ in range(50):
            there.sendto(b"sent", here.getsockname())
        arrived = 0
        with suppress(BlockingIOError):
            while receive(100) == (b"sent", there.getsockname()):
                arrived += 1
        there.sendto(b"next", here.getsockname())
        assert receive(100) == (b"next", there.getsockname())
        drops.look()
    assert counters.snapshot() == {"judp.kernel_dropped": 50 - arrived}
    assert "the receive buffer was full" in caplog.text


def test_drops_until_the_end_are_counted() -> None:
    with ExitStack() as stack:
        host = Host(stack, by_packets=False)
        host._unicast.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1)
        for _ in range(50):
            host.peers[0].sendto(b"sent", host._unicast.getsockname())
        host.transport.close()
        assert host.loop.counters.snapshot()["judp.kernel_dropped"] > 0


@pytest.mark.parametrize(("limit", "arrived"), [(0.2, [b"\x02\x40new"]), (0, None)])
def test_what_waited_while_the_process_stood_still_is_thrown_away(
    limit: float, arrived: list[bytes] | None, caplog: pytest.LogCaptureFixture
) -> None:
    taken: list[bytes] = []
    old = [b"\x02\x40old" + bytes([number]) for number in range(40)]
    port = free_port()
    settings = TransportSettings(port=port, standstill=limit)
    with Loop() as loop, _socket() as peer, ExitStack() as stack:
        transport = JudpTransport(settings, loop)
        transport.open()
        stack.callback(transport.close)
        transport.attach(FIRST, lambda message: taken.append(message.payload))
        for number, payload in enumerate(old):
            peer.sendto(Packet(FIRST, PEERS[0], payload, number).encode(), ("127.0.0.1", port))
        time.sleep(0.3)
        while loop.run_once(0):
            pass
        peer.sendto(Packet(FIRST, PEERS[0], b"\x02\x40new", 99).encode(), ("127.0.0.1", port))
        while loop.run_once(0):
            pass
        assert taken == (arrived or [*old, b"\x02\x40new"])
        thrown = loop.counters.snapshot().get("judp.too_old", 0)
        assert thrown == (len(old) if limit else 0)
        assert ("stood still for 0." in caplog.text) == bool(limit)

"""Datagrams are read from a socket, and what the kernel drops or is too old is counted."""

import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import pytest
from ports import free_port

from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.transports.packets.packet import AckNak, Packet
from jausml.runtime.transports.udp.judp import JudpTransport, KernelDrops

pytestmark = pytest.mark.ports

FIRST, PEER = JausAddress(1, 1, 1), JausAddress(7, 1, 1)


class Host:
    """A transport on a clock of its own, a socket that sends to it, and what it delivered."""

    def __init__(self, stack: ExitStack) -> None:
        self.time = 1000.0
        self.loop = stack.enter_context(Loop(clock=lambda: self.time))
        self.peer = stack.enter_context(_socket())
        self.transport = JudpTransport(TransportSettings(port=free_port()), self.loop)
        self.transport.open()
        stack.callback(self.transport.close)
        self.delivered: list[bytes] = []
        self.transport.attach(FIRST, lambda payload, _: self.delivered.append(payload))
        self.unicast = self.transport._port.unicast

    def send(self, datagram: bytes) -> None:
        self.peer.sendto(datagram, self.unicast.getsockname())

    def run(self) -> None:
        while self.loop.run_once(0):
            pass


@pytest.fixture
def host() -> Iterator[Host]:
    with ExitStack() as stack:
        yield Host(stack)


def _socket() -> socket.socket:
    made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    made.bind(("127.0.0.1", 0))
    made.setblocking(False)
    return made


def _drain(sock: socket.socket) -> list[tuple[bytes, Any]]:
    arrived = []
    while True:
        try:
            arrived.append(sock.recvfrom(65535))
        except BlockingIOError:
            return arrived


@pytest.mark.parametrize("acknowledge", [AckNak.NONE, AckNak.REQUESTED])
@pytest.mark.parametrize("payload", [b"\x02\x40", bytes(1024)])
def test_each_message_is_taken_once_and_each_packet_answered(host, acknowledge, payload):
    for number in range(5):
        packet = Packet(FIRST, PEER, payload, number, acknowledge=acknowledge)
        host.send(packet.encode())
        host.send(packet.encode())
    host.run()
    assert host.delivered == [payload] * 5
    counters = host.loop.counters.snapshot()
    assert counters["transport.duplicate"] == 5
    assert counters["judp.received"] == 10
    assert len(_drain(host.peer)) == (10 if acknowledge else 0)


def test_others_have_their_turn_between_many_datagrams(host):
    turns: list[int] = []
    for number in range(200):
        host.send(Packet(FIRST, PEER, b"\x02\x40", number).encode())
    while len(host.delivered) < 200:
        host.loop.run_once(0)
        turns.append(len(host.delivered))
    read = [after - before for before, after in zip([0, *turns], turns, strict=False)]
    # One at first, and twice as many in each turn while one follows the other.
    assert read == [1, 2, 4, 8, 16, 32, 32, 32, 32, 32, 9]
    host.time += 1.0
    host.send(Packet(FIRST, PEER, b"\x02\x40", 200).encode())
    host.send(Packet(FIRST, PEER, b"\x02\x40", 201).encode())
    host.loop.run_once(0)
    assert len(host.delivered) == 201


def test_what_the_kernel_drops_is_counted(host, caplog):
    host.unicast.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1)
    packet = Packet(FIRST, PEER, b"\x02\x40", 0).encode()
    for _ in range(50):
        host.send(packet)
    host.run()
    host.time += 1.1
    host.run()
    counters = host.loop.counters.snapshot()
    assert counters["judp.kernel_dropped"] == 50 - counters["judp.received"]
    assert "the receive buffer was full" in caplog.text


def test_drops_are_counted_once_where_a_socket_is_named_again():
    counters = Counters()
    drops = KernelDrops(counters)
    with _socket() as flooded, _socket() as sender:
        flooded.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1)
        for _ in range(50):
            sender.sendto(bytes(200), flooded.getsockname())
        arrived = len(_drain(flooded))
        drops.watch(flooded)
        drops.update()
        drops.watch(flooded)  # as when a compiled core begins to read it
        drops.update()
    assert arrived < 50
    assert counters.snapshot() == {"judp.kernel_dropped": 50 - arrived}


def test_what_is_no_answer_of_the_kernel_counts_nothing():
    counters = Counters()
    drops = KernelDrops(counters)
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as closed:
        drops.watch(closed)
    drops.update()
    drops.update()
    assert counters.snapshot() == {}


def test_drops_until_the_end_are_counted(host):
    host.unicast.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1)
    for _ in range(50):
        host.send(b"sent")
    host.transport.close()
    assert host.loop.counters.snapshot()["judp.kernel_dropped"] > 0


@pytest.mark.parametrize(("limit", "arrived"), [(0.2, [b"\x02\x40new"]), (0, None)])
def test_what_waited_while_the_process_stood_still_is_thrown_away(limit, arrived, caplog):
    taken: list[bytes] = []
    old = [b"\x02\x40old" + bytes([number]) for number in range(40)]
    port = free_port()
    settings = TransportSettings(port=port, standstill=limit)
    with Loop() as loop, _socket() as peer, ExitStack() as stack:
        transport = JudpTransport(settings, loop)
        transport.open()
        stack.callback(transport.close)
        transport.attach(FIRST, lambda payload, _: taken.append(payload))
        for number, payload in enumerate(old):
            peer.sendto(Packet(FIRST, PEER, payload, number).encode(), ("127.0.0.1", port))
        time.sleep(0.3)
        while loop.run_once(0):
            pass
        peer.sendto(Packet(FIRST, PEER, b"\x02\x40new", 99).encode(), ("127.0.0.1", port))
        while loop.run_once(0):
            pass
        assert taken == (arrived or [*old, b"\x02\x40new"])
        thrown = loop.counters.snapshot().get("judp.too_old", 0)
        assert thrown == (len(old) if limit else 0)
        assert ("stood still for 0." in caplog.text) == bool(limit)

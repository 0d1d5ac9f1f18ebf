"""JAUS over TCP, over real connections on loopback."""

from __future__ import annotations

import contextlib
import json
import random
import socket
import subprocess
import sys
from contextlib import ExitStack
from functools import partial
from typing import TYPE_CHECKING

import ports
import pytest
from hypothesis import given
from hypothesis import strategies as st
from network_hosts import NetworkHost

from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.base.settings import TransportKind
from jausml.runtime.transports import jtcp
from jausml.runtime.transports.packets.packet import (
    AckNak,
    Broadcast,
    DataFlags,
    Packet,
    Priority,
    parse_datagram,
)
from jausml.runtime.transports.tcp_connection import StreamError, StreamReader

from .conftest import wait_until
from .transport_support import DRIVER, OCU, PEER, SENSOR, STATUS, in_threads
from .transport_support import from_peer as packet_from_peer

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from conftest import Station

pytestmark = pytest.mark.ports


def from_peer(*arguments, **fields) -> bytes:
    """Returns a message of the peer as it stands in a stream."""
    return packet_from_peer(*arguments, **fields).encode()[1:]


class Stream:
    """The foreign end of a connection: bytes made and read by hand."""

    def __init__(self, sock: socket.socket) -> None:
        self.socket = sock
        self.socket.settimeout(5)
        self.data = b""

    def send(self, data: bytes) -> None:
        self.socket.sendall(data)

    def read(self, size: int) -> bytes:
        while len(self.data) < size:
            chunk = self.socket.recv(65536)
            assert chunk, f"the connection ended after {self.data!r}"
            self.data += chunk
        data, self.data = self.data[:size], self.data[size:]
        return data

    def receive(self) -> Packet:
        head = self.read(3)
        message = head + self.read(int.from_bytes(head[1:], "little") - 3)
        (packet,) = parse_datagram(b"\x02" + message, Counters())
        return packet

    def is_closed(self) -> bool:
        """Waits for the other end to close the connection."""
        with contextlib.suppress(ConnectionError):
            while self.socket.recv(65536):
                pass
        return True

    def close(self) -> None:
        self.socket.close()


class Host:
    """A foreign stack that listens, and connects."""

    def __init__(self) -> None:
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.listener.settimeout(5)
        self.streams: list[Stream] = []

    @property
    def endpoint(self) -> tuple[str, int]:
        return self.listener.getsockname()

    def accept(self) -> Stream:
        self.streams.append(Stream(self.listener.accept()[0]))
        return self.streams[-1]

    def connect(self, there: Station, data: bytes = b"") -> Stream:
        """Connects, and says this behind the version."""
        self.streams.append(Stream(socket.create_connection(there.transport.endpoint, 5)))
        self.streams[-1].send(b"\x02" + data if data else b"")
        return self.streams[-1]

    def meet(self, there: Station) -> Stream:
        """Connects and is heard."""
        stream = self.connect(there, from_peer())
        wait_until(lambda: there.received)
        return stream

    def close(self) -> None:
        self.listener.close()
        for stream in self.streams:
            stream.close()


@pytest.fixture
def host() -> Iterator[Host]:
    made = Host()
    yield made
    made.close()


@pytest.fixture
def tcp(station) -> Callable[..., Station]:
    """Makes running transports over TCP on one free port."""

    def make(**settings: object) -> Station:
        return station(**{"transport": TransportKind.JTCP, "takeover_interval": 0.1, **settings})

    return make


LIMITED = """
import json, os, resource, sys, time
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.transports.jtcp import JtcpTransport

port, limit = int(sys.argv[1]), int(sys.argv[2])
resource.setrlimit(resource.RLIMIT_NOFILE, (limit, limit))
stated = {JausAddress(400, 1, 1): ("127.0.0.9", port)}
received, held = [], []
with Loop() as loop:
    transport = JtcpTransport(TransportSettings(port=port, address_book=stated), loop)
    transport.open()
    transport.attach(JausAddress(100, 1, 1), lambda *message: received.append(message))
    loop.start()
    print("runs", flush=True)
    for line in sys.stdin:
        what, count = line.split()
        if what == "fill":
            try:
                while True:
                    held.append(os.dup(0))
            except OSError:
                pass
        while what == "free" and held:
            os.close(held.pop())
        counter = loop.counters.snapshot
        has = {
            "received": lambda: len(received),
            "failed": lambda: counter().get("jtcp.accept_failed", 0),
        }.get(what, lambda: int(count))
        end = time.monotonic() + 20
        while has() < int(count) and time.monotonic() < end:
            time.sleep(0.002)
        print(json.dumps({"received": len(received), **counter()}), flush=True)
    transport.close()
"""


class Limited:
    """A process that may have few descriptors."""

    def __init__(self, folder: Path, limit: int) -> None:
        self.port, self._log, self._held = ports.free_port(), folder / "log", ExitStack()
        line = [sys.executable, "-c", LIMITED, str(self.port), str(limit)]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True, "bufsize": 1}
        errors = self._held.enter_context(self._log.open("w"))
        self._process = self._held.enter_context(subprocess.Popen(line, stderr=errors, **pipes))
        assert self._process.stdout.readline() == "runs\n"

    @property
    def log(self) -> str:
        return self._log.read_text(encoding="utf-8")

    def connect(self, host: str = "127.0.0.1") -> socket.socket:
        made = socket.create_connection(("127.0.0.1", self.port), 5, (host, 0))
        return self._held.enter_context(made)

    def ask(self, what: str, count: int = 0) -> dict[str, int]:
        """Has it do or wait for something; returns its counters."""
        self._process.stdin.write(f"{what} {count}\n")
        return json.loads(self._process.stdout.readline())

    def close(self) -> None:
        self._process.stdin.close()
        assert self._process.wait(20) == 0
        self._held.close()


@pytest.fixture
def limited(tmp_path: Path) -> Iterator[Callable[[int], Limited]]:
    with ExitStack() as held:
        yield lambda limit: held.enter_context(contextlib.closing(Limited(tmp_path, limit)))


class TestStream:
    @pytest.mark.parametrize("is_prepared", [False, True])
    def test_the_version_goes_once_and_messages_follow(self, tcp, host, is_prepared):
        here = tcp(address_book={PEER: host.endpoint}).attach(DRIVER)
        send = partial(here.transport.send, DRIVER, PEER, priority=Priority.HIGH)
        if is_prepared:
            send = here.transport.sender(DRIVER, PEER, Priority.HIGH)
        for number in range(3):
            send(STATUS + bytes([number]))
        stream = host.accept()
        assert stream.read(1) == b"\x02"
        packets = [stream.receive() for _ in range(3)]
        first = packets[0].sequence
        assert packets == [
            Packet(PEER, DRIVER, STATUS + bytes([count]), first + count & 0xFFFF, Priority.HIGH)
            for count in range(3)
        ]

    def test_a_peer_that_connects_is_answered_over_its_connection(self, tcp, host):
        here = tcp().attach(DRIVER, SENSOR)
        stream = host.connect(here, from_peer() + from_peer(sequence=2, destination=SENSOR))
        wait_until(lambda: len(here.received) == 2)
        assert [own for own, _ in here.received] == [DRIVER, SENSOR]
        here.transport.send(SENSOR, PEER, STATUS)
        assert stream.read(1) == b"\x02"
        assert stream.receive().source == SENSOR

    def test_a_broadcast_with_all_flags_set_is_no_announcement(self, tcp, host):
        here = tcp().attach(DRIVER)
        data = bytearray(from_peer(destination=BROADCAST))
        data[3] = 0xFF
        host.connect(here, data)
        wait_until(lambda: here.received)
        assert here.counter("transport.flagless") == 1
        assert here.counter("jtcp.present") == 0

    @pytest.mark.parametrize("size", [4079, 4080, 300_001])
    def test_large_messages_arrive_whole(self, tcp, free_port, size):
        there = tcp().attach(OCU)
        here = tcp(port=ports.free_port(), address_book={OCU: ("127.0.0.1", free_port)}).attach(
            DRIVER
        )
        payload = random.Random(size).randbytes(size)
        assert here.result(DRIVER, OCU, payload, acknowledge=True) is True
        wait_until(lambda: there.received)
        assert there.payloads == [payload]

    def test_chunks_are_those_of_datagrams(self, tcp, host):
        here = tcp(address_book={PEER: host.endpoint}).attach(DRIVER)
        here.transport.send(DRIVER, PEER, bytes(5000))
        stream = host.accept()
        stream.read(1)
        packets = [stream.receive() for _ in range(2)]
        assert [len(packet.payload) for packet in packets] == [4079, 921]
        assert [packet.data_flags for packet in packets] == [DataFlags.FIRST, DataFlags.LAST]

    def test_a_request_for_acknowledgement_is_answered_and_none_is_made(self, tcp, host):
        here = tcp().attach(DRIVER)
        stream = host.connect(here, from_peer(sequence=9, acknowledge=AckNak.REQUESTED))
        stream.read(1)
        assert stream.receive() == Packet(PEER, DRIVER, b"", 9, acknowledge=AckNak.ACK)
        results = here.send(DRIVER, PEER, STATUS, acknowledge=True)
        packet = stream.receive()
        assert packet.acknowledge is AckNak.NONE
        stream.send(from_peer(b"", packet.sequence, acknowledge=AckNak.ACK))
        wait_until(lambda: here.counter("transport.unmatched_acknowledgement") == 1)
        assert results == [True]


class TestWildcards:
    def test_every_peer_and_the_own_components_but_not_the_sender(self, tcp, host):
        known = Host()
        here = tcp(address_book={OCU: known.endpoint}).attach(DRIVER, SENSOR)
        stream = host.meet(here)
        here.transport.send(DRIVER, BROADCAST, STATUS + b"all")
        for receiving_stream in (stream, known.accept()):
            receiving_stream.read(1)
            packet = receiving_stream.receive()
            assert (packet.destination, packet.broadcast) == (BROADCAST, Broadcast.GLOBAL)
        wait_until(lambda: len(here.received) == 2)
        assert here.received[1][0] == SENSOR
        known.close()

    def test_nobody_to_send_to_is_no_failure_worth_a_warning(self, tcp):
        here = tcp()
        here.transport.send(DRIVER, BROADCAST, STATUS)
        wait_until(lambda: here.counter("jtcp.nobody_connected") == 1)
        assert here.loop.counters.drops() == {}


class TestBadStreams:
    @pytest.mark.parametrize(
        ("data", "counter"),
        [
            (b"\x03" + from_peer(), "jtcp.bad_version"),
            (b"GET / HTTP/1.1\r\n\r\n", "jtcp.bad_version"),
            (b"\x02" + bytes(14), "jtcp.bad_size"),
            (b"\x02" + from_peer() + b"\x00\x0d\x00", "jtcp.bad_size"),
        ],
    )
    def test_it_is_closed_and_counted(self, tcp, host, data, counter):
        here = tcp().attach(DRIVER)
        stream = host.connect(here)
        stream.send(data)
        assert stream.is_closed()
        wait_until(lambda: here.counter(counter) == 1)
        host.connect(here, from_peer(sequence=2))
        wait_until(lambda: STATUS in here.payloads)

    def test_an_end_within_a_message_is_counted(self, tcp, host):
        here = tcp().attach(DRIVER)
        stream = host.connect(here, from_peer()[:-1])
        stream.socket.shutdown(socket.SHUT_WR)
        wait_until(lambda: here.counter("jtcp.truncated") == 1)
        assert not here.received

    def test_messages_that_cannot_be_used_are_counted_and_the_stream_goes_on(self, tcp, host):
        here = tcp().attach(DRIVER)
        bad = [
            from_peer(message_type=7),
            from_peer(destination=OCU),
            Packet(DRIVER, BROADCAST, STATUS).encode()[1:],
            Packet(OCU, DRIVER, STATUS).encode()[1:],
            from_peer(b""),
        ]
        host.connect(here, b"".join(bad) + from_peer(sequence=3))
        wait_until(lambda: here.received)
        assert here.payloads == [STATUS]
        names = ("bad_message_type", "not_for_us", "bad_source", "own_source", "no_message_code")
        for name in names:
            assert here.counter(f"transport.{name}") == 1

    @pytest.fixture
    def filled(self, tcp, host):
        """A transport with as many connections as it may have, and these: all of one host."""
        here = tcp(max_connections=4).attach(DRIVER)
        streams = [host.connect(here, from_peer(sequence=number)) for number in range(4)]
        wait_until(lambda: len(here.received) == 4)
        return here, streams

    def test_connections_are_bounded(self, filled, host):
        here, streams = filled
        assert host.connect(here).is_closed()
        wait_until(lambda: here.counter("jtcp.too_many_connections") == 1)
        streams[1].send(from_peer(sequence=9))
        wait_until(lambda: len(here.received) == 5)

    def test_silent_connections_shut_nobody_out(self, tcp, host):
        here = tcp(max_connections=4).attach(DRIVER)
        honest = host.meet(here)
        silent = [host.connect(here) for _ in range(20)]
        silent[0].send(b"\x02\xff\xff")  # half a header
        wait_until(lambda: here.counter("jtcp.gave_way") == 17)
        host.connect(here, from_peer(sequence=2))
        wait_until(lambda: len(here.received) == 2)
        honest.send(from_peer(sequence=3))
        wait_until(lambda: len(here.received) == 3)

    def test_another_host_gets_a_connection_of_the_one_that_has_most(self, filled):
        here, streams = filled
        with socket.create_connection(here.transport.endpoint, 5, ("127.0.0.9", 0)) as other:
            other.sendall(b"\x02" + from_peer(sequence=9))
            wait_until(lambda: len(here.received) == 5)
        assert streams[-1].is_closed()
        assert here.counter("jtcp.gave_way") == 1

    def test_a_connection_that_nothing_comes_by_ends(self, tcp, host):
        here = tcp(idle_timeout=0.2).attach(DRIVER)
        honest = host.connect(here, from_peer())
        silent = host.connect(here)
        silent.send(b"\x02\xff\xff")
        wait_until(lambda: here.counter("jtcp.never_spoke") == 1)
        assert silent.is_closed()
        honest.send(from_peer(sequence=2))
        wait_until(lambda: len(here.received) == 2)

    def test_the_descriptors_of_the_process_bound_connections(self, limited):
        process = limited(70)
        assert (
            "may have 70 descriptors (ulimit -n): 6 TCP connections instead of 256" in process.log
        )
        for number in range(6):
            process.connect().sendall(b"\x02" + from_peer(sequence=number))
        process.ask("received", 6)
        assert Stream(process.connect()).is_closed()
        # Who is in the address book has a place all the same.
        process.connect("127.0.0.9").sendall(b"\x02" + from_peer(sequence=20))
        counts = process.ask("received", 7)
        assert (counts["jtcp.too_many_connections"], counts["jtcp.gave_way"]) == (1, 1)

    def test_a_listener_rests_while_there_are_no_descriptors(self, limited):
        process = limited(100)
        used = process.connect()
        used.sendall(b"\x02" + from_peer(sequence=1))
        process.ask("received", 1)
        process.ask("fill")
        process.connect().sendall(b"\x02" + from_peer(sequence=2))
        process.ask("failed", 2)
        used.sendall(from_peer(sequence=3))
        process.ask("received", 2)
        process.ask("free")
        counts = process.ask("received", 3)
        assert counts["received"] == 3
        # Without a rest it fails some thousand times between two questions.
        assert counts["jtcp.accept_failed"] < 50

    @pytest.mark.parametrize("fixed", [False, True])
    def test_invented_names_push_out_those_of_their_connection(self, tcp, host, fixed):
        here = tcp(max_peers=16, fixed_sources=fixed).attach(DRIVER)
        honest, other = (host.connect(here) for _ in range(2))
        honest.send(b"\x02" + from_peer())
        wait_until(lambda: here.received)
        invented = [
            Packet(DRIVER, JausAddress(1000 + number, 1, 1), STATUS, number).encode()[1:]
            for number in range(100)
        ]
        other.send(b"\x02" + b"".join(invented))
        wait_until(lambda: len(here.received) == 101)
        results = here.send(DRIVER, PEER, STATUS)
        wait_until(lambda: results == [True])
        assert here.counter("transport.source_refused") == 0

    def test_a_peer_that_takes_nothing_costs_no_more_than_the_buffer(self, tcp, host):
        here = tcp(send_buffer=50_000, connection_timeout=0.3).attach(DRIVER)
        host.meet(here)
        results: list[list[bool]] = []

        def is_full() -> bool:
            results.append(here.send(DRIVER, PEER, bytes(20_000)))
            return here.counter("jtcp.buffer_full") > 0

        wait_until(is_full)
        wait_until(lambda: here.counter("jtcp.stalled") == 1)
        wait_until(lambda: here.counter("jtcp.unsent") == 1)
        assert [False] in results
        here.transport.send(DRIVER, PEER, STATUS)
        wait_until(lambda: here.counter("jtcp.not_connected") == 1)


VANISHING = """
import socket, subprocess
from jausml.runtime.base.loop import Loop
from jausml.runtime.transports import tcp_connection

tcp_connection._VANISHED_S = 1
with socket.create_server(("127.0.0.1", 0)) as server, Loop() as loop:
    place, closed = server.getsockname(), []
    connection = tcp_connection.TcpConnection(
        tcp_connection.connect(place), place, loop, connecting=True, buffer=1000, timeout=60.0,
        idle=0.0, on_packet=print, on_close=closed.append,
    )
    peer, _ = server.accept()
    while not connection.is_connected:
        loop.run_once(0.1)
    subprocess.run(["ip", "link", "set", "lo", "down"], check=True)
    connection.write(b"hello")
    while not closed:
        loop.run_once(0.1)
    print(loop.counters.snapshot())
"""


class TestConnecting:
    @pytest.mark.needs("namespaces of networks")
    def test_a_peer_that_vanishes_while_it_is_sent_to_is_noticed(self):
        host = NetworkHost("127.0.0.1")
        try:
            assert host.run(sys.executable, "-c", VANISHING) == "{'jtcp.lost': 1}\n"
        finally:
            host.close()

    @pytest.mark.parametrize(
        ("is_known", "counter"), [(True, "jtcp.connect_failed"), (False, "jtcp.not_connected")]
    )
    def test_who_refuses_or_is_unknown_is_reported(self, tcp, is_known, counter):
        nobody = ("127.0.0.1", ports.free_port())
        here = tcp(address_book={PEER: nobody} if is_known else {})
        assert here.result(DRIVER, PEER, STATUS) is False
        assert here.counter(counter) >= 1

    def test_a_peer_that_does_not_answer_is_given_up(self, tcp):
        with contextlib.ExitStack() as stack:
            full = stack.enter_context(socket.socket())
            full.bind(("127.0.0.1", 0))
            full.listen(0)
            for _ in range(3):  # a full backlog leaves the next one without an answer
                waiting = stack.enter_context(socket.socket())
                waiting.setblocking(False)
                waiting.connect_ex(full.getsockname())
            here = tcp(address_book={PEER: full.getsockname()}, connection_timeout=0.1)
            assert here.result(DRIVER, PEER, STATUS) is False
            assert here.counter("jtcp.connect_failed") >= 1

    def test_a_lost_connection_is_made_again(self, tcp, host):
        here = tcp(address_book={PEER: host.endpoint}).attach(DRIVER)
        here.transport.send(DRIVER, PEER, STATUS)
        first = host.accept()
        first.read(1)
        first.receive()
        first.close()
        second = host.accept()
        assert second.read(1) == b"\x02"
        here.transport.send(DRIVER, PEER, STATUS + b"again")
        assert second.receive().payload == STATUS + b"again"

    def test_attempts_become_seldom(self, tcp, monkeypatch):
        monkeypatch.setattr(jtcp, "_FIRST_PAUSE_S", 0.01)
        here = tcp(address_book={PEER: ("127.0.0.1", ports.free_port())})
        here.transport.send(DRIVER, PEER, STATUS)
        wait_until(lambda: here.counter("jtcp.connect_failed") >= 4)
        (line,) = here.transport._lines.values()
        assert line.pause >= 0.01 * 2**3
        assert here.loop.counters.snapshot()["jtcp.connect_failed"] < 20

    def test_the_newest_connection_of_a_component_is_used(self, tcp, host):
        here = tcp().attach(DRIVER)
        streams = [host.connect(here) for _ in range(2)]
        for sequence, stream in enumerate(streams):
            stream.send(b"\x02" + from_peer(sequence=sequence))
            wait_until(lambda count=sequence + 1: len(here.received) == count)
        here.transport.send(DRIVER, PEER, STATUS)
        streams[1].read(1)
        assert streams[1].receive().payload == STATUS
        assert here.counter("transport.address_changed") == 1


class TestSharedPort:
    @pytest.fixture
    def three(self, tcp):
        """The owner of a port and two others that share it, of a component each."""
        stations = [tcp().attach(address) for address in (DRIVER, SENSOR, OCU)]
        wait_until(lambda: stations[0].counter("jtcp.present") == 2)
        return stations

    def test_processes_of_a_host_reach_each_other_and_the_world(self, three, host):
        owner, first, second = three
        assert first.transport.endpoint is None
        first.transport.send(SENSOR, OCU, STATUS + b"relayed")
        first.transport.send(SENSOR, DRIVER, STATUS + b"direct")
        owner.transport.send(DRIVER, OCU, STATUS + b"out")
        wait_until(lambda: len(second.received) == 2 and owner.received)
        assert sorted(second.payloads) == [STATUS + b"out", STATUS + b"relayed"]
        stream = host.connect(owner, from_peer(destination=SENSOR))
        wait_until(lambda: first.received)
        first.transport.send(SENSOR, PEER, STATUS)
        stream.read(1)
        while (packet := stream.receive()).acknowledge is AckNak.ACK:
            pass
        assert (packet.source, packet.destination) == (SENSOR, PEER)

    def test_a_broadcast_reaches_each_once(self, three, host):
        owner, first, second = three
        first.transport.send(SENSOR, BROADCAST, STATUS)
        wait_until(lambda: owner.received and second.received)
        host.connect(owner, from_peer(STATUS + b"2", destination=BROADCAST))
        for station in (owner, first, second):
            wait_until(lambda each=station: STATUS + b"2" in each.payloads)
        assert [len(station.received) for station in (owner, first, second)] == [2, 1, 2]

    def test_a_broadcast_that_comes_by_two_ways_arrives_once_and_changes_no_route(self, tcp):
        port = ports.free_port()
        far = tcp(port=port).attach(PEER)
        owner, first = (
            tcp(address_book={PEER: ("127.0.0.1", port)}).attach(address)
            for address in (DRIVER, SENSOR)
        )
        owner.transport.send(DRIVER, PEER, STATUS)
        first.transport.send(SENSOR, PEER, STATUS)
        wait_until(lambda: len(far.received) == 2 and owner.counter("jtcp.present"))
        for count in range(3):
            first.transport.send(SENSOR, BROADCAST, STATUS + bytes([count]))
        wait_until(lambda: far.counter("transport.duplicate") == 3)
        assert len(far.received) == 5
        assert far.counter("transport.address_changed") == 0

    def test_another_process_takes_over(self, three):
        owner, first, second = three
        endpoint = owner.transport.endpoint
        owner.close()
        wait_until(lambda: endpoint in (first.transport.endpoint, second.transport.endpoint))
        new = first if first.transport.endpoint else second
        wait_until(lambda: new.counter("jtcp.present") >= 1)
        first.transport.send(SENSOR, OCU, STATUS)
        wait_until(lambda: second.received)


class TestThreads:
    def test_messages_of_many_threads_all_arrive_with_their_own_number(self, tcp, free_port):
        there = tcp().attach(OCU)
        here = tcp(port=ports.free_port(), address_book={OCU: ("127.0.0.1", free_port)}).attach(
            DRIVER
        )

        def work(index: int) -> None:
            for count in range(50):
                here.transport.send(DRIVER, OCU, bytes([2, 64, index, count]))

        in_threads(work)
        wait_until(lambda: len(there.received) == 200)
        assert len({message.sequence for _, message in there.received}) == 200

    def test_what_was_sent_before_closing_arrives(self, tcp, host):
        here = tcp().attach(DRIVER)
        stream = host.meet(here)
        with here.loop.lock:
            here.transport.send(DRIVER, PEER, STATUS + b"farewell")
            here.transport.close()
        stream.read(1)
        assert stream.receive().payload == STATUS + b"farewell"

    def test_closing_reports_what_still_waits(self, tcp, host):
        here = tcp(address_book={PEER: host.endpoint})
        with here.loop.lock:
            results = here.send(DRIVER, PEER, bytes(20_000_000))
        host.accept()
        here.transport.close()
        wait_until(lambda: results)
        assert results == [False]


MESSAGES = st.lists(
    st.builds(from_peer, st.binary(max_size=40), st.integers(0, 65535)), max_size=6
).map(b"".join)


def read(chunks: list[bytes]) -> tuple[list[Packet | None], str]:
    """Returns what a stream holds and how it ends."""
    reader, packets = StreamReader(Counters()), []
    try:
        for chunk in chunks:
            packets += reader.feed(chunk)
    except StreamError as error:
        return packets, error.counter
    assert reader.pending < 65536
    return packets, "more may come"


@given(st.one_of(st.binary(), MESSAGES), st.binary(max_size=4), st.lists(st.integers(1, 30)))
def test_any_stream_is_read_the_same_however_it_is_cut(data, damage, cuts):
    data = b"\x02" + data + damage + data
    chunks, rest = [], data
    for size in cuts:
        chunks.append(rest[:size])
        rest = rest[size:]
    whole, end = read([data])
    parts, same_end = read([*chunks, rest])
    assert (parts, same_end) == (whole, end)

"""Real sockets on loopback, and processes, for the tests of the runtime."""

import os
import queue
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import ports
import pytest

from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.component.process import create_transport
from jausml.runtime.transports.packets.packet import Packet, parse_datagram

ROOT = Path(__file__).parents[2]
GROUP = "239.255.0.1"
LOOPBACK = "127.0.0.1"


def wait_until(condition: Callable[[], object], seconds: float = 10.0) -> None:
    """Returns when the condition holds; fails when it does not in time."""
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "the condition did not come true in time"
        time.sleep(0.002)


def reports_of(component: Any, target: Any, query: Any, report_class: Any, **options: Any) -> list:
    """Subscribes to reports; returns where they will stand."""
    reports: list = []
    component.subscribe(
        target, query, report_class, lambda report, _sender: reports.append(report), **options
    )
    return reports


class Received(NamedTuple):
    """A message as a component gets it."""

    source: JausAddress
    payload: bytes
    sequence: int | None


class Station:
    """A transport on its own loop that records what each of its components receives."""

    def __init__(self, settings: TransportSettings) -> None:
        self.loop = Loop()
        self.transport = create_transport(settings, self.loop)
        self.received: list[tuple[JausAddress, Received]] = []
        self.transport.open()
        self.loop.start()

    def attach(self, *addresses: JausAddress):
        for address in addresses:
            self.transport.attach(address, partial(self._take, address))
        return self

    def _take(self, own: JausAddress, payload: bytes, source: JausAddress) -> None:
        inbox = self.transport._messenger_of(own).inbox
        message = Received(source, payload, inbox.arrival.number)
        self.received.append((own, message))

    def send(self, *message: object, **options: object) -> list[bool]:
        """Sends a message; its result will stand in the list."""
        results: list[bool] = []
        self.transport.send(*message, on_result=results.append, **options)
        return results

    def result(self, *message: object, **options: object) -> bool:
        """Sends a message and waits for its result, of which there is one."""
        results = self.send(*message, **options)
        wait_until(lambda: results)
        (result,) = results
        return result

    @property
    def payloads(self) -> list[bytes]:
        return [message.payload for _, message in list(self.received)]

    def counter(self, name: str) -> int:
        return self.loop.counters.snapshot().get(name, 0)

    def close(self) -> None:
        self.transport.close()
        self.loop.stop()


class Peer:
    """A foreign stack: bare sockets, datagrams made and read by hand."""

    def __init__(self, port: int) -> None:
        self.port = port
        self.unicast = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.unicast.bind((LOOPBACK, 0))
        interface = socket.inet_aton(LOOPBACK)
        self.unicast.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, interface)
        self.multicast = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.multicast.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.multicast.bind((GROUP, port))
        self.multicast.setsockopt(
            socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(GROUP) + interface
        )
        self.counters = Counters()
        self.answered_from = ("", 0)

    @property
    def endpoint(self) -> tuple[str, int]:
        return self.unicast.getsockname()

    def send(self, packet: Packet | bytes, endpoint: tuple[str, int] | None = None) -> None:
        data = packet if isinstance(packet, bytes) else packet.encode()
        self.unicast.sendto(data, endpoint or (LOOPBACK, self.port))

    def multicast_out(self, packet: Packet) -> None:
        self.send(packet, (GROUP, self.port))

    def receive(self, seconds: float = 5.0) -> Packet:
        """Returns the next unicast packet; fails after the time."""
        return self._next(self.unicast, seconds)

    def overhear(self, seconds: float = 5.0) -> Packet:
        """Returns the next multicast packet of someone else."""
        return self._next(self.multicast, seconds)

    def _next(self, sock: socket.socket, seconds: float) -> Packet:
        sock.settimeout(seconds)
        data, sender = sock.recvfrom(65535)
        while sender == self.endpoint:
            data, sender = sock.recvfrom(65535)
        self.answered_from = sender
        (packet,) = parse_datagram(data, self.counters)
        return packet

    def is_quiet(self, seconds: float = 0.05) -> bool:
        """Returns whether nothing arrives by unicast for a moment."""
        self.unicast.settimeout(seconds)
        try:
            self.unicast.recvfrom(65535)
        except TimeoutError:
            return True
        return False

    def close(self) -> None:
        self.unicast.close()
        self.multicast.close()


class Program:
    """A running program of Python, the lines that it writes, and what it logs."""

    def __init__(self, *command: object) -> None:
        self.running = subprocess.Popen(
            [sys.executable, *map(str, command)],
            cwd=ROOT,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            bufsize=1,
        )
        self.log = ""
        self._lines: queue.Queue[str] = queue.Queue()
        self._readers = [threading.Thread(target=read) for read in (self._read, self._read_log)]
        for reader in self._readers:
            reader.start()

    def _read(self) -> None:
        for line in self.running.stdout:
            self._lines.put(line.strip())

    def _read_log(self) -> None:
        for line in self.running.stderr:
            self.log += line

    def tell(self, line: str) -> None:
        self.running.stdin.write(f"{line}\n")

    def expect(self, start: str, seconds: float = 20.0) -> str:
        """Returns the next line that starts so; fails after the time."""
        while True:
            line = self._lines.get(timeout=seconds)
            if line.startswith(start):
                return line

    def end(self, number: int = 0) -> int:
        """Waits for the end, after a signal if one is named; returns the exit code."""
        if number:
            self.running.send_signal(number)
        code = self.running.wait(20)
        for reader in self._readers:
            reader.join()
        for pipe in (self.running.stdin, self.running.stdout, self.running.stderr):
            pipe.close()
        return code

    def kill(self) -> None:
        if not self.running.stdout.closed:
            self.end(signal.SIGKILL if self.running.poll() is None else 0)


@pytest.fixture
def start() -> Iterator[Callable[..., Program]]:
    """Starts programs; all are killed in the end."""
    started: list[Program] = []

    def make(*command: object, kind: type[Program] = Program) -> Program:
        started.append(kind(*command))
        return started[-1]

    yield make
    for program in started:
        program.kill()


@pytest.fixture
def free_port() -> int:
    """A UDP port of loopback that nobody uses."""
    return ports.free_port()


@pytest.fixture
def station(free_port: int) -> Iterator[Callable[..., Station]]:
    """Makes running transports on one free port, with settings by keyword."""
    stations: list[Station] = []

    def make(**settings: object):
        stations.append(Station(TransportSettings(**{"port": free_port, **settings})))
        return stations[-1]

    yield make
    for made in stations:
        made.close()


@pytest.fixture
def peer(free_port: int) -> Iterator[Peer]:
    """A foreign stack on the same port."""
    made = Peer(free_port)
    yield made
    made.close()


class FakeClock:
    """A clock that only moves when told."""

    def __init__(self) -> None:
        self.time = 1000.0

    def __call__(self) -> float:
        return self.time


@pytest.fixture
def clock() -> FakeClock:
    """A clock that only moves when told."""
    return FakeClock()

"""A round trip between two JAUS components in two processes, beside one of raw datagrams."""

from __future__ import annotations

import gc
import random
import threading
import time
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ends import LOOPBACK, free_port, udp_socket, wait_until
from figures import Blocks
from hosts import HOSTED, component
from processes import Children
from systems import Measured, generate
from variants import PATIENCE, UnreachableError

from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.messages import QueryStatus, ReportStatus
from jausml.runtime.transports.udp.judp import JudpTransport

if TYPE_CHECKING:
    from scale import Scale

HERE = Path(__file__).resolve().parent
CLIENT = JausAddress(1, 3, 1)
DATAGRAMS, MESSAGES, QUERIES = "datagrams", "messages", "queries"
_COUNT = 2000
_BLOCKS = 10
_PAUSE = 0.001


class _Client:
    """The component that begins the round trips."""

    def __init__(self, port: int) -> None:
        self._loop = Loop()
        settings = TransportSettings(port=free_port(), address_book={HOSTED: (LOOPBACK, port)})
        self.transport = JudpTransport(settings, self._loop)
        self.transport.open()
        self._component = component(self.transport, CLIENT)
        self._component.on_message(ReportStatus, self._came)
        self._component.start()
        self._loop.start()
        self._event = threading.Event()
        self._arrived = 0
        self._message = ReportStatus(1, 0)

    def message(self) -> float | None:
        """Sends a message that comes back; microseconds."""
        return self._until_came(lambda: self._component.send(self._message, HOSTED))

    def query(self) -> float | None:
        """Asks for the status; microseconds."""
        return self._until_came(
            lambda: self._component.query(HOSTED, QueryStatus(), ReportStatus, self._came)
        )

    def _until_came(self, send: Any) -> float | None:
        self._event.clear()
        started = time.perf_counter_ns()
        send()
        return (self._arrived - started) / 1e3 if self._event.wait(1.0) else None

    def _came(self, *_: object) -> None:
        self._arrived = time.perf_counter_ns()
        self._event.set()

    def close(self) -> None:
        """Leaves the network."""
        self._component.stop()
        self._loop.stop()
        self.transport.close()


def measure(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures round trips of datagrams, of messages that handlers exchange, and of queries.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        Figures by what goes round, in microseconds; ratios are to datagrams.
    """
    environment = generate(folder, {"one": Measured(("point",))}).environment()
    with Children(environment, folder / "processes.log") as children:
        ports = free_port(), free_port()
        children.start(HERE / "hosts.py", "components", str(ports[0]), "1")
        children.start(HERE / "hosts.py", "echo", str(ports[1]))
        with closing(_Client(ports[0])) as client, closing(udp_socket(timeout=1.0)) as sock:
            target = (LOOPBACK, ports[1])
            # As long as the message of the components with its header.
            data = bytes(22)

            def datagram() -> float | None:
                started = time.perf_counter_ns()
                sock.sendto(data, target)
                try:
                    sock.recv(2048)
                except BlockingIOError:
                    return None
                return (time.perf_counter_ns() - started) / 1e3

            trips = {DATAGRAMS: datagram, MESSAGES: client.message, QUERIES: client.query}
            for name, trip in trips.items():
                if not wait_until(lambda trip=trip: trip() is not None, PATIENCE):
                    raise UnreachableError(f"no {name} come back")
            return _by_turns(scale, trips)


def _by_turns(scale: Scale, trips: dict[str, Any]) -> dict[str, Any]:
    blocks = Blocks()
    order = list(trips.items())
    count = max(scale.count(_COUNT) // _BLOCKS, 5)
    gc.disable()
    for _ in range(scale.count(_BLOCKS, 2)):
        blocks.begin()
        random.shuffle(order)
        for name, trip in order:
            trip()
            for _ in range(count):
                time.sleep(_PAUSE)
                blocks.add(name, trip())
    gc.enable()
    return blocks.summary(against=DATAGRAMS)

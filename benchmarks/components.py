"""Round trips between two JAUS components in two processes, beside ones of raw datagrams.

Each is begun by the thread that receives, as a handler or a timer of a component begins what it
does.
"""

from __future__ import annotations

import gc
import random
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack, closing
from functools import partial
from pathlib import Path
from typing import Any

from ends import LOOPBACK, free_port, udp_socket, wait_until
from figures import Blocks
from hosts import HOSTED, component
from processes import Children
from scale import Scale
from systems import Measured, generate
from variants import PATIENCE, UnreachableError

from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.messages import ReportStatus
from jausml.runtime.transports.udp.judp import JudpTransport

Trips = Callable[[int], list[float | None]]
"""Makes so many round trips, a pause before each; microseconds, None for what was lost."""

HERE = Path(__file__).resolve().parent
DATAGRAMS, MESSAGES = "datagrams", "messages"
_COUNT = 2000
_BLOCKS = 10
_PAUSE = 0.001
_LOST_AFTER = 1.0
_SIZE = 22
"""Bytes of a message of the components with its header."""


class _Datagrams:
    """Raw datagrams to a process that sends them back."""

    def __init__(self, port: int) -> None:
        """Opens a socket (`port`: that of the process)."""
        self._target = (LOOPBACK, port)
        self._sock = udp_socket(timeout=_LOST_AFTER)
        self._data = bytes(_SIZE)

    def __call__(self, count: int) -> list[float | None]:
        """Makes round trips."""
        durations = []
        for _ in range(count):
            time.sleep(_PAUSE)
            durations.append(self._trip())
        return durations

    def close(self) -> None:
        """Closes the socket."""
        self._sock.close()

    def _trip(self) -> float | None:
        started = time.perf_counter_ns()
        self._sock.sendto(self._data, self._target)
        try:
            self._sock.recv(2048)
        except BlockingIOError:
            return None
        return (time.perf_counter_ns() - started) / 1e3


class _Rounds:
    """Round trips of a component, one a pause after the other."""

    def __init__(self, loop: Loop, send: Callable[[], object]) -> None:
        """Begins none (`send`: sends what comes back to `came`)."""
        self._loop = loop
        self._send = send
        self._durations: list[float | None] = []
        self._wanted = 0
        self._started = 0
        self._all = threading.Event()

    def __call__(self, count: int) -> list[float | None]:
        """Makes round trips."""
        self._durations, self._wanted = [], count
        self._all.clear()
        self._plan()
        self._watch()
        return self._durations

    def came(self, *_: object) -> None:
        """Ends a round trip."""
        self._note((time.perf_counter_ns() - self._started) / 1e3)

    def _watch(self) -> None:
        """Waits for all, and for none longer than it can take."""
        known = -1
        while not self._all.wait(_LOST_AFTER):
            if len(self._durations) == known:
                self._loop.call_soon(partial(self._note, None))
            known = len(self._durations)

    def _plan(self) -> None:
        self._loop.call_later(_PAUSE, self._begin)

    def _begin(self) -> None:
        self._started = time.perf_counter_ns()
        self._send()

    def _note(self, value: float | None) -> None:
        self._durations.append(value)
        if len(self._durations) >= self._wanted:
            self._all.set()
        else:
            self._plan()


class _Client:
    """A component that begins round trips; each side takes messages in a handler."""

    def __init__(self, port: int) -> None:
        self._loop = Loop()
        settings = TransportSettings(port=free_port(), address_book={HOSTED: (LOOPBACK, port)})
        self._transport = JudpTransport(settings, self._loop)
        self._transport.open()
        self._component = component(self._transport, JausAddress(1, 3, 1))
        send = partial(self._component.send, ReportStatus(1, 0), HOSTED)
        self.trips = _Rounds(self._loop, send)
        self._component.on_message(ReportStatus, self.trips.came)
        self._component.start()
        self._loop.start()

    def close(self) -> None:
        """Leaves the network."""
        self._component.stop()
        self._loop.stop()
        self._transport.close()


def measure(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures round trips of datagrams, and of messages that handlers exchange.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        Figures by what goes round, in microseconds; ratios are to datagrams.
    """
    environment = generate(folder, {"one": Measured(("point",))}).environment()
    with Children(environment, folder / "processes.log") as children, ExitStack() as opened:
        ports = free_port(), free_port()
        children.start(HERE / "hosts.py", "components", str(ports[0]), "1")
        children.start(HERE / "hosts.py", "echo", str(ports[1]))
        client = opened.enter_context(closing(_Client(ports[0])))
        trips: dict[str, Trips] = {
            DATAGRAMS: opened.enter_context(closing(_Datagrams(ports[1]))),
            MESSAGES: client.trips,
        }
        for name, trip in trips.items():
            if not wait_until(lambda trip=trip: trip(1) != [None], PATIENCE):
                raise UnreachableError(f"no {name} come back")
        return _by_turns(scale, trips)


def _by_turns(scale: Scale, trips: dict[str, Trips]) -> dict[str, Any]:
    blocks = Blocks()
    order = list(trips.items())
    count = max(scale.count(_COUNT) // _BLOCKS, 5)
    gc.disable()
    for _ in range(scale.count(_BLOCKS, 2)):
        blocks.begin()
        random.shuffle(order)
        for name, trip in order:
            _, *durations = trip(count + 1)
            for duration in durations:
                blocks.add(name, duration)
    gc.enable()
    return blocks.summary(against=DATAGRAMS)

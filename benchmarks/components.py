"""Round trips between two JAUS components in two processes, beside ones of raw datagrams.

Each is begun by the thread that receives, as a handler or a timer of a component begins what it
does. What another thread begins is measured as well: that one still runs when the answer is made.
"""

from __future__ import annotations

import gc
import os
import random
import select
import socket
import threading
import time
from contextlib import ExitStack, closing
from functools import partial
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
    from collections.abc import Callable

    from scale import Scale

    from jausml.runtime import JausComponent

    Trips = Callable[[int], list[float | None]]
    """Makes so many round trips, a pause before each; microseconds, None for what was lost."""

HERE = Path(__file__).resolve().parent
DATAGRAMS, WAITED, MESSAGES, QUERIES, THREADED = (
    "datagrams",
    "datagrams, epoll",
    "messages",
    "queries",
    "messages, another thread",
)
_COUNT = 2000
_BLOCKS = 10
_PAUSE = 0.001
_LOST_AFTER = 1.0
_SIZE = 22
"""Bytes of a message of the components with its header."""


class _Datagrams:
    """Raw datagrams to a process that sends them back."""

    def __init__(self, port: int, *, waits: bool) -> None:
        """Opens a socket.

        Args:
            port: Port of the process.
            waits: Whether a socket that does not block is waited for, as a loop does it.
        """
        self._target = (LOOPBACK, port)
        self._sock = udp_socket(timeout=_LOST_AFTER)
        self._poll = select.epoll()
        self._poll.register(self._sock, select.EPOLLIN)
        self._trip = self._waited if waits else self._blocking
        self._data = bytes(_SIZE)

    def __call__(self, count: int) -> list[float | None]:
        """Makes round trips."""
        found = []
        for _ in range(count):
            time.sleep(_PAUSE)
            found.append(self._trip())
        return found

    def close(self) -> None:
        """Closes the socket."""
        self._poll.close()
        self._sock.close()

    def _blocking(self) -> float | None:
        started = time.perf_counter_ns()
        self._sock.sendto(self._data, self._target)
        try:
            self._sock.recv(2048)
        except BlockingIOError:
            return None
        return (time.perf_counter_ns() - started) / 1e3

    def _waited(self) -> float | None:
        started = time.perf_counter_ns()
        self._sock.sendto(self._data, self._target)
        self._poll.poll(_LOST_AFTER)
        try:
            self._sock.recv(2048, socket.MSG_DONTWAIT)
        except BlockingIOError:
            return None
        return (time.perf_counter_ns() - started) / 1e3


class _Rounds:
    """Round trips of a component, one a pause after the other."""

    def __init__(self, loop: Loop, send: Callable[[], object], *, by_loop: bool = True) -> None:
        """Begins none.

        Args:
            loop: The loop of the component.
            send: Sends what comes back to `came`.
            by_loop: Whether the thread of the loop begins them, not the one that asks for them.
        """
        self._loop = loop
        self._send = send
        self._by_loop = by_loop
        self._found: list[float | None] = []
        self._wanted = 0
        self._started = 0
        self._one = threading.Event()
        self._all = threading.Event()

    def __call__(self, count: int) -> list[float | None]:
        """Makes round trips."""
        self._found, self._wanted = [], count
        self._all.clear()
        if self._by_loop:
            self._plan()
            self._watch()
            return self._found
        for _ in range(count):
            time.sleep(_PAUSE)
            self._one.clear()
            self._begin()
            if not self._one.wait(_LOST_AFTER):
                self._found.append(None)
        return self._found

    def came(self, *_: object) -> None:
        """Ends a round trip."""
        self._note((time.perf_counter_ns() - self._started) / 1e3)

    def _watch(self) -> None:
        """Waits for all, and for none longer than it can take."""
        known = -1
        while not self._all.wait(_LOST_AFTER):
            if len(self._found) == known:
                self._loop.call_soon(partial(self._note, None))
            known = len(self._found)

    def _plan(self) -> None:
        self._loop.call_later(_PAUSE, self._begin)

    def _begin(self) -> None:
        self._started = time.perf_counter_ns()
        self._send()

    def _note(self, value: float | None) -> None:
        self._found.append(value)
        self._one.set()
        if len(self._found) >= self._wanted:
            self._all.set()
        elif self._by_loop:
            self._plan()


class _Client:
    """Components that begin round trips.

    Attributes:
        trips: What they do, by name.
    """

    def __init__(self, port: int) -> None:
        self._loop = Loop()
        settings = TransportSettings(port=free_port(), address_book={HOSTED: (LOOPBACK, port)})
        self._transport = JudpTransport(settings, self._loop)
        self._transport.open()
        self._components: list[JausComponent] = []
        self.trips: dict[str, Trips] = {
            MESSAGES: self._sending(by_loop=True),
            THREADED: self._sending(by_loop=False),
            QUERIES: self._asking(),
        }
        for each in self._components:
            each.start()
        self._loop.start()

    def close(self) -> None:
        """Leaves the network."""
        for each in self._components:
            each.stop()
        self._loop.stop()
        self._transport.close()

    def _sending(self, *, by_loop: bool) -> Trips:
        """Returns what exchanges messages that each side takes in a handler."""
        sender = self._component()
        rounds = _Rounds(
            self._loop, partial(sender.send, ReportStatus(1, 0), HOSTED), by_loop=by_loop
        )
        sender.on_message(ReportStatus, rounds.came)
        return rounds

    def _asking(self) -> Trips:
        """Returns what asks for the status."""
        asker, query = self._component(), QueryStatus()
        rounds = _Rounds(
            self._loop, lambda: asker.query(HOSTED, query, ReportStatus, rounds.came, retries=0)
        )
        return rounds

    def _component(self) -> JausComponent:
        added = component(self._transport, JausAddress(1, 3, len(self._components) + 1))
        self._components.append(added)
        return added


def measure(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures round trips of datagrams, of messages that handlers exchange, and of queries.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        Figures by what goes round, in microseconds; ratios are to datagrams.
    """
    environment = generate(folder, {"one": Measured(("point",))}).environment()
    with Children(environment, folder / "processes.log") as children, ExitStack() as opened:
        ports = free_port(), free_port(), free_port()
        children.start(HERE / "hosts.py", "components", str(ports[0]), "1")
        children.start(HERE / "hosts.py", "echo", str(ports[1]))
        children.start(HERE / "hosts.py", "waiting-echo", str(ports[2]))
        client = opened.enter_context(closing(_Client(ports[0])))
        trips: dict[str, Trips] = {
            DATAGRAMS: opened.enter_context(closing(_Datagrams(ports[1], waits=False))),
            WAITED: opened.enter_context(closing(_Datagrams(ports[2], waits=True))),
            **client.trips,
        }
        for name, trip in trips.items():
            if not wait_until(lambda trip=trip: trip(1) != [None], PATIENCE):
                raise UnreachableError(f"no {name} come back")
        return _by_turns(scale, trips)


def measure_on_one_processor(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures the same while all processes share one processor, from now on.

    Where a process is woken no other processor has to be, and the figures scatter less.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        Those of `measure`.
    """
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    return measure(scale, folder)


def _by_turns(scale: Scale, trips: dict[str, Trips]) -> dict[str, Any]:
    blocks = Blocks()
    order = list(trips.items())
    count = max(scale.count(_COUNT) // _BLOCKS, 5)
    gc.disable()
    for _ in range(scale.count(_BLOCKS, 2)):
        blocks.begin()
        random.shuffle(order)
        for name, trip in order:
            _, *found = trip(count + 1)
            for each in found:
                blocks.add(name, each)
    gc.enable()
    return blocks.summary(against=DATAGRAMS)

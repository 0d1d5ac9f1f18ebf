"""Datagrams to ROS: a core receives, translates and publishes the usual ones alone.

What each of them changes on its way through Python is written down before anything else runs. Any
other datagram is handed to those who read the socket, as if it had been received here.
"""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, NamedTuple

from ...messages import Event
from .library import TAKEN, Route, host_of, packed_host

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable

    from ...base.fast_path import FastPath
    from ...base.settings import Endpoint
    from ...component.component import JausComponent
    from ...transports.udp.drops import Receiver
    from ...transports.udp.judp import JudpTransport
    from .library import Library, Waited

_ENDS = slice(4, 13)
_CODE = slice(13, 15)
_EVENT = 15
_SHORTEST = 17
_MOST_WITHOUT = 1024


class _Key(NamedTuple):
    """Flags, destination and source of datagrams, the code of their messages, and the event."""

    ends: bytes
    code: int
    event: int


class _Known(NamedTuple):
    """A route of the core, its path through Python, and what writes down what has passed."""

    path: FastPath
    order: Any
    settle: Callable[[int, float, int, bytes, bool], None]


class FastReceiver:
    """Receives from the socket of a transport, for one component.

    Routes are found from what has passed: after each datagram that was not usual it is looked at
    whether the next one like it can be.
    """

    def __init__(
        self, library: Library, core: int, transport: JudpTransport, component: JausComponent
    ) -> None:
        self._library = library
        self._core = core
        self._component = component
        self._inbox = transport.inbox
        self._book = transport.address_book
        self._window = transport.inbox.duplicates
        self._received = transport.counters.tally("judp.received")
        self._sent = transport.counters.tally("judp.sent")
        self._loop = component.loop
        self._routes: list[_Known] = []
        self._by_key: dict[_Key, _Known] = {}
        self._without: set[_Key] = set()
        self._lent: list[object] = []
        self._seen: list[_Key] = []
        self._other: tuple[bytes, Endpoint] | None = None
        self._is_enough = False

    def receiver(self, sock: socket.socket) -> Receiver:
        """Returns what receives from a socket whatever is not usual."""
        self._library.core_listen(self._core, sock.fileno())
        receive, changed = sock.recvfrom, self._loop.revision.changed

        def take_other(most: int) -> tuple[bytes, Endpoint]:
            other, self._other = self._other, None
            if other is not None:
                self._is_enough = True
                return other
            if self._is_enough:
                self._is_enough = False
                raise BlockingIOError  # the core looks for the next one
            changed()  # the core does not know the number of what is received here
            return receive(most)

        return take_other

    def settle(self, waited: Waited) -> None:
        """Writes down what has passed, and keeps a datagram that has not for whoever reads."""
        count, text = waited.taken_count, ctypes.string_at
        self._received.count += count
        for at in range(count):
            when, unknown, data, size, index, number, answered = TAKEN.unpack_from(
                waited.taken, at * TAKEN.size
            )
            self._routes[index].settle(number, when, unknown, text(data, size), answered)

    def keep(self, waited: Waited) -> None:
        """Keeps a datagram that has not passed for whoever reads the socket."""
        datagram = ctypes.string_at(waited.data, waited.size)
        self._other = datagram, (host_of(waited.host), waited.port)
        self._note(datagram)

    def forget(self) -> None:
        """Forgets all routes, as something has changed that they rest on."""
        self._routes.clear()
        self._by_key.clear()
        self._without.clear()
        self._lent.clear()

    # ------------------------------------------------------------------ routes

    def _note(self, datagram: bytes) -> None:
        """Looks after the turn whether datagrams like this one are usual from now on."""
        if len(datagram) < _SHORTEST:
            return
        code = int.from_bytes(datagram[_CODE], "little")
        key = _Key(datagram[_ENDS], code, datagram[_EVENT] if code == Event.CODE else 0)
        if not self._seen:
            self._loop.call_soon(self._learn)
        if len(self._seen) < _MOST_WITHOUT:
            self._seen.append(key)

    def _learn(self) -> None:
        seen, self._seen = self._seen, []
        for key in seen:
            self._bring_up_to_date(key)
            if key not in self._by_key and key not in self._without:
                self._find(key)

    def _bring_up_to_date(self, key: _Key) -> None:
        """Tells the routes of a kind of messages what Python has learnt of one of them."""
        for other, known in self._by_key.items():
            if other.ends[1:] == key.ends[1:] and other[1:] == key[1:]:
                _tell(known.order, known.path)

    def _find(self, key: _Key) -> None:
        """Makes a route of what the datagrams with a key go through, where they are usual."""
        way = self._inbox.usual.get(key.ends)
        if way is None:
            return
        path = None
        if not way.place and way.destination == self._component.address:
            path = self._component.fast_path(key.code, key.event, way.source)
        if path is None or (path.expected is not None and path.expected() is None):
            if len(self._without) >= _MOST_WITHOUT:
                self._without.clear()
            self._without.add(key)
            return
        host, port = way.entry.endpoint
        route = Route(
            source=way.source,
            destination=way.destination,
            host=packed_host(host),
            port=port,
            code=path.code,
            flags=key.ends[0],
            answer=way.answers,
            is_event=key.code == Event.CODE,
            event=key.event,
            is_ordered=path.latest is not None,
            index=len(self._routes),
            publisher=path.publisher,
            translation=ctypes.pointer(path.translation),
        )
        numbers = list(way.numbers)
        known = (ctypes.c_uint16 * len(numbers))(*numbers)
        order = self._library.core_add(self._core, ctypes.byref(route), known, len(numbers))
        if not order:
            return
        _tell(order.contents, path)
        self._lent.append(path.translation)
        self._by_key[key] = found = _Known(path, order.contents, self._settling(way, path))
        self._routes.append(found)

    def _settling(self, way: Any, path: FastPath) -> Callable[[int, float, int, bytes, bool], None]:
        """Returns what writes down a message, as those would have done whom it has not met."""
        entry, source, destination, numbers = way.entry, way.source, way.destination, way.numbers
        pair, window, capacity = way.pair, self._window, self._window.capacity
        learnt, seen = self._book.learnt, window.seen
        heard, passed, sent = self._component.note_heard, path.passed, self._sent

        def settle(number: int, at: float, unknown: int, payload: bytes, answered: bool) -> None:  # noqa: FBT001
            entry.heard = at
            learnt.move_to_end(source)
            seen.move_to_end(pair)
            if len(numbers) >= capacity:
                window.make_room(pair, numbers)
            numbers[number] = at, hash(payload) ^ destination
            sent.count += answered
            passed(payload, number, at, unknown)
            heard(source, at)

        return settle


def _tell(order: Any, path: FastPath) -> None:
    """Tells a route what its path through Python knows."""
    latest = None if path.latest is None else path.latest()
    order.has_latest = latest is not None
    if latest is not None:
        order.latest, order.latest_at = latest
    if path.expected is not None:
        order.expected = path.expected() or 0

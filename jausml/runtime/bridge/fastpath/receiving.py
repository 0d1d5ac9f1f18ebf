"""From JAUS to ROS on the fast path: the core receives, translates and publishes by itself.

What each of them changes on its way through Python is written down before anything else runs. Any
other datagram is handed to those who read the socket, as if it had been received here.
"""

from __future__ import annotations

import ctypes
import socket
import struct
from collections import deque
from collections.abc import Callable, Sequence
from typing import NamedTuple, TypeAlias

from ...base.address import JausAddress, address_of
from ...base.fast_path import FastPath
from ...base.settings import Endpoint
from ...component.base import Component
from ...messages import Event
from ...transports.address_book import Entry
from ...transports.packets.duplicates import Numbers, pair_of
from ...transports.udp.judp import JudpTransport, Receiver
from .library import TAKEN, Library, Order, Route, Waited, host_of, packed_host

# Offsets in a datagram of one message (AS5669A): version, type, size, flags, ends, payload.
_ENDS = slice(4, 13)
_FLAGS = 4
# The two highest bits of the flags: the place of a packet in its message.
_PLACE, _FIRST, _WITHOUT_PLACE = 6, 1, 0x3F
_DESTINATION = slice(5, 9)
_CODE = slice(13, 15)
_EVENT = 15
_SHORTEST = 17
_ENDS_LAYOUT = struct.Struct("<BII")
_PRIORITY, _ASKS, _ANSWERS, _ACKNOWLEDGES = 0x03, 0x10, 0x20, 0x30
# Strangers that invent kinds of datagrams must not fill the memory.
_MOST_KEYS = 1024


class _Key(NamedTuple):
    """Flags, destination and source of datagrams, the code of their messages, and the event."""

    ends: bytes
    code: int
    event: int


Settle: TypeAlias = "Callable[[int, float, int, bytes, bool, Sequence[int] | None], None]"
"""Writes down a message: the number of its last packet, when it came, what was left out, its
payload, whether it was acknowledged, and the sizes of its packets, if they are several."""


class _Flow(NamedTuple):
    """Where datagrams come from and go to."""

    entry: Entry
    source: JausAddress
    destination: JausAddress
    numbers: Numbers
    answer: int  # flags of the acknowledgement of each; 0 where none is asked for


class _LearntRoute(NamedTuple):
    """A route of the core, its path through Python, and what writes down what has passed."""

    path: FastPath
    order: Order
    settle: Settle


class FastReceiver:
    """Receives from the socket of a transport, for one component.

    Routes are found from what has passed: after each datagram that was not usual it is looked at
    whether the next one like it can be.
    """

    def __init__(
        self, library: Library, core: int, transport: JudpTransport, component: Component
    ) -> None:
        self._library = library
        self._core = core
        self._transport = transport
        self._component = component
        self._inbox = transport.inbox
        self._book = transport.address_book
        self._window = transport.inbox.duplicates
        self._longest = transport.inbox.reassembly.limit
        self._received = transport.counters.tally("judp.received")
        self._sent = transport.counters.tally("judp.sent")
        self._loop = component.loop
        self._routes: list[_LearntRoute] = []
        self._by_key: dict[_Key, _LearntRoute] = {}
        self._unusual_keys: set[_Key] = set()
        self._keys_to_learn: list[_Key] = []
        self._left_datagrams: deque[tuple[bytes, Endpoint]] = deque()
        self._core_goes_first = False
        self.descriptor = -1

    def receiver(self, sock: socket.socket, by_multicast: bool) -> Receiver:  # noqa: FBT001
        """Returns what receives from a socket whatever is not usual."""
        return self._grouped(sock) if by_multicast else self._alone(sock)

    def _grouped(self, sock: socket.socket) -> Receiver:
        """Returns what receives what comes to the group, in Python alone.

        What is meant for one component has a number among those that the core knows.
        """
        # Bound once: each datagram would pay for the look-ups.
        receive, changed = sock.recvfrom, self._loop.revision.changed

        def take(most: int) -> tuple[bytes, Endpoint]:
            datagram, origin = receive(most)
            if address_of(int.from_bytes(datagram[_DESTINATION], "little")).is_concrete:
                changed()
            return datagram, origin

        return take

    def _alone(self, sock: socket.socket) -> Receiver:
        self.descriptor = sock.fileno()
        self._library.core_listen(self._core, self.descriptor, self._longest)
        receive, changed, left = sock.recvfrom, self._loop.revision.changed, self._left_datagrams

        def take_left(most: int) -> tuple[bytes, Endpoint]:
            if left:
                self._core_goes_first = True
                return left.popleft()
            if self._core_goes_first:
                self._core_goes_first = False
                raise BlockingIOError  # the core looks for the next one
            changed()  # the core does not know the number of what is received here
            return receive(most)

        return take_left

    @property
    def has_left_datagrams(self) -> bool:
        """Whether datagrams are kept that nobody has read."""
        return bool(self._left_datagrams)

    def settle(self, waited: Waited) -> None:
        """Writes down what has passed, and keeps what has not for whoever reads the socket."""
        text, size = ctypes.string_at, TAKEN.size
        for at in range(waited.taken_count):
            when, unknown, data, length, sizes, packets, index, number, answered = (
                TAKEN.unpack_from(waited.taken, at * size)
            )
            self._received.count += packets
            payload, settle = text(data, length), self._routes[index].settle
            parts = None
            if packets > 1:
                parts = struct.unpack(f"{packets}I", text(sizes, 4 * packets))
            settle(number, when, unknown, payload, answered, parts)
        for at in range(waited.left_count):
            left = waited.left[at]
            # Copied, as the core uses its buffers again in the next wait.
            datagram = text(left.data, left.size)
            self._left_datagrams.append((datagram, (host_of(left.host), left.port)))
            self._note(datagram)

    def forget(self) -> None:
        """Forgets all routes, as something has changed that they rest on."""
        # The core has forgotten them by now, which had the addresses of their translations alone.
        self._routes.clear()
        self._by_key.clear()
        self._unusual_keys.clear()

    # ------------------------------------------------------------------ routes

    def _note(self, datagram: bytes) -> None:
        """Looks after the turn whether datagrams like this one are usual from now on."""
        # Without a message code it is an acknowledgement, or damaged: never usual.
        if len(datagram) < _SHORTEST:
            return
        code = int.from_bytes(datagram[_CODE], "little")
        flags = datagram[_FLAGS]
        # Later packets of a message take the route of its first one.
        if flags >> _PLACE > _FIRST:
            return
        # Without the place, so that whole messages and first packets share a route.
        ends = bytes([flags & _WITHOUT_PLACE]) + datagram[_FLAGS + 1 : _ENDS.stop]
        key = _Key(ends, code, datagram[_EVENT] if code == Event.CODE else 0)
        # Once for all of a turn, when Python has taken the datagrams themselves.
        if not self._keys_to_learn:
            self._loop.call_soon(self._learn)
        if len(self._keys_to_learn) < _MOST_KEYS:
            self._keys_to_learn.append(key)

    def _learn(self) -> None:
        keys, self._keys_to_learn = self._keys_to_learn, []
        for key in keys:
            self._bring_up_to_date(key)
            if key not in self._by_key and key not in self._unusual_keys:
                self._find(key)

    def _bring_up_to_date(self, key: _Key) -> None:
        """Tells the routes of a kind of messages what Python has learnt of one of them."""
        for other, route in self._by_key.items():
            # Whatever the flags: numbers and order are those of the pair and the kind of message.
            if other.ends[1:] == key.ends[1:] and other[1:] == key[1:]:
                _tell(route.order, route.path)

    def _flow_of(self, ends: bytes) -> _Flow | None:
        """Returns where datagrams come from and go to; None where Python must look at each.

        A core compares origin and number alone. So they must come from a component that is known
        and has proved where it is, whose numbers are remembered, to one of this process.
        """
        flags, destination, source = _ENDS_LAYOUT.unpack(ends)
        entry = self._book.learnt.get(source)
        numbers = self._window.seen.get(pair_of(source, destination))
        if (
            # Acknowledgements are matched one by one, with what waits for them.
            flags & _ANSWERS
            or entry is None
            # Who has not proved where it is has a credit, which Python keeps.
            or entry.claim is not None
            # From there come own multicasts, which are dropped.
            or entry.endpoint in self._transport.own_endpoints
            # Forgotten, or never seen: there is nothing to compare numbers with.
            or not numbers
            or destination not in self._inbox.receivers
            # Somebody else uses the address of a component of this process: an error to be told.
            or source in self._inbox.receivers
        ):
            return None
        # As the inbox would answer: with the priority of the question.
        answer = flags & _PRIORITY | _ACKNOWLEDGES if flags & _ASKS else 0
        return _Flow(entry, address_of(source), address_of(destination), numbers, answer)

    def _find(self, key: _Key) -> None:
        """Makes a route of what the datagrams with a key go through, where they are usual."""
        flow = self._flow_of(key.ends)
        if flow is None:
            return
        path = self._usual_path(key, flow)
        if path is None:
            # Emptied as a whole: what is asked for again is simply judged again.
            if len(self._unusual_keys) >= _MOST_KEYS:
                self._unusual_keys.clear()
            self._unusual_keys.add(key)
            return
        order = self._add(key, flow, path)
        if order is None:
            return
        _tell(order, path)
        self._by_key[key] = route = _LearntRoute(path, order, self._settling(flow, path))
        self._routes.append(route)

    def _usual_path(self, key: _Key, flow: _Flow) -> FastPath | None:
        """Returns the path of messages through Python that a core can take instead, if any."""
        if flow.destination != self._component.address:
            return None
        path = self._component.fast_path(key.code, key.event, flow.source)
        # Of an event nobody has seen a report yet, so there is no number to expect. A command that
        # is acknowledged may be a stop: older ones without acknowledgement have a route apart, and
        # must hear of it before the next message.
        if (
            path is None
            or (path.expected is not None and path.expected() is None)
            or (path.latest is not None and flow.answer)
        ):
            return None
        return path

    def _add(self, key: _Key, flow: _Flow, path: FastPath) -> Order | None:
        """Returns the part of a new route that the core and Python write to; it copies the rest.

        None where the core has no memory for it.
        """
        host, port = flow.entry.endpoint
        route = Route(
            source=flow.source,
            destination=flow.destination,
            host=packed_host(host),
            port=port,
            code=path.code,
            flags=key.ends[0],
            answer=flow.answer,
            is_event=key.code == Event.CODE,
            event=key.event,
            is_ordered=path.latest is not None,
            index=len(self._routes),
            publisher=path.publisher,
            translation=ctypes.pointer(path.translation),
        )
        # What Python has seen so far is a duplicate for the core too.
        numbers = list(flow.numbers)
        known = (ctypes.c_uint16 * len(numbers))(*numbers)
        order = self._library.core_add(self._core, ctypes.byref(route), known, len(numbers))
        contents: Order | None = order.contents if order else None
        return contents

    def _settling(self, flow: _Flow, path: FastPath) -> Settle:
        """Returns what writes down a message, as those would have done whom it has not met."""
        entry, source, destination, numbers = (
            flow.entry,
            flow.source,
            flow.destination,
            flow.numbers,
        )
        pair, window = pair_of(source, destination), self._window
        reassembly = self._inbox.reassembly
        learnt, seen = self._book.learnt, window.seen
        heard, passed, sent = self._component.note_heard, path.passed, self._sent

        def settle(
            number: int,
            at: float,
            unknown: int,
            payload: bytes,
            answered: bool,  # noqa: FBT001
            sizes: Sequence[int] | None,
        ) -> None:
            # What the address book and the window do with a datagram that Python reads.
            entry.heard = at
            learnt.move_to_end(source)
            seen.move_to_end(pair)
            if sizes is None:
                window.remember(pair, numbers, number, destination, payload, at)
            else:
                reassembly.note_whole(len(sizes))
                # The number is that of the last packet; those before it may lie beyond 65535.
                start, first = 0, number - len(sizes) + 1
                for sequence_number, size in enumerate(sizes, first):
                    part = payload[start : start + size]
                    window.remember(pair, numbers, sequence_number & 0xFFFF, destination, part, at)
                    start += size
            # Acknowledgements that the core has sent are datagrams too.
            sent.count += answered
            passed(payload, number, at, unknown)
            heard(source, at)

        return settle


def _tell(order: Order, path: FastPath) -> None:
    """Tells a route what its path through Python knows."""
    latest = None if path.latest is None else path.latest()
    order.has_latest = latest is not None
    if latest is not None:
        order.latest, order.latest_at = latest
    if path.expected is not None:
        order.expected = path.expected() or 0

"""From JAUS to ROS on the fast path: the core receives, translates and publishes without Python.

A route tells the core which datagrams it may take; it is learnt from a datagram that Python has
taken. After each wait the state of Python (address book, duplicates, counters) is brought up to
date with the messages that the core has passed on. All other datagrams are given to the transport
as if they had just been received.
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
_MAX_KEYS = 1024  # invented kinds of datagrams must not fill the memory


class _Key(NamedTuple):
    """A kind of datagrams: flags, destination and source; code of the message; event."""

    ends: bytes
    code: int
    event: int


# Accounts for a message that the core has passed on: number of its last packet, time, bits of
# omitted fields, payload, whether it was acknowledged, sizes of its packets if there are several.
Settle: TypeAlias = "Callable[[int, float, int, bytes, bool, Sequence[int] | None], None]"


class _Flow(NamedTuple):
    """Source and destination of a kind of datagrams."""

    entry: Entry
    source: JausAddress
    destination: JausAddress
    numbers: Numbers
    answer: int  # flags of the acknowledgement of each datagram; 0 for none


class _LearntRoute(NamedTuple):
    """A route of the core, its path through Python, and the function that accounts for it."""

    path: FastPath
    order: Order
    settle: Settle


class FastReceiver:
    """Receives from the socket of a transport, for one component.

    After each datagram that Python had to take, a route is made if the core can take the next one
    of the same kind.
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
        self._slow_keys: set[_Key] = set()
        self._keys_to_learn: list[_Key] = []
        self._left_datagrams: deque[tuple[bytes, Endpoint]] = deque()
        self._core_goes_first = False
        self.descriptor = -1

    def receiver(self, sock: socket.socket, by_multicast: bool) -> Receiver:  # noqa: FBT001
        """Returns the function by which the transport receives datagrams that the core leaves."""
        return self._group_receiver(sock) if by_multicast else self._unicast_receiver(sock)

    def _group_receiver(self, sock: socket.socket) -> Receiver:
        """Returns the function that receives datagrams to the multicast group, without the core.

        One for a single component counts among the numbers of its route, which is made anew then.
        """
        # Bound once: each datagram would pay for the look-ups.
        receive, changed = sock.recvfrom, self._loop.revision.changed

        def take(most: int) -> tuple[bytes, Endpoint]:
            datagram, origin = receive(most)
            if address_of(int.from_bytes(datagram[_DESTINATION], "little")).is_concrete:
                changed()
            return datagram, origin

        return take

    def _unicast_receiver(self, sock: socket.socket) -> Receiver:
        self.descriptor = sock.fileno()
        self._library.core_listen(self._core, self.descriptor, self._longest)
        receive, changed, left = sock.recvfrom, self._loop.revision.changed, self._left_datagrams

        def take_left(most: int) -> tuple[bytes, Endpoint]:
            if left:
                self._core_goes_first = True
                return left.popleft()
            if self._core_goes_first:
                self._core_goes_first = False
                raise BlockingIOError  # the core receives the next one
            changed()  # the core does not know the number of this datagram
            return receive(most)

        return take_left

    @property
    def has_left_datagrams(self) -> bool:
        """Whether datagrams of the core wait to be received in Python."""
        return bool(self._left_datagrams)

    def settle(self, waited: Waited) -> None:
        """Accounts for the messages of a wait, and keeps the datagrams that are left to Python."""
        read, size = ctypes.string_at, TAKEN.size
        for position in range(waited.taken_count):
            when, unknown, data, length, sizes, packets, index, number, answered = (
                TAKEN.unpack_from(waited.taken, position * size)
            )
            self._received.count += packets
            payload, settle = read(data, length), self._routes[index].settle
            parts = None
            if packets > 1:
                parts = struct.unpack(f"{packets}I", read(sizes, 4 * packets))
            settle(number, when, unknown, payload, answered, parts)
        for position in range(waited.left_count):
            left = waited.left[position]
            # Copied, as the core uses its buffers again in the next wait.
            datagram = read(left.data, left.size)
            self._left_datagrams.append((datagram, (host_of(left.host), left.port)))
            self._learn_later(datagram)

    def forget(self) -> None:
        """Forgets all routes, which may not hold any more; the core has forgotten them already."""
        self._routes.clear()
        self._by_key.clear()
        self._slow_keys.clear()

    # ------------------------------------------------------------------ routes

    def _learn_later(self, datagram: bytes) -> None:
        """Makes a route for the kind of a datagram at the end of the turn, if that is possible."""
        # Without a message code it is an acknowledgement, or damaged.
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
        if len(self._keys_to_learn) < _MAX_KEYS:
            self._keys_to_learn.append(key)

    def _learn(self) -> None:
        keys, self._keys_to_learn = self._keys_to_learn, []
        for key in keys:
            self._bring_up_to_date(key)
            if key not in self._by_key and key not in self._slow_keys:
                self._make_route(key)

    def _bring_up_to_date(self, key: _Key) -> None:
        """Gives routes the present numbers of Python, whatever the flags of their datagrams."""
        for other, route in self._by_key.items():
            if other.ends[1:] == key.ends[1:] and other[1:] == key[1:]:
                _update(route.order, route.path)

    def _flow_of(self, ends: bytes) -> _Flow | None:
        """Returns source and destination of datagrams; None where Python must check each.

        The core only compares origin and number. So the source must be known at a proved endpoint,
        its numbers must be remembered, and the destination must be a component of this process.
        """
        flags, destination, source = _ENDS_LAYOUT.unpack(ends)
        entry = self._book.learnt.get(source)
        numbers = self._window.seen.get(pair_of(source, destination))
        if (
            # Acknowledgements are matched with the packets that wait for them.
            flags & _ANSWERS
            or entry is None
            # Python counts the datagrams of a source at an endpoint that is not proved.
            or entry.claim is not None
            # Own multicasts, which are dropped.
            or entry.endpoint in self._transport.own_endpoints
            # No numbers to compare with.
            or not numbers
            or destination not in self._inbox.receivers
            # Another process uses the address of a component of this one, which is reported.
            or source in self._inbox.receivers
        ):
            return None
        # As the inbox answers: with the same priority.
        answer = flags & _PRIORITY | _ACKNOWLEDGES if flags & _ASKS else 0
        return _Flow(entry, address_of(source), address_of(destination), numbers, answer)

    def _make_route(self, key: _Key) -> None:
        """Makes a route for datagrams of a kind, if the core can take them."""
        flow = self._flow_of(key.ends)
        if flow is None:
            return
        path = self._direct_path(key, flow)
        if path is None:
            # Emptied as a whole: kinds that come again are judged again.
            if len(self._slow_keys) >= _MAX_KEYS:
                self._slow_keys.clear()
            self._slow_keys.add(key)
            return
        order = self._add(key, flow, path)
        if order is None:
            return
        _update(order, path)
        self._by_key[key] = route = _LearntRoute(path, order, self._settle_function(flow, path))
        self._routes.append(route)

    def _direct_path(self, key: _Key, flow: _Flow) -> FastPath | None:
        """Returns the path of messages that the core can take without Python, if any."""
        if flow.destination != self._component.address:
            return None
        path = self._component.fast_path(key.code, key.event, flow.source)
        # An event whose first report has not come has no number to expect. An acknowledged command
        # may be a stop, which must end older commands of another route, without acknowledgement.
        if (
            path is None
            or (path.expected is not None and path.expected() is None)
            or (path.latest is not None and flow.answer)
        ):
            return None
        return path

    def _add(self, key: _Key, flow: _Flow, path: FastPath) -> Order | None:
        """Adds a route to the core; returns the part of it that core and Python both write to.

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
        # Numbers that Python has seen are duplicates for the core too.
        numbers = list(flow.numbers)
        duplicates = (ctypes.c_uint16 * len(numbers))(*numbers)
        order = self._library.core_add(self._core, ctypes.byref(route), duplicates, len(numbers))
        contents: Order | None = order.contents if order else None
        return contents

    def _settle_function(self, flow: _Flow, path: FastPath) -> Settle:
        """Returns the function that updates the state of Python for a message of the core."""
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
            arrival: float,
            unknown: int,
            payload: bytes,
            answered: bool,  # noqa: FBT001
            sizes: Sequence[int] | None,
        ) -> None:
            # As the address book and the duplicates do for a datagram that Python reads.
            entry.heard = arrival
            learnt.move_to_end(source)
            seen.move_to_end(pair)
            if sizes is None:
                window.remember(pair, numbers, number, destination, payload, arrival)
            else:
                reassembly.note_whole(len(sizes))
                # The number is that of the last packet; those before it may lie beyond 65535.
                start, first = 0, number - len(sizes) + 1
                for sequence_number, size in enumerate(sizes, first):
                    part, start = payload[start : start + size], start + size
                    window.remember(
                        pair, numbers, sequence_number & 0xFFFF, destination, part, arrival
                    )
            # Acknowledgements that the core has sent are datagrams too.
            sent.count += answered
            passed(payload, number, arrival, unknown)
            heard(source, arrival)

        return settle


def _update(order: Order, path: FastPath) -> None:
    """Gives a route the present numbers of its path in Python."""
    latest = None if path.latest is None else path.latest()
    order.has_latest = latest is not None
    if latest is not None:
        order.latest, order.latest_at = latest
    if path.expected is not None:
        order.expected = path.expected() or 0

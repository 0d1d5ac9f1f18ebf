"""Reading of a socket: the usual datagram on its bytes, any other one packet by packet."""

from __future__ import annotations

import socket
import struct
import sys
from typing import TYPE_CHECKING

from ...base.address import address_of
from ..delivery import MESSAGE_CODE_SIZE
from ..packets.duplicates import pair_of
from ..packets.packet import EMPTY_MESSAGE_SIZE, JUDP_VERSION

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...base.counters import Counters
    from ...base.loop import Loop
    from ...base.settings import Endpoint
    from ..address_book import AddressBook, Entry
    from ..delivery import Take
    from ..packets.duplicates import Numbers
    from ..packets.inbox import Inbox
    from ..ports import SharedPort

    Receiver = Callable[[int], tuple[bytes, Endpoint]]
    """Receives a datagram of at most so many bytes; tells where it came from."""


# Options of Linux that the socket module does not name.
SO_RXQ_OVFL = 40  # each datagram tells how many were dropped so far
SO_MEMINFO = 55  # the same and more is told on request, since 4.12

_MEMINFO = struct.Struct("9I")
_DROPS = 8
_DROPPED = struct.Struct("I")
_NOTES_SIZE = socket.CMSG_SPACE(_DROPPED.size)


class KernelDrops:
    """Counts what the kernel drops at the sockets of one process, as ``judp.kernel_dropped``.

    To have it told with each datagram costs 5 us after a pause; so the kernel is asked now and
    then, where it answers.
    """

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._known: dict[socket.socket, int] = {}

    def receiver(self, sock: socket.socket, option: int = SO_MEMINFO) -> Receiver:
        """Return what receives from a socket, whose drops are counted from now on."""
        if sys.platform != "linux":
            return sock.recvfrom
        if len(_told(sock, option)) == _MEMINFO.size:
            self._known[sock] = 0
            return sock.recvfrom
        return self._noting(sock)

    def look(self) -> None:
        """Count what was dropped since the last time; sockets that are closed are forgotten."""
        for sock, known in list(self._known.items()):
            told = _told(sock, SO_MEMINFO)
            if told:
                self._known[sock] = self._counted(known, _MEMINFO.unpack(told)[_DROPS])
            else:
                del self._known[sock]

    def _noting(self, sock: socket.socket) -> Receiver:
        """Return what receives, and reads the notes of the kernel that come with datagrams."""
        try:
            sock.setsockopt(socket.SOL_SOCKET, SO_RXQ_OVFL, 1)
        except OSError:
            return sock.recvfrom
        known = 0

        def receive(size: int) -> tuple[bytes, Endpoint]:
            nonlocal known
            data, notes, _, origin = sock.recvmsg(size, _NOTES_SIZE)
            for level, kind, note in notes:
                if (level, kind) == (socket.SOL_SOCKET, SO_RXQ_OVFL):
                    known = self._counted(known, *_DROPPED.unpack(note))
            return data, origin

        return receive

    def _counted(self, known: int, total: int) -> int:
        amount = total - known & 0xFFFFFFFF
        if amount:
            self._counters.count(
                "judp.kernel_dropped",
                f"{amount} datagrams; the receive buffer was full: this process stood "
                "still or too much comes at once; the kernel allows no larger buffer "
                "than net.core.rmem_max",
                amount=amount,
            )
        return total


def _told(sock: socket.socket, option: int) -> bytes:
    """Returns what the kernel says of a socket; nothing where it does not, as of a closed one."""
    try:
        return sock.getsockopt(socket.SOL_SOCKET, option, _MEMINFO.size)
    except OSError:
        return b""


_LARGEST_DATAGRAM = 65535
_DATAGRAMS_PER_TURN = 32
_PAUSE_S = 0.0002  # after which what comes has likely come alone

_HEADER = struct.Struct("<HHBII")  # version and message type, size, flags, destination, source
_ANSWER = struct.Struct("<HHBIIH")  # the same and the sequence number: a message without payload
_ENDS = slice(4, _HEADER.size)  # flags, destination and source
_PAYLOAD = slice(_HEADER.size, -2)
_SHORTEST = EMPTY_MESSAGE_SIZE + MESSAGE_CODE_SIZE
_PRIORITY = 0x03
_ASKS = 0x10
_ANSWERS = 0x20
_ACK = 0x30
_PLACE = 6
_MAX_WAYS = 1024


class _Way:
    """What is known of the datagrams with the same flags, destination and source."""

    __slots__ = ("answers", "destination", "entry", "numbers", "pair", "place", "source", "take")

    def __init__(
        self, destination: int, source: int, flags: int, entry: Entry, numbers: Numbers, take: Take
    ) -> None:
        self.destination = address_of(destination)
        self.source = address_of(source)
        self.pair = pair_of(source, destination)
        self.entry = entry
        self.numbers = numbers
        self.take = take
        self.place = flags >> _PLACE
        self.answers = flags & _PRIORITY | _ACK if flags & _ASKS else 0


class Usual:
    """What is known of usual datagrams, and what is done about others.

    A datagram is usual when it is one packet (JUDP version 2; a whole message, a fragment or an
    acknowledgement) to one component of this process, from a known component that is where it
    was, and new. What all datagrams between two components have in common is found out once, and
    kept in ``inbox.usual``, by the bytes that say it, until anything of it changes.
    """

    def __init__(self, port: SharedPort, book: AddressBook, inbox: Inbox[Endpoint]) -> None:
        self._port = port
        self.book = book
        self.inbox = inbox

    def take_other(
        self,
        data: bytes,
        origin: Endpoint,
        now: float,
        way: _Way | None,
        otherwise: Callable[[bytes, Endpoint], None],
    ) -> None:
        """Take a datagram that is no usual message.

        Args:
            way: That of its flags, destination and source; it came from elsewhere or is damaged.
            otherwise: Takes it packet by packet, unless it is a usual acknowledgement.
        """
        size = len(data) - 1
        # What is refused in a flood must cost less than what is taken.
        if (
            way is not None
            and way.entry.endpoint != origin
            and data[2] | data[3] << 8 == size
            and self.book.refuses(way.source, way.entry, origin, now)
        ):
            return
        if size == EMPTY_MESSAGE_SIZE:
            start, stated, flags, destination, source = _HEADER.unpack_from(data)
            learnt, inbox = self.book.learnt, self.inbox
            entry = learnt.get(source)
            if (
                start == JUDP_VERSION
                and stated == EMPTY_MESSAGE_SIZE
                and flags & _ACK == _ACK
                and entry is not None
                and entry.endpoint == origin
                and entry.claim is None
                and destination in inbox.receivers
                and source not in inbox.receivers
                and origin not in self._port.endpoints
            ):
                entry.heard = now
                learnt.move_to_end(source)
                inbox.take_acknowledgement(destination, data[-2] | data[-1] << 8, source)
                return
        otherwise(data, origin)
        if size > EMPTY_MESSAGE_SIZE:
            self._learn(data, origin)

    def keep(self, way: _Way, sequence: int, payload: bytes, now: float) -> None:
        """Write down a fragment of a message that is not whole yet."""
        inbox = self.inbox
        self.book.learnt.move_to_end(way.source)
        inbox.duplicates.seen.move_to_end(way.pair)
        inbox.duplicates.remember(way.pair, way.numbers, sequence, way.destination, payload, now)
        inbox.plan_expiry()

    def _learn(self, data: bytes, origin: Endpoint) -> None:
        """Remember what the next datagram has in common with one that was taken as packets."""
        start, stated, flags, destination, source = _HEADER.unpack_from(data)
        inbox = self.inbox
        entry = self.book.learnt.get(source)
        numbers = inbox.duplicates.seen.get(pair_of(source, destination))
        take = inbox.takers.get(destination)
        if (
            start == JUDP_VERSION  # of a message type other than 0 as well
            and stated == len(data) - 1
            and not flags & _ANSWERS
            and entry is not None
            and entry.endpoint == origin
            and entry.claim is None
            and numbers
            and take is not None
            and source not in inbox.receivers
            and origin not in self._port.endpoints
        ):
            if len(inbox.usual) >= _MAX_WAYS:
                inbox.forget_usual()
            inbox.usual[data[_ENDS]] = _Way(destination, source, flags, entry, numbers, take)


def reader(  # noqa: C901 - for `read`
    receive: Receiver,
    loop: Loop,
    usual: Usual,
    answer: Callable[[bytes, Endpoint], bool],
    otherwise: Callable[[bytes, Endpoint], None],
) -> Callable[[], None]:
    """Return what reads the datagrams that have arrived at a socket, a few at a time.

    A usual message is taken in one function and on its bytes, with the effects that it has as a
    packet: of the functions that a message meets after a pause each costs as much as all that is
    done in it (docs/adr/0018). What only later datagrams ask for is written down when the message
    has been handed over.

    To find that nothing more has arrived costs more than a datagram, 30 us after a pause. So more
    than one are only looked for when one follows the other.

    Args:
        receive: Receives from the socket, which does not block.
        answer: Sends an acknowledgement.
        otherwise: Takes a datagram packet by packet.
    """
    inbox, learnt, take_other = usual.inbox, usual.book.learnt, usual.take_other
    ways, window, arrival = inbox.usual, inbox.duplicates, inbox.arrival
    seen, capacity, put = window.seen, window.capacity, inbox.reassembly.put
    clock, standstill, counters = loop.now, loop.standstill, loop.counters
    received, pack_answer = counters.tally("judp.received"), _ANSWER.pack
    burst, latest = 1, clock()

    def read() -> None:  # noqa: C901 - a call costs more than what it does
        nonlocal burst, latest
        now = clock()
        if now - latest > _PAUSE_S:
            burst = 1
            if now > standstill.due:
                standstill.end()
        latest, enough = now, burst
        for count in range(_DATAGRAMS_PER_TURN):
            if count == enough:
                break
            try:
                data, origin = receive(_LARGEST_DATAGRAM)
            except BlockingIOError:
                burst = 1
                return
            except OSError as error:
                counters.count("judp.receive_failed", str(error))
                return
            received.count += 1
            size, way = len(data) - 1, ways.get(data[_ENDS])
            if (
                way is None
                or size < _SHORTEST
                or data[2] | data[3] << 8 != size
                or data[0] | data[1] << 8 != JUDP_VERSION
                or way.entry.endpoint != origin
                or not (numbers := way.numbers)
                or (sequence := data[-2] | data[-1] << 8) in numbers
            ):
                take_other(data, origin, now, way, otherwise)
                continue
            way.entry.heard = now
            source, destination = way.source, way.destination
            if way.answers:
                ends = source, destination, sequence
                answer(pack_answer(JUDP_VERSION, EMPTY_MESSAGE_SIZE, way.answers, *ends), origin)
            payload = message = data[_PAYLOAD]
            if way.place:
                joined = put(source, destination, data[4], sequence, payload, now)
                if joined is None:
                    usual.keep(way, sequence, payload, now)
                    enough = max(enough, count + 2)  # the next one is on its way
                    continue
                message = joined[0]
            arrival.number, arrival.is_sure = sequence, way.answers != 0
            arrival.origin = origin
            try:
                way.take(message, source)
            except Exception as error:  # one component must not silence the others
                inbox.count_failure(destination, error)
            finally:
                learnt.move_to_end(source)
                seen.move_to_end(way.pair)
                if len(numbers) >= capacity:
                    window.make_room(way.pair, numbers)
                numbers[sequence] = now, hash(payload) ^ destination
                if way.place:
                    window.settle()
        burst = min(2 * burst, _DATAGRAMS_PER_TURN)

    return read

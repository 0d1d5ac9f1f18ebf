"""Reading of a socket: the usual datagram on its bytes, any other one packet by packet."""

from __future__ import annotations

import socket
import struct
from typing import TYPE_CHECKING

from ...base.address import address_of
from ..delivery import MESSAGE_CODE_SIZE
from ..packets.duplicates import SMALL
from ..packets.packet import EMPTY_MESSAGE_SIZE, FLAGS, JUDP_VERSION, Packet
from .shared_port import SO_RXQ_OVFL

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...base.counters import Counters
    from ...base.loop import Loop
    from ...base.settings import Endpoint
    from ..address_book import AddressBook
    from ..packets.inbox import Inbox
    from .shared_port import SharedPort


_LARGEST_DATAGRAM = 65535
_NOTES_SIZE = socket.CMSG_SPACE(4)
_DATAGRAMS_PER_TURN = 32
_PAUSE_S = 0.0002  # after which what comes has likely come alone

_HEADER = struct.Struct("<HHBII")  # version and message type, size, flags, destination, source
_ANSWER = struct.Struct("<HHBIIH")  # the same and the sequence number: a message without payload
_PAYLOAD = slice(_HEADER.size, -2)
_DROPPED = struct.Struct("I")
_SHORTEST = EMPTY_MESSAGE_SIZE + MESSAGE_CODE_SIZE
_PRIORITY = 0x03
_ASKS = 0x10
_ANSWERS = 0x20
_ACK = 0x30
_FRAGMENT = 0x40


def reader(  # noqa: C901 - a call costs more than what it does, see below
    sock: socket.socket,
    loop: Loop,
    port: SharedPort,
    book: AddressBook,
    inbox: Inbox[Endpoint],
    answer: Callable[[bytes, Endpoint], bool],
    otherwise: Callable[[bytes, Endpoint], None],
) -> Callable[[], None]:
    """Return what reads the datagrams that have arrived at a socket, a few at a time.

    A datagram is usual when it is one packet (JUDP version 2; a whole message, a fragment or an
    acknowledgement) to one component of this process, from a known component that is where it
    was. It is taken here, in one function and on its bytes, with the effects that it has
    as a packet: of the functions that a message meets after a pause each costs as much as all
    that is done in it (docs/adr/0018).

    To find that nothing more has arrived costs more than a datagram, 30 us after a pause. So more
    than one are only looked for when one follows the other.

    Args:
        sock: The socket, which does not block.
        loop: Its clock and counters are used.
        port: Its own endpoints are those of this process.
        book: Where components are.
        inbox: Who receives, and what was received.
        answer: Sends an acknowledgement.
        otherwise: Takes a datagram that is not usual, and where it came from.
    """
    receive, clock, counters = sock.recvmsg, loop.now, loop.counters
    received = counters.tally("judp.received")
    note_drops = _drops_counter(counters)
    takers, learnt, window = inbox.takers, book.learnt, inbox.duplicates
    seen, history = window.seen, window.history
    unpack, pack_answer = _HEADER.unpack_from, _ANSWER.pack
    burst, latest = 1, clock()

    def read() -> None:  # noqa: C901
        nonlocal burst, latest
        now = clock()
        if now - latest > _PAUSE_S:
            burst = 1
        latest = now
        enough = burst
        for count in range(_DATAGRAMS_PER_TURN):
            if count == enough:
                break
            try:
                data, notes, _, origin = receive(_LARGEST_DATAGRAM, _NOTES_SIZE)
            except BlockingIOError:
                burst = 1
                return
            except OSError as error:
                counters.count("judp.receive_failed", str(error))
                return
            received.count += 1
            if notes:
                note_drops(notes)
            size = len(data) - 1
            if size < EMPTY_MESSAGE_SIZE:
                otherwise(data, origin)
                continue
            start, stated, flags, destination, source = unpack(data)
            entry = learnt.get(source)
            if (
                start != JUDP_VERSION  # of a message type other than 0 as well
                or stated != size
                or entry is None
                or entry.endpoint != origin
                or source in inbox.receivers
                or origin in port.endpoints
            ):
                otherwise(data, origin)
                continue
            sequence = data[-2] | data[-1] << 8
            if size == EMPTY_MESSAGE_SIZE:
                if flags & _ACK != _ACK or destination not in inbox.receivers:
                    otherwise(data, origin)
                    continue
                entry.heard = now
                learnt.move_to_end(source)
                inbox.take_acknowledgement(destination, sequence, source)
                continue
            take, numbers = takers.get(destination), seen.get(source)
            if take is None or numbers is None or flags & _ANSWERS or size < _SHORTEST:
                otherwise(data, origin)
                continue
            entry.heard = now
            learnt.move_to_end(source)
            if flags & _ASKS:
                how = flags & _PRIORITY | _ACK
                answer(
                    pack_answer(start, EMPTY_MESSAGE_SIZE, how, source, destination, sequence),
                    origin,
                )
            payload = data[_PAYLOAD]
            seen.move_to_end(source)
            if size >= SMALL or sequence in numbers:
                if window.is_known(numbers, sequence, destination, payload, now):
                    counters.add("transport.duplicate")
                    continue
            else:
                if len(numbers) >= history:
                    numbers.popitem(last=False)
                numbers[sequence] = now, hash(payload) ^ destination
            sender = address_of(source)
            if flags >= _FRAGMENT:
                packet = Packet(address_of(destination), sender, payload, sequence, *FLAGS[flags])
                whole = inbox.complete(packet, now)
                if whole is None:
                    enough = max(enough, count + 2)  # the next one is on its way
                    continue
                payload = whole.payload
            try:
                take(payload, sender)
            except Exception as error:  # one component must not silence the others
                inbox.count_failure(address_of(destination), error)
        burst = min(2 * burst, _DATAGRAMS_PER_TURN)

    return read


def _drops_counter(counters: Counters) -> Callable[[list[tuple[int, int, bytes]]], None]:
    """Return what reads how many datagrams the kernel has dropped at a socket, and counts them."""
    known = 0

    def note(notes: list[tuple[int, int, bytes]]) -> None:
        nonlocal known
        for level, kind, data in notes:
            if (level, kind) == (socket.SOL_SOCKET, SO_RXQ_OVFL):
                (total,) = _DROPPED.unpack(data)
                amount, known = total - known & 0xFFFFFFFF, total
                if amount:
                    counters.count(
                        "judp.kernel_dropped",
                        f"{amount} datagrams; the receive buffer was full: this process stood "
                        "still or too much comes at once; the kernel allows no larger buffer "
                        "than net.core.rmem_max",
                        amount=amount,
                    )

    return note

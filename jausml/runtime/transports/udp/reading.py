"""Reading of a socket: the usual datagram on its bytes, any other one packet by packet."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

from ...base.address import address_of
from ..delivery import MESSAGE_CODE_SIZE
from ..packets.duplicates import pair_of
from ..packets.packet import EMPTY_MESSAGE_SIZE, JUDP_VERSION

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...base.loop import Loop
    from ...base.settings import Endpoint
    from ..address_book import AddressBook, Entry
    from ..delivery import Take
    from ..packets.duplicates import Numbers
    from ..packets.inbox import Inbox
    from .drops import Receiver
    from .shared_port import SharedPort


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


def reader(  # noqa: C901 - a call costs more than what it does, see below
    receive: Receiver,
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
    was, and new. It is taken here, in one function and on its bytes, with the effects that it has
    as a packet: of the functions that a message meets after a pause each costs as much as all
    that is done in it (docs/adr/0018). What all datagrams between two components have in
    common is found out once, and kept in ``inbox.usual`` until anything of it changes; and what
    only later datagrams ask for is written down when the message has been handed over.

    To find that nothing more has arrived costs more than a datagram, 30 us after a pause. So more
    than one are only looked for when one follows the other.
    """
    clock, counters = loop.now, loop.counters
    received = counters.tally("judp.received")
    learnt, window, usual = book.learnt, inbox.duplicates, inbox.usual
    seen, capacity = window.seen, window.capacity
    pack_answer, put = _ANSWER.pack, inbox.reassembly.put
    arrival = inbox.arrival
    burst, latest, standstill = 1, clock(), loop.standstill

    def prepare(data: bytes, origin: Endpoint) -> None:
        """Remember what the next datagram has in common with one that was taken as packets."""
        if len(data) <= EMPTY_MESSAGE_SIZE:
            return
        start, stated, flags, destination, source = _HEADER.unpack_from(data)
        entry, numbers = learnt.get(source), seen.get(pair_of(source, destination))
        take = inbox.takers.get(destination)
        if (
            start == JUDP_VERSION  # of a message type other than 0 as well
            and stated == len(data) - 1
            and stated != EMPTY_MESSAGE_SIZE
            and entry is not None
            and entry.endpoint == origin
            and entry.claim is None
            and numbers
            and take is not None
            and not flags & _ANSWERS
            and source not in inbox.receivers
            and origin not in port.endpoints
        ):
            if len(usual) >= _MAX_WAYS:
                usual.clear()
            usual[data[_ENDS]] = _Way(destination, source, flags, entry, numbers, take)

    def read() -> None:  # noqa: C901
        nonlocal burst, latest
        now = clock()
        if now - latest > _PAUSE_S:
            burst = 1
            if now > standstill.due:
                standstill.end()
        latest = now
        enough = burst
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
            size = len(data) - 1
            way = usual.get(data[_ENDS])
            if (
                way is None
                or size < _SHORTEST
                or data[2] | data[3] << 8 != size
                or data[0] | data[1] << 8 != JUDP_VERSION
                or way.entry.endpoint != origin
            ):
                # What is refused in a flood must cost less than what is taken.
                if (
                    way is not None
                    and data[2] | data[3] << 8 == size
                    and book.refuses(way.source, way.entry, origin, now)
                ):
                    continue
                if size != EMPTY_MESSAGE_SIZE or not acknowledged(data, origin, now):
                    otherwise(data, origin)
                    prepare(data, origin)
                continue
            sequence, numbers, pair = data[-2] | data[-1] << 8, way.numbers, way.pair
            if sequence in numbers or not numbers:
                otherwise(data, origin)
                prepare(data, origin)
                continue
            entry, source = way.entry, way.source
            entry.heard = now
            if way.answers:
                ends = source, way.destination, sequence
                answer(pack_answer(JUDP_VERSION, EMPTY_MESSAGE_SIZE, way.answers, *ends), origin)
            payload = data[_PAYLOAD]
            whole = payload
            if way.place:
                found = put(source, way.destination, data[4], sequence, payload, now)
                if found is None:
                    learnt.move_to_end(source)
                    seen.move_to_end(pair)
                    window.remember(pair, numbers, sequence, way.destination, payload, now)
                    if inbox.expiry is None:
                        inbox.plan_expiry()
                    enough = max(enough, count + 2)  # the next one is on its way
                    continue
                whole = found[0]
            arrival.number, arrival.is_sure = sequence, way.answers != 0
            try:
                way.take(whole, source)
            except Exception as error:  # one component must not silence the others
                inbox.count_failure(way.destination, error)
            finally:
                learnt.move_to_end(source)
                seen.move_to_end(pair)
                if len(numbers) >= capacity:
                    window.make_room(pair, numbers)
                numbers[sequence] = now, hash(payload) ^ way.destination
                if way.place:
                    window.settle()
        burst = min(2 * burst, _DATAGRAMS_PER_TURN)

    def acknowledged(data: bytes, origin: Endpoint, now: float) -> bool:
        """Take a usual acknowledgement; return whether it was one."""
        start, stated, flags, destination, source = _HEADER.unpack_from(data)
        entry = learnt.get(source)
        if (
            start != JUDP_VERSION
            or stated != EMPTY_MESSAGE_SIZE
            or flags & _ACK != _ACK
            or entry is None
            or entry.endpoint != origin
            or entry.claim is not None
            or destination not in inbox.receivers
            or source in inbox.receivers
            or origin in port.endpoints
        ):
            return False
        entry.heard = now
        learnt.move_to_end(source)
        inbox.take_acknowledgement(destination, data[-2] | data[-1] << 8, source)
        return True

    return read

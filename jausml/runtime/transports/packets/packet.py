"""Packets of AS5669A (general transport header), to and from JUDP datagrams."""

from __future__ import annotations

import struct
from enum import IntEnum
from typing import NamedTuple

from ...base.address import JausAddress, address_of
from ...base.counters import Counters

JUDP_VERSION = 2  # first byte of every datagram (AS5669A)

PLACE_MASK = 0xC0  # bits of the flags for the place of a packet in a message of several
EMPTY_MESSAGE_SIZE = 14  # bytes of a message without payload: header 12, sequence number 2
MAX_PAYLOAD = 65507 - 1 - EMPTY_MESSAGE_SIZE  # bytes of the largest payload in a UDP datagram


class Priority(IntEnum):
    """Priority of a message (AS5669A, flags bits 0-1)."""

    LOW = 0
    STANDARD = 1
    HIGH = 2
    SAFETY_CRITICAL = 3


class Broadcast(IntEnum):
    """Reach of a message (AS5669A, flags bits 2-3).

    Receivers go by the destination, as some peers send NONE to a wildcard.
    """

    NONE = 0
    LOCAL = 1
    GLOBAL = 2
    RESERVED = 3


class AckNak(IntEnum):
    """Acknowledgement requested or given (AS5669A, flags bits 4-5)."""

    NONE = 0
    REQUESTED = 1
    NAK = 2
    ACK = 3


class DataFlags(IntEnum):
    """Place of a packet in a message of several packets (AS5669A, flags bits 6-7)."""

    SINGLE = 0
    FIRST = 1
    MIDDLE = 2
    LAST = 3


class Packet(NamedTuple):
    """One message of the transport: a whole JAUS message, a fragment, or an acknowledgement."""

    destination: JausAddress
    source: JausAddress
    payload: bytes = b""  # message code and body, or a part; empty in an acknowledgement
    sequence: int = 0  # number of the packet among those of its source, modulo 65536
    priority: Priority = Priority.STANDARD
    broadcast: Broadcast = Broadcast.NONE
    acknowledge: AckNak = AckNak.NONE
    data_flags: DataFlags = DataFlags.SINGLE
    message_type: int = 0  # 0 for a JAUS message; others are reserved

    @property
    def flags(self) -> int:
        """The byte of the flags."""
        return self.priority | self.broadcast << 2 | self.acknowledge << 4 | self.data_flags << 6

    def encode(self) -> bytes:
        """Returns the datagram with this packet; raises ValueError for a field out of range."""
        if len(self.payload) > MAX_PAYLOAD:
            raise ValueError(f"{len(self.payload)} bytes of payload do not fit one datagram")
        if not (0 <= self.sequence <= 0xFFFF and 0 <= self.message_type <= 0x3F):
            raise ValueError(f"sequence {self.sequence} or type {self.message_type} out of range")
        header = _DATAGRAM_HEADER.pack(
            JUDP_VERSION,
            self.message_type,
            EMPTY_MESSAGE_SIZE + len(self.payload),
            self.flags,
            self.destination.packed,
            self.source.packed,
        )
        return b"".join((header, self.payload, _SEQUENCE.pack(self.sequence)))


_DATAGRAM_HEADER = struct.Struct("<BBHBII")  # version before the header of a message
_SEQUENCE = struct.Struct("<H")  # behind the payload
_HEADER = struct.Struct("<BHBII")
_FIELDS = struct.Struct("<BII")
_HEADER_SIZE = 12
_FIELDS_OFFSET = 3
_COMPRESSION_FIELDS_SIZE = 2
_COMPRESSED = 3
_TYPE_MASK = 0x3F
# Priority, broadcast, acknowledge and data flags of each byte: a table is faster for each packet.
FLAGS = tuple(
    (Priority(flags & 3), Broadcast(flags >> 2 & 3), AckNak(flags >> 4 & 3), DataFlags(flags >> 6))
    for flags in range(256)
)

_OTHER_VERSIONS = (
    (b"\x01", "judp.version_1", "AS5669 version 1, which AS5669A replaced"),
    (b"JAUS01.0", "judp.reference_architecture", "JAUS Reference Architecture 3 (OPC)"),
)


def parse_datagram(data: bytes, counters: Counters) -> list[Packet]:
    """Returns the packets of a datagram in their order; never raises.

    Errors are counted: ``judp.version_1`` and ``judp.reference_architecture`` (older protocols);
    ``judp.bad_version``; ``judp.acknowledgement_of_other_version``, which is taken all the same;
    ``judp.truncated`` (the size is beyond the end); ``transport.bad_size``;
    ``judp.trailing_bytes``, ignored after a good packet; and those of ``parse_message``.
    """
    if not data or data[0] != JUDP_VERSION:
        if _is_acknowledgement(data):
            # JAUS-DEVIATION: JAUS++ omits the version of its acknowledgements, which are right
            # otherwise. They only have an effect with the number of a packet that waits for one.
            counters.add("judp.acknowledgement_of_other_version")
            packet = parse_message(
                data, len(data) - EMPTY_MESSAGE_SIZE, EMPTY_MESSAGE_SIZE, counters
            )
            return [] if packet is None else [packet]
        _count_version(data, counters)
        return []
    packets: list[Packet] = []
    offset, end = 1, len(data)
    while offset < end:
        size = -1
        if end - offset >= EMPTY_MESSAGE_SIZE:
            size = data[offset + 1] | data[offset + 2] << 8
        if not EMPTY_MESSAGE_SIZE <= size <= end - offset:
            _count_remainder(data, offset, size, counters)
            break
        packet = parse_message(data, offset, size, counters)
        if packet is not None:
            packets.append(packet)
        offset += size
    if end == 1:
        counters.count("judp.truncated", data.hex())
    return packets


def message_size(data: bytes | bytearray, offset: int) -> int:
    """Returns the size in the header of the packet at an offset, which has at least three bytes."""
    return data[offset + 1] | data[offset + 2] << 8


def parse_message(data: bytes, offset: int, size: int, counters: Counters) -> Packet | None:
    """Returns a packet of at least 14 bytes, without a version; never raises.

    Returns None after an error, which is counted: ``transport.bad_message_type``, reserved by the
    standard; ``transport.compressed``; ``transport.bad_size``.
    """
    kind, _, flags, destination, source = _HEADER.unpack_from(data, offset)
    start, end = offset + _HEADER_SIZE, offset + size
    # Rare: compressed, or of a reserved type.
    if kind:
        reason, skipped = _compression(data, offset, size)
        if reason:
            counters.count(reason, data[offset : offset + 32].hex())
            return None
        start += skipped
        flags, destination, source = _FIELDS.unpack_from(data, offset + _FIELDS_OFFSET + skipped)
    priority, broadcast, acknowledge, data_flags = FLAGS[flags]
    return Packet(
        address_of(destination),
        address_of(source),
        data[start : end - 2],
        data[end - 2] | data[end - 1] << 8,
        priority,
        broadcast,
        acknowledge,
        data_flags,
    )


def _compression(data: bytes, offset: int, size: int) -> tuple[str, int]:
    """Returns the counter of an error, or an empty text, and the bytes to skip before the fields.

    In the standard the flags of header compression are bits 6-7, with two more bytes before the
    fields if they are set. Requests and confirmations of compression (1 and 2) have an uncompressed
    message, which is read; compression itself is not supported. Some peers use bits 0-1 (Junior and
    the node manager of fkie), or set bits 6-7 without the two bytes. Both are read if the addresses
    are only plausible so.
    """
    kind = data[offset]
    if kind >> 6 == _COMPRESSED and not kind & _TYPE_MASK:
        return "transport.compressed", 0
    with_fields = size >= EMPTY_MESSAGE_SIZE + _COMPRESSION_FIELDS_SIZE and _is_plausible(
        data, offset + _COMPRESSION_FIELDS_SIZE
    )
    if kind & _TYPE_MASK:
        is_misplaced = kind in (1, 2) and with_fields and not _is_plausible(data, offset)
        return ("", _COMPRESSION_FIELDS_SIZE) if is_misplaced else ("transport.bad_message_type", 0)
    if with_fields:
        return "", _COMPRESSION_FIELDS_SIZE
    return ("", 0) if _is_plausible(data, offset) else ("transport.bad_size", 0)


def _is_plausible(data: bytes, offset: int) -> bool:
    """Returns whether the fields at an offset have possible addresses."""
    _, destination, source = _FIELDS.unpack_from(data, offset + _FIELDS_OFFSET)
    receiver = address_of(destination)
    is_receiver = bool(receiver.subsystem and receiver.node and receiver.component)
    return is_receiver and address_of(source).is_concrete


def _is_acknowledgement(data: bytes) -> bool:
    """Returns whether a datagram is an acknowledgement of any version, or without one."""
    start = len(data) - EMPTY_MESSAGE_SIZE
    if start not in (0, 1) or data[start]:
        return False
    size, flags = data[start + 1] | data[start + 2] << 8, data[start + 3]
    return size == EMPTY_MESSAGE_SIZE and FLAGS[flags][2] is AckNak.ACK


def _count_version(data: bytes, counters: Counters) -> None:
    for start, name, title in _OTHER_VERSIONS:
        if data.startswith(start):
            counters.count(name, f"a peer speaks {title}; let it send AS5669A: {data[:32].hex()}")
            return
    counters.count("judp.bad_version" if data else "judp.truncated", data[:32].hex())


def _count_remainder(data: bytes, offset: int, size: int, counters: Counters) -> None:
    if offset > 1:
        name = "judp.trailing_bytes"
    elif 0 <= size < EMPTY_MESSAGE_SIZE:
        name = "transport.bad_size"
    else:
        name = "judp.truncated"
    counters.count(name, f"{len(data)} bytes: {data[:32].hex()}")

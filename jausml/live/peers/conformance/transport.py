"""Checks of the transport: what the target makes of datagrams, good and bad (AS5669A)."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

from jausml.live.peers.conformance.acknowledgements import (
    acknowledges,
    acknowledges_empty,
    acknowledges_flags,
    acknowledges_sequence,
    duplicate,
    duplicate_acknowledged,
    expect_answer,
    no_acknowledgement,
    ping_payload,
)
from jausml.live.peers.conformance.check import Check, check, step
from jausml.live.peers.conformance.session import PINGS
from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.messages import ConfirmEventRequest, CreateEvent, RejectEventRequest
from jausml.runtime.transports.packets.packet import AckNak, DataFlags

if TYPE_CHECKING:
    from jausml.live.peers.conformance.session import Session

UNKNOWN_CODE = b"\xb7\x7a"
"""A message code (7AB7) that no published service set uses."""

_TRUNCATED_QUERIES = (b"\x00\x2b", b"\x11\x20", b"\xf0\x21", b"\x03\x2b\x01")
"""QueryIdentification, QueryTime, QueryEvents and QueryServices without (all of) their bodies."""


def requires(session: Session) -> str:
    """Returns nothing: the group runs against each target that answers anything at all."""
    names = ", ".join(query.NAME for query, _ in PINGS)
    session.require(session.answers(), f"the target is there, but answers none of {names}")
    return ""


@step
def damaged(session: Session, what: str, bytes_at: dict[int, bytes]) -> None:
    """A query is sent with other bytes at some offsets of its datagram."""
    datagram = session.first.packet(ping_payload(session)).encode()
    for offset, others in bytes_at.items():
        datagram = datagram[:offset] + others + datagram[offset + len(others) :]
    session.probe.put_raw(datagram, what)


@step
def dropped(session: Session, what: str, bytes_at: dict[int, bytes]) -> None:
    """A query with other bytes at some offsets of its datagram is not answered."""
    damaged(what, bytes_at)(session)
    silence(f"{what} is to be dropped")(session)


@step
def payloads(session: Session, *each_payload: bytes) -> None:
    """Payloads are sent as they are, each in a packet."""
    for payload in each_payload:
        session.first.put(session.first.packet(payload))


@step
def silence(session: Session, why: str) -> None:
    """The target sends nothing for the quiet time."""
    session.first.expect_silence(why)


@step
def fragments(session: Session, *order: int, first: int | None = None) -> None:
    """Packets of a request in three that is answered and leaves nothing behind, in an order.

    Its sequence numbers begin with `first`.
    """
    session.skip_unless(session.serves("Events"), "the target answers nothing of Events")
    client = session.first
    if first is not None:
        client.skip_to(first)
    payload = CreateEvent(
        request_id=7,
        event_type=CreateEvent.EventType.EVERY_CHANGE,
        requested_periodic_rate=0.0,
        query_message=UNKNOWN_CODE,
    ).encode()
    parts = (payload[:4], payload[4:8], payload[8:])
    flags = (DataFlags.FIRST, DataFlags.MIDDLE, DataFlags.LAST)
    packets = [
        client.packet(part, data_flags=flag) for part, flag in zip(parts, flags, strict=True)
    ]
    for index in order:
        client.put(packets[index])


@step
def request_answered(session: Session, what: str, *, tolerated: bool = False) -> None:
    """The request for an event is confirmed or rejected; silence may be tolerated."""
    codes = (RejectEventRequest.CODE, ConfirmEventRequest.CODE)
    arrived = session.probe.wait(
        lambda: any(each.code in codes for each in session.first.inbox), session.probe.timeout
    )
    if not arrived and tolerated:
        session.note(f"{what} is not answered")
        return
    session.require(arrived, f"{what} is not answered")


@check(
    "transport.two-messages",
    "Reads two messages in one datagram",
    "AS5669A, JUDP: one version byte and one or more messages",
)
def two_messages(session: Session) -> None:
    """Both queries are answered; some stacks read only the first, so one may be lost."""
    client = session.first
    packets = [client.packet(ping_payload(session)) for _ in range(2)]
    session.probe.put_raw(
        packets[0].encode() + packets[1].encode()[1:], "two queries in one datagram"
    )
    session.probe.wait(lambda: len(client.inbox) > 1, session.probe.timeout)
    session.require(bool(client.inbox), "two queries in one datagram are not answered")
    if len(client.inbox) == 1:
        session.note("only the first message of a datagram is read")


@check(
    "transport.trailing-bytes",
    "Reads a message that garbage follows",
    "AS5669A, JUDP; practice: Junior ignores the rest",
)
def trailing_bytes(session: Session) -> None:
    """The query before the garbage may be answered; the target goes on in any case."""
    client = session.first
    packet = client.packet(ping_payload(session))
    session.probe.put_raw(packet.encode() + b"\xde\xad\xbe", "a query and three bytes of garbage")
    if not session.probe.wait(lambda: bool(client.inbox), session.probe.timeout):
        session.note("a message that garbage follows is dropped")


@check(
    "transport.size-too-large",
    "Drops a message whose size exceeds the datagram",
    "AS5669A, data size",
    risky=True,
)
def size_too_large(session: Session) -> None:
    """The data size says 200 bytes more than there are."""
    size = len(session.first.packet(ping_payload(session)).encode()) + 199
    what = "a query with a data size beyond the datagram"
    dropped(what, {2: size.to_bytes(2, "little")})(session)


@check(
    "transport.short-datagrams",
    "Survives datagrams that end too early",
    "AS5669A, general transport header",
    risky=True,
)
def short_datagrams(session: Session) -> None:
    """A query cut after each of its bytes; the target goes on."""
    datagram = session.first.packet(ping_payload(session)).encode()
    for length in range(len(datagram)):
        session.probe.put_raw(datagram[:length], f"{length} of {len(datagram)} bytes of a query")


@check(
    "transport.message-type",
    "Ignores reserved message types",
    "AS5669A, message type: 1 to 32 are reserved",
)
def message_type(session: Session) -> None:
    """A query under message type 5 is no JAUS message."""
    packet = session.first.packet(ping_payload(session))._replace(message_type=5)
    session.first.put(packet)
    if session.probe.wait(lambda: bool(session.first.inbox), session.probe.quiet):
        session.note("a query under the reserved message type 5 is answered")


@check(
    "transport.wildcard-destination",
    "Takes messages to wildcard destinations whatever their broadcast flag",
    "AS5669A, destination; practice: node managers leave the flag 0",
)
def wildcard_destination(session: Session) -> None:
    """Queries to all of the target's node and to everybody, with broadcast 0, are answered."""
    target = session.probe.target
    for destination in (JausAddress(target.subsystem, target.node, 255), BROADCAST):
        session.first.clear()
        session.first.put(session.first.packet(ping_payload(session), destination=destination))
        expect_answer(session, session.first, f"a query to {destination} with broadcast flag 0")


@check(
    "transport.wildcard-ack",
    "Acknowledges a message to a wildcard under its own id",
    "AS5669A, acknowledgement: source",
)
def wildcard_acknowledged(session: Session) -> None:
    """The acknowledgement comes from the concrete id, once."""
    session.first.put(
        session.first.packet(
            ping_payload(session), destination=BROADCAST, acknowledge=AckNak.REQUESTED
        )
    )
    arrived = session.probe.wait(
        lambda: bool(session.first.acknowledgements), session.probe.timeout
    )
    session.require(arrived, "a message to everybody that asks for it is not acknowledged")


@check(
    "transport.multicast",
    "Takes multicast messages to its own id",
    "AS5669A, JUDP; practice: stacks multicast what they do not know the place of",
)
def multicast(session: Session) -> None:
    """A query to the target's own id, sent to the multicast group, is acknowledged and answered."""
    client = session.first
    session.probe.put_to_group(client.packet(ping_payload(session), acknowledge=AckNak.REQUESTED))
    arrived = session.probe.wait(
        lambda: bool(client.acknowledgements and client.inbox), session.probe.timeout
    )
    if not arrived:
        what = "acknowledged but not answered" if client.acknowledgements else "not acknowledged"
        session.note(f"a multicast query to its id is {what}: multicast may not reach the target")


@check(
    "transport.other-destination",
    "Ignores messages to others",
    "AS5669A, destination",
)
def other_destination(session: Session) -> None:
    """A query to another id is neither answered nor acknowledged by the target."""
    target = session.probe.target
    other = JausAddress(target.subsystem, target.node, target.component % 254 + 1)
    session.first.put(
        session.first.packet(ping_payload(session), destination=other, acknowledge=AckNak.REQUESTED)
    )
    session.first.expect_silence(f"it was sent to {other}")
    session.require(
        not session.first.acknowledgements, f"a message to {other} is acknowledged by the target"
    )


@check(
    "transport.stray-acks",
    "Ignores acknowledgements that it does not wait for",
    "AS5669A, ack/nak flags",
)
def stray_acknowledgements(session: Session) -> None:
    """A stray ACK, a NAK and an ACK with payload are not answered."""
    client = session.first
    client.put(client.packet(b"", acknowledge=AckNak.ACK))
    client.put(client.packet(b"", acknowledge=AckNak.NAK))
    client.put(client.packet(ping_payload(session), acknowledge=AckNak.ACK))
    client.expect_silence("acknowledgements are not answered")


@check(
    "transport.sequence-numbers",
    "Gives each message a new sequence number",
    "AS5669A, sequence numbers: +1 for each packet of a source",
)
def sequence_numbers(session: Session) -> None:
    """The numbers of five reports differ and rise; others may hear what lies between."""
    client = session.first
    query, report_class = session.ping
    numbers = []
    for _ in range(5):
        client.send(query)
        arrived = session.probe.wait(
            lambda: any(each.code == report_class.CODE for each in client.inbox),
            session.probe.timeout,
        )
        session.require(arrived, f"{query.NAME} is not answered")
        numbers += [each.packet.sequence for each in client.inbox]
        client.clear()
    steps = [(after - before) & 0xFFFF for before, after in itertools.pairwise(numbers)]
    session.require(
        all(0 < step < 0x8000 for step in steps), f"the sequence numbers of reports are {numbers}"
    )


@check(
    "transport.well-formed",
    "Sends datagrams that can be read",
    "AS5669A, general transport header",
)
def well_formed(session: Session) -> None:
    """No datagram of the target so far was cut, of another version or followed by other bytes."""
    malformed = session.probe.malformed
    session.require(not malformed, f"{len(malformed)} unreadable datagrams: {malformed[:3]}")


CHECKS = (
    acknowledges,
    acknowledges_empty,
    acknowledges_sequence,
    acknowledges_flags,
    no_acknowledgement,
    duplicate,
    duplicate_acknowledged,
    two_messages,
    trailing_bytes,
    Check(
        "transport.version",
        "Drops a datagram of another version",
        "AS5669A, JUDP: version 2",
        "A query under version 3 is not answered.",
        (dropped("a query under version 3", {0: b"\x03"}),),
    ),
    size_too_large,
    Check(
        "transport.size-too-small",
        "Drops a message whose size is below the header",
        "AS5669A, data size: at least 14",
        "The data size says 5.",
        (dropped("a query with a data size of 5", {2: b"\x05\x00"}),),
        risky=True,
    ),
    short_datagrams,
    Check(
        "transport.no-message-code",
        "Survives a message without a message code",
        "AS5669A, payload",
        "Payloads of no byte and of one byte; the target goes on.",
        (payloads(b"", b"\x02"),),
        risky=True,
    ),
    message_type,
    Check(
        "transport.header-compression",
        "Survives header compression that it did not agree to",
        "AS5669A, header compression flags",
        "A message marked as compressed comes out of the blue; the target goes on.",
        (damaged("a message marked as compressed", {1: b"\xc0"}),),
        risky=True,
    ),
    Check(
        "transport.fragments",
        "Puts a message of several packets together",
        "AS5669A, data flags",
        "A request in three packets is answered like one in a single packet.",
        (fragments(0, 1, 2), request_answered("a request in three packets")),
    ),
    Check(
        "transport.fragments-reversed",
        "Puts packets together that come in reverse order",
        "AS5669A, data flags, sequence numbers; practice: Junior",
        "UDP does not keep the order; not every stack sorts.",
        (
            fragments(2, 1, 0),
            request_answered("a request in three packets in reverse", tolerated=True),
        ),
    ),
    Check(
        "transport.fragments-wrap",
        "Puts packets together over the wrap of sequence numbers",
        "AS5669A, sequence numbers: 65535 is followed by 0",
        "The three packets have the numbers 65535, 0 and 1.",
        (
            fragments(0, 1, 2, first=65535),
            request_answered("a request with the numbers 65535, 0, 1"),
        ),
    ),
    Check(
        "transport.fragment-missing",
        "Survives a message whose packets do not all come",
        "AS5669A, data flags",
        "First and last packet come without the one between; nothing is answered.",
        (fragments(0, 2), silence("a packet of the request is missing")),
    ),
    wildcard_destination,
    wildcard_acknowledged,
    multicast,
    other_destination,
    stray_acknowledgements,
    Check(
        "transport.unknown-message",
        "Ignores unknown messages",
        "AS5710A, Transport; no transition for unknown messages",
        "A message code that no set uses is not answered, whatever follows it.",
        (
            payloads(UNKNOWN_CODE, UNKNOWN_CODE + bytes(64)),
            silence("no answer to an unknown message exists"),
        ),
    ),
    Check(
        "transport.truncated-bodies",
        "Survives known messages without their bodies",
        "AS5684, encoding; AS5710A, core messages",
        "Queries whose body is missing; the target may ignore them and goes on.",
        (payloads(*_TRUNCATED_QUERIES),),
        risky=True,
    ),
    sequence_numbers,
    well_formed,
)

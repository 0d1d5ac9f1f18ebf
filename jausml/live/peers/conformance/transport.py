"""Checks of the transport: what the target makes of datagrams, good and bad (AS5669A)."""

from __future__ import annotations

import itertools

from jausml.live.peers.conformance.check import Check, step
from jausml.live.peers.conformance.packet_steps import (
    UNKNOWN_CODE,
    acknowledged,
    again,
    another,
    answered,
    cut_short,
    datagram,
    everybody,
    fragments,
    its_node,
    query,
    sequence_sent,
    two_queries,
    unacknowledged,
)
from jausml.live.peers.conformance.session import PINGS, Session
from jausml.live.peers.conformance.steps import A, has, settle, should_have, silence
from jausml.runtime.transports.packets.packet import AckNak, Broadcast, DataFlags, Priority

WANTED = AckNak.REQUESTED

_TRUNCATED_QUERIES = (b"\x00\x2b", b"\x11\x20", b"\xf0\x21", b"\x03\x2b\x01")
"""QueryIdentification, QueryTime, QueryEvents and QueryServices without (all of) their bodies."""


def requires(session: Session) -> str:
    """Returns nothing: the group runs against each target that answers anything at all."""
    names = ", ".join(query.NAME for query, _ in PINGS)
    session.require(session.answers(), f"the target is there, but answers none of {names}")
    return ""


@step
def _numbers_rise(session: Session, reports: int) -> None:
    """The numbers of reports differ and rise; others may hear what lies between."""
    client, (query, report_class) = session.first, session.ping
    numbers = []
    for _ in range(reports):
        client.send(query)
        arrived = session.probe.wait(
            lambda: any(message.code == report_class.CODE for message in client.inbox),
            session.probe.timeout,
        )
        session.require(arrived, f"{query.NAME} is not answered")
        numbers += [message.packet.sequence for message in client.inbox]
        client.clear()
    steps = [(after - before) & 0xFFFF for before, after in itertools.pairwise(numbers)]
    session.require(
        all(0 < step < 0x8000 for step in steps), f"the sequence numbers of reports are {numbers}"
    )


def _all_could_be_read(session: Session) -> None:
    malformed = session.probe.malformed
    session.require(not malformed, f"{len(malformed)} unreadable datagrams: {malformed[:3]}")


CHECKS = (
    Check(
        "transport.ack",
        "Acknowledges a message that asks for it, once",
        "AS5669A, ack/nak flags",
        "One acknowledgement from the target's own id comes for one message.",
        (query(A, acknowledge=WANTED), acknowledged(A), unacknowledged(A, "it has been before")),
    ),
    Check(
        "transport.ack-empty",
        "Acknowledges without payload",
        "AS5669A, acknowledgement: data size 14",
        "An acknowledgement is a header and a sequence number, 14 bytes in all.",
        (query(A, acknowledge=WANTED), acknowledged(A, has(payload=b""))),
    ),
    Check(
        "transport.ack-sequence",
        "Acknowledges under the sequence number of the message",
        "AS5669A, acknowledgement: sequence number",
        "The sender could not know otherwise which message has arrived.",
        (query(A, acknowledge=WANTED), acknowledged(A, has(sequence=sequence_sent))),
    ),
    Check(
        "transport.ack-flags",
        "Acknowledges with the flags of an acknowledgement",
        "AS5669A, flags of the general transport header",
        "Ack/nak is 3, data flags are 0; broadcast 0 and the priority of the message are usual.",
        (
            query(A, acknowledge=WANTED),
            acknowledged(
                A,
                has(acknowledge=AckNak.ACK, data_flags=DataFlags.SINGLE),
                should_have(broadcast=Broadcast.NONE, priority=Priority.STANDARD),
            ),
        ),
    ),
    Check(
        "transport.no-ack",
        "Acknowledges nothing that does not ask for it",
        "AS5669A, ack/nak flags",
        "A message with ack/nak 0 is answered, but not acknowledged.",
        (query(A), answered(A), unacknowledged(A, "the message asks for none")),
    ),
    Check(
        "transport.duplicate",
        "Drops a message that comes twice",
        "AS5669A, sequence numbers",
        "The second datagram with the same source and sequence number is not answered.",
        (query(A), answered(A), again(A), silence(A, "the datagram is a repeated one")),
    ),
    Check(
        "transport.duplicate-ack",
        "Acknowledges a message that comes twice again",
        "AS5669A, retransmission",
        "The first acknowledgement may be lost; without a second one the sender would give up.",
        (query(A, acknowledge=WANTED), acknowledged(A), settle(A), again(A), acknowledged(A)),
    ),
    Check(
        "transport.two-messages",
        "Reads two messages in one datagram",
        "AS5669A, JUDP: one version byte and one or more messages",
        "Both queries are answered; some stacks read only the first, so one may be lost.",
        (two_queries(), answered(A), answered(A, tolerated="only the first one is answered")),
    ),
    Check(
        "transport.trailing-bytes",
        "Reads a message that garbage follows",
        "AS5669A, JUDP; practice: Junior ignores the rest",
        "The query before the garbage may be answered; the target goes on in any case.",
        (
            datagram("a query and garbage", more=b"\xde\xad\xbe"),
            answered(A, tolerated="it is dropped"),
        ),
    ),
    Check(
        "transport.version",
        "Drops a datagram of another version",
        "AS5669A, JUDP: version 2",
        "A query under version 3 is not answered.",
        (datagram("a query under version 3", {0: b"\x03"}), silence(A, "it is to be dropped")),
    ),
    Check(
        "transport.size-too-large",
        "Drops a message whose size exceeds the datagram",
        "AS5669A, data size",
        "The data size says 1000 bytes, which are more than there are.",
        (datagram("a data size of 1000", {2: b"\xe8\x03"}), silence(A, "it is to be dropped")),
        risky=True,
    ),
    Check(
        "transport.size-too-small",
        "Drops a message whose size is below the header",
        "AS5669A, data size: at least 14",
        "The data size says 5.",
        (datagram("a data size of 5", {2: b"\x05\x00"}), silence(A, "it is to be dropped")),
        risky=True,
    ),
    Check(
        "transport.short-datagrams",
        "Survives datagrams that end too early",
        "AS5669A, general transport header",
        "A query cut after each of its bytes; the target goes on.",
        (cut_short(),),
        risky=True,
    ),
    Check(
        "transport.no-message-code",
        "Survives a message without a message code",
        "AS5669A, payload",
        "Payloads of no byte and of one byte; the target goes on.",
        (query(A, payload=b""), query(A, payload=b"\x02")),
        risky=True,
    ),
    Check(
        "transport.message-type",
        "Ignores reserved message types",
        "AS5669A, message type: 1 to 32 are reserved",
        "A query under message type 5 is no JAUS message.",
        (query(A, message_type=5), silence(A, "type 5 is reserved", tolerated=True)),
    ),
    Check(
        "transport.header-compression",
        "Survives header compression that it did not agree to",
        "AS5669A, header compression flags",
        "A message marked as compressed comes out of the blue; the target goes on.",
        (datagram("a message marked as compressed", {1: b"\xc0"}),),
        risky=True,
    ),
    Check(
        "transport.fragments",
        "Puts a message of several packets together",
        "AS5669A, data flags",
        "A request in three packets is answered like one in a single packet.",
        (fragments(0, 1, 2), answered(A, "a request in three packets")),
    ),
    Check(
        "transport.fragments-reversed",
        "Puts packets together that come in reverse order",
        "AS5669A, data flags, sequence numbers; practice: Junior",
        "UDP does not keep the order; not every stack sorts.",
        (fragments(2, 1, 0), answered(A, tolerated="packets in reverse are not answered")),
    ),
    Check(
        "transport.fragments-wrap",
        "Puts packets together over the wrap of sequence numbers",
        "AS5669A, sequence numbers: 65535 is followed by 0",
        "The three packets have the numbers 65535, 0 and 1.",
        (fragments(0, 1, 2, first=65535), answered(A, "a request in three packets")),
    ),
    Check(
        "transport.fragment-missing",
        "Survives a message whose packets do not all come",
        "AS5669A, data flags",
        "First and last packet come without the one between; nothing is answered.",
        (fragments(0, 2), silence(A, "a packet of the request is missing")),
    ),
    Check(
        "transport.wildcard-destination",
        "Takes messages to wildcard destinations whatever their broadcast flag",
        "AS5669A, destination; practice: node managers leave the flag 0",
        "Queries to all of the target's node and to everybody, with broadcast 0, are answered.",
        (
            query(A, destination=its_node),
            answered(A, "a query to its node"),
            query(A, destination=everybody),
            answered(A, "a query to everybody"),
        ),
    ),
    Check(
        "transport.wildcard-ack",
        "Acknowledges a message to a wildcard under its own id",
        "AS5669A, acknowledgement: source",
        "The acknowledgement comes from the concrete id, once.",
        (query(A, destination=everybody, acknowledge=WANTED), acknowledged(A)),
    ),
    Check(
        "transport.multicast",
        "Takes multicast messages to its own id",
        "AS5669A, JUDP; practice: stacks multicast what they do not know the place of",
        "A query to the target's own id, sent to the multicast group, is acknowledged and answered."
        "\n\nMulticast may not reach the target.",
        (
            query(A, to_group=True, acknowledge=WANTED),
            acknowledged(A, tolerated="it is not acknowledged"),
            answered(A, tolerated="it is not answered"),
        ),
    ),
    Check(
        "transport.other-destination",
        "Ignores messages to others",
        "AS5669A, destination",
        "A query to another id is neither answered nor acknowledged by the target.",
        (
            query(A, destination=another, acknowledge=WANTED),
            silence(A, "it is not for the target"),
            unacknowledged(A, "the query is not for the target"),
        ),
    ),
    Check(
        "transport.stray-acks",
        "Ignores acknowledgements that it does not wait for",
        "AS5669A, ack/nak flags",
        "A stray ACK, a NAK and an ACK with payload are not answered.",
        (
            query(A, payload=b"", acknowledge=AckNak.ACK),
            query(A, payload=b"", acknowledge=AckNak.NAK),
            query(A, acknowledge=AckNak.ACK),
            silence(A, "acknowledgements are not answered"),
        ),
    ),
    Check(
        "transport.unknown-message",
        "Ignores unknown messages",
        "AS5710A, Transport; no transition for unknown messages",
        "A message code that no set uses is not answered, whatever follows it.",
        (
            query(A, payload=UNKNOWN_CODE),
            query(A, payload=UNKNOWN_CODE + bytes(64)),
            silence(A, "no answer to an unknown message exists"),
        ),
    ),
    Check(
        "transport.truncated-bodies",
        "Survives known messages without their bodies",
        "AS5684, encoding; AS5710A, core messages",
        "Queries whose body is missing; the target may ignore them and goes on.",
        tuple(query(A, payload=truncated_query) for truncated_query in _TRUNCATED_QUERIES),
        risky=True,
    ),
    Check(
        "transport.sequence-numbers",
        "Gives each message a new sequence number",
        "AS5669A, sequence numbers: +1 for each packet of a source",
        "The numbers of five reports differ and rise; others may hear what lies between.",
        (_numbers_rise(5),),
    ),
    Check(
        "transport.well-formed",
        "Sends datagrams that can be read",
        "AS5669A, general transport header",
        "No datagram of the target so far was cut, of another version or followed by other bytes.",
        (_all_could_be_read,),
    ),
)

"""Checks of acknowledgements and of messages that come twice (AS5669A)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.live.peers.conformance.check import check
from jausml.live.peers.conformance.evidence import CheckFailed
from jausml.runtime.transports.packets.packet import AckNak, Broadcast, DataFlags, Packet

if TYPE_CHECKING:
    from jausml.live.peers.conformance.client import Client
    from jausml.live.peers.conformance.session import Session


def ping_payload(session: Session) -> bytes:
    """Returns a query that the target answers."""
    return session.ping[0].encode()


def expect_answer(session: Session, client: Client, what: str) -> None:
    """Takes an answer that has to come."""
    arrived = session.probe.wait(lambda: bool(client.inbox), session.probe.timeout)
    session.require(arrived, f"{what} is not answered")
    del client.inbox[0]


def expect_acknowledgement(session: Session, client: Client) -> tuple[Packet, Packet]:
    """Returns the acknowledgement of a query, and the query."""
    sent = client.packet(ping_payload(session), acknowledge=AckNak.REQUESTED)
    client.put(sent)
    if not session.probe.wait(lambda: bool(client.acknowledgements), session.probe.timeout):
        raise CheckFailed("a message that asks for it is not acknowledged")
    return client.acknowledgements.pop(0), sent


@check(
    "transport.ack",
    "Acknowledges a message that asks for it, once",
    "AS5669A, ack/nak flags",
)
def acknowledges(session: Session) -> None:
    """One acknowledgement from the target's own id comes for one message."""
    expect_acknowledgement(session, session.first)
    session.probe.wait(lambda: False, session.probe.quiet)
    count = 1 + len(session.first.acknowledgements)
    session.require(count == 1, f"{count} acknowledgements came for one message")


@check(
    "transport.ack-empty",
    "Acknowledges without payload",
    "AS5669A, acknowledgement: data size 14",
)
def acknowledges_empty(session: Session) -> None:
    """An acknowledgement is a header and a sequence number, 14 bytes in all."""
    acknowledgement, _ = expect_acknowledgement(session, session.first)
    size = len(acknowledgement.payload)
    session.require(not size, f"the acknowledgement has {size} bytes of payload")


@check(
    "transport.ack-sequence",
    "Acknowledges under the sequence number of the message",
    "AS5669A, acknowledgement: sequence number",
)
def acknowledges_sequence(session: Session) -> None:
    """The sender could not know otherwise which message has arrived."""
    acknowledgement, sent = expect_acknowledgement(session, session.first)
    session.require(
        acknowledgement.sequence == sent.sequence,
        f"message {sent.sequence} is acknowledged as {acknowledgement.sequence}",
    )


@check(
    "transport.ack-flags",
    "Acknowledges with the flags of an acknowledgement",
    "AS5669A, flags of the general transport header",
)
def acknowledges_flags(session: Session) -> None:
    """Ack/nak is 3, data flags are 0; broadcast 0 and the priority of the message are usual."""
    acknowledgement, sent = expect_acknowledgement(session, session.first)
    session.require(acknowledgement.acknowledge is AckNak.ACK, "a NAK came")
    session.require(
        acknowledgement.data_flags is DataFlags.SINGLE,
        f"the data flags of the acknowledgement are {acknowledgement.data_flags}",
    )
    if acknowledgement.broadcast is not Broadcast.NONE:
        session.note(f"the acknowledgement has broadcast {acknowledgement.broadcast}")
    if acknowledgement.priority is not sent.priority:
        session.note(f"the acknowledgement has priority {acknowledgement.priority}")


@check(
    "transport.no-ack",
    "Acknowledges nothing that does not ask for it",
    "AS5669A, ack/nak flags",
)
def no_acknowledgement(session: Session) -> None:
    """A message with ack/nak 0 is answered, but not acknowledged."""
    session.require_answers("nothing special")
    session.probe.wait(lambda: False, session.probe.quiet)
    session.require(
        not session.third.acknowledgements, "a message that asks for no acknowledgement got one"
    )


@check(
    "transport.duplicate",
    "Drops a message that comes twice",
    "AS5669A, sequence numbers",
)
def duplicate(session: Session) -> None:
    """The second datagram with the same source and sequence number is not answered."""
    client = session.first
    packet = client.packet(ping_payload(session))
    client.put(packet)
    expect_answer(session, client, "a query")
    client.put(packet)
    session.probe.wait(lambda: bool(client.inbox), session.probe.quiet)
    session.require(not client.inbox, "a repeated datagram is answered again")


@check(
    "transport.duplicate-ack",
    "Acknowledges a message that comes twice again",
    "AS5669A, retransmission",
)
def duplicate_acknowledged(session: Session) -> None:
    """The first acknowledgement may be lost; without a second one the sender would give up."""
    _, sent = expect_acknowledgement(session, session.first)
    session.probe.wait(lambda: False, session.probe.quiet)
    session.first.clear()
    session.first.put(sent)
    arrived = session.probe.wait(
        lambda: bool(session.first.acknowledgements), session.probe.timeout
    )
    session.require(arrived, "a repeated message is not acknowledged again")

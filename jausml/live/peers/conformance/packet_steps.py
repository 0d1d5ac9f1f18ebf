"""Steps of the checks of the transport: packets and datagrams of a query (AS5669A)."""

from __future__ import annotations

from collections.abc import Callable

from jausml.live.peers.conformance.check import step
from jausml.live.peers.conformance.client import Client
from jausml.live.peers.conformance.session import Session
from jausml.live.peers.conformance.steps import Judgement
from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.messages import CreateEvent
from jausml.runtime.transports.packets.packet import AckNak, DataFlags, Packet

UNKNOWN_CODE = b"\xb7\x7a"
"""A message code (7AB7) that no published service set uses."""


def packet_of_query(session: Session, client: Client) -> Packet:
    """Returns the next packet with a query that the target answers."""
    return client.packet(session.ping[0].encode())


@step
def query(
    session: Session,
    client: int,
    *,
    payload: bytes | None = None,
    acknowledge: AckNak = AckNak.NONE,
    destination: Callable[[Session], JausAddress] | None = None,
    message_type: int = 0,
    to_group: bool = False,
) -> None:
    """A query that the target answers is sent, or another payload; the header may be another."""
    test_client = session.client(client)
    packet = packet_of_query(session, test_client)._replace(
        acknowledge=acknowledge, message_type=message_type
    )
    if payload is not None:
        packet = packet._replace(payload=payload)
    if destination is not None:
        packet = packet._replace(destination=destination(session))
    if to_group:
        session.probe.put_to_group(packet)
    else:
        test_client.put(packet)


def everybody(_: Session) -> JausAddress:
    """All components there are."""
    return BROADCAST


def its_node(session: Session) -> JausAddress:
    """All components of the target's node."""
    target = session.probe.target
    return JausAddress(target.subsystem, target.node, 255)


def another(session: Session) -> JausAddress:
    """A component beside the target."""
    target = session.probe.target
    return JausAddress(target.subsystem, target.node, target.component % 254 + 1)


@step
def again(session: Session, client: int) -> None:
    """The packet that a client sent last is sent once more."""
    session.client(client).put(session.client(client).sent)


def sequence_sent(session: Session) -> int:
    """The sequence number of what our first client sent last."""
    return session.first.sent.sequence


@step
def datagram(
    session: Session, what: str, bytes_at: dict[int, bytes] | None = None, more: bytes = b""
) -> None:
    """A query is sent with other bytes at some offsets of its datagram, and more at its end."""
    data = packet_of_query(session, session.first).encode()
    for offset, others in (bytes_at or {}).items():
        data = data[:offset] + others + data[offset + len(others) :]
    session.probe.put_raw(data + more, what)


@step
def two_queries(session: Session) -> None:
    """Two queries are sent in one datagram."""
    first, second = (packet_of_query(session, session.first).encode() for _ in range(2))
    session.probe.put_raw(first + second[1:], "two queries in one datagram")


@step
def cut_short(session: Session) -> None:
    """A query is sent again and again, cut after each of its bytes."""
    data = packet_of_query(session, session.first).encode()
    for length in range(len(data)):
        session.probe.put_raw(data[:length], f"{length} of {len(data)} bytes of a query")


@step
def fragments(session: Session, *order: int, first: int | None = None) -> None:
    """Packets of a request in three that is answered and leaves nothing behind, in an order.

    Its sequence numbers begin with `first`.
    """
    session.skip_unless(session.serves("Events"), "the target answers nothing of Events")
    client = session.first
    if first is not None:
        client.skip_to(first)
    payload = CreateEvent(1, CreateEvent.EventType.EVERY_CHANGE, 0.0, UNKNOWN_CODE).encode()
    parts = (payload[:4], payload[4:8], payload[8:])
    flags = (DataFlags.FIRST, DataFlags.MIDDLE, DataFlags.LAST)
    packets = [
        client.packet(part, data_flags=flag) for part, flag in zip(parts, flags, strict=True)
    ]
    for index in order:
        client.put(packets[index])


@step
def answered(session: Session, client: int, what: str = "a query", *, tolerated: str = "") -> None:
    """A client is sent something; what silence means may be noted instead."""
    test_client = session.client(client)
    if session.probe.wait(lambda: bool(test_client.inbox), session.probe.timeout):
        del test_client.inbox[0]
        return
    session.require(bool(tolerated), f"{what} is not answered")
    session.note(tolerated)


@step
def acknowledged(
    session: Session, client: int, *judgements: Judgement[Packet], tolerated: str = ""
) -> None:
    """A message that asks for it is acknowledged as it should be; silence may be noted."""
    test_client = session.client(client)
    if session.probe.wait(lambda: bool(test_client.acknowledgements), session.probe.timeout):
        packet = test_client.acknowledgements.pop(0)
        for judge in judgements:
            judge(session, packet, "the acknowledgement")
        return
    session.require(bool(tolerated), "a message that asks for it is not acknowledged")
    session.note(tolerated)


@step
def unacknowledged(session: Session, client: int, why: str) -> None:
    """No acknowledgement comes to a client within the quiet time."""
    session.pause()
    session.require(
        not session.client(client).acknowledgements, f"an acknowledgement came, but {why}"
    )

"""Addresses, packets and threads for tests of transports."""

import threading

from jausml.runtime.base.address import JausAddress
from jausml.runtime.transports.packets.packet import AckNak, Packet

from .conftest import wait_until

DRIVER = JausAddress(100, 1, 1)
SENSOR = JausAddress(100, 1, 2)
OCU = JausAddress(200, 1, 1)
PEER = JausAddress(300, 1, 1)
STATUS = b"\x02\x40" + bytes(5)


def from_peer(payload: bytes = STATUS, sequence: int = 1, **fields) -> Packet:
    return Packet(fields.pop("destination", DRIVER), PEER, payload, sequence, **fields)


def join(peer, at) -> None:
    """Lets a station learn where the peer is."""
    before = at.counter("transport.nak")
    peer.send(from_peer(b"", 0, acknowledge=AckNak.NAK), at.transport.endpoint)
    wait_until(lambda: at.counter("transport.nak") > before)


def in_threads(work) -> None:
    """Lets four threads work, each told its index, until all are done."""
    threads = [threading.Thread(target=work, args=(index,)) for index in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()

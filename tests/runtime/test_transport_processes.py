"""Several processes of one host on one JUDP port."""

import queue
from collections.abc import Callable
from pathlib import Path

import pytest

from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.transports.packets.packet import AckNak, Packet

from .conftest import Program

pytestmark = pytest.mark.ports

SCRIPT = Path(__file__).with_name("judp_process.py")

A, B, C = (JausAddress(100, 1, component) for component in (1, 2, 3))
PEER = JausAddress(300, 1, 1)


class Process(Program):
    """A running judp_process.py."""

    def __init__(self, port: int, address: JausAddress) -> None:
        super().__init__(SCRIPT, port, address)
        self.address = address
        self.port = int(self.expect("open").rpartition(":")[2])

    def send(self, destination: JausAddress, payload: bytes) -> None:
        self.tell(f"send {destination} {payload.hex()}")


@pytest.fixture
def process(start, free_port: int) -> Callable[[JausAddress], Process]:
    """Starts processes on one free port."""
    return lambda address: start(free_port, address, kind=Process)


def ask(peer, address: JausAddress, sequence: int) -> Packet:
    """Sends to a component at the well-known port, acknowledged; returns its echo."""
    wanted = AckNak.REQUESTED
    peer.send(Packet(address, PEER, b"\x02\x40hi", sequence, acknowledge=wanted))
    answers = [peer.receive(), peer.receive()]
    kinds = {answer.acknowledge for answer in answers}
    assert {answer.source for answer in answers} == {address}
    assert AckNak.ACK in kinds
    return next(answer for answer in answers if answer.acknowledge is not AckNak.ACK)


def test_processes_share_the_port_and_reach_each_other(process, free_port):
    a, b, c = process(A), process(B), process(C)
    assert a.port == free_port
    assert len({a.port, b.port, c.port}) == 3
    b.send(BROADCAST, b"\x02\x40hello")
    for other in (a, c):
        assert other.expect("got") == f"got {B} {BROADCAST} 024068656c6c6f"
    c.send(B, b"\x02\x40hi")
    assert b.expect("got") == f"got {C} {B} 02406869"
    assert c.expect("got") == f"got {B} {C} 00d06869"


def test_the_owner_forwards_to_the_process_that_is_meant(process, peer):
    process(A)
    b = process(B)
    assert ask(peer, A, 1).payload == b"\x00\xd0hi"
    assert ask(peer, B, 2).payload == b"\x00\xd0hi"
    assert peer.answered_from == ("127.0.0.1", b.port)  # straight, not back through the owner
    assert b.expect("got") == f"got {PEER} {B} 02406869"


def test_another_process_takes_over_the_port_of_a_dead_owner(process, peer, free_port):
    a, b, c = process(A), process(B), process(C)
    a.kill()
    assert any(takes_over(one, free_port) for one in (b, c))
    for one, sequence in ((b, 1000), (c, 2000)):
        assert eventually_answers(peer, one.address, sequence)


def takes_over(one: Process, port: int) -> bool:
    """Returns whether the process comes to own the port in time."""
    try:
        return one.expect("open", seconds=3.0).endswith(f":{port}")
    except queue.Empty:
        return False


def eventually_answers(peer, address: JausAddress, sequence: int) -> bool:
    """Asks until the new owner has learnt where the component is."""
    for attempt in range(50):
        peer.send(Packet(address, PEER, b"\x02\x40hi", sequence + attempt))
        try:
            answer = peer.receive(seconds=0.2)
        except TimeoutError:
            continue
        if answer.source == address:
            return True
    return False

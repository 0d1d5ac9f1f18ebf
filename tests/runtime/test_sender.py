"""Prepared senders: what they send is what `send` sends, in all cases."""

import random
import threading

import pytest

from jausml.runtime.base.address import BROADCAST
from jausml.runtime.transports.packets.packet import AckNak, Broadcast, Packet, Priority

from .conftest import wait_until
from .transport_support import DRIVER, OCU, PEER, SENSOR, STATUS, join

pytestmark = pytest.mark.ports


@pytest.fixture
def driver(station, peer):
    """A station that knows where the peer is."""
    made = station().attach(DRIVER)
    join(peer, made)
    return made


@pytest.fixture
def send(driver):
    """Sends to the peer."""
    return driver.transport.sender(DRIVER, PEER)


def test_a_known_peer_gets_plain_datagrams_in_order(driver, peer):
    send = driver.transport.sender(DRIVER, PEER, Priority.HIGH)
    sent = driver.counter("judp.sent")
    for number in range(5):
        send(STATUS + bytes([number]))
        driver.transport.send(DRIVER, PEER, STATUS)
    received = [peer.receive() for _ in range(10)]
    first = received[0].sequence
    for index, packet in enumerate(received):
        sequence = first + index & 0xFFFF
        if index % 2:
            assert packet == Packet(PEER, DRIVER, STATUS, sequence)
        else:
            payload = STATUS + bytes([index // 2])
            assert packet == Packet(PEER, DRIVER, payload, sequence, Priority.HIGH)
    assert driver.counter("judp.sent") == sent + 10


def test_numbers_wrap(station, peer, monkeypatch):
    monkeypatch.setattr(random, "randrange", lambda _: 65534)
    driver = station().attach(DRIVER)
    join(peer, driver)
    send = driver.transport.sender(DRIVER, PEER)
    for _ in range(4):
        send(STATUS)
    assert [peer.receive().sequence for _ in range(4)] == [65534, 65535, 0, 1]


def test_an_unknown_peer_is_searched_and_then_sent_to(station, peer):
    driver = station().attach(DRIVER)
    send = driver.transport.sender(DRIVER, PEER)
    send(STATUS)
    packet = peer.overhear()
    assert (packet.broadcast, packet.acknowledge) == (Broadcast.GLOBAL, AckNak.REQUESTED)
    join(peer, driver)
    send(STATUS)
    packet = peer.receive()
    assert (packet.broadcast, packet.acknowledge) == (Broadcast.NONE, AckNak.NONE)


def test_a_peer_that_moved_is_sent_to_where_it_is(station, peer):
    driver = station(address_book={PEER: ("127.0.0.1", 9)}).attach(DRIVER)
    send = driver.transport.sender(DRIVER, PEER)
    send(STATUS)
    join(peer, driver)
    send(STATUS)
    assert peer.receive().payload == STATUS


def test_a_doubted_peer_is_asked(station, peer):
    driver = station(address_lifetime=0.1).attach(DRIVER)
    join(peer, driver)
    send = driver.transport.sender(DRIVER, PEER)
    heard = driver.transport.loop.now()
    wait_until(lambda: driver.transport.loop.now() > heard + 0.15)
    send(STATUS)
    assert peer.receive().acknowledge is AckNak.REQUESTED


def test_components_of_this_process_are_reached_without_the_network(station):
    here = station().attach(DRIVER)
    send = here.transport.sender(DRIVER, SENSOR)
    here.attach(SENSOR)
    send(STATUS)
    wait_until(lambda: here.received)
    assert here.received[0][0] == SENSOR
    assert here.counter("judp.sent") == 0


def test_a_broadcast_goes_to_the_group(station, peer):
    driver = station().attach(DRIVER)
    driver.transport.sender(DRIVER, BROADCAST)(STATUS)
    assert peer.overhear().broadcast is Broadcast.GLOBAL


@pytest.mark.parametrize("size", [4079, 4080, 60_000])
def test_a_large_message_arrives_whole(station, size):
    driver, ocu = station().attach(DRIVER), station().attach(OCU)
    payload = STATUS + random.Random(1).randbytes(size - len(STATUS))
    driver.transport.sender(DRIVER, OCU)(payload)
    wait_until(lambda: ocu.received)
    assert ocu.payloads == [payload]


def test_a_payload_needs_a_message_code(driver):
    with pytest.raises(ValueError, match="message code"):
        driver.transport.sender(DRIVER, PEER)(b"\x01")


def test_a_transport_that_is_closed_counts(driver, send):
    driver.transport.close()
    send(STATUS)
    assert driver.counter("judp.send_failed") == 1


def test_messages_of_many_threads_have_their_own_numbers(send, peer):

    def work() -> None:
        for _ in range(40):
            send(STATUS)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    numbers = [peer.receive().sequence for _ in range(160)]
    for thread in threads:
        thread.join()
    assert len(set(numbers)) == 160
    assert (max(numbers) - min(numbers)) & 0xFFFF >= 159

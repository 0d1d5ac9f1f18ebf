"""Against a peer that behaves as Junior does, with what it can and cannot take."""

import os
import struct

import pytest
from keeping_peer import KeepingPeer

from jausml.live.peers.makes.junior import REPORT_STATUS, STANDBY, JtsComponent
from jausml.live.peers.makes.vehicle import Place
from jausml.runtime import ComponentSettings, JausComponent, ServiceIdentity
from jausml.runtime.base.address import BROADCAST
from jausml.runtime.transports.packets import outbox
from jausml.runtime.transports.packets.packet import Packet

from .conftest import wait_until
from .transport_support import DRIVER, OCU, PEER, STATUS

pytestmark = pytest.mark.ports

QUERY_STATUS = b"\x02\x20"


@pytest.fixture
def junior(free_port):
    """A component on Junior, on the same port of another host."""
    with KeepingPeer(PEER, Place(port=free_port)) as made:
        made.transmissions = 50
        yield made


def test_first_contact_works_both_ways(station, junior):
    driver = station().attach(DRIVER)
    driver.transport.send(DRIVER, PEER, STATUS)
    wait_until(lambda: junior.payloads == [STATUS])
    assert junior.send(DRIVER, STATUS, acknowledge=True)
    wait_until(lambda: driver.payloads == [STATUS])


def test_messages_of_many_packets_pass_both_ways(station, junior):
    driver = station().attach(DRIVER)
    big = os.urandom(100_000)
    results = []
    driver.transport.send(DRIVER, PEER, big, acknowledge=True, on_result=results.append)
    wait_until(lambda: results == [True])
    wait_until(lambda: junior.payloads == [big])
    for acknowledge in (True, False):
        assert junior.send(DRIVER, big, acknowledge=acknowledge)
    wait_until(lambda: driver.payloads == [big, big])


def test_a_broadcast_reaches_it(station, junior):
    station().attach(DRIVER).transport.send(DRIVER, BROADCAST, STATUS)
    wait_until(lambda: junior.received == [(DRIVER, STATUS)])


def test_an_empty_message_ends_a_generated_component(station, peer, free_port):
    with JtsComponent(PEER, Place(port=free_port)) as component:
        driver = station().attach(DRIVER)
        driver.transport.send(DRIVER, PEER, QUERY_STATUS)
        wait_until(lambda: driver.payloads == [struct.pack("<HBI", REPORT_STATUS, STANDBY, 0)])
        peer.send(Packet(PEER, OCU), component.endpoint)
        wait_until(lambda: not component.alive)
        component.restart()
        assert component.alive


def big(count: int, size: int) -> list[bytes]:
    return [STATUS + os.urandom(size - len(STATUS)) for _ in range(count)]


def met(station, junior):
    """A component that knows where the peer is, and gives a busy computer time."""
    driver = station(acknowledge_retries=50).attach(DRIVER)
    assert junior.send(DRIVER, b"\x01\x40", acknowledge=True)
    wait_until(lambda: driver.payloads)
    driver.received.clear()
    return driver


@pytest.mark.parametrize(("count", "size"), [(3, 100_000), (8, 100_000), (8, 50_000)])
def test_large_messages_at_the_same_time_all_arrive(station, junior, count, size):
    """It holds 50 loose packets; those of several messages by turns push each other out."""
    driver = met(station, junior)
    sent, results = big(count, size), []
    for payload in sent:
        driver.transport.send(DRIVER, PEER, payload, acknowledge=True, on_result=results.append)
    wait_until(lambda: len(results) == count, 60)
    assert results == [True] * count
    wait_until(lambda: len(junior.payloads) == count)
    assert junior.payloads == sent
    assert junior.thrown_away == 0


@pytest.mark.parametrize("size", [50_000, 100_000, 150_000, 200_000])
def test_a_large_message_without_acknowledgement_arrives(station, junior, size):
    """Its receive buffer holds 70,000 bytes, which a message in one go does not fit."""
    driver = met(station, junior)
    (sent,) = big(1, size)
    driver.transport.send(DRIVER, PEER, sent)
    wait_until(lambda: junior.payloads == [sent], 60)


def test_messages_of_several_packets_in_a_row_arrive(station, junior, monkeypatch):
    monkeypatch.setattr(outbox, "_BEST_EFFORT_PATIENCE_S", 60.0)
    driver = met(station, junior)
    sent = big(6, 38_000)
    for payload in sent:
        driver.transport.send(DRIVER, PEER, payload)
    wait_until(lambda: sent[-1] in junior.payloads, 60)
    # The first has ten packets, for which nobody asks: where the peer stands still it may be lost.
    assert junior.payloads in (sent, sent[1:])


def test_a_burst_of_acknowledged_messages_arrives(station, junior):
    driver = met(station, junior)
    results: list[bool] = []
    for _ in range(1000):
        driver.transport.send(DRIVER, PEER, STATUS, acknowledge=True, on_result=results.append)
    wait_until(lambda: len(results) == 1000, 60)
    assert results == [True] * 1000
    wait_until(lambda: len(junior.payloads) == 1000)


def test_a_message_that_it_cannot_hold_is_warned_of_once(station, junior, caplog):
    driver = met(station, junior)
    results: list[bool] = []
    for payload in big(2, 52 * 4079):
        driver.transport.send(DRIVER, PEER, payload, on_result=results.append)
    wait_until(lambda: len(results) == 2, 60)
    assert junior.payloads == []
    assert caplog.text.count("takes 52 packets; Junior") == 1


def test_a_component_that_runs_again_is_heard(station, junior):
    """Its numbers start at 1 in each process."""
    driver = station().attach(DRIVER)
    for run in range(3):
        sent = [STATUS + bytes([run, number]) for number in range(5)]
        assert all(junior.send(DRIVER, payload, acknowledge=True) for payload in sent)
        wait_until(lambda: len(driver.received) == 5)
        assert driver.payloads == sent
        driver.received.clear()
        junior.restart()


def test_a_large_message_of_a_component_that_runs_again_is_heard(station, junior):
    driver = station().attach(DRIVER)
    first, second = big(2, 100_000)
    for payload in (first, second):
        assert junior.send(DRIVER, payload, acknowledge=True)
        wait_until(lambda: driver.payloads)
        assert driver.payloads == [payload]
        driver.received.clear()
        junior.restart()


def test_a_component_that_says_the_same_when_it_runs_again_is_heard(
    station, junior, clock, monkeypatch
):
    """JrConnect takes two seconds, in which nothing is a repetition any more."""
    driver = station().attach(DRIVER)
    monkeypatch.setattr(driver.loop, "now", clock)
    assert junior.send(DRIVER, STATUS, acknowledge=True)
    wait_until(lambda: driver.payloads)
    junior.restart()
    clock.time += 2.0
    assert junior.send(DRIVER, STATUS, acknowledge=True)
    wait_until(lambda: driver.payloads == [STATUS, STATUS])


def test_a_component_that_starts_elsewhere_and_has_nothing_to_say_is_found(station, junior):
    """Its address book never forgets where a component was."""
    services = [ServiceIdentity("urn:jaus:jss:core:Liveness", 1, 1)]
    settings = ComponentSettings(register_services=False)
    station().attach(OCU)  # owns the port
    for _ in range(2):
        transport = station().transport
        component = JausComponent(
            transport, DRIVER, name="silent", services=services, settings=settings
        )
        component.start()
        wait_until(lambda own=transport.endpoint: junior.knows(DRIVER) == own)
        assert junior.send(DRIVER, STATUS, acknowledge=True)
        component.stop()
        transport.close()

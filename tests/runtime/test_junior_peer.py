"""Against a peer that behaves as Junior does, with what it can and cannot take."""

from __future__ import annotations

import os
import struct

import pytest
from jts_component import REPORT_STATUS, STANDBY, JtsComponent
from junior_peer import JuniorPeer

from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.transports.packets.packet import Packet

pytestmark = pytest.mark.ports

DRIVER = JausAddress(100, 1, 1)
PEER = JausAddress(300, 1, 1)
OCU = JausAddress(200, 1, 1)
STATUS = b"\x02\x40" + bytes(5)
QUERY_STATUS = b"\x02\x20"


@pytest.fixture
def junior(free_port):
    """A component on Junior, on the same port of another host."""
    with JuniorPeer(PEER, free_port) as made:
        yield made


def test_first_contact_works_both_ways(station, junior, wait_until):
    driver = station().attach(DRIVER)
    driver.transport.send(DRIVER, PEER, STATUS)
    wait_until(lambda: junior.payloads == [STATUS])
    assert junior.send(DRIVER, STATUS, acknowledge=True)
    wait_until(lambda: driver.payloads == [STATUS])


def test_messages_of_many_packets_pass_both_ways(station, junior, wait_until):
    driver = station().attach(DRIVER)
    big = os.urandom(100_000)
    results = []
    driver.transport.send(DRIVER, PEER, big, acknowledge=True, on_result=results.append)
    wait_until(lambda: results == [True])
    assert junior.payloads == [big]
    for acknowledge in (True, False):
        assert junior.send(DRIVER, big, acknowledge=acknowledge)
    wait_until(lambda: driver.payloads == [big, big])


def test_a_broadcast_reaches_it(station, junior, wait_until):
    station().attach(DRIVER).transport.send(DRIVER, BROADCAST, STATUS)
    wait_until(lambda: junior.received == [(DRIVER, STATUS)])


def test_an_empty_message_ends_a_generated_component(station, peer, free_port, wait_until):
    with JtsComponent(PEER, free_port) as component:
        driver = station().attach(DRIVER)
        driver.transport.send(DRIVER, PEER, QUERY_STATUS)
        wait_until(lambda: driver.payloads == [struct.pack("<HBI", REPORT_STATUS, STANDBY, 0)])
        peer.send(Packet(PEER, OCU), component.endpoint)
        wait_until(lambda: not component.alive)
        component.restart()
        assert component.alive

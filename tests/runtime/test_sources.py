"""Where messages may come from: hosts that are allowed, and sources that stay where they are."""

from __future__ import annotations

import argparse
import contextlib
import socket
from typing import TYPE_CHECKING

import pytest

from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.base.settings import (
    TransportKind,
    TransportSettings,
    add_arguments,
    from_arguments,
)
from jausml.runtime.transports.address_book import AddressBook, AllowedHosts
from jausml.runtime.transports.packets.packet import Packet

from .conftest import wait_until

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from conftest import Station

pytestmark = pytest.mark.ports

DRIVER, PEER = JausAddress(100, 1, 1), JausAddress(300, 1, 1)
HERE, THERE = ("10.0.0.1", 3794), ("10.0.0.2", 3794)
NOT_ALLOWED, REFUSED = "transport.source_not_allowed", "transport.source_refused"
TAKEN_OVER = "transport.address_changed"
STRANGER = "127.0.0.9"
"""An address of the loopback network that is not the interface of the tests."""


def message(number: int, text: bytes = b"1", destination: JausAddress = DRIVER) -> bytes:
    return Packet(destination, PEER, b"\x02\x40" + text, number).encode()


@pytest.fixture
def udp() -> Iterator[Callable[..., socket.socket]]:
    """Makes foreign sockets, on the interface of the tests or elsewhere."""
    with contextlib.ExitStack() as stack:

        def make(host: str = "127.0.0.1") -> socket.socket:
            made = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            made.bind((host, 0))
            return made

        yield make


@pytest.fixture
def tcp() -> Iterator[Callable[..., socket.socket]]:
    """Connects to a station from the interface of the tests or from elsewhere."""
    with contextlib.ExitStack() as stack:

        def make(to: Station, host: str = "127.0.0.1") -> socket.socket:
            made = socket.create_connection(to.transport.endpoint, 5, (host, 0))
            stack.enter_context(made)
            made.sendall(b"\x02")
            return made

        yield make


class TestAllowedHosts:
    @pytest.mark.parametrize(
        ("named", "host", "is_taken"),
        [
            ((), "192.0.2.1", True),
            (("10.0.0.0/24",), "10.0.0.255", True),
            (("10.0.0.0/24",), "10.0.1.0", False),
            (("10.0.0.0/24", "10.0.1.7"), "10.0.1.7", True),
            (("10.0.1.7",), "10.0.1.8", False),
            (("10.0.1.7",), "127.0.0.1", True),
            (("0.0.0.0/0",), "192.0.2.1", True),
        ],
    )
    def test_networks_addresses_and_the_own_host_are_taken(self, named, host, is_taken):
        counters = Counters()
        hosts = AllowedHosts(TransportSettings(allowed_hosts=named), counters)
        assert hosts.admits((host, 4000)) is is_taken
        assert counters.snapshot() == ({} if is_taken else {NOT_ALLOWED: 1})

    def test_a_flood_from_elsewhere_is_one_line(self, caplog):
        hosts = AllowedHosts(TransportSettings(allowed_hosts=("10.0.0.1",)), Counters())
        for _ in range(1000):
            hosts.admits(("192.0.2.1", 4000))
        assert [record.getMessage() for record in caplog.records] == [
            f"{NOT_ALLOWED} (1 times): 192.0.2.1:4000"
        ]

    @pytest.mark.parametrize("text", ["10.0.0.1/24", "10.0.0", "robot", "::1", "10.0.0.0/33"])
    def test_what_is_no_network_is_told(self, text):
        with pytest.raises(ValueError, match=f"allowed host '{text}'"):
            TransportSettings(allowed_hosts=(text,))

    def test_a_datagram_from_elsewhere_has_no_effect(self, station, udp):
        driver = station(allowed_hosts=("127.0.0.2",)).attach(DRIVER)
        stranger, friend = udp(STRANGER), udp("127.0.0.2")
        stranger.sendto(message(1), driver.transport.endpoint)
        # In the name of a component of this process it would be an error of the configuration.
        own = Packet(DRIVER, DRIVER, b"\x02\x40", 1).encode()
        stranger.sendto(own, driver.transport.endpoint)
        wait_until(lambda: driver.counter(NOT_ALLOWED) == 2)
        assert not driver.transport.address_book.learnt
        assert driver.transport.double_of(DRIVER) is None
        friend.sendto(message(1, b"2"), driver.transport.endpoint)
        wait_until(lambda: driver.payloads == [b"\x02\x402"])

    def test_nor_has_one_to_the_multicast_group(self, station, udp):
        driver = station(allowed_hosts=("10.0.0.0/8",)).attach(DRIVER)
        stranger, here = udp(STRANGER), udp()
        for udp_socket in (stranger, here):
            interface = socket.inet_aton("127.0.0.1")
            udp_socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, interface)
        group = ("239.255.0.1", driver.transport.endpoint[1])
        stranger.sendto(message(1, b"1", BROADCAST), group)
        here.sendto(message(2, b"2", BROADCAST), group)
        wait_until(lambda: driver.payloads == [b"\x02\x402"])
        assert driver.counter(NOT_ALLOWED) == 1

    def test_a_neighbour_passes_nothing_on_from_elsewhere(self, station, udp):
        owner = station().attach(PEER)
        driver = station(allowed_hosts=("10.0.0.1",)).attach(DRIVER)
        known = driver.transport.endpoint
        wait_until(lambda: owner.transport.address_book.find(DRIVER) == known)
        for number, host in enumerate((STRANGER, "127.0.0.1")):
            text = b"%d" % number
            source = Packet(DRIVER, JausAddress(7, 1, 1), b"\x02\x40" + text, number).encode()
            udp(host).sendto(source, owner.transport.endpoint)
        wait_until(lambda: driver.payloads == [b"\x02\x401"])
        assert driver.counter(NOT_ALLOWED) == 1

    def test_a_connection_from_elsewhere_is_closed(self, station, tcp):
        settings = {"transport": TransportKind.JTCP, "allowed_hosts": ("127.0.0.2",)}
        driver = station(**settings).attach(DRIVER)
        stranger = tcp(driver, STRANGER)
        with contextlib.suppress(ConnectionError):
            while stranger.recv(100):
                pass
        assert driver.counter(NOT_ALLOWED) == 1
        tcp(driver, "127.0.0.2").sendall(message(1)[1:])
        wait_until(lambda: driver.payloads == [b"\x02\x401"])


class TestFixedSources:
    @pytest.fixture
    def counters(self) -> Counters:
        return Counters()

    @pytest.fixture
    def book(self, counters: Counters) -> AddressBook:
        return AddressBook(10.0, counters, fixed=True)

    def test_another_endpoint_is_refused_until_the_first_was_silent(self, book, counters):
        assert book.learn(PEER, HERE, 0.0)
        assert not book.learn(PEER, THERE, 9.9)
        assert book.learn(PEER, HERE, 10.0)
        assert not book.learn(PEER, THERE, 19.9)
        assert book.find(PEER) == HERE
        assert counters.snapshot() == {REFUSED: 2}
        assert book.learn(PEER, THERE, 20.0)
        assert book.find(PEER) == THERE

    def test_what_is_refused_does_not_let_the_first_live_on(self, book):
        book.learn(PEER, HERE, 0.0)
        for tenths in range(100):
            assert not book.learn(PEER, THERE, tenths / 10)
        assert book.learn(PEER, THERE, 10.0)

    def test_lost_acknowledgements_give_nobody_the_place(self, book):
        book.learn(PEER, HERE, 0.0)
        book.suspect(PEER, 0.5)
        book.suspect(PEER, 0.6)
        assert not book.learn(PEER, THERE, 1.0)
        assert book.learn(PEER, THERE, 10.0)

    def test_a_configured_place_is_no_place_where_it_was_heard(self, book):
        book.configure({PEER: HERE})
        assert book.learn(PEER, THERE, 0.0)
        assert not book.learn(PEER, HERE, 1.0)

    @pytest.mark.parametrize("fixed", [False, True])
    def test_one_datagram_does_not_take_the_traffic_over(self, station, udp, fixed):
        driver = station(fixed_sources=fixed).attach(DRIVER)
        peer, thief = udp(), udp()
        for number in (1, 2):  # the second one is usual
            peer.sendto(message(number), driver.transport.endpoint)
        wait_until(lambda: len(driver.payloads) == 2)
        thief.sendto(message(3, b"stop"), driver.transport.endpoint)
        wait_until(lambda: driver.counter(REFUSED if fixed else TAKEN_OVER) == 1)
        driver.transport.send(DRIVER, PEER, b"\x02\x40secret")
        receiver = peer if fixed else thief
        receiver.settimeout(5)
        assert b"secret" in receiver.recv(100)
        assert (b"\x02\x40stop" in driver.payloads) is not fixed
        peer.sendto(message(4, b"4"), driver.transport.endpoint)
        wait_until(lambda: driver.payloads[-1] == b"\x02\x404")

    def test_nor_does_one_that_acknowledges(self, station, udp):
        driver = station(fixed_sources=True).attach(DRIVER)
        peer, thief = udp(), udp()
        peer.sendto(message(1), driver.transport.endpoint)
        wait_until(lambda: driver.payloads)
        results = driver.send(DRIVER, PEER, b"\x02\x40", acknowledge=True)
        peer.settimeout(5)
        number = int.from_bytes(peer.recv(100)[-2:], "little")
        acknowledgement = Packet(DRIVER, PEER, b"", number, acknowledge=3).encode()
        thief.sendto(acknowledgement, driver.transport.endpoint)
        wait_until(lambda: driver.counter(REFUSED) == 1)
        assert not results
        peer.sendto(acknowledgement, driver.transport.endpoint)
        wait_until(lambda: results == [True])

    def test_a_connection_keeps_its_components_until_it_ends(self, station, tcp):
        settings = {"transport": TransportKind.JTCP, "fixed_sources": True}
        driver = station(**settings).attach(DRIVER)
        peer, thief = tcp(driver), tcp(driver)
        peer.sendall(message(1)[1:])
        wait_until(lambda: driver.payloads)
        for number, destination in enumerate((DRIVER, BROADCAST)):
            thief.sendall(message(2 + number, b"stop", destination)[1:])
        wait_until(lambda: driver.counter(REFUSED) == 2)
        assert driver.payloads == [b"\x02\x401"]
        peer.close()
        wait_until(lambda: len(driver.transport._connections) == 1)
        thief.sendall(message(4, b"new")[1:])
        wait_until(lambda: driver.payloads == [b"\x02\x401", b"\x02\x40new"])


def test_the_command_line_goes_before_the_model():
    model = TransportSettings(allowed_hosts=("10.0.0.0/24",), fixed_sources=True)

    def parse(*words: str) -> TransportSettings:
        parser = argparse.ArgumentParser()
        add_arguments(parser, model)
        return from_arguments(parser.parse_args(words), model)

    assert parse() == model
    changed = parse("--jaus-allowed-hosts=10.0.1.7, 10.0.2.0/24", "--no-jaus-fixed-sources")
    assert changed.allowed_hosts == ("10.0.1.7", "10.0.2.0/24")
    assert not changed.fixed_sources
    assert parse("--jaus-allowed-hosts=").allowed_hosts == ()

import random
import socket
import sys
import threading

import pytest
from network_hosts import NetworkHost

from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.transports.jtcp import JtcpTransport
from jausml.runtime.transports.packets.packet import AckNak, Broadcast, Packet, Priority
from jausml.runtime.transports.ports import neighbour_ports
from jausml.runtime.transports.udp import judp
from jausml.runtime.transports.udp.judp import JudpTransport
from jausml_generators.wireshark.target import NEIGHBOUR_PORTS

from .conftest import wait_until
from .transport_support import DRIVER, OCU, PEER, SENSOR, STATUS, from_peer, in_threads, join

pytestmark = pytest.mark.ports


class TestUnicast:
    def test_numbers_count_per_source_and_wrap(self, station, peer, monkeypatch):
        monkeypatch.setattr(random, "randrange", lambda _: 65534)
        driver = station().attach(DRIVER, SENSOR)
        join(peer, driver)
        for source in (DRIVER, DRIVER, SENSOR, DRIVER):
            driver.transport.send(source, PEER, STATUS)
        received = [peer.receive() for _ in range(4)]
        assert [(packet.source, packet.sequence) for packet in received] == [
            (DRIVER, 65534),
            (DRIVER, 65535),
            (SENSOR, 65534),
            (DRIVER, 0),
        ]

    def test_a_restarted_component_does_not_begin_at_the_same_number(self, station, peer):
        numbers = set()
        for _ in range(4):
            made = station()
            made.transport.send(DRIVER, PEER, STATUS)
            numbers.add(peer.overhear().sequence)
        assert len(numbers) > 1

    def test_a_received_message_says_all_that_a_component_needs(self, station, peer):
        driver = station().attach(DRIVER)
        peer.send(from_peer(sequence=77, priority=Priority.SAFETY_CRITICAL))
        wait_until(lambda: driver.received)
        assert driver.received == [(DRIVER, (PEER, STATUS, 77))]

    def test_a_configured_peer_is_reached_without_discovery(self, station, peer):
        driver = station(address_book={PEER: peer.endpoint})
        driver.transport.send(DRIVER, PEER, STATUS)
        packet = peer.receive()
        assert packet.payload == STATUS
        assert packet.acknowledge is AckNak.REQUESTED  # never heard, hence asked

    def test_the_newest_endpoint_of_a_component_is_used(self, station, peer):
        driver = station(address_book={PEER: ("127.0.0.1", 9)}).attach(DRIVER)
        join(peer, driver)
        driver.transport.send(DRIVER, PEER, STATUS)
        assert peer.receive().payload == STATUS

    def test_a_component_is_unheard_until_it_speaks(self, station, peer):
        driver = station().attach(DRIVER)
        assert driver.transport.is_unheard(PEER)
        assert not driver.transport.is_unheard(DRIVER)
        join(peer, driver)
        assert not driver.transport.is_unheard(PEER)


class TestWildcards:
    def test_every_matching_component_of_all_processes_but_not_the_sender(self, station):
        here, there = station().attach(DRIVER, SENSOR), station().attach(OCU)
        here.transport.send(DRIVER, BROADCAST, STATUS)
        here.transport.send(DRIVER, JausAddress(100, 255, 255), STATUS + b"own subsystem")
        here.transport.send(DRIVER, JausAddress(200, 255, 255), STATUS + b"other subsystem")
        wait_until(lambda: len(here.received) + len(there.received) == 4)
        assert [(own, message.payload) for own, message in here.received] == [
            (SENSOR, STATUS),
            (SENSOR, STATUS + b"own subsystem"),
        ]
        assert there.payloads == [STATUS, STATUS + b"other subsystem"]
        assert here.counter("transport.own_source") == 0

    def test_a_broadcast_is_not_fragmented(self, station, caplog):
        driver = station(fragment_size=100).attach(DRIVER)
        assert driver.result(DRIVER, BROADCAST, bytes(4080)) is False
        assert driver.counter("transport.broadcast_too_large") == 1
        assert "a broadcast goes in one packet, of 4079 bytes at most" in caplog.text
        assert driver.counter("judp.sent") == 0

    def test_a_broadcast_is_sent_whole_where_other_packets_are_small(self, station, peer):
        station(fragment_size=100).transport.send(DRIVER, BROADCAST, STATUS + bytes(1000))
        assert peer.overhear().payload == STATUS + bytes(1000)


class TestSameProcess:
    def test_components_reach_each_other_without_the_network(self, station):
        driver = station().attach(DRIVER, SENSOR)
        big = bytes(20_000)
        assert driver.result(DRIVER, SENSOR, big, acknowledge=True) is True
        ((own, message),) = driver.received
        assert (own, message.source, message.payload) == (SENSOR, DRIVER, big)
        assert driver.counter("judp.sent") == 0

    def test_an_answer_within_a_callback_is_not_recursion(self, station):
        here = station()
        depths: list[int] = []
        active = 0

        def answer(own, other):
            def receive(payload, _source):
                nonlocal active
                active += 1
                depths.append(active)
                if len(depths) < 200:
                    here.transport.send(own, other, payload)
                active -= 1

            return receive

        here.transport.attach(DRIVER, answer(DRIVER, SENSOR))
        here.transport.attach(SENSOR, answer(SENSOR, DRIVER))
        here.transport.send(DRIVER, SENSOR, STATUS)
        wait_until(lambda: len(depths) == 200)
        assert set(depths) == {1}

    def test_a_component_detached_meanwhile_gets_nothing(self, station):
        here = station().attach(SENSOR)
        with here.loop.lock:
            results = here.send(DRIVER, SENSOR, STATUS)
            here.transport.detach(SENSOR)
        wait_until(lambda: results)
        assert results == [False]
        assert not here.received

    def test_one_failing_component_does_not_silence_the_others(self, station, peer):
        here = station()

        def fail(_payload, _source):
            raise RuntimeError("boom")

        here.transport.attach(DRIVER, fail)
        here.attach(SENSOR)
        peer.multicast_out(from_peer(destination=BROADCAST))
        wait_until(lambda: here.received)
        assert here.counter("transport.receiver_failed") == 1


class TestAttach:
    def test_only_one_component_may_have_an_address(self, station):
        here = station().attach(DRIVER)
        with pytest.raises(ValueError, match="attached already"):
            here.transport.attach(DRIVER, print)
        here.transport.detach(DRIVER)
        here.transport.detach(DRIVER)
        here.transport.attach(DRIVER, print)

    @pytest.mark.parametrize("address", [BROADCAST, JausAddress(0, 1, 1)])
    def test_an_address_must_be_one_component(self, station, address):
        here = station()
        with pytest.raises(ValueError, match="one component"):
            here.transport.attach(address, print)
        with pytest.raises(ValueError, match="one component"):
            here.transport.send(address, DRIVER, STATUS)

    def test_a_payload_needs_a_message_code(self, station):
        with pytest.raises(ValueError, match="message code"):
            station().transport.send(DRIVER, PEER, b"\x00")

    def test_a_reserved_destination_is_counted(self, station):
        here = station()
        assert here.result(DRIVER, JausAddress(0, 0, 0), STATUS) is False
        assert here.counter("transport.bad_destination") == 1


class TestAcknowledge:
    def test_a_multicast_to_a_unicast_id_is_received_and_acknowledged(self, station, peer):
        driver = station().attach(DRIVER)
        peer.multicast_out(from_peer(acknowledge=AckNak.REQUESTED, broadcast=Broadcast.GLOBAL))
        assert peer.receive().source == DRIVER
        wait_until(lambda: driver.payloads == [STATUS])

    def test_four_transmissions_then_failure(self, station, peer):
        here = station(acknowledge_timeout=0.02).attach(DRIVER)
        join(peer, here)
        results = here.send(DRIVER, PEER, STATUS, acknowledge=True)
        packets = [peer.receive() for _ in range(4)]
        wait_until(lambda: results)
        assert results == [False]
        assert len(set(packets)) == 1
        assert packets[0].acknowledge is AckNak.REQUESTED
        assert peer.is_quiet()
        wait_until(lambda: here.counter("transport.unacknowledged") == 1)

    def test_a_late_acknowledgement_ends_the_repetition(self, station, peer):
        here = station(acknowledge_timeout=0.02, acknowledge_retries=50).attach(DRIVER)
        join(peer, here)
        results = here.send(DRIVER, PEER, STATUS, acknowledge=True)
        peer.receive()
        packet = peer.receive()
        stranger = Packet(DRIVER, OCU, b"", packet.sequence, acknowledge=AckNak.ACK)
        peer.send(stranger, here.transport.endpoint)
        peer.send(from_peer(b"", packet.sequence, acknowledge=AckNak.ACK), here.transport.endpoint)
        wait_until(lambda: results)
        assert results == [True]
        assert here.counter("transport.unmatched_acknowledgement") == 1

    @pytest.mark.parametrize("version", [b"", b"\x00", b"\x01", b"\x03"])
    def test_an_acknowledgement_counts_whatever_version_it_states(self, station, peer, version):
        # JAUS++ states none: its acknowledgements have 14 bytes.
        here = station(acknowledge_timeout=0.5).attach(DRIVER)
        join(peer, here)
        results = here.send(DRIVER, PEER, STATUS, acknowledge=True)
        packet = peer.receive()
        data = from_peer(b"", packet.sequence, acknowledge=AckNak.ACK).encode()
        peer.send(version + data[1:], here.transport.endpoint)
        wait_until(lambda: results)
        assert results == [True]
        assert peer.is_quiet()
        assert here.counter("judp.acknowledgement_of_other_version") == 1

    def test_closing_reports_what_still_waits(self, station):
        here = station(acknowledge_timeout=30.0)
        results = here.send(DRIVER, PEER, STATUS, acknowledge=True)
        here.transport.close()
        wait_until(lambda: results)
        assert results == [False]


class TestUnknownDestination:
    def test_it_is_multicast_and_the_acknowledgement_teaches(self, station, peer):
        here = station().attach(DRIVER)
        here.transport.send(DRIVER, PEER, STATUS)
        packet = peer.overhear()
        assert packet.destination == PEER
        assert (packet.acknowledge, packet.broadcast) == (AckNak.REQUESTED, Broadcast.GLOBAL)
        answer = from_peer(b"", packet.sequence, acknowledge=AckNak.ACK)
        peer.send(answer, here.transport.endpoint)
        wait_until(lambda: here.counter("transport.unmatched_acknowledgement") == 1)
        here.transport.send(DRIVER, PEER, STATUS)
        assert peer.receive().acknowledge is AckNak.NONE

    def test_a_component_that_moved_is_found_again(self, station):
        station()  # owns the port, and is told where the others are
        here, there = station().attach(DRIVER), station().attach(OCU)
        assert here.result(DRIVER, OCU, STATUS, acknowledge=True) is True
        there.transport.close()
        elsewhere = station().attach(OCU)
        assert here.result(DRIVER, OCU, STATUS, acknowledge=True) is True
        wait_until(lambda: elsewhere.received)
        assert here.transport.address_book.find(OCU) == elsewhere.transport.endpoint

    def test_a_silent_peer_is_asked_and_then_searched(self, station, peer):
        here = station(address_lifetime=0.1).attach(DRIVER)
        join(peer, here)
        seen: list[Packet] = []

        def sends_until(wanted) -> None:
            def attempt() -> bool:
                here.transport.send(DRIVER, PEER, STATUS)
                seen.append(peer.receive())
                return wanted()

            wait_until(attempt)

        sends_until(lambda: seen[-1].acknowledge is AckNak.REQUESTED)
        assert seen[0].acknowledge is AckNak.NONE
        assert seen[-1].broadcast is Broadcast.NONE
        count = len(seen)
        sends_until(lambda: seen[-1].acknowledge is AckNak.REQUESTED and len(seen) > count)
        searched = peer.overhear()
        assert searched.sequence == seen[-1].sequence
        assert searched.broadcast is Broadcast.GLOBAL


class TestThreads:
    def test_messages_of_many_threads_all_arrive_with_their_own_number(self, station):
        here, there = station().attach(DRIVER), station().attach(OCU)
        here.transport.send(DRIVER, OCU, STATUS)
        wait_until(lambda: there.received)

        def work(index: int) -> None:
            for count in range(50):
                here.transport.send(DRIVER, OCU, bytes([2, 64, index, count]))

        in_threads(work)
        wait_until(lambda: len(there.received) == 201)
        assert len({message.sequence for _, message in there.received}) == 201

    def test_sending_does_not_wait_for_the_loop(self, station, peer):
        here = station()
        with here.loop.lock:
            thread = threading.Thread(target=here.transport.send, args=(DRIVER, PEER, STATUS))
            thread.start()
            assert peer.overhear().payload == STATUS
            thread.join()


REPLUGGED = """
import subprocess, time
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.transports.udp.judp import JudpTransport

def ip(words):
    subprocess.run(["ip", *words.split()], check=True)

def plug():
    ip("link add wire type veth peer name other")
    ip("address add 192.0.2.1/24 dev wire")
    for name in ("wire", "other"):
        ip(f"link set {name} up")

plug()
with Loop() as loop:
    transport = JudpTransport(TransportSettings(interface="192.0.2.1"), loop)
    transport.open()
    port = transport._port
    for _ in range(22):  # the kernel keeps 20 memberships
        assert not port.rejoin()
        ip("link delete wire")
        assert not port.rejoin()
        plug()
        assert port.rejoin()
    ip("link delete wire")
    plug()
    while not loop.counters.snapshot().get("judp.rejoined"):
        loop.run_once(0.1)
    port.unicast.sendto(b"hello", port.group)
    while not loop.counters.snapshot().get("judp.own_multicast"):
        loop.run_once(0.1)
    transport.close()
"""


class TestNetworkFailure:
    @pytest.mark.needs("namespaces of networks")
    def test_an_interface_that_is_removed_and_comes_back_is_used_again(self):
        host = NetworkHost("192.0.2.1")
        try:
            host.run(sys.executable, "-c", REPLUGGED)
        finally:
            host.close()

    def test_a_transport_that_is_not_open_counts(self):
        with Loop() as loop:
            transport = JudpTransport(TransportSettings(), loop)
            results: list[bool] = []
            transport.send(DRIVER, PEER, STATUS, on_result=results.append)
            loop.run_once(0)
            assert results == [False]
            assert loop.counters.snapshot() == {"judp.send_failed": 1}
            assert transport.endpoint is None
            transport.close()

    def test_an_endpoint_that_cannot_be_reached_is_counted(self, station):
        here = station(address_book={PEER: ("255.255.255.255", 9)})
        here.transport.send(DRIVER, PEER, STATUS)
        assert here.counter("judp.send_failed") == 1

    @pytest.mark.parametrize("kind", [JudpTransport, JtcpTransport])
    def test_an_unusable_interface_is_an_error_of_open(self, kind):
        with Loop() as loop:
            transport = kind(TransportSettings(interface="192.0.2.200"), loop)
            with pytest.raises(OSError, match=r"192\.0\.2\.200"):
                transport.open()

    def test_a_port_taken_by_another_program_is_left_to_it(self, station, peer, free_port):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as foreign:
            foreign.bind(("127.0.0.1", free_port))
            here = station(takeover_interval=0.05).attach(DRIVER)
            former = here.transport.endpoint
            assert former[1] != free_port
        wait_until(lambda: here.transport.endpoint == ("127.0.0.1", free_port))
        wait_until(lambda: here.counter("judp.port_taken_over") == 1)
        receiving = []
        here.transport.receive_by(lambda sock, _by_group: receiving.append(sock) or sock.recvfrom)
        # A core waits at the last one.
        assert [sock.getsockname() for sock in receiving[-2:]] == [former, here.transport.endpoint]
        for sequence, endpoint in enumerate([former, here.transport.endpoint]):
            peer.send(from_peer(sequence=sequence), endpoint)
        wait_until(lambda: len(here.received) == 2)

    def test_processes_that_share_a_port_are_at_known_ones(self, station):
        ports = [station(port=3794).transport.endpoint[1] for _ in range(3)]
        assert ports == [3794, 53794, 53795]
        assert list(neighbour_ports(3794)) == list(NEIGHBOUR_PORTS)
        assert not neighbour_ports(15_505)

    def test_a_port_beside_it_that_is_taken_is_left_out(self, station):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as foreign:
            foreign.bind(("127.0.0.1", 53794))
            ports = [station(port=3794).transport.endpoint[1] for _ in range(2)]
        assert ports == [3794, 53795]

    def test_a_node_manager_that_shares_the_port_is_run_beside(self, station, free_port):
        """That of fkie takes the port of all interfaces, and allows others to."""
        interface, group = socket.inet_aton("127.0.0.1"), "239.255.0.1"
        with (
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as manager,
            socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asking,
        ):
            manager.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
            manager.bind(("0.0.0.0", free_port))  # noqa: S104
            member = socket.inet_aton(group) + interface
            manager.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
            asking.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, interface)
            for udp_socket in (manager, asking):
                udp_socket.settimeout(5)
            here = station().attach(DRIVER)
            question = from_peer(destination=BROADCAST, acknowledge=AckNak.REQUESTED).encode()
            asking.sendto(question, (group, free_port))
            endpoint = asking.recvfrom(65535)[1]
            assert endpoint == here.transport.endpoint != ("127.0.0.1", free_port)
            asking.sendto(from_peer(sequence=2).encode(), endpoint)
            wait_until(lambda: len(here.received) == 2)
            to_manager = from_peer(sequence=3).encode()
            asking.sendto(to_manager, ("127.0.0.1", free_port))
            heard = [manager.recv(65535)]
            while heard[-1] != to_manager:
                heard.append(manager.recv(65535))
            assert question in heard

    def test_a_node_manager_that_starts_later_is_warned_of(
        self, tmp_path_factory, caplog, monkeypatch
    ):
        folder = tmp_path_factory.mktemp("nm")
        monkeypatch.setattr(judp, "_MANAGER_INTERVAL_S", 0.02)
        settings = TransportSettings(node_manager_directory=str(folder))
        with Loop() as loop:
            transport = JudpTransport(settings, loop)
            transport.open()
            loop.start()
            with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
                manager.bind(str(folder / "JuniorRTE"))
                wait_until(lambda: "a node manager runs on this host" in caplog.text)
            transport.close()
        assert caplog.text.count("a node manager runs") == 1
        assert str(folder) in caplog.text

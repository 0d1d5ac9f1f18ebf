"""What a transport makes of messages in parts, and of datagrams that are none."""

import random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.transports.packets.packet import AckNak, DataFlags, Packet
from jausml.runtime.transports.udp.judp import JudpTransport

from .conftest import wait_until
from .transport_support import DRIVER, OCU, PEER, SENSOR, STATUS, from_peer, join

pytestmark = pytest.mark.ports


class TestFragments:
    @pytest.mark.parametrize("acknowledge", [False, True])
    @pytest.mark.parametrize("size", [4079, 4080, 4079 * 3, 100_001])
    def test_large_messages_arrive_whole(self, station, size, acknowledge):
        here, there = station().attach(DRIVER), station().attach(OCU)
        payload = random.Random(size).randbytes(size)
        assert here.result(DRIVER, OCU, payload, acknowledge=acknowledge) is True
        wait_until(lambda: there.received)
        assert there.payloads == [payload]

    def test_the_chunks_of_a_message(self, station, peer, monkeypatch):
        monkeypatch.setattr(random, "randrange", lambda _: 65535)
        here = station(fragment_size=4).attach(DRIVER)
        join(peer, here)
        here.transport.send(DRIVER, PEER, b"\x02\x40abcdefg")
        packets = [peer.receive() for _ in range(3)]
        assert [(p.sequence, p.data_flags, p.payload) for p in packets] == [
            (65535, DataFlags.FIRST, b"\x02\x40ab"),
            (0, DataFlags.MIDDLE, b"cdef"),
            (1, DataFlags.LAST, b"g"),
        ]

    def test_acknowledged_chunks_go_one_by_one(self, station, peer):
        here = station(fragment_size=4, acknowledge_timeout=0.05, acknowledge_retries=100)
        here.attach(DRIVER)
        join(peer, here)
        results = here.send(DRIVER, PEER, b"\x02\x40abcdef", acknowledge=True)
        first = peer.receive()
        assert peer.receive() == first
        peer.send(from_peer(b"", first.sequence, acknowledge=AckNak.ACK), here.transport.endpoint)
        second = peer.receive()
        while second == first:
            second = peer.receive()
        assert (second.sequence, second.payload) == (first.sequence + 1 & 0xFFFF, b"cdef")
        peer.send(from_peer(b"", second.sequence, acknowledge=AckNak.ACK), here.transport.endpoint)
        wait_until(lambda: results)
        assert results == [True]

    def test_each_chunk_is_repeated_as_often_as_a_message(self, station, peer):
        here = station(fragment_size=4, acknowledge_timeout=0.3, acknowledge_retries=1)
        here.attach(DRIVER)
        join(peer, here)
        results = here.send(DRIVER, PEER, b"\x02\x40abcdef", acknowledge=True)
        for _ in range(2):
            chunk = peer.receive()
            assert peer.receive() == chunk
            answer = from_peer(b"", chunk.sequence, acknowledge=AckNak.ACK)
            peer.send(answer, here.transport.endpoint)
        wait_until(lambda: results)
        assert results == [True]

    def test_a_partial_message_is_discarded(self, station, peer):
        driver = station(reassembly_timeout=0.05).attach(DRIVER)
        peer.send(from_peer(b"\x02\x40a", 1, data_flags=DataFlags.FIRST))
        wait_until(lambda: driver.counter("transport.reassembly_timeout") == 1)
        assert driver.transport.inbox.reassembly.size == 0
        peer.send(from_peer(b"b", 2, data_flags=DataFlags.LAST))
        peer.send(from_peer(sequence=3))
        wait_until(lambda: driver.received)
        assert driver.payloads == [STATUS]


class TestBadDatagrams:
    @pytest.mark.parametrize(
        ("data", "counter"),
        [
            (b"", "judp.truncated"),
            (from_peer(b"").encode(), "transport.no_message_code"),
            (from_peer(b"\x02").encode(), "transport.no_message_code"),
            (from_peer()._replace(source=DRIVER).encode(), "transport.own_source"),
        ],
    )
    def test_each_is_counted_and_the_next_one_arrives(self, station, peer, data, counter):
        driver = station().attach(DRIVER)
        peer.send(data)
        peer.send(from_peer(sequence=2))
        wait_until(lambda: driver.received)
        assert driver.counter(counter) == 1
        assert driver.payloads == [STATUS]

    def test_another_component_with_our_id_is_an_error_once(self, station, peer, caplog):
        driver = station().attach(DRIVER, SENSOR)
        assert driver.transport.double_of(DRIVER) is None
        for sequence, source in enumerate([DRIVER, DRIVER, SENSOR, DRIVER]):
            peer.send(from_peer(sequence=sequence)._replace(source=source).encode())
        wait_until(lambda: driver.counter("transport.own_source") == 4)
        errors = [record.message for record in caplog.records if record.levelname == "ERROR"]
        assert len(errors) == 2
        place = f"127.0.0.1:{peer.unicast.getsockname()[1]}"
        start = f"another component has your id: {DRIVER} at {place} (first heard "
        assert errors[0].startswith(start)
        assert str(driver.transport.double_of(DRIVER)) == errors[0]
        assert driver.loop.counters.drops()["transport.own_source"] == 4

    @pytest.fixture
    def quiet(self):
        """A transport with closed sockets, for datagrams by the thousand."""
        with Loop() as loop:
            transport = JudpTransport(
                TransportSettings(reassembly_limit=1 << 16, duplicate_history=16), loop
            )
            transport.attach(DRIVER, lambda *_: None)
            yield transport

    @settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
    @given(
        st.lists(
            st.one_of(
                st.binary(max_size=60),
                st.binary(max_size=60).map(lambda data: b"\x02" + data),
                st.binary(max_size=60).map(lambda data: b"\x00" + data),
                st.builds(
                    lambda source, payload, sequence, flags, broadcast: Packet(
                        broadcast, JausAddress(source, 1, 1), payload, sequence, data_flags=flags
                    ).encode(),
                    st.integers(0, 65535),
                    st.binary(max_size=50),
                    st.integers(0, 65535),
                    st.sampled_from(DataFlags),
                    st.sampled_from([BROADCAST, DRIVER]),
                ),
            ),
            max_size=30,
        ),
        st.sampled_from([("127.0.0.1", 3794), ("127.0.0.1", 5), ("192.0.2.1", 3794)]),
        st.integers(0, 255),
        st.booleans(),
    )
    def test_nothing_that_arrives_raises_or_piles_up(
        self, quiet, datagrams, sender, noise, by_multicast
    ):
        for data in datagrams:
            damaged = bytearray(data)
            if damaged:
                damaged[noise % len(damaged)] ^= noise
            quiet.receive_datagram(data, sender, by_multicast=by_multicast)
            quiet.receive_datagram(bytes(damaged), sender, by_multicast=by_multicast)
        assert len(quiet.address_book.learnt) <= 1024
        assert len(quiet.inbox.duplicates) <= 256 * 16
        assert quiet.inbox.reassembly.size <= 4 << 16

"""JUDP between processes that share the port and so have others."""

import pytest
from capture_files import ETHERNET, QUERY_STATUS, ethernet, ipv4, udp

from jausml.live.traffic.captures import CapturedFrame
from jausml.live.traffic.frames import Endpoint, OtherPorts, UdpReader, is_judp

ACKNOWLEDGEMENT = bytes.fromhex("02 00 0e00 02 0201c800 01016500 0700")
"""A datagram with the shortest packet: it has no payload."""


def read(*datagrams):
    reader = UdpReader(3794)
    found = []
    for number, (data, source, destination) in enumerate(datagrams, 1):
        frame = ethernet(ipv4(udp(data, source, destination)))
        found.append(reader.read(CapturedFrame(number, float(number), ETHERNET, frame)))
    return [datagram.number for datagram in found if datagram is not None], reader


def test_unicast_of_an_endpoint_that_has_multicast_is_taken():
    numbers, reader = read(
        (QUERY_STATUS, 46884, 3794), (QUERY_STATUS, 46884, 51000), (QUERY_STATUS, 51000, 46884)
    )
    assert numbers == [1, 2]  # 10.9.0.1 speaks at 46884; the hosts of the third are the same ones
    assert reader.other_ports.unclaimed == 1


def test_unicast_to_a_speaker_is_taken_and_its_sender_speaks_too():
    numbers, reader = read(
        (QUERY_STATUS, 3794, 46884), (QUERY_STATUS, 51000, 46884), (QUERY_STATUS, 51000, 52000)
    )
    assert (numbers, reader.other_ports.unclaimed) == ([1, 2, 3], 0)


@pytest.mark.parametrize("ports", [(53794, 50000), (50000, 53794), (53825, 50000), (50000, 53825)])
def test_the_ports_of_processes_that_share_are_known(ports):
    numbers, reader = read((QUERY_STATUS, *ports), (QUERY_STATUS, 53826, 53793))
    assert (numbers, reader.other_ports.unclaimed) == ([1], 1)


def test_speakers_take_bounded_memory():
    ports = OtherPorts(3794)
    known = [Endpoint("10.9.0.1", port) for port in range(10000, 20000)]
    for endpoint in known:
        ports.learn(endpoint)
    stranger = Endpoint("10.9.0.2", 50000)
    assert sum(ports.takes(endpoint, stranger) for endpoint in known) == 4096


def test_who_was_not_seen_on_the_port_is_counted():
    numbers, reader = read((QUERY_STATUS, 50000, 50001), (b"\2 is no JUDP", 50000, 50001))
    assert numbers == []
    assert reader.other_ports.unclaimed == 1


def test_other_protocols_of_a_speaker_are_left_alone():
    numbers, reader = read((QUERY_STATUS, 46884, 3794), (b"\2" + bytes(40), 46884, 53))
    assert (numbers, reader.other_ports.unclaimed) == ([1], 0)
    assert not reader.skipped


def test_what_is_no_judp_on_the_port_makes_no_speaker():
    numbers, _ = read((b"noise on the port", 46884, 3794), (QUERY_STATUS, 46884, 51000))
    assert numbers == [1]


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (QUERY_STATUS, True),
        (QUERY_STATUS + QUERY_STATUS[1:], True),
        (ACKNOWLEDGEMENT, True),
        (QUERY_STATUS[:-1], False),
        (QUERY_STATUS + b"\0", False),
        (b"\1" + QUERY_STATUS[1:], False),
        (b"\2\5" + QUERY_STATUS[2:], False),
        (b"\2", False),
        (b"", False),
    ],
)
def test_the_form_of_judp(data, expected):
    assert is_judp(data) is expected

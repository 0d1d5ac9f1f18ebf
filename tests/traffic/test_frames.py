"""Frames as UDP datagrams."""

import struct

import pytest
from capture_files import (
    ETHERNET,
    LINUX_COOKED,
    LINUX_COOKED_2,
    NULL,
    RAW,
    ethernet,
    ipv4,
    ipv6,
    udp,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from jausml.live.traffic.captures import CapturedFrame
from jausml.live.traffic.frames import UdpReader

DATA = b"a datagram of some length"


def read(*frames, link_type=ETHERNET, port=3794, is_cut=False):
    reader = UdpReader(port)
    numbered = enumerate(frames, 1)
    found = [
        reader.read(CapturedFrame(n, float(n), link_type, data, is_cut)) for n, data in numbered
    ]
    return [datagram for datagram in found if datagram is not None], reader


@pytest.mark.parametrize(
    ("link_type", "frame"),
    [
        (ETHERNET, ethernet(ipv4(udp(DATA)))),
        (ETHERNET, ethernet(ipv4(udp(DATA))) + bytes(14)),  # padded to the least size
        (ETHERNET, ethernet(ipv4(udp(DATA)), tags=[0x8100])),
        (ETHERNET, ethernet(ipv4(udp(DATA)), tags=[0x88A8, 0x8100])),
        (ETHERNET, ethernet(ipv4(udp(DATA), options=bytes(8)))),
        (ETHERNET, ethernet(ipv4(udp(DATA), length=0))),
        (NULL, b"\2\0\0\0" + ipv4(udp(DATA))),
        (RAW, ipv4(udp(DATA))),
        (228, ipv4(udp(DATA))),
        (LINUX_COOKED, bytes(14) + b"\x08\0" + ipv4(udp(DATA))),
        (LINUX_COOKED_2, b"\x08\0" + bytes(18) + ipv4(udp(DATA))),
    ],
)
def test_links(link_type, frame):
    (datagram,), reader = read(frame, link_type=link_type)
    assert datagram.data == DATA
    assert (str(datagram.source), str(datagram.destination)) == (
        "10.9.0.1:3794",
        "239.255.0.1:3794",
    )
    assert (datagram.number, datagram.time) == (1, 1.0)
    assert not reader.skipped


def test_ipv6():
    fragment = struct.pack(">BBHI", 17, 0, 0, 9)
    for packet in (
        ipv6(udp(DATA)),
        ipv6(b"\x11\0" + bytes(6) + udp(DATA), following=0),
        ipv6(b"\x2c\1" + bytes(14) + fragment + udp(DATA), following=60),
    ):
        (datagram,), _ = read(ethernet(packet))
        assert datagram.data == DATA
        assert str(datagram.source) == "[fe80::1]:3794"


def test_only_datagrams_of_the_port():
    frames = [
        ethernet(ipv4(udp(b"from", 3794, 5000))),
        ethernet(ipv4(udp(b"to", 5000, 3794))),
        ethernet(ipv4(udp(b"neither", 53, 5000))),
        ethernet(ipv4(udp(b"TCP"), protocol=6)),
        ethernet(ipv6(udp(b"TCP"), following=6)),
        bytes(12) + b"\x08\x06" + bytes(28),  # ARP
    ]
    found, reader = read(*frames)
    assert [datagram.data for datagram in found] == [b"from", b"to"]
    assert not reader.skipped
    assert [datagram.data for datagram in read(*frames, port=53)[0]] == [b"neither"]


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0), (0, 0, 1, 1, 2)])
def test_ip_fragments_are_put_together(order):
    content = udp(bytes(range(60)))
    parts = [
        ipv4(content[:24], more=True),
        ipv4(content[24:48], offset=24, more=True),
        ipv4(content[48:], offset=48),
    ]
    other = ipv4(content[:24], more=True, identity=2)
    found, reader = read(ethernet(other), *(ethernet(parts[index]) for index in order))
    assert [datagram.data for datagram in found] == [bytes(range(60))]
    assert found[0].number == len(order) + 1
    assert reader.unfinished == 1


def test_ipv6_fragments_are_put_together():
    content = udp(bytes(range(40)))
    first = struct.pack(">BBHI", 17, 0, 1, 9) + content[:24]
    last = struct.pack(">BBHI", 17, 0, 24, 9) + content[24:]
    found, _ = read(ethernet(ipv6(last, following=44)), ethernet(ipv6(first, following=44)))
    assert [datagram.data for datagram in found] == [bytes(range(40))]


def test_fragments_without_end_take_bounded_memory():
    frames = [
        ethernet(ipv4(bytes(8), offset=8, more=True, identity=number)) for number in range(200)
    ]
    _, reader = read(*frames)
    assert reader.unfinished == 64
    assert reader.skipped == {"IP packets with missing fragments": 136}
    _, reader = read(*(ethernet(ipv4(bytes(size), offset=65528)) for size in (7, 8)))
    assert reader.skipped == {"IP packets whose fragments are too long": 1}


def test_frames_that_cannot_be_read_are_counted():
    whole = ethernet(ipv4(udp(DATA)))
    _, reader = read(*(whole[:size] for size in range(len(whole))), is_cut=True)
    assert set(reader.skipped) == {"frames that were cut"}
    # What pads a frame is no data, and be a datagram as long as both.
    _, reader = read(*(ethernet(made(udp(DATA)[:-1])) + bytes(9) for made in (ipv4, ipv6)))
    assert reader.skipped == {"malformed frames": 2}
    _, reader = read(b"", b"", link_type=147)
    assert reader.skipped == {"frames of link type 147, which is not supported": 2}


def test_the_length_of_udp_says_where_a_datagram_ends():
    (datagram,), _ = read(ethernet(ipv4(udp(DATA) + b"more")))
    assert datagram.data == DATA
    empty = (struct.pack(">HHHH", 3794, 3794, length, 0) for length in (7, 8))
    found, reader = read(*(ethernet(ipv4(header)) for header in empty))
    assert [udp_datagram.data for udp_datagram in found] == [b""]
    assert reader.skipped == {"malformed frames": 1}


def test_a_header_that_is_too_short_is_not_read_as_ports():
    packet = bytearray(ipv4(udp(DATA, 12, 5000)))
    packet[0] = 0x44
    packet[16:18] = (3794).to_bytes(2, "big")
    found, reader = read(ethernet(packet))
    assert (found, reader.skipped) == ([], {"malformed frames": 1})


@pytest.mark.parametrize(
    "whole",
    [
        ipv4(udp(DATA, 53, 53)),
        ipv6(udp(DATA, 53, 53)),
        # A further fragment has no ports, whatever it begins with.
        ipv4(udp(DATA), offset=24),
        ipv6(struct.pack(">BBHI", 17, 0, 24, 9) + udp(DATA), following=44),
    ],
)
def test_what_is_cut_and_not_of_the_port_concerns_nobody(whole):
    found, reader = read(ethernet(whole)[:-1], is_cut=True)
    assert (found, reader.skipped) == ([], {})


@settings(max_examples=300, deadline=None)
@given(
    st.sampled_from([ETHERNET, NULL, RAW, LINUX_COOKED, LINUX_COOKED_2]),
    st.sampled_from([ethernet(ipv4(udp(DATA))), ipv4(udp(DATA)), ipv6(udp(DATA), following=44)]),
    st.integers(0, 60),
    st.binary(max_size=6),
)
def test_no_frame_raises(link_type, frame, position, change):
    broken = frame[:position] + change + frame[position + len(change) :]
    found, _ = read(broken, frame, link_type=link_type)
    assert len(found) <= 2

"""The fast path of a core on its own, with whatever comes, under the sanitizers of the compiler."""

import random
import struct
import subprocess
from pathlib import Path

import needs
import pytest
from scripts import succeeded

from jausml.generation.native import compiler
from jausml.runtime.base.counters import Counters
from jausml.runtime.messages import Event
from jausml.runtime.transports.packets.packet import Packet, Priority, parse_datagram
from jausml_generators.cpp import jaus_codec

GUARDS = ("generators/jausml_generators/cpp",)

TEMPLATES = Path(jaus_codec.__file__).parent / "templates"
DRIVER = Path(__file__).with_name("fast_path_driver.cpp")
WARNED = ("-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror")
FLAGS = ("-std=c++17", "-O1", "-g1", "-pthread", "-fno-sanitize-recover=all", *WARNED)

PEER, BRIDGE = 0x00010101, 0x0001010A
ENOUGH, OTHER = 0, 1
"""Descriptors that are left to Python."""

CODE = b"\x01\xd1"


def built(folder, sanitizer):
    """Returns the driver with a sanitizer."""
    needs.ask("sanitizers")
    made = folder / "driver"
    line = [str(compiler()), *FLAGS, sanitizer, f"-I{TEMPLATES}", str(DRIVER), "-o", str(made)]
    succeeded(line)
    return made


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    return built(tmp_path_factory.mktemp("driver"), "-fsanitize=address,undefined")


def answers(program, asked, *arguments):
    """What the driver says of each datagram or message."""
    text = b"".join(
        f"{kind} {len(data)} {number}\n".encode() + data for kind, data, number in asked
    )
    done = subprocess.run([program, *arguments], input=text, capture_output=True, timeout=120)
    assert done.returncode == 0, done.stderr[-4000:]
    found = [line.split() for line in done.stdout.decode().splitlines()]
    assert len(found) == len(asked)
    return found


def datagram(payload, number, flags=1, destination=BRIDGE, source=PEER):
    head = struct.pack("<HHBII", 2, 14 + len(payload), flags, destination, source)
    return head + payload + struct.pack("<H", number)


def test_what_is_usual_passes_and_nothing_else(program):
    event = Event(3, 0, CODE + b"x").encode()
    later = Event(3, 1, CODE + b"y").encode()
    cases = [
        (datagram(CODE + b"abc", 100), [ENOUGH, 1, 0, 100, CODE + b"abc"]),
        (datagram(CODE + b"abc", 100), [OTHER, 0]),  # again
        (datagram(CODE + b"abc", 7), [OTHER, 0]),  # a number that was known before
        (datagram(CODE + b"abc", 99), [OTHER, 0]),  # late
        (datagram(CODE + b"new", 101), [ENOUGH, 1, 0, 101, CODE + b"new"]),
        (datagram(CODE + b"G", 102), [OTHER, 0]),  # the translation gives way
        (datagram(CODE + b"R", 103), [OTHER, 0]),  # ROS refuses
        (datagram(CODE + b"abc", 104, flags=2), [OTHER, 0]),
        (datagram(CODE + b"abc", 105, flags=0x41), [ENOUGH, 0]),  # the first of several packets
        (datagram(CODE + b"abc", 106, source=PEER + 1), [OTHER, 0]),
        (datagram(CODE + b"abc", 107, destination=BRIDGE + 1), [OTHER, 0]),
        (datagram(b"\x02\xd1abc", 108), [OTHER, 0]),
        (datagram(b"\x01", 109), [OTHER, 0]),
        (datagram(b"", 110), [OTHER, 0]),
        (b"", [OTHER, 0]),
        (datagram(event, 111), [ENOUGH, 1, 1, 111, event]),
        (datagram(event, 112), [OTHER, 0]),  # the same report
        (datagram(later, 113), [ENOUGH, 1, 1, 113, later]),
        (datagram(Event(4, 2, CODE).encode(), 114), [OTHER, 0]),
        (datagram(Event(3, 2, b"\x02\xd1").encode(), 115), [OTHER, 0]),
        (datagram(event[:4] + bytes(4), 116), [OTHER, 0]),
        (datagram(later[:4] + b"\xff" + later[5:], 117), [OTHER, 0]),  # its size is wrong
        (datagram(CODE, 118), [ENOUGH, 1, 0, 118, CODE]),
    ]
    found = answers(program, [("d", data, 0) for data, _ in cases])
    for (data, wanted), line in zip(cases, found, strict=True):
        told = [value.hex() if isinstance(value, bytes) else str(value) for value in wanted]
        told += ["left", *([data.hex()] if data else [])] if wanted[1] == 0 else []
        assert line == told, data.hex()


def packets(payload, first, step):
    """The packets of a message of several."""
    parts = [payload[at : at + step] for at in range(0, len(payload), step)]
    places = [0x41, *[0x81] * (len(parts) - 2), 0xC1]
    return [datagram(part, first + at, places[at]) for at, part in enumerate(parts)]


def test_messages_of_several_packets_pass_when_they_come_in_order(program):
    payload = CODE + bytes(range(1, 200))
    whole = packets(payload, 200, 60)
    cases = [
        (whole, True),
        ([*packets(payload, 300, 40)[:2], *packets(payload, 300, 40)[3:]], False),  # one is missing
        (
            [
                *packets(payload, 400, 60)[:2],
                datagram(CODE + b"a", 500),
                packets(payload, 400, 60)[2],
            ],
            False,
        ),
        ([*packets(payload, 600, 60)[:2], *packets(payload, 700, 60)], False),
        (packets(CODE + b"G" + bytes(100), 800, 50), False),  # the translation gives way
        (packets(CODE + b"R" + bytes(100), 900, 50), False),  # ROS refuses
        (packets(CODE + bytes(120000), 1000, 4000), False),  # more than is kept
        (packets(payload, 1100, 190), True),
    ]
    asked = [
        ("d" if at == len(sent) - 1 else "k", packet, 0)
        for sent, _ in cases
        for at, packet in enumerate(sent)
    ]
    found = iter(answers(program, asked))
    for sent, is_passed in cases:
        line = [next(found) for _ in sent][-1]
        if is_passed:
            number = struct.unpack("<H", sent[-1][-2:])[0]
            assert line == ["0", "1", "0", str(number), payload.hex()]
        else:
            left = [bytes.fromhex(word) for word in line if word not in ("0", "1", "left")]
            singles = [packet for packet in sent if packet[4] == 1]
            assert left == sent, line[:2]
            assert len(singles) <= 1


def test_damaged_datagrams_do_no_harm(program):
    rng = random.Random(20)
    sent = []
    for number in range(4000):
        payload = rng.choice([CODE + rng.randbytes(rng.randrange(60)), rng.randbytes(9)])
        if rng.random() < 0.3:
            payload = Event(3, rng.randrange(4), payload).encode()
        data = bytearray(datagram(payload, number * 3 & 0xFFFF))
        for _ in range(rng.choice([0, 0, 1, 1, 2, 5])):
            data[rng.randrange(len(data))] = rng.randrange(256)
        cut = rng.choice([0, 0, 0, rng.randrange(len(data))])
        sent.append(bytes(data[: len(data) - cut]) + rng.choice([b"", b"", b"\x00"]))
    found = answers(program, [("d", damaged_datagram, 0) for damaged_datagram in sent])
    passed = 0
    for data, line in zip(sent, found, strict=True):
        if line[1] == "0":
            assert not data or bytes.fromhex(line[-1]) == data
            continue
        passed += 1
        (packet,) = parse_datagram(data, Counters())  # what passes is a packet that Python reads
        assert packet.payload.hex() == line[4]
        assert packet.sequence == int(line[3])
        assert (packet.source, packet.destination) == (PEER, BRIDGE)
        assert packet.priority is Priority.STANDARD
        assert CODE in (packet.payload[:2], packet.payload[8:10])
    assert passed > 300


@pytest.mark.slow
def test_another_thread_may_stop_it_at_any_time(tmp_path):
    program = built(tmp_path, "-fsanitize=thread")
    sent = [("d", datagram(CODE + bytes(8), 100 + number), 0) for number in range(2000)]
    for number in range(1000):
        sent.insert(2 * number, ("m", CODE + bytes(150), 50 + number))
    found = answers(program, sent, "stopped")
    passed = sum(line[1] == "1" for line in found)
    assert 0 < passed <= len(found)  # how often it was stopped in time depends on the machine


def test_messages_of_ros_become_packets(program):
    sizes = [2, 3, 99, 100, 101, 200, 201, 1, 0]
    sent = [("m", payload_of(size), 50 + at) for at, size in enumerate(sizes)]
    sent.append(("m", CODE + b"G", 59))
    sent.append(("m", CODE + b"a", 99))  # one is missing before it
    found = answers(program, sent)
    look_at_packets(sent[:7], found[:7])
    assert [line[:3] for line in found[7:]] == [[str(OTHER), "0", size] for size in "1033"]


@pytest.mark.parametrize(("size", "passes"), [(1000, True), (1001, False), (4001, False)])
def test_more_packets_than_a_peer_takes_at_once_are_left_to_who_waits(program, size, passes):
    sent = [("m", payload_of(size), 50)]
    found = answers(program, sent)
    if passes:
        look_at_packets(sent, found)
    else:
        assert found == [[str(OTHER), "0", str(size)]]


def payload_of(size):
    return (CODE + random.Random(size).randbytes(max(0, size - 2)))[:size]


def look_at_packets(sent, found):
    """Checks the packets that messages became, at most 100 bytes in each."""
    number = 65530
    for (_, data, _), line in zip(sent, found, strict=True):
        assert line[:2] == [str(ENOUGH), "1"]
        packets = [
            packet
            for word in line[2:]
            for packet in parse_datagram(bytes.fromhex(word), Counters())
        ]
        assert b"".join(packet.payload for packet in packets) == data
        assert len(packets) <= 10
        for parsed_packet in packets:
            assert parsed_packet.sequence == number & 0xFFFF
            assert isinstance(parsed_packet, Packet)
            number += 1
        flags = [int(packet.data_flags) for packet in packets]
        assert flags == ([0] if len(flags) == 1 else [1, *[2] * (len(flags) - 2), 3])

"""Captures of JAUS traffic made by hand, and recordings as others read them."""

import struct
import time
from dataclasses import dataclass

from capture_files import ETHERNET, ethernet, ipv4, udp
from mcap.reader import make_reader
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore

BEGIN = 1_700_000_000_123_456_789
"""Time of the first frame of a capture in nanoseconds: 2023-11-14 22:13:20.123456789."""

LARGEST = 0xFFFFFFFF

PATIENCE = 90.0
"""Seconds after which what a test waits for counts as missing."""


def wait_for(condition, what):
    """Waits until a condition holds."""
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, f"no {what} within {PATIENCE} s"
        time.sleep(0.02)


def scaled(value, lower, upper, largest=LARGEST):
    """Returns the integer of a scaled integer (AS5684), by its definition."""
    return round((value - lower) / (upper - lower) * largest)


def velocity(x, y, yaw_rate, milliseconds=None, day=14):
    """ReportVelocityState (AS6009): m/s and rad/s in axes ahead, right, down."""
    presence = 0x01 | 0x02 | 0x40 | (0x100 if milliseconds is not None else 0)
    body = struct.pack(
        "<HHIIH",
        0x4404,
        presence,
        scaled(x, -327.68, 327.67),
        scaled(y, -327.68, 327.67),
        scaled(yaw_rate, -32.768, 32.767, 0xFFFF),
    )
    return body + (stamp(milliseconds, day) if milliseconds is not None else b"")


def pose(x, y, yaw):
    """ReportLocalPose (AS6009): metres and radians in axes ahead, right, down."""
    return struct.pack(
        "<HHIIH",
        0x4403,
        0x01 | 0x02 | 0x40,
        scaled(x, -100000, 100000),
        scaled(y, -100000, 100000),
        scaled(yaw, -3.14159265358979323846, 3.14159265358979323846, 0xFFFF),
    )


def stamp(milliseconds, day):
    """A TimeStamp: milliseconds of a day of the month."""
    ms, rest = milliseconds % 1000, milliseconds // 1000
    return struct.pack(
        "<I", ms | rest % 60 << 10 | rest // 60 % 60 << 16 | rest // 3600 << 22 | day << 27
    )


def event(report, number=0):
    """An Event (AS5710) with a report."""
    return struct.pack("<HBBI", 0x41F1, 1, number, len(report)) + report


def datagram(payload, source=(100, 1, 1), number=0):
    """A JUDP datagram with one message to 200.1.1 (AS5669A)."""
    subsystem, node, component = source
    head = struct.pack("<BBHB", 2, 0, 14 + len(payload), 1)
    addresses = struct.pack("<BBHBBH", 1, 1, 200, component, node, subsystem)
    return head + addresses + payload + struct.pack("<H", number)


def frame(payload, **options):
    """An Ethernet frame with a message."""
    return ethernet(ipv4(udp(datagram(payload, **options))))


def nano_pcap(frames, step=10_000_001, begin=BEGIN):
    """Returns a pcap file with times in nanoseconds, one frame each step."""
    data = struct.pack("<IHHiIII", 0xA1B23C4D, 2, 4, 0, 0, 262144, ETHERNET)
    for index, frame_bytes in enumerate(frames):
        seconds, rest = divmod(begin + index * step, 10**9)
        data += (
            struct.pack("<IIII", seconds, rest, len(frame_bytes), len(frame_bytes)) + frame_bytes
        )
    return data


@dataclass(frozen=True)
class Heard:
    """A message of ROS in a recording."""

    topic: str
    time: int
    message: object


def by_rosbags(path):
    """Returns the messages of a bag in a file, as rosbags reads and decodes them."""
    store = get_typestore(Stores.ROS2_JAZZY)
    with Reader(path) as reader:
        return [
            Heard(connection.topic, time, store.deserialize_cdr(data, connection.msgtype))
            for connection, time, data in reader.messages()
        ]


def by_mcap(path):
    """Returns schema, channel and message of each record, as the library of MCAP reads it."""
    with path.open("rb") as stream:
        return list(make_reader(stream).iter_messages())

"""The judges' unit of a competition: `judging_unit.py PORT`, as captures of one show it.

It sends everything by multicast to all components of the robot's node, with the flag of a
broadcast, and begins its numbers at 1 in each test. Each line on stdin begins a test; one line of
JSON for each answer, and one at the end of the test.
"""

from __future__ import annotations

import select
import socket
import struct
import sys
import time

from jausml_runtime.base.address import JausAddress
from jausml_runtime.base.counters import Counters
from jausml_runtime.messages import (
    QueryIdentification,
    QueryStatus,
    QueryTimeout,
    ReleaseControl,
    RequestControl,
    Resume,
)
from jausml_runtime.transports.packets.packet import AckNak, Packet, parse_datagram
from roles import say
from tolerant.messages import QueryVelocityState, SetWrenchEffort

UNIT, ROBOT = JausAddress(42, 1, 1), JausAddress(105, 1, 255)
SYSTEM, ALL = 1, 2
PAUSE_S = 0.3
_HEADER = struct.Struct("<BBHBII")


class Unit:
    """Sends, and tells of what comes."""

    def __init__(self, port: int) -> None:
        self.group = ("239.255.0.1", port)
        self.sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.sock.bind(("127.0.0.2", port))
        interface = socket.inet_aton("127.0.0.1")
        self.sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, interface)
        self.number = 0

    def send(self, payload: bytes) -> None:
        """Sends a message as broadcast, and tells of the answers that come soon."""
        self.number += 1
        size = _HEADER.size - 1 + len(payload) + 2
        head = _HEADER.pack(2, 0, size, ALL << 2, ROBOT.packed, UNIT.packed)
        self.sock.sendto(head + payload + struct.pack("<H", self.number), self.group)
        end = time.monotonic() + PAUSE_S
        while (left := end - time.monotonic()) > 0:
            readable, _, _ = select.select([self.sock], [], [], left)
            if not readable:
                return
            data, sender = self.sock.recvfrom(65535)
            for packet in parse_datagram(data, Counters()):
                code = int.from_bytes(packet.payload[:2], "little")
                if packet.acknowledge is AckNak.REQUESTED:
                    answer = Packet(packet.source, UNIT, b"", packet.sequence)
                    acknowledgement = answer._replace(acknowledge=AckNak.ACK)
                    self.sock.sendto(acknowledgement.encode(), sender)
                say("answer", code=code, source=str(packet.source), to=str(packet.destination))

    def test(self, effort: float) -> None:
        """Runs one test."""
        self.number = 0
        for message in (
            QueryIdentification(SYSTEM),
            RequestControl(authority_code=255),
            QueryTimeout(),
            Resume(),
            QueryStatus(),
            SetWrenchEffort(propulsive_linear_effort_x=effort),
            QueryVelocityState(presence_vector=0xFFFF),
            ReleaseControl(),
        ):
            self.send(message.encode())
        say("tested", effort=effort)


def main() -> None:
    """Tests as often as it is told to."""
    unit = Unit(int(sys.argv[1]))
    say("ready")
    for line in sys.stdin:
        unit.test(float(line))


if __name__ == "__main__":
    main()

"""The judges' unit of a competition on the wire, as captures of one show it.

It sends everything by multicast to all components of the robot's node, with the flag of a
broadcast, and begins its numbers at 1 in each test. For processes that have the runtime of a
generated workspace on their module path.
"""

import select
import socket
import struct
import time
from collections.abc import Iterator

from jausml_runtime.base.address import JausAddress
from jausml_runtime.base.counters import Counters
from jausml_runtime.transports.packets.packet import AckNak, Packet, parse_datagram

UNIT, ROBOT = JausAddress(42, 1, 1), JausAddress(105, 1, 255)
ALL = 2
_HEADER = struct.Struct("<BBHBII")


class Unit:
    """Sends payloads, acknowledges what asks for it, and takes what comes."""

    def __init__(self, port: int) -> None:
        self.group = ("239.255.0.1", port)
        self.sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.sock.bind(("127.0.0.2", port))
        interface = socket.inet_aton("127.0.0.1")
        self.sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, interface)
        self.number = 0

    def begin(self) -> None:
        """Begins a test."""
        self.number = 0

    def send(self, payload: bytes) -> None:
        """Sends a message as broadcast."""
        self.number += 1
        size = _HEADER.size - 1 + len(payload) + 2
        head = _HEADER.pack(2, 0, size, ALL << 2, ROBOT.packed, UNIT.packed)
        self.sock.sendto(head + payload + struct.pack("<H", self.number), self.group)

    def answers(self, seconds: float) -> Iterator[Packet]:
        """Yields what comes, until nothing has come for some time."""
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            readable, _, _ = select.select([self.sock], [], [], left)
            if not readable:
                return
            data, sender = self.sock.recvfrom(65535)
            for packet in parse_datagram(data, Counters()):
                if packet.acknowledge is AckNak.REQUESTED:
                    answer = Packet(packet.source, UNIT, b"", packet.sequence)
                    acknowledgement = answer._replace(acknowledge=AckNak.ACK)
                    self.sock.sendto(acknowledgement.encode(), sender)
                yield packet

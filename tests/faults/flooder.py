"""Sends datagrams to a port as fast as it is told, and says how many it sent.

Usage: flooder.py KIND PORT RATE SECONDS [HOST]

Kinds: `commands` of somebody who has no control, `garbage`, and `reports` in the name of a vehicle
that is elsewhere. HOST is the address that they come from.
"""

import random
import socket
import sys
import time

from jausml_runtime import JausAddress
from jausml_runtime.transports.packets.packet import Packet
from loop_bridge.messages import ReportVelocityState, SetVelocityCommand
from stamps import say

BURST = 50
BRIDGE = JausAddress(10, 1, 9)
STRANGER, VEHICLE = JausAddress(40, 1, 1), JausAddress(10, 1, 1)
MESSAGES = {
    "commands": (STRANGER, SetVelocityCommand(velocity_x=1.0)),
    "reports": (VEHICLE, ReportVelocityState(velocity_x=1.0)),
}
VARIETY = 512


def datagrams(kind: str) -> list[bytes]:
    """Returns datagrams of a kind, all different."""
    rng = random.Random(3)
    if kind == "garbage":
        return [rng.randbytes(rng.randrange(1, 60)) for _ in range(VARIETY)]
    source, message = MESSAGES[kind]
    return [Packet(BRIDGE, source, message.encode(), n).encode() for n in range(VARIETY)]


def flood(kind: str, port: int, rate: float, seconds: float, host: str) -> int:
    """Sends for some seconds; returns how many."""
    different = datagrams(kind)
    sent = 0
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind((host, 0))
        sock.connect(("127.0.0.1", port))
        start = time.monotonic()
        while (elapsed := time.monotonic() - start) < seconds:
            if sent > elapsed * rate:
                time.sleep(BURST / rate)
            for _ in range(BURST):
                sock.send(different[sent % VARIETY])
                sent += 1
    return sent


if __name__ == "__main__":
    kind, port, rate, seconds, *host = sys.argv[1:]
    sent = flood(kind, int(port), float(rate), float(seconds), *(host or ["127.0.0.1"]))
    say("sent", sent)

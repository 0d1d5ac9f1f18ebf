"""An operator unit that says nothing before it is asked who it is, on a port of its own.

It stands for the judges' unit of a competition: no multicast, no answer to who has not greeted it.
"""

import socket
import sys

from jausml_runtime.base.address import JausAddress
from jausml_runtime.base.counters import Counters
from jausml_runtime.clients.discovery_client import query_services, reported_services
from jausml_runtime.messages import QueryIdentification, ReportIdentification, ReportServices
from jausml_runtime.transports.packets.packet import AckNak, Packet, parse_datagram
from roles import say

JUDGE = JausAddress(42, 1, 1)
SUBSYSTEM = 2
OCU = 20001


def main() -> None:
    """Answers, and asks back, until the process is ended."""
    counters, greeted, number = Counters(), set(), 0
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.bind(("127.0.0.1", int(sys.argv[1])))
        say("ready")
        while True:
            data, endpoint = sock.recvfrom(65535)
            for packet in parse_datagram(data, counters):
                code = packet.payload[:2]
                say("got", code=int.from_bytes(code, "little"), source=str(packet.source))
                replies = []
                if code == QueryIdentification.CODE.to_bytes(2, "little"):
                    scope = QueryIdentification.decode(packet.payload).query_type
                    say("greeted", by=str(packet.source), scope=scope)
                    if scope == SUBSYSTEM:
                        greeted.add(packet.source)
                        answer = ReportIdentification(SUBSYSTEM, OCU, "judge")
                        replies = [answer.encode(), query_services().encode()]
                elif code == ReportServices.CODE.to_bytes(2, "little"):
                    report = ReportServices.decode(packet.payload)
                    found = reported_services(report, packet.source.subsystem)
                    urns = sorted(service.urn for _, services in found for service in services)
                    say("services", of=str(packet.source), urns=urns)
                if packet.acknowledge == AckNak.REQUESTED and packet.source in greeted:
                    acknowledgement = Packet(
                        packet.source, JUDGE, b"", packet.sequence, acknowledge=AckNak.ACK
                    )
                    sock.sendto(acknowledgement.encode(), endpoint)
                for payload in replies:
                    number += 1
                    sock.sendto(Packet(packet.source, JUDGE, payload, number).encode(), endpoint)


if __name__ == "__main__":
    main()

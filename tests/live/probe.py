"""Knocks at ports of another host, and says on that host which knocks come through.

probe.py listen udp|tcp ADDRESS GROUP PORT...    a line of JSON for each, until stdin ends
probe.py knock udp|tcp SOURCE,ADDRESS,PORT...    in this order; connections last until stdin ends
"""

import json
import selectors
import socket
import sys

KINDS = {"udp": socket.SOCK_DGRAM, "tcp": socket.SOCK_STREAM}


def say(*facts: object) -> None:
    sys.stdout.write(json.dumps(facts) + "\n")
    sys.stdout.flush()


def listen(kind: str, address: str, group: str, *ports: str) -> None:
    """Says of each knock where it is from, and where it came."""
    ends = selectors.DefaultSelector()
    ends.register(sys.stdin, selectors.EVENT_READ)
    for port in map(int, ports):
        for where in (address, group) if kind == "udp" else (address,):
            made = socket.socket(socket.AF_INET, KINDS[kind])
            made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            made.bind((where, port))
            if where == group:
                joined = socket.inet_aton(group) + socket.inet_aton(address)
                made.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, joined)
            if kind == "tcp":
                made.listen()
            ends.register(made, selectors.EVENT_READ, (where, port))
    say("ready")
    while True:
        for key, _ in ends.select():
            if key.data is None:
                return
            take = key.fileobj.accept if kind == "tcp" else lambda end=key.fileobj: end.recvfrom(9)
            _, (source, _) = take()
            say(source, *key.data)


def knock(kind: str, *knocks: str) -> None:
    """Knocks at all, without waiting for an answer of any."""
    ends = []
    for text in knocks:
        source, address, port = text.split(",")
        end = socket.socket(socket.AF_INET, KINDS[kind])
        ends.append(end)
        end.setblocking(False)
        end.bind((source, 0))
        if kind == "udp":
            end.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(source))
            end.sendto(b"knock", (address, int(port)))
        else:
            end.connect_ex((address, int(port)))
    sys.stdin.read()


if __name__ == "__main__":
    {"listen": listen, "knock": knock}[sys.argv[1]](*sys.argv[2:])

"""A network between two ends on this computer that loses, repeats, delays and turns round.

Usage: proxy.py SEED PORT=HOST_PORT:PEER_PORT...

A datagram that arrives at PORT goes on to HOST_PORT, from PEER_PORT, which is a port of this
process too: so each end knows the other by a port of the proxy. Lines of JSON on stdin say how
datagrams fare: {"drop": 0.2, "repeat": 0.1, "delay": 0.1, "jitter": 0.05}; each is answered with
what was done until then.
"""

from __future__ import annotations

import heapq
import itertools
import json
import random
import select
import socket
import sys
import time

BUFFER = 1 << 20
LONGEST = 65536


class Proxy:
    """Forwards datagrams between its sockets."""

    def __init__(self, seed, routes):
        self.random = random.Random(seed)
        self.sockets = {}
        for port, _, _ in routes:
            sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER)
            sock.bind(("127.0.0.1", port))
            self.sockets[port] = sock
        self.routes = {self.sockets[port]: (to, self.sockets[by]) for port, to, by in routes}
        self.fate = {}
        self.counts = dict.fromkeys(("taken", "dropped", "repeated", "sent"), 0)
        self.waiting = []
        self.order = itertools.count()

    def run(self):
        poll = select.poll()
        poll.register(sys.stdin, select.POLLIN | select.POLLHUP)
        by_number = {each.fileno(): each for each in self.routes}
        for number in by_number:
            poll.register(number, select.POLLIN)
        while True:
            for number, _ in poll.poll(self.until_next()):
                if number in by_number:
                    self.take(by_number[number])
                elif not self.obey(sys.stdin.readline()):
                    return
            self.send_due()

    def until_next(self):
        """Milliseconds until something is to be sent; None when nothing waits."""
        if not self.waiting:
            return None
        return max(0.0, (self.waiting[0][0] - time.monotonic()) * 1000)

    def obey(self, line):
        if not line:
            return False
        self.fate = json.loads(line)
        sys.stdout.write(json.dumps({"kind": "counts", **self.counts}) + "\n")
        return True

    def take(self, sock):
        data = sock.recv(LONGEST)
        self.counts["taken"] += 1
        if self.random.random() < self.fate.get("drop", 0.0):
            self.counts["dropped"] += 1
            return
        copies = 1
        if self.random.random() < self.fate.get("repeat", 0.0):
            self.counts["repeated"] += 1
            copies = 2
        for _ in range(copies):
            delay = self.fate.get("delay", 0.0) + self.random.random() * self.fate.get("jitter", 0)
            heapq.heappush(self.waiting, (time.monotonic() + delay, next(self.order), sock, data))

    def send_due(self):
        now = time.monotonic()
        while self.waiting and self.waiting[0][0] <= now:
            _, _, sock, data = heapq.heappop(self.waiting)
            port, by = self.routes[sock]
            by.sendto(data, ("127.0.0.1", port))
            self.counts["sent"] += 1


if __name__ == "__main__":
    Proxy(
        int(sys.argv[1]),
        [tuple(map(int, each.replace("=", ":").split(":"))) for each in sys.argv[2:]],
    ).run()

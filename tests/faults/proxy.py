"""A network between two ends on this computer that loses, repeats, delays and turns round.

Usage: proxy.py SEED PORT=HOST_PORT:PEER_PORT...

A datagram that arrives at PORT goes on to HOST_PORT, from PEER_PORT, which is a port of this
process too: so each end knows the other by a port of the proxy. Lines of JSON on stdin say how
datagrams fare: {"drop": 0.2, "repeat": 0.1, "delay": 0.1, "jitter": 0.05}; each is answered with
what was done until then, and with what became of the packets of each pair of components.
"""

import heapq
import itertools
import json
import random
import select
import socket
import struct
import sys
import time

HEADER = struct.Struct("<HHBII")
NUMBER = struct.Struct("<H")
ANSWER = 0x20
MOST_AHEAD = 64
"""Numbers by which a packet may be ahead of the one before it in the same life of its sender."""

MOST_BEHIND = 512
"""Numbers by which one that is repeated may be behind."""

BUFFER = 1 << 20
LONGEST = 65536


class Pair:
    """What one component sent to another one: for each life of it, which packets arrived.

    The network is the first that sees the numbers, so those of one life follow each other. A number
    that it never saw is no packet.
    """

    def __init__(self):
        self.lives = []
        self.newest = None

    def take(self, number, *, arrives):
        step = 0
        if self.newest is not None:
            step = ((number - self.newest + 0x8000) & 0xFFFF) - 0x8000
        life = self.lives[-1] if self.lives else None
        if life is None or not -min(len(life), MOST_BEHIND) < step <= MOST_AHEAD:
            self.lives.append([arrives])
            self.newest = number
            return
        if step > 0:
            life += [None] * step
            self.newest = number
        place = len(life) - 1 + min(step, 0)
        life[place] = life[place] or arrives

    def truth(self):
        """The packets of all lives that arrived, and those lost between two that did."""
        came = lost = 0
        for life in self.lives:
            arrived = [place for place, arrives in enumerate(life) if arrives]
            if arrived:
                came += len(arrived)
                lost += life[arrived[0] : arrived[-1]].count(False)
        return {"came": came, "lost": lost, "lives": len(self.lives)}


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
        self.pairs = {}
        self.waiting = []
        self.order = itertools.count()

    def run(self):
        poll = select.poll()
        poll.register(sys.stdin, select.POLLIN | select.POLLHUP)
        by_number = {route.fileno(): route for route in self.routes}
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
        truths = {pair: flow.truth() for pair, flow in self.pairs.items()}
        sys.stdout.write(json.dumps({"kind": "counts", **self.counts, "pairs": truths}) + "\n")
        return True

    def take(self, sock):
        data = sock.recv(LONGEST)
        self.counts["taken"] += 1
        is_lost = self.random.random() < self.fate.get("drop", 0.0)
        self.note(data, arrives=not is_lost)
        if is_lost:
            self.counts["dropped"] += 1
            return
        copies = 1
        if self.random.random() < self.fate.get("repeat", 0.0):
            self.counts["repeated"] += 1
            copies = 2
        for _ in range(copies):
            delay = self.fate.get("delay", 0.0) + self.random.random() * self.fate.get("jitter", 0)
            heapq.heappush(self.waiting, (time.monotonic() + delay, next(self.order), sock, data))

    def note(self, data, *, arrives):
        if len(data) <= HEADER.size + NUMBER.size:
            return
        _, size, flags, destination, source = HEADER.unpack_from(data)
        if size == len(data) - 1 and not flags & ANSWER:
            (number,) = NUMBER.unpack_from(data, len(data) - NUMBER.size)
            pair = f"{name(source)} to {name(destination)}"
            self.pairs.setdefault(pair, Pair()).take(number, arrives=arrives)

    def send_due(self):
        now = time.monotonic()
        while self.waiting and self.waiting[0][0] <= now:
            _, _, sock, data = heapq.heappop(self.waiting)
            port, by = self.routes[sock]
            by.sendto(data, ("127.0.0.1", port))
            self.counts["sent"] += 1


def name(address):
    return f"{address >> 16}.{address >> 8 & 0xFF}.{address & 0xFF}"


if __name__ == "__main__":
    Proxy(
        int(sys.argv[1]),
        [tuple(map(int, argument.replace("=", ":").split(":"))) for argument in sys.argv[2:]],
    ).run()

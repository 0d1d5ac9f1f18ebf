"""TCP between ends on this computer that can be cut, or held as by a cable that is pulled out.

Usage: tcp_proxy.py PORT=TO_PORT...

Who connects to PORT is joined with TO_PORT. Lines of JSON on stdin say how connections fare, and
are answered: {"cut": 1} ends all and refuses new ones, {"hold": 1} keeps them and lets nothing
pass, {} lets all pass, with what was held.
"""

import contextlib
import json
import selectors
import socket
import sys

LONGEST = 65536


class TcpProxy:
    """Joins connections."""

    def __init__(self, routes):
        self.routes = dict(routes)
        self.selector = selectors.DefaultSelector()
        self.listeners = {}
        self.others = {}
        self.passed = 0
        self.is_held = False
        self.selector.register(sys.stdin, selectors.EVENT_READ, self.obey)
        self.listen()

    def run(self):
        while True:
            for key, _ in self.selector.select():
                # What came first may have ended what comes now.
                if key.fileobj is sys.stdin or key.fileobj.fileno() >= 0:
                    key.data(key.fileobj)

    def listen(self):
        for port in self.routes.keys() - self.listeners.keys():
            sock = socket.create_server(("127.0.0.1", port))
            self.listeners[port] = sock
            self.selector.register(sock, selectors.EVENT_READ, self.accept)

    def obey(self, stdin):
        line = stdin.readline()
        if not line:
            raise SystemExit
        fate = json.loads(line)
        if fate.get("cut"):
            for sock in [*self.listeners.values(), *self.others]:
                self.forget(sock)
            self.listeners.clear()
            self.others.clear()
        else:
            self.listen()
            self.hold(bool(fate.get("hold")))
        sys.stdout.write(json.dumps({"kind": "counts", "passed": self.passed}) + "\n")

    def hold(self, is_held):
        if is_held != self.is_held:
            for sock in [*self.others, *self.listeners.values()]:
                if is_held:
                    self.selector.unregister(sock)
                else:
                    accepts = sock in self.listeners.values()
                    self.watch(sock, self.accept if accepts else self.take)
        self.is_held = is_held

    def watch(self, sock, what):
        self.selector.register(sock, selectors.EVENT_READ, what)

    def forget(self, sock):
        with contextlib.suppress(KeyError):
            self.selector.unregister(sock)
        sock.close()

    def accept(self, listener):
        near, _ = listener.accept()
        try:
            far = socket.create_connection(
                ("127.0.0.1", self.routes[listener.getsockname()[1]]), timeout=1
            )
        except OSError:
            near.close()
            return
        far.settimeout(None)
        for one, other in ((near, far), (far, near)):
            self.others[one] = other
            self.watch(one, self.take)

    def take(self, sock):
        other = self.others[sock]
        try:
            data = sock.recv(LONGEST)
            other.sendall(data)
        except OSError:
            data = b""
        self.passed += len(data)
        if not data:
            for endpoint in (sock, other):
                self.others.pop(endpoint, None)
                self.forget(endpoint)


if __name__ == "__main__":
    TcpProxy(tuple(map(int, argument.split("="))) for argument in sys.argv[1:]).run()

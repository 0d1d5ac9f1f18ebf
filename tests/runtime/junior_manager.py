"""A node manager by the letter of Junior's local protocol, as a process of its own.

Arguments: folder, UDP port, peer endpoint ``HOST:PORT`` or ``-``. It owns the socket
``JuniorRTE`` and the UDP port. A client attaches with an AS5669 version 1 packet: destination 0,
command code 1; the answer has source 0 and code 2; code 3 ends it. Everything else is a JUDP
datagram, passed on by its destination, between clients and to and from the one peer.
Writes ``ready``, then one line for each client that comes or goes.
"""

import selectors
import socket
import struct
import sys
from pathlib import Path

COMMAND_SIZE = 21
CONNECT, ACCEPT, CANCEL = 1, 2, 3
ALL = (0xFFFF, 0xFF, 0xFF)


def parts(packed: int) -> tuple[int, int, int]:
    return packed >> 16, packed >> 8 & 0xFF, packed & 0xFF


def say(text: str) -> None:
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


class Manager:
    def __init__(self, folder: Path, port: int, peer: tuple[str, int] | None) -> None:
        self.folder = folder
        self.peer = peer
        self.clients: set[int] = set()
        path = folder / "JuniorRTE"
        path.unlink(missing_ok=True)
        self.local = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.local.bind(str(path))
        self.network = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.network.bind(("127.0.0.1", port))

    def run(self) -> None:
        selector = selectors.DefaultSelector()
        for sock in (self.local, self.network):
            selector.register(sock, selectors.EVENT_READ)
        say("ready")
        while True:
            for key, _ in selector.select():
                data = key.fileobj.recv(65535)
                if data[0] == 1 and len(data) == COMMAND_SIZE:
                    self.on_command(data)
                elif key.fileobj is self.network:
                    self.pass_on(data)
                else:
                    self.pass_on(data)
                    if self.peer:
                        self.network.sendto(data, self.peer)

    def on_command(self, data: bytes) -> None:
        hc, length, _, version, code, destination, source, control, _ = struct.unpack(
            "<H2sBBHIIHH", data[1:]
        )
        assert (hc, length, version, destination, control) == (0, b"\x00\x10", 2, 0, 0)
        if code == CONNECT:
            self.clients.add(source)
            say(f"client {source}")
            answer = struct.pack("<BH2sBBHIIHH", 1, 0, length, 6, 2, ACCEPT, source, 0, 0, 0)
            self.give(source, answer)
        elif code == CANCEL:
            self.clients.discard(source)
            say(f"gone {source}")

    def pass_on(self, data: bytes) -> None:
        destination, source = struct.unpack_from("<II", data, 5)
        for client in self.clients - {source}:
            pairs = zip(parts(destination), parts(client), ALL, strict=True)
            if all(wanted in (own, every) for wanted, own, every in pairs):
                self.give(client, data)

    def give(self, client: int, data: bytes) -> None:
        try:
            self.local.sendto(data, str(self.folder / str(client)))
        except OSError:
            self.clients.discard(client)


if __name__ == "__main__":
    host, _, number = sys.argv[3].rpartition(":")
    endpoint = (host, int(number)) if host else None
    Manager(Path(sys.argv[1]), int(sys.argv[2]), endpoint).run()

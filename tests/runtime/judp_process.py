"""A process of its own with one component that answers whatever it receives.

Arguments: port, address. Reads commands from standard input: ``send ADDRESS HEX``, ``quit``.
Writes ``open HOST:PORT``, then one line for each message and for each change of endpoint.
"""

import sys

from jausml.runtime.base.address import BROADCAST, JausAddress
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.transports.udp.judp import JudpTransport

ECHO = b"\x00\xd0"


def main(port: int, address: JausAddress) -> None:
    loop = Loop()
    transport = JudpTransport(TransportSettings(port=port, takeover_interval=0.1), loop)

    def say(text: str) -> None:
        sys.stdout.write(text + "\n")
        sys.stdout.flush()

    def receive(payload: bytes, source: JausAddress) -> None:
        is_broadcast = transport.arrival.number is None
        say(f"got {source} {BROADCAST if is_broadcast else address} {payload.hex()}")
        if not is_broadcast and not payload.startswith(ECHO):
            transport.send(address, source, ECHO + payload[2:])

    def watch(known: object) -> None:
        if transport.endpoint != known:
            say(f"open {transport.endpoint[0]}:{transport.endpoint[1]}")
        loop.call_later(0.02, lambda endpoint=transport.endpoint: watch(endpoint))

    transport.attach(address, receive)
    transport.open()
    watch(None)
    loop.start()
    for line in sys.stdin:
        words = line.split()
        if words[0] == "quit":
            break
        transport.send(address, JausAddress.parse(words[1]), bytes.fromhex(words[2]))
    transport.close()
    loop.stop()


if __name__ == "__main__":
    main(int(sys.argv[1]), JausAddress.parse(sys.argv[2]))

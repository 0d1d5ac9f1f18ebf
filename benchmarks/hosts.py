"""Processes at the other end of round trips.

Usage: hosts.py components PORT COUNT   components 1.2.1, 1.2.2, ... that send messages back
       hosts.py echo PORT               a socket that sends datagrams back
"""

from __future__ import annotations

import signal
import socket
import sys

from jausml.runtime import ComponentSettings, JausComponent, ServiceIdentity
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.loop import Loop
from jausml.runtime.base.settings import TransportSettings
from jausml.runtime.messages import ReportStatus
from jausml.runtime.transports.udp.judp import JudpTransport

HOSTED = JausAddress(1, 2, 1)
"""The first component."""

_CORE = "urn:jaus:jss:core:"
_NAMES = ("Transport", "Events", "AccessControl", "Management", "Discovery", "Liveness")
_SERVICES = tuple(ServiceIdentity(_CORE + name, 1, 1) for name in _NAMES)


def component(transport: JudpTransport, address: JausAddress) -> JausComponent:
    """Returns a component with the core services."""
    return JausComponent(
        transport,
        address,
        name=f"component {address}",
        services=_SERVICES,
        settings=ComponentSettings(register_services=False),
    )


def host(port: int, count: int) -> None:
    """Runs components until the process is ended."""
    loop = Loop()
    transport = JudpTransport(TransportSettings(port=port), loop)
    transport.open()
    hosted = []
    for number in range(1, count + 1):
        jaus_component = component(transport, JausAddress(1, 2, number))
        jaus_component.on_message(ReportStatus, jaus_component.send)
        jaus_component.start()
        hosted.append(jaus_component)
    loop.start()
    signal.pause()


def echo(port: int) -> None:
    """Sends datagrams back until the process is ended."""
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.bind(("127.0.0.1", port))
    while True:
        data, sender = sock.recvfrom(2048)
        sock.sendto(data, sender)


def main() -> None:
    """Runs one of the processes."""
    what, port, *more = sys.argv[1:]
    if what == "components":
        host(int(port), int(more[0]))
    else:
        echo(int(port))


if __name__ == "__main__":
    main()

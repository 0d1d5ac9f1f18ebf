"""Network of a live tool by the options of a user, and the JAUS id of the tool.

The id is that of the option, or one that no other tool of this host has.
"""

from __future__ import annotations

import errno
import logging
import os
import socket
import sys
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace

from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.settings import (
    JUDP_GROUP,
    JUDP_PORT,
    Endpoint,
    TransportKind,
    TransportSettings,
)
from jausml.runtime.transports.ports import manager_folder, who_holds

TRANSPORTS = tuple(kind.value for kind in TransportKind)

DEFAULT_INTERFACE = "127.0.0.1"
DEFAULT_PORT = JUDP_PORT
DEFAULT_GROUP = JUDP_GROUP


# Subsystem of our tools. Their ids have no byte 0xFF, which Junior takes for a wildcard.
SUBSYSTEM = 65000

_LAST = 254
_NOWHERE = logging.NullHandler()


@dataclass(frozen=True, slots=True)
class Network:
    """Our JAUS id, and the transport.

    Attributes:
        is_own_given: Whether a user chose the id.
        is_shared: Whether another tool of this host has the same id.
    """

    own: JausAddress
    settings: TransportSettings
    is_own_given: bool = True
    is_shared: bool = False

    @property
    def place(self) -> str:
        """Interface, port and group on which we listen, in words."""
        settings = self.settings
        if settings.transport is TransportKind.NODE_MANAGER:
            return "listened through the node manager of this host"
        if settings.transport is TransportKind.JTCP:
            return f"listened on interface {settings.interface}, TCP port {settings.port}"
        return (
            f"listened on interface {settings.interface}, port {settings.port}, multicast group "
            f"{settings.multicast_group}"
        )

    def hints(self) -> str:
        """Returns the possible causes when no message came at all, the likeliest first."""
        if self.settings.transport is TransportKind.NODE_MANAGER:
            if manager_folder(self.settings) is None:
                return f"{self.place}, and none runs: --node-manager-directory says where it is"
            return f"{self.place}. Either nothing runs, or the manager does not reach it"
        if self.settings.transport is TransportKind.JTCP:
            return f"{self.place}. Without multicast, --peer ID=HOST:PORT says where components are"
        only = self.settings.interface == DEFAULT_INTERFACE
        host = " (127.0.0.1 reaches this host only)" if only else ""
        return (
            f"{self.place}. Either nothing runs there; or it is on another --interface{host}, "
            "--port or --multicast-group; or the network carries no multicast, which --peer "
            "ID=HOST:PORT does without; or a firewall drops UDP"
        )


def fault(error: OSError, network: Network, remedy: str) -> str:
    """Returns why the network cannot be used; for a port in use, also its holder and `remedy`."""
    settings = network.settings
    if error.errno != errno.EADDRINUSE:
        what = f"the network cannot be used: {error.strerror or error}"
        return f"{what}; 'jausml doctor --interface {settings.interface}' tells more"
    protocol = "tcp" if settings.transport is TransportKind.JTCP else "udp"
    return (
        f"port {settings.port} is in use and not shared; {who_holds(protocol, settings)}. {remedy}"
    )


def make_network(
    own: str | None,
    interface: str,
    port: int,
    group: str,
    peers: Iterable[str],
    *,
    transport: str = TransportKind.JUDP.value,
    node_manager_directory: str = "",
) -> Network:
    """Returns the network of options (`ValueError`: an id or a peer is not valid).

    Args:
        own: Our JAUS id; None for any.
        peers: Endpoints of components as `ID=HOST:PORT`.
        transport: One of `TRANSPORTS`.
        node_manager_directory: Folder of the local sockets of a node manager; empty for the folder
            of temporary files.
    """
    settings = TransportSettings(
        interface=interface,
        port=port,
        multicast_group=group,
        address_book=dict(map(_peer, peers)),
        transport=TransportKind(transport),
        node_manager_directory=node_manager_directory,
    )
    if own is None:
        return Network(JausAddress(SUBSYSTEM, 1, 1), settings, is_own_given=False)
    return Network(component_address(own), settings)


def component_address(text: str) -> JausAddress:
    """Returns the address of one component (`ValueError`: the text is none)."""
    if not isinstance(text, str):  # scripts may pass anything
        raise ValueError(f"{text!r} is no JAUS id; it is written as text, e.g. '100.1.2'")
    address = JausAddress.parse(text)
    if not address.is_concrete:
        raise ValueError(f"{text} does not name one component")
    return address


def silence_log() -> None:
    """Keeps warnings of the runtime, such as those about foreign datagrams, off the terminal."""
    logging.getLogger("jausml").addHandler(_NOWHERE)  # a logger has the same handler only once


def _peer(text: str) -> tuple[JausAddress, Endpoint]:
    address, _, place = text.partition("=")
    host, _, port = place.rpartition(":")
    if not host or not (port.isascii() and port.isdigit()):
        raise ValueError(f"{text!r} is not ID=HOST:PORT, e.g. 100.1.2=192.168.0.7:3794")
    return component_address(address), (host, int(port))


@contextmanager
def identified(network: Network, count: int = 1) -> Iterator[Network]:
    """Yields the network with our id, which is marked as used for other tools of this host.

    An id that the user chose stays; `is_shared` is set if another tool has it. Otherwise the id is
    65000, the last number of the interface, which differs between hosts of a network, and the first
    free number on this host (`count`: number of consecutive ids that must be free).
    """
    with ExitStack() as claims:
        if network.is_own_given:
            free = _claimed(network.own, count, claims)
            yield replace(network, is_shared=not free)
            return
        for own in _candidates(network.settings.interface, count):
            if _claimed(own, count, claims):
                break
            claims.close()
        yield replace(network, own=own)


def _candidates(interface: str, count: int) -> Iterator[JausAddress]:
    node = int(interface.rpartition(".")[2])
    node = node if 0 < node <= _LAST else 1
    # Where ids cannot be claimed, the process id usually makes them different.
    first = 1 if sys.platform == "linux" else os.getpid() % (_LAST - count) + 1
    for component in range(first, _LAST - count + 2):
        yield JausAddress(SUBSYSTEM, node, component)


def _claimed(own: JausAddress, count: int, claims: ExitStack) -> bool:
    """Claims ids until the stack is closed, and returns whether all of them were free."""
    if sys.platform != "linux":
        return True
    for offset in range(count):
        address = JausAddress(own.subsystem, own.node, (own.component - 1 + offset) % _LAST + 1)
        # An abstract socket, one for each network namespace: the system frees it with the process.
        claim = claims.enter_context(socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM))
        try:
            claim.bind(f"\0jausml tool {address}")
        except OSError as error:
            if error.errno != errno.EADDRINUSE:
                raise
            return False
    return True

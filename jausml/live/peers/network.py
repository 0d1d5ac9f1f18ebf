"""Network of a live tool, by the options of a user."""

from __future__ import annotations

import errno
import logging
from collections.abc import Iterable
from dataclasses import dataclass

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

# Their ids have no byte 0xFF, which Junior takes for a wildcard.
TOOL_SUBSYSTEM = 65000
"""Subsystem of live tools."""

_NOWHERE = logging.NullHandler()


@dataclass(frozen=True, slots=True)
class Network:
    """The network of a tool.

    Attributes:
        own: Our JAUS id; `identified` makes it one of this tool alone, unless it was chosen.
        is_own_given: Whether a user chose the id.
        is_shared: Whether another tool of this host has the same id.
    """

    own: JausAddress
    settings: TransportSettings
    is_own_given: bool = True
    is_shared: bool = False

    @property
    def place(self) -> str:
        """Where we listened, as the end of a sentence."""
        settings = self.settings
        if settings.transport is TransportKind.NODE_MANAGER:
            return "listened through the node manager of this host"
        if settings.transport is TransportKind.JTCP:
            return f"listened on interface {settings.interface}, TCP port {settings.port}"
        where = f"interface {settings.interface}, port {settings.port}"
        return f"listened on {where}, multicast group {settings.multicast_group}"

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
    """Returns the network of options.

    Args:
        own: Our JAUS id; None for any.
        peers: Endpoints of components as `ID=HOST:PORT`.
        transport: One of `TRANSPORTS`.
        node_manager_directory: Folder of the local sockets of a node manager; empty for the folder
            of temporary files.

    Raises:
        ValueError: An id or a peer is not valid.
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
        return Network(JausAddress(TOOL_SUBSYSTEM, 1, 1), settings, is_own_given=False)
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

"""Network of a live tool, made of the words that a user types."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.live.peers.identity import SUBSYSTEM
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.settings import JUDP_GROUP, JUDP_PORT, Endpoint, TransportSettings

if TYPE_CHECKING:
    from collections.abc import Iterable

DEFAULT_INTERFACE = "127.0.0.1"
DEFAULT_PORT = JUDP_PORT
DEFAULT_GROUP = JUDP_GROUP


@dataclass(frozen=True, slots=True)
class Network:
    """Our own identity, and where the others are.

    Attributes:
        own: Our JAUS id; see `identified`.
        settings: Interface, port, multicast group and known peers.
        is_own_given: Whether the user says it.
        is_shared: Whether another tool of this host has it too.
    """

    own: JausAddress
    settings: TransportSettings
    is_own_given: bool = True
    is_shared: bool = False

    @property
    def place(self) -> str:
        """Where we listen."""
        settings = self.settings
        return (
            f"listened on interface {settings.interface}, port {settings.port}, multicast group "
            f"{settings.multicast_group}"
        )

    def hints(self) -> str:
        """Returns what may be the cause when nothing at all was heard, the likeliest first."""
        only = self.settings.interface == DEFAULT_INTERFACE
        host = " (127.0.0.1 reaches this host only)" if only else ""
        return (
            f"{self.place}. Either nothing runs there; or it is on another --interface{host}, "
            "--port or --multicast-group; or the network carries no multicast, which --peer "
            "ID=HOST:PORT does without; or a firewall drops UDP"
        )


def make_network(
    own: str | None, interface: str, port: int, group: str, peers: Iterable[str]
) -> Network:
    """Returns the network that the options describe.

    Args:
        own: Dotted JAUS id; None for one that is free.
        interface: IPv4 address of the interface.
        port: UDP port of JUDP.
        group: Multicast group.
        peers: Known components as `ID=HOST:PORT`.

    Raises:
        ValueError: One of them cannot be.
    """
    settings = TransportSettings(
        interface=interface,
        port=port,
        multicast_group=group,
        address_book=dict(map(_peer, peers)),
    )
    if own is None:
        return Network(JausAddress(SUBSYSTEM, 1, 1), settings, is_own_given=False)
    return Network(component_address(own), settings)


def component_address(text: str) -> JausAddress:
    """Returns the address of one component.

    Raises:
        ValueError: The text is no JAUS id or names several components.
    """
    address = JausAddress.parse(text)
    if not address.is_concrete:
        raise ValueError(f"{text} does not name one component")
    return address


def silence_log() -> None:
    """Keeps warnings of the runtime about foreign datagrams from the terminal."""
    logging.getLogger("jausml").addHandler(logging.NullHandler())


def _peer(text: str) -> tuple[JausAddress, Endpoint]:
    address, _, place = text.partition("=")
    host, _, port = place.rpartition(":")
    if not host or not (port.isascii() and port.isdigit()):
        raise ValueError(f"{text!r} is not ID=HOST:PORT, e.g. 100.1.2=192.168.0.7:3794")
    return component_address(address), (host, int(port))

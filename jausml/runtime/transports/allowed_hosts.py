"""Hosts that packets are taken from.

JAUS has no authentication: whoever reaches the port is heard (AS5669A). An IPv4 address can be
forged too, so that this keeps out who is there by mistake, or cannot send in the name of another.
"""

from __future__ import annotations

import ipaddress
import socket
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..base.counters import Counters
    from ..base.settings import Endpoint, TransportSettings

NOT_ALLOWED = "transport.source_not_allowed"
"""Packets of hosts that are not allowed."""


class AllowedHosts:
    """The hosts that the settings name; any host when they name none.

    Processes of the same host are always allowed: they share its port, and pass packets on to each
    other (docs/adr/0006).
    """

    def __init__(self, settings: TransportSettings, counters: Counters) -> None:
        self._counters = counters
        named = (*settings.allowed_hosts, settings.interface) if settings.allowed_hosts else ()
        networks = [ipaddress.IPv4Network(each) for each in named]
        self._networks = [(int(each.netmask), int(each.network_address)) for each in networks]

    def admits(self, endpoint: Endpoint) -> bool:
        """Return whether packets of an endpoint are taken; it is counted if they are not."""
        if not self._networks:
            return True
        host = int.from_bytes(socket.inet_aton(endpoint[0]), "big")
        if any(host & mask == network for mask, network in self._networks):
            return True
        self._counters.count(NOT_ALLOWED, f"{endpoint[0]}:{endpoint[1]}")
        return False

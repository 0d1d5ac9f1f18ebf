"""Clients of one component: everything by which it uses others."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .command_client import CommandClient
from .control_session import ControlClient
from .discovery_client import DiscoveryClient
from .event_client import EventClient
from .list_client import ListClient
from .peer_client import PeerClient
from .presence import Greeter, Presence
from .query import QueryClient

if TYPE_CHECKING:
    from ..services.host import Host


class Clients:
    """The clients of one component."""

    def __init__(self, host: Host) -> None:
        self.presence = Presence(host.loop)
        self.queries = QueryClient(host)
        self.events = EventClient(host, self.presence, self.queries)
        self.control = ControlClient(host, self.presence, self.events)
        self.discovery = DiscoveryClient(host)
        self.greeter = Greeter(host, self.presence)
        self.peers = PeerClient(host, self.discovery)
        self.commands = CommandClient(host)
        self.lists = ListClient(host, self.queries)

    def start(self) -> None:
        """Look around for others, and speak to those that wait for it."""
        self.discovery.start()
        self.greeter.start()

    def stop(self) -> None:
        """Wait for nothing any more, release control and cancel subscriptions."""
        self.queries.stop()
        self.commands.stop()
        self.lists.stop()
        self.peers.stop()
        self.greeter.stop()
        self.discovery.stop()
        self.control.stop()
        self.events.stop()

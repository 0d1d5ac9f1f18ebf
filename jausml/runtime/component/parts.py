"""What a component is made of: its core services, and its clients of those of others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from ..clients.command_client import CommandClient
from ..clients.control_session import ControlClient, HandoffClient
from ..clients.discovery_client import DiscoveryClient, Greeter, Presence
from ..clients.event_client import EventClient
from ..clients.list_client import ListClient
from ..clients.peer_search import PeerClient
from ..clients.query import QueryClient
from ..clients.resource_client import ResourceClient
from ..services.access_control import AccessControlService
from ..services.discovery import DigitalResourceService, DiscoveryService
from ..services.events import EventsService
from ..services.handoff import HandoffService
from ..services.list_manager import ListManagerService
from ..services.liveness_and_time import LivenessService, TimeService
from ..services.management import MachineStatesService, ManagementService

if TYPE_CHECKING:
    from ..services.host import Host


class Clients:
    """The clients of one component."""

    def __init__(self, host: Host) -> None:
        self.presence = Presence(host.loop)
        self.queries = QueryClient(host)
        self.events = EventClient(host, self.presence, self.queries)
        self.control = ControlClient(host, self.presence, self.events)
        self.handoff = HandoffClient(host, self.control)
        self.discovery = DiscoveryClient(host)
        self.greeter = Greeter(host, self.presence)
        self.peers = PeerClient(host, self.discovery)
        self.commands = CommandClient(host)
        self.lists = ListClient(host, self.queries)
        self.resources = ResourceClient(host, self.peers, self.queries)

    def start(self) -> None:
        """Look around for others, and speak to those that wait for it."""
        self.discovery.start()
        self.greeter.start()

    def stop(self) -> None:
        """Wait for nothing any more, release control and cancel subscriptions."""
        self.resources.stop()
        self.queries.stop()
        self.commands.stop()
        self.lists.stop()
        self.peers.stop()
        self.greeter.stop()
        self.discovery.stop()
        self.handoff.stop()
        self.control.stop()
        self.events.stop()


class CoreService(Protocol):
    """One core service."""

    @property
    def urns(self) -> frozenset[str]:
        """Identifiers of the service; some had several over the years."""

    def attach(self) -> None:
        """Take the messages of the service, for a component that provides it."""


class CoreServices:
    """The part of a component's state that core services keep.

    It is there whatever the component provides: one without Management is ready for nobody, one
    without AccessControl is never controlled. Only services that are provided take messages.
    """

    def __init__(self, host: Host) -> None:
        self.events = EventsService(host)
        self.access_control = AccessControlService(host)
        self.management = ManagementService(host, self.access_control)
        self.handoff = HandoffService(host, self.access_control)
        self.time = TimeService(host)
        self.list_manager = ListManagerService(host)
        self.liveness = LivenessService(host)
        self.discovery = DiscoveryService(host)
        self.digital_resources = DigitalResourceService(host)
        self.machine_states = MachineStatesService(host)
        every: tuple[CoreService, ...] = (
            self.events,
            self.access_control,
            self.handoff,
            self.management,
            self.time,
            self.list_manager,
            self.liveness,
            self.discovery,
            self.digital_resources,
            self.machine_states,
        )
        provided = {service.urn for service in host.services}
        for service in every:
            if not provided.isdisjoint(service.urns):
                service.attach()

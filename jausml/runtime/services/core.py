"""The core services of a component (AS5710)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from .access_control import AccessControlService
from .discovery import DiscoveryService
from .events import EventsService
from .list_manager import ListManagerService
from .liveness import LivenessService
from .management import ManagementService
from .time_service import TimeService

if TYPE_CHECKING:
    from .host import Host


class CoreService(Protocol):
    """One core service."""

    @property
    def urns(self) -> frozenset[str]:
        """Identifiers of the service; some had several over the years."""

    def attach(self) -> None:
        """Take the messages of the service, for a component that provides it.

        Raises:
            ValueError: The component handles one of them otherwise.
        """


class CoreServices:
    """The part of a component's state that core services keep.

    It is there whatever the component provides: one without Management is ready for nobody, one
    without AccessControl is never controlled. Only services that are provided take messages.
    """

    def __init__(self, host: Host) -> None:
        self.events = EventsService(host)
        self.access_control = AccessControlService(host)
        self.management = ManagementService(host, self.access_control)
        self.time = TimeService(host)
        self.list_manager = ListManagerService(host)
        self.liveness = LivenessService(host)
        self.discovery = DiscoveryService(host)
        every: tuple[CoreService, ...] = (
            self.events,
            self.access_control,
            self.management,
            self.time,
            self.list_manager,
            self.liveness,
            self.discovery,
        )
        provided = {service.urn for service in host.services}
        for service in every:
            if not provided.isdisjoint(service.urns):
                service.attach()

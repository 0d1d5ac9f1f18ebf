"""Registration of a component's streams and files with the registry of its subsystem (IOP)."""

from __future__ import annotations

from collections.abc import Sequence

from ..base.address import JausAddress
from ..base.clocks import Alarm
from ..messages.digital_resources import (
    QueryDigitalResourceEndpoint,
    RegisterDigitalResourceEndpoint,
    ReportDigitalResourceEndpoint,
    RequestIDRec,
)
from ..services.definitions import DIGITAL_RESOURCE_DISCOVERY, Scope
from ..services.digital_resources import endpoints
from ..services.host import Host
from .peer_search import PeerClient, PeerSearch
from .query import QueryClient

REGISTRY = PeerSearch((DIGITAL_RESOURCE_DISCOVERY,), within=Scope.SUBSYSTEM)

CHECK_INTERVAL = 5.0  # seconds between two queries to the registry


class ResourceClient:
    """Registers the endpoints of a component until the registry of its subsystem reports them.

    The report is what counts, not a confirmation: so a lost registration and a restarted registry
    are noticed in the same way.
    """

    def __init__(self, component: Host) -> None:
        self._component = component
        self._queries = component.part(QueryClient)
        component.when_stopped(self.stop)
        self._own = endpoints(component.settings.digital_resources, component.address)
        self._registry: JausAddress | None = None
        self._timer = Alarm(component.loop)
        component.part(PeerClient).find(REGISTRY, self._registries_found)

    def stop(self) -> None:
        """Stops the queries."""
        self._timer.cancel()

    def _registries_found(self, registries: Sequence[JausAddress]) -> None:
        self.stop()
        self._registry = next(iter(registries), None)
        self._check()

    def _check(self) -> None:
        registry, component = self._registry, self._component
        if registry is None or not component.running:
            return
        self._timer.set(CHECK_INTERVAL, self._check)
        self._queries.ask(
            registry,
            QueryDigitalResourceEndpoint(),
            ReportDigitalResourceEndpoint,
            self._compare,
            retries=2,
        )

    def _compare(self, report: ReportDigitalResourceEndpoint, registry: JausAddress) -> None:
        # Another component may have a resource of the same URL; registries need not tell whose.
        registered = {(endpoint.server_url, endpoint.jaus_id) for endpoint in report.endpoints}
        for number, endpoint in enumerate(self._own, 1):
            url = endpoint.server_url
            if registered.isdisjoint([(url, endpoint.jaus_id), (url, None)]):
                request = RequestIDRec(number)
                message = RegisterDigitalResourceEndpoint(request, endpoint)
                self._component.send(message, registry, acknowledge=True)

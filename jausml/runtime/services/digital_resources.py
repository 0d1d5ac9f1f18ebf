"""The DigitalResourceDiscovery service: URLs of streams and files of components (IOP)."""

from __future__ import annotations

from collections.abc import Sequence

from ..base.address import JausAddress
from ..messages.digital_resources import (
    ConfirmDigitalResourceEndpoint,
    Endpoint,
    QueryDigitalResourceEndpoint,
    RegisterDigitalResourceEndpoint,
    RemoveDigitalResourceEndpoint,
    ReportDigitalResourceEndpoint,
)
from ..wire.message import Message
from .definitions import DIGITAL_RESOURCE_DISCOVERY, server_type
from .host import Host

MAX_ENDPOINTS = 255  # endpoints that a report can list


def endpoints(urls: Sequence[str], owner: JausAddress) -> list[Endpoint]:
    """Returns the endpoints of a component, numbered from 1; raises ValueError as `server_type`."""
    return [
        Endpoint(server_type(url), url, owner.packed, number) for number, url in enumerate(urls, 1)
    ]


class DigitalResourceService:
    """Stores the endpoints that components register, and reports them with its own ones.

    The IOP does not require control: every component may register and remove endpoints.
    """

    urns = frozenset([DIGITAL_RESOURCE_DISCOVERY])

    def __init__(self, component: Host) -> None:
        self._component = component
        self._own = endpoints(component.settings.digital_resources, component.address)
        self._registered: dict[int, Endpoint] = {}

    def attach(self) -> None:
        """Takes the messages of the service, unless a connection of a bridge reports endpoints."""
        self._component.when_started(self._register_handlers)

    def _register_handlers(self) -> None:
        component = self._component
        if component.provision(QueryDigitalResourceEndpoint.CODE) is None:
            component.provide(
                QueryDigitalResourceEndpoint, ReportDigitalResourceEndpoint, self._report
            )
            component.handle(RegisterDigitalResourceEndpoint, self._register, counts_each=True)
            component.handle(RemoveDigitalResourceEndpoint, self._remove, counts_each=True)

    def _report(self, _query: Message, _sender: JausAddress) -> ReportDigitalResourceEndpoint:
        all_endpoints = [*self._own, *self._registered.values()]
        return ReportDigitalResourceEndpoint(all_endpoints[:MAX_ENDPOINTS])

    def _register(self, message: RegisterDigitalResourceEndpoint, sender: JausAddress) -> None:
        """Adds an endpoint, or replaces that of the same resource or URL."""
        endpoint = message.endpoint
        registered = self._registered.items()
        same = (number for number, other in registered if _is_same(other, endpoint))
        number = next(same, None) or self._free_id()
        if number is None:
            self._component.counters.count("digital_resources.full", f"endpoint of {sender}")
            return
        self._registered[number] = endpoint
        self._confirm(number, message.request_id_rec.request_id, sender)

    def _free_id(self) -> int | None:
        most = MAX_ENDPOINTS - len(self._own)
        free = (number for number in range(1, most + 1) if number not in self._registered)
        return next(free, None)

    def _remove(self, message: RemoveDigitalResourceEndpoint, sender: JausAddress) -> None:
        if self._registered.pop(message.id, None) is not None:
            self._confirm(message.id, message.request_id, sender)

    def _confirm(self, number: int, request: int, sender: JausAddress) -> None:
        self._component.send(ConfirmDigitalResourceEndpoint(number, request), sender)
        self._component.report_changed(ReportDigitalResourceEndpoint)


def _is_same(one: Endpoint, other: Endpoint) -> bool:
    if None in (one.jaus_id, one.resource_id):
        return one.server_url == other.server_url
    return (one.jaus_id, one.resource_id) == (other.jaus_id, other.resource_id)

"""The Discovery service: who is there, and what it provides (AS5710)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..base.api import part_of_whole
from ..messages import (
    QueryConfiguration,
    QueryIdentification,
    QueryServiceList,
    QueryServices,
    QuerySubsystemList,
    RegisterServices,
    ReportConfiguration,
    ReportIdentification,
    ReportServiceList,
    ReportServices,
    ReportSubsystemList,
)
from .definitions import CORE, VERSION_1_1, Scope
from .discovery_messages import report_service_list, report_services

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ..base.address import JausAddress
    from ..wire.message import Message
    from .definitions import ServiceIdentity
    from .host import Host


Type = ReportIdentification.Type


class DiscoveryService:
    """Answers for the component, its node or its subsystem (AS5710, Discovery).

    A component that provides Discovery v1.0 knows no QueryServiceList. A query whose scope is wider
    than the service's own stays unanswered; one that answers for others has a `Directory` of them.
    """

    urns = frozenset([CORE + "Discovery"])

    def __init__(self, component: Host) -> None:
        self._component = component
        self._scope = component.settings.discovery_scope
        self._directory: Any = None

    def attach(self) -> None:
        """Take the messages of Discovery."""
        component = self._component
        component.provide(QueryIdentification, ReportIdentification, self._identification)
        component.provide(QueryServices, ReportServices, self._services)
        if component.core_version("Discovery") >= VERSION_1_1:
            component.provide(QueryServiceList, ReportServiceList, self._service_list)
        if self._scope < Scope.COMPONENT:
            self._directory = component.part(part_of_whole("services.directory", "Directory"))
            return
        component.provide(QueryConfiguration, ReportConfiguration, _not_told)
        component.provide(QuerySubsystemList, ReportSubsystemList, _not_told)
        component.handle(RegisterServices, self._ignore)

    def _identification(
        self, query: QueryIdentification, _sender: JausAddress
    ) -> ReportIdentification | None:
        if not Scope.SYSTEM <= query.query_type <= Scope.COMPONENT:
            return None
        scope = Scope(query.query_type)
        # Operator units ask single components for the system: it has the name of the subsystem.
        if Scope.SYSTEM < scope < self._scope:
            return None
        name = self._component.name
        if scope <= Scope.SUBSYSTEM:
            name = self._component.settings.subsystem_name or name
        return ReportIdentification(
            query_type=scope, type_=self._type(scope), identification=_latin(name)[:255]
        )

    def _type(self, scope: Scope) -> int:
        known = self._component.component_type
        if scope is Scope.NODE:
            return Type.NODE
        if scope is Scope.COMPONENT:
            return known if known >= Type.PAYLOAD else Type.COMPONENT
        return known if known < Type.NODE else Type.OTHER_SUBSYSTEM

    def _services(self, query: QueryServices, _sender: JausAddress) -> ReportServices:
        own = self._component.address.subsystem
        members = {
            address: services
            for address, services in self._catalog().items()
            if address.subsystem == own
        }
        return report_services(query, members, own)

    def _service_list(self, query: QueryServiceList, _sender: JausAddress) -> ReportServiceList:
        return report_service_list(query, self._catalog())

    def _catalog(self) -> Mapping[JausAddress, tuple[ServiceIdentity, ...]]:
        """Return the services of whom it answers for."""
        own = {self._component.address: self._component.services}
        return own if self._directory is None else self._directory.catalog()

    def _ignore(self, _message: RegisterServices, _sender: JausAddress) -> None:
        self._component.counters.add("discovery.registration_ignored")


def _not_told(_query: Message, _sender: JausAddress) -> None:
    """Leave what concerns others to a component that answers for them."""


def _latin(name: str) -> str:
    """Replace what a JAUS string cannot hold."""
    return name.encode("latin-1", "replace").decode("latin-1")

"""The Discovery service: who is there, and what it provides (AS5710)."""

from __future__ import annotations

from typing import TYPE_CHECKING

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
from .definitions import CORE, VERSION_1_1, Scope, ServiceIdentity
from .discovery_messages import (
    MAX_LIST,
    report_configuration,
    report_service_list,
    report_services,
    report_subsystem_list,
    services_of,
)

if TYPE_CHECKING:
    from ..base.address import JausAddress
    from ..wire.message import Message
    from .host import Host


Type = ReportIdentification.Type

MAX_REGISTRATIONS = 1024
"""Components that are remembered; a flood of registrations must not fill the memory."""

MAX_SUBSYSTEMS = MAX_LIST - 1  # other subsystems that fit a ReportSubsystemList


class DiscoveryService:
    """Answers for the component, its node or its subsystem (AS5710, Discovery).

    A component that provides Discovery v1.0 knows no QueryServiceList.
    A query whose scope is wider than the service's own stays unanswered.
    """

    urns = frozenset([CORE + "Discovery"])

    def __init__(self, component: Host) -> None:
        self._component = component
        self._scope = component.settings.discovery_scope
        self._registered: dict[JausAddress, tuple[ServiceIdentity, ...]] = {}
        self._heard: dict[JausAddress, float] = {}
        self._servers: dict[int, tuple[JausAddress, float]] = {}

    def attach(self) -> None:
        """Take the messages of Discovery."""
        component = self._component
        component.provide(QueryIdentification, ReportIdentification, self._identification)
        component.provide(QueryConfiguration, ReportConfiguration, self._configuration)
        component.provide(QuerySubsystemList, ReportSubsystemList, self._subsystem_list)
        component.provide(QueryServices, ReportServices, self._services)
        if component.core_version("Discovery") >= VERSION_1_1:
            component.provide(QueryServiceList, ReportServiceList, self._service_list)
        component.handle(RegisterServices, self._register)
        component.on_message(ReportIdentification, self._server_found)

    def _identification(
        self, query: QueryIdentification, sender: JausAddress
    ) -> ReportIdentification | None:
        if sender in self._heard:
            self._heard[sender] = self._component.loop.now()
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

    def _configuration(
        self, query: QueryConfiguration, _sender: JausAddress
    ) -> ReportConfiguration | None:
        own = self._component.address
        members = [address for address in self._catalog() if address.subsystem == own.subsystem]
        if query.query_type == Scope.SUBSYSTEM and self._scope <= Scope.SUBSYSTEM:
            return report_configuration(members)
        if query.query_type == Scope.NODE and self._scope <= Scope.NODE:
            return report_configuration(member for member in members if member.node == own.node)
        return None

    def _subsystem_list(self, _query: Message, _sender: JausAddress) -> ReportSubsystemList | None:
        if self._scope > Scope.SUBSYSTEM:
            return None
        own = self._component.address
        self._forget_servers()
        others = {subsystem: server for subsystem, (server, _) in self._servers.items()}
        return report_subsystem_list({**others, own.subsystem: own}.values())

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

    def _register(self, message: RegisterServices, sender: JausAddress) -> None:
        counters = self._component.counters
        if len(self._registered) >= MAX_REGISTRATIONS:
            self._forget_registrations()
        if not self._answers_for(sender):
            counters.add("discovery.registration_ignored")
        elif sender not in self._registered and len(self._registered) >= MAX_REGISTRATIONS:
            counters.count("discovery.too_many_registrations", str(sender))
        else:
            self._registered[sender] = services_of(message)
            self._heard[sender] = self._component.loop.now()

    def _server_found(self, report: ReportIdentification, sender: JausAddress) -> None:
        if report.query_type != Scope.SUBSYSTEM:
            return
        if len(self._servers) >= MAX_SUBSYSTEMS:
            self._forget_servers()
        if sender.subsystem in self._servers or len(self._servers) < MAX_SUBSYSTEMS:
            self._servers[sender.subsystem] = sender, self._component.loop.now()
        else:
            self._component.counters.count("discovery.too_many_subsystems", str(sender))

    def _answers_for(self, other: JausAddress) -> bool:
        own = self._component.address
        if self._scope is Scope.SYSTEM:
            return True
        if self._scope is Scope.SUBSYSTEM:
            return other.subsystem == own.subsystem
        if self._scope is Scope.NODE:
            return (other.subsystem, other.node) == (own.subsystem, own.node)
        return False

    def _oldest(self) -> float:
        """Return the time before which whoever was heard last is forgotten."""
        return self._component.loop.now() - self._component.settings.registration_lifetime

    def _catalog(self) -> dict[JausAddress, tuple[ServiceIdentity, ...]]:
        """Return the component and those that registered and were heard of lately."""
        self._forget_registrations()
        return {**self._registered, self._component.address: self._component.services}

    def _forget_registrations(self) -> None:
        limit = self._oldest()
        for address in [registrant for registrant, heard in self._heard.items() if heard < limit]:
            del self._heard[address]
            del self._registered[address]

    def _forget_servers(self) -> None:
        limit = self._oldest()
        for subsystem in [
            subsystem_id for subsystem_id, (_, heard) in self._servers.items() if heard < limit
        ]:
            del self._servers[subsystem]


def _latin(name: str) -> str:
    """Replace what a JAUS string cannot hold."""
    return name.encode("latin-1", "replace").decode("latin-1")

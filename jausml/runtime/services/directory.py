"""The directory of a Discovery service that answers for a node, a subsystem or more (AS5710)."""

from __future__ import annotations

from collections.abc import Iterable

from ..base.address import JausAddress
from ..messages import (
    QueryConfiguration,
    QueryIdentification,
    QuerySubsystemList,
    RegisterServices,
    ReportConfiguration,
    ReportIdentification,
    ReportSubsystemList,
)
from ..wire.message import Message
from .definitions import Scope, ServiceIdentity
from .discovery import MAX_LIST, component_record, grouped, services_of
from .host import Host

MAX_REGISTRATIONS = 1024  # components that are stored; false ones must not fill the memory
MAX_SUBSYSTEMS = MAX_LIST - 1  # other subsystems that fit a ReportSubsystemList


class Directory:
    """The registered components, and the Discovery servers of other subsystems."""

    def __init__(self, component: Host) -> None:
        self._component = component
        self._scope = component.settings.discovery_scope
        self._registered: dict[JausAddress, tuple[ServiceIdentity, ...]] = {}
        self._heard: dict[JausAddress, float] = {}
        self._servers: dict[int, tuple[JausAddress, float]] = {}
        component.provide(QueryConfiguration, ReportConfiguration, self._configuration)
        component.provide(QuerySubsystemList, ReportSubsystemList, self._subsystem_list)
        component.handle(RegisterServices, self._register)
        component.on_message(ReportIdentification, self._add_server)
        component.on_message(QueryIdentification, self._renew)

    def catalog(self) -> dict[JausAddress, tuple[ServiceIdentity, ...]]:
        """Returns the services of this component and of registered ones that were heard lately."""
        self._forget_registrations()
        return {**self._registered, self._component.address: self._component.services}

    def _renew(self, _query: QueryIdentification, sender: JausAddress) -> None:
        if sender in self._heard:
            self._heard[sender] = self._component.loop.now()

    def _configuration(
        self, query: QueryConfiguration, _sender: JausAddress
    ) -> ReportConfiguration | None:
        own = self._component.address
        members = [address for address in self.catalog() if address.subsystem == own.subsystem]
        if query.query_type == Scope.SUBSYSTEM and self._scope <= Scope.SUBSYSTEM:
            return _report_configuration(members)
        if query.query_type == Scope.NODE and self._scope <= Scope.NODE:
            return _report_configuration(member for member in members if member.node == own.node)
        return None

    def _subsystem_list(self, _query: Message, _sender: JausAddress) -> ReportSubsystemList | None:
        if self._scope > Scope.SUBSYSTEM:
            return None
        own = self._component.address
        self._forget_servers()
        others = {subsystem: server for subsystem, (server, _) in self._servers.items()}
        return ReportSubsystemList(
            subsystem_list=[
                ReportSubsystemList.SubsystemRec(server.subsystem, server.node, server.component)
                for server in {**others, own.subsystem: own}.values()
            ]
        )

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

    def _add_server(self, report: ReportIdentification, sender: JausAddress) -> None:
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
        """Returns the earliest time of the last message of a component that is not forgotten."""
        return self._component.loop.now() - self._component.settings.registration_lifetime

    def _forget_registrations(self) -> None:
        limit = self._oldest()
        for address in [address for address, heard in self._heard.items() if heard < limit]:
            del self._heard[address]
            del self._registered[address]

    def _forget_servers(self) -> None:
        limit = self._oldest()
        servers = self._servers.items()
        self._servers = {
            subsystem: (server, heard) for subsystem, (server, heard) in servers if heard >= limit
        }


def _report_configuration(addresses: Iterable[JausAddress]) -> ReportConfiguration:
    """Returns the report of components, grouped by node."""
    return ReportConfiguration(
        node_list=[
            ReportConfiguration.NodeSeq(
                node_rec=ReportConfiguration.NodeRec(node_id=node),
                component_list=[component_record(address) for address in members],
            )
            for node, members in grouped(addresses, lambda address: address.node)
        ]
    )

"""Reports of Discovery as addresses and services."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.runtime.base.address import JausAddress
from jausml.runtime.services.definitions import ServiceIdentity

if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import TypeAlias

    from jausml.runtime.messages import ReportControl, ReportServiceList, ReportServices

    _Component: TypeAlias = ReportServices.ComponentSeq | ReportServiceList.ComponentSeq

Services = dict[JausAddress, tuple[ServiceIdentity, ...]]
"""The services of components."""


def services_of(report: ReportServices, subsystem: int) -> Services:
    """Returns the components of a ReportServices, which does not name their subsystem.

    Args:
        report: The report (AS5710, Discovery).
        subsystem: Subsystem of the component that sent it.
    """
    return _merged(
        (JausAddress(subsystem, node.node_rec.node_id, each.component_rec.component_id), each)
        for node in report.node_list
        for each in node.component_list
    )


def service_list(report: ReportServiceList) -> Services:
    """Returns the components of a ReportServiceList (AS5710A v1.1, Discovery)."""
    return _merged(
        (
            JausAddress(
                subsystem.subsystem_rec.subsystem_id,
                node.node_rec.node_id,
                each.component_rec.component_id,
            ),
            each,
        )
        for subsystem in report.subsystem_list
        for node in subsystem.node_list
        for each in node.component_list
    )


def controller_of(report: ReportControl) -> str:
    """Returns the dotted address of the controller; 0.0.0 when there is none (AS5710)."""
    return f"{report.subsystem_id}.{report.node_id}.{report.component_id}"


def _merged(records: Iterable[tuple[JausAddress, _Component]]) -> Services:
    """Returns the services of each component, of all records that name it.

    Components of the JAUS Tool Set report a node record for each of their services.
    """
    found: dict[JausAddress, dict[ServiceIdentity, None]] = {}
    for address, component in records:
        services = found.setdefault(address, {})
        for each in component.service_list:
            number = (each.major_version_number, each.minor_version_number)
            services[ServiceIdentity(each.uri, *number)] = None
    return {address: tuple(services) for address, services in found.items()}

"""Reports of Discovery as addresses and services."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.runtime.base.address import JausAddress
from jausml.runtime.services.definitions import ServiceIdentity

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.runtime.messages import ReportControl, ReportServiceList, ReportServices

Services = dict[JausAddress, tuple[ServiceIdentity, ...]]
"""The services of components."""


def services_of(report: ReportServices, subsystem: int) -> Services:
    """Returns the components of a ReportServices, which does not name their subsystem.

    Args:
        report: The report (AS5710, Discovery).
        subsystem: Subsystem of the component that sent it.
    """
    return {
        JausAddress(subsystem, node.node_rec.node_id, each.component_rec.component_id): _identities(
            each.service_list
        )
        for node in report.node_list
        for each in node.component_list
    }


def service_list(report: ReportServiceList) -> Services:
    """Returns the components of a ReportServiceList (AS5710A v1.1, Discovery)."""
    return {
        JausAddress(
            subsystem.subsystem_rec.subsystem_id,
            node.node_rec.node_id,
            each.component_rec.component_id,
        ): _identities(each.service_list)
        for subsystem in report.subsystem_list
        for node in subsystem.node_list
        for each in node.component_list
    }


def controller_of(report: ReportControl) -> str:
    """Returns the dotted address of the controller; 0.0.0 when there is none (AS5710)."""
    return f"{report.subsystem_id}.{report.node_id}.{report.component_id}"


def _identities(
    records: Iterable[ReportServices.ServiceRec | ReportServiceList.ServiceRec],
) -> tuple[ServiceIdentity, ...]:
    return tuple(
        ServiceIdentity(each.uri, each.major_version_number, each.minor_version_number)
        for each in records
    )

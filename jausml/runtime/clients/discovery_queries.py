"""What is asked for services of others, and what reports of them say (AS5710, Discovery)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..base.address import BROADCAST, JausAddress
from ..messages import QueryServiceList, QueryServices, ReportServiceList, ReportServices
from ..services.discovery_messages import services_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..services.definitions import ServiceIdentity


def query_services(component: JausAddress = BROADCAST) -> QueryServices:
    """Return the query for the services of one component, or of all.

    Args:
        component: The component. There are stacks that know no wildcards, and report nothing.
    """
    record = QueryServices.ComponentRec(component_id=component.component)
    node = QueryServices.NodeSeq(
        node_rec=QueryServices.NodeRec(node_id=component.node), component_list=[record]
    )
    return QueryServices(node_list=[node])


def query_service_lists(component: JausAddress = BROADCAST) -> QueryServiceList:
    """Return the query of v1.1 for the services of one component, or of all."""
    record = QueryServiceList.ComponentRec(component_id=component.component)
    node = QueryServiceList.NodeSeq(
        node_rec=QueryServiceList.NodeRec(node_id=component.node), component_list=[record]
    )
    subsystem = QueryServiceList.SubsystemSeq(
        subsystem_rec=QueryServiceList.SubsystemRec(subsystem_id=component.subsystem),
        node_list=[node],
    )
    return QueryServiceList(subsystem_list=[subsystem])


def reported_services(
    report: ReportServices | ReportServiceList, subsystem: int
) -> Iterator[tuple[JausAddress, tuple[ServiceIdentity, ...]]]:
    """Yield the components of a report with their services.

    Args:
        subsystem: Where the components of a ReportServices are, which does not tell it.
    """
    if isinstance(report, ReportServices):
        parts = [(subsystem, report.node_list)]
    else:
        lists = report.subsystem_list
        parts = [
            (subsystem_entry.subsystem_rec.subsystem_id, subsystem_entry.node_list)
            for subsystem_entry in lists
        ]
    for number, nodes in parts:
        for node in nodes:
            for component_entry in node.component_list:
                component = component_entry.component_rec.component_id
                yield (
                    JausAddress(number, node.node_rec.node_id, component),
                    services_of(component_entry),
                )

"""Reports of Discovery as addresses and services."""

from jausml.live.peers.discovery import services_of
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import ReportServiceList, ReportServices

TWO_RECORDS = bytes.fromhex(
    "034b 02"
    "01 01 c7 00 01 25" + b"urn:jaus:jss:mobility:LocalPoseSensor".hex() + "01 00"
    "01 01 c7 00 01 2d" + b"urn:jaus:jss:mobility:LocalWaypointListDriver".hex() + "01 00"
)
"""ReportServices of a component that reports a node record for each of its services."""


def names(services):
    return [service.urn.rpartition(":")[2] for service in services]


def test_a_component_of_two_node_records_has_the_services_of_both():
    found = services_of(ReportServices.decode(TWO_RECORDS), 126)
    assert {str(address): names(service_list) for address, service_list in found.items()} == {
        "126.1.199": ["LocalPoseSensor", "LocalWaypointListDriver"]
    }


def test_a_service_that_is_listed_twice_counts_once():
    report = ReportServices.decode(TWO_RECORDS)
    report.node_list += report.node_list
    (services,) = services_of(report, 126).values()
    assert names(services) == ["LocalPoseSensor", "LocalWaypointListDriver"]


def test_a_service_list_of_two_component_records_is_merged_too():
    def component(urn):
        return ReportServiceList.ComponentSeq(
            component_rec=ReportServiceList.ComponentRec(component_id=9, instance_id=0),
            service_list=[ReportServiceList.ServiceRec(urn, 1, 0)],
        )

    node = ReportServiceList.NodeSeq(
        node_rec=ReportServiceList.NodeRec(node_id=2),
        component_list=[component("urn:a:One"), component("urn:a:Two")],
    )
    subsystem = ReportServiceList.SubsystemSeq(
        subsystem_rec=ReportServiceList.SubsystemRec(subsystem_id=7), node_list=[node]
    )
    found = services_of(ReportServiceList(subsystem_list=[subsystem]), 0)
    assert {address: names(service_list) for address, service_list in found.items()} == {
        JausAddress(7, 2, 9): ["One", "Two"]
    }

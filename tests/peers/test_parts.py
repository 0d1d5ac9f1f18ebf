"""Parts of the live tools without a network: what they hear, and when what they repeat is due."""

from itertools import count

import pytest

from jausml.live.peers.discovery import Survey, services_of
from jausml.live.peers.heard import Heard
from jausml.live.peers.requesting import Course
from jausml.runtime import JausComponent
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.messages import (
    QueryIdentification,
    ReportIdentification,
    ReportServiceList,
    ReportServices,
    ReportStatus,
)
from jausml.runtime.virtual import VirtualWorld

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


def test_a_name_that_changes_with_each_answer_is_not_asked_for_without_end():
    with VirtualWorld() as world:
        tool, peer = (
            JausComponent(world.transport(), JausAddress(subsystem, 1, 1), name="", services=())
            for subsystem in (1, 2)
        )
        names = count()

        def identify(query, sender):
            peer.send(ReportIdentification(query.query_type, 10001, f"{next(names)}"), sender)

        peer.handle(QueryIdentification, identify)
        survey = Survey(tool, ())
        peer.start()
        tool.start()
        for _ in range(2):
            survey.ask(peer.address)
            world.run_for(1.0)
        assert next(names) < 10


# -- what was heard --------------------------------------------------------------------------------


ANSWER = ReportStatus(status=1, reserved=0).encode()


def test_an_awaited_answer_arrives_however_many_others_were_heard():
    heard = Heard(None, None, Counters())
    for subsystem in range(1, 2001):
        heard.note(ANSWER, JausAddress(subsystem, 1, 1))
    assert len(heard.sources()) == 1024
    late = JausAddress(3000, 1, 1)
    with heard.awaiting(late, (ReportStatus.CODE,)) as queue:
        heard.note(b"?", late)
        heard.note(ANSWER, late)
        assert queue.get_nowait() == ANSWER
    assert heard.of(late)


# -- when a command that is repeated is due --------------------------------------------------------


def times(course, late):
    """Returns when messages are due, each of which is sent so much later."""
    due, found = 0.0, []
    while due is not None:
        found.append(due)
        due = course.next_due(due, due + late)
    return found


@pytest.mark.parametrize("late", [0.0, 0.004, 0.09])
def test_lateness_does_not_add_up(late):
    found = times(Course(rate=10, duration=2.0), late)
    assert found == pytest.approx([0.1 * number for number in range(20)])


def test_what_was_missed_is_left_out():
    assert times(Course(rate=10, duration=1.0), 0.25) == pytest.approx([0.0, 0.3, 0.6, 0.9])


def test_once_without_a_rate():
    assert times(Course(duration=5.0), 0.1) == [0.0]

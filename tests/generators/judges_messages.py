"""Eighty messages of a judge to a robot straight from the generator: run by test_simulated.py.

The captures of the IGVC of 2015 are not ours to copy: these messages are our own, of the same
services, in the order of the tasks, sent to all components of the node by multicast as the judges
send theirs. Each row names the answer, and what it says.
"""

import os
import subprocess
import sys

import pytest
import robot.messages as own
from jausml_runtime import messages as core
from judges_unit import Unit

PORT = os.environ["JUDGED_PORT"]
SECONDS = 5.0
ALL = 0xFFFF
NONE = 99
"""An event that there is not; the others of the table are the last that was confirmed."""
PULSE = core.QueryHeartbeatPulse().encode()
WAYPOINT = own.SetLocalWaypoint(x=5.0, y=-2.0).encode()


def services(*numbers):
    """The query for services of nodes or components."""
    node, component = core.QueryServices.NodeRec, core.QueryServices.ComponentRec
    return core.QueryServices(
        [
            core.QueryServices.NodeSeq(
                node(numbers[0]), [component(number) for number in numbers[1:]]
            )
        ]
    )


def listed():
    """The query for all services of all subsystems."""
    query = core.QueryServiceList
    node = query.NodeSeq(query.NodeRec(255), [query.ComponentRec(255)])
    return query([query.SubsystemSeq(query.SubsystemRec(0xFFFF), [node])])


def elements(*uids):
    """A list of waypoints."""
    record, data = core.SetElement.ElementRec, core.SetElement.ElementData
    found = [
        record(uid, uid - 1, uid + 1 if uid != uids[-1] else 0, data(0, WAYPOINT)) for uid in uids
    ]
    return core.SetElement(core.SetElement.RequestIDRec(1), found)


def deleted(*uids):
    record = core.DeleteElement.DeleteElementRec
    return core.DeleteElement(core.DeleteElement.RequestIDRec(2), [record(uid) for uid in uids])


def near(**values):
    """Tells whether a report has these values, within a step of the wire."""
    return lambda report: (
        {name: getattr(report, name) for name in values} == pytest.approx(values, abs=1e-2)
    )


def says(**values):
    """Tells whether a report has these values."""
    return lambda report: {name: getattr(report, name) for name in values} == values


DISCOVERY = [
    *((core.QueryIdentification(scope), core.ReportIdentification) for scope in (1, 2, 3, 4)),
    (services(255, 255), core.ReportServices),
    (services(1, 1), core.ReportServices),
    (listed(), core.ReportServiceList),
    (core.QueryConfiguration(2), core.ReportConfiguration),
    (core.QueryConfiguration(3), core.ReportConfiguration),
    (core.QuerySubsystemList(), core.ReportSubsystemList),
]
EVENTS = [
    (core.QueryHeartbeatPulse(), core.ReportHeartbeatPulse),
    (core.QueryEventTimeout(), core.ReportEventTimeout),
    (core.CreateEvent(1, 0, 5.0, PULSE), core.ConfirmEventRequest, says(request_id=1)),
    (core.QueryEvents(), core.ReportEvents),
    (core.UpdateEvent(2, 0, 10.0, 0, PULSE), core.ConfirmEventRequest, says(request_id=2)),
    (core.CancelEvent(3, 0), core.ConfirmEventRequest, says(request_id=3)),
    (
        core.CreateEvent(4, 1, 0.0, core.QueryStatus().encode()),
        core.ConfirmEventRequest,
        says(request_id=4),
    ),
    (core.CancelEvent(5, 0), core.ConfirmEventRequest, says(request_id=5)),
    (core.CreateEvent(6, 0, 5.0, b"\xff\xee"), core.RejectEventRequest, says(request_id=6)),
    (core.CancelEvent(7, NONE), core.RejectEventRequest, says(request_id=7)),
]
ACCESS = [
    (core.QueryControl(), core.ReportControl, says(subsystem_id=0)),
    (core.QueryAuthority(), core.ReportAuthority),
    (core.QueryTimeout(), core.ReportTimeout),
    (core.RequestControl(255), core.ConfirmControl, says(response_code=0)),
    (core.QueryControl(), core.ReportControl, says(subsystem_id=42, authority_code=255)),
    (core.SetAuthority(200), None),
    (core.QueryAuthority(), core.ReportAuthority, says(authority_code=200)),
    (core.ReleaseControl(), core.RejectControl, says(response_code=0)),
    (core.QueryControl(), core.ReportControl, says(subsystem_id=0)),
]
MANAGEMENT = [
    (core.QueryStatus(), core.ReportStatus, says(status=2)),
    (core.RequestControl(255), core.ConfirmControl),
    (core.Resume(), None),
    (core.QueryStatus(), core.ReportStatus, says(status=1)),
    (core.Standby(), None),
    (core.QueryStatus(), core.ReportStatus, says(status=2)),
    (core.SetEmergency(1), None),
    (core.QueryStatus(), core.ReportStatus, says(status=5)),
    (core.ClearEmergency(1), None),
    (core.QueryStatus(), core.ReportStatus, says(status=2)),
    (core.RequestControl(255), core.ConfirmControl),
    (core.Resume(), None),
    (core.QueryStatus(), core.ReportStatus, says(status=1)),
]
SENSORS = [
    (own.QueryVelocityState(ALL), own.ReportVelocityState, near(velocity_x=0.0, yaw_rate=0.0)),
    (own.QueryVelocityState(0x0140), own.ReportVelocityState, says(velocity_x=None)),
    (core.CreateEvent(8, 0, 5.0, own.QueryVelocityState(ALL).encode()), core.ConfirmEventRequest),
    (core.CancelEvent(9, 0), core.ConfirmEventRequest),
    (own.QueryLocalPose(ALL), own.ReportLocalPose, near(x=0.0, y=0.0)),
    (own.SetLocalPose(x=3.0, y=-2.0, yaw=0.5), None),
    (own.QueryLocalPose(ALL), own.ReportLocalPose, near(x=3.0, y=-2.0, yaw=0.5)),
    (core.CreateEvent(10, 1, 0.0, own.QueryLocalPose(ALL).encode()), core.ConfirmEventRequest),
    (own.SetLocalPose(x=0.0, y=0.0, yaw=0.0), None),
    (own.QueryLocalPose(ALL), own.ReportLocalPose, near(x=0.0, y=0.0, yaw=0.0)),
    (core.CancelEvent(11, 0), core.ConfirmEventRequest),
    (own.QueryLocalPose(0x0003), own.ReportLocalPose, says(yaw=None)),
    (own.QueryLocalPose(ALL), own.ReportLocalPose),
    (own.QueryWrenchEffort(ALL), own.ReportWrenchEffort),
    (own.SetWrenchEffort(propulsive_linear_effort_x=50.0), None),
    (own.QueryWrenchEffort(ALL), own.ReportWrenchEffort, near(propulsive_linear_effort_x=50.0)),
]
WAYPOINTS = [
    (own.QueryLocalWaypoint(0xFF), own.ReportLocalWaypoint),
    (own.SetLocalWaypoint(x=5.0, y=-2.0), None),
    (own.QueryLocalWaypoint(0xFF), own.ReportLocalWaypoint, near(x=5.0, y=-2.0)),
    (own.QueryTravelSpeed(), own.ReportTravelSpeed, near(speed=0.0)),
    (own.SetTravelSpeed(speed=1.5), None),
    (own.QueryTravelSpeed(), own.ReportTravelSpeed, near(speed=1.5)),
    (core.QueryElementCount(), core.ReportElementCount, says(element_count=0)),
    (elements(1, 2, 3, 4), core.ConfirmElementRequest),
    (core.QueryElementCount(), core.ReportElementCount, says(element_count=4)),
    (core.QueryElementList(), core.ReportElementList),
    (core.QueryElement(2), core.ReportElement),
    (own.QueryActiveElement(), own.ReportActiveElement, says(element_uid=0)),
    (own.ExecuteList(speed=1.0, element_uid=1), None),
    (own.QueryActiveElement(), own.ReportActiveElement, says(element_uid=1)),
    (own.QueryTravelSpeed(), own.ReportTravelSpeed),
    (own.QueryLocalWaypoint(0xFF), own.ReportLocalWaypoint),
    (own.QueryLocalPose(ALL), own.ReportLocalPose),
    (own.QueryVelocityState(ALL), own.ReportVelocityState),
    (core.Standby(), None),
    (deleted(0xFFFF), core.ConfirmElementRequest),
    (core.QueryElementCount(), core.ReportElementCount, says(element_count=0)),
    (core.ReleaseControl(), core.RejectControl),
]
TASKS = (DISCOVERY, EVENTS, ACCESS, MANAGEMENT, SENSORS, WAYPOINTS)


@pytest.fixture
def unit():
    line = [sys.executable, "-m", "robot.main", "--jaus-port", PORT]
    robot = subprocess.Popen(line, stderr=subprocess.PIPE, text=True)
    try:
        for told in robot.stderr:
            if "runs as" in told:
                break
        made = Unit(int(PORT))
        yield made
        made.sock.close()
    finally:
        robot.kill()
        robot.communicate()


def test_a_judge_has_every_answer(unit):
    assert sum(len(task_group) for task_group in TASKS) == 80
    wrong, event = [], 0
    for task in TASKS:
        for message, expected, *checks in task:
            if (
                isinstance(message, core.UpdateEvent | core.CancelEvent)
                and message.event_id != NONE
            ):
                message.event_id = event
            unit.send(message.encode())
            if expected is None:
                continue
            for packet in unit.answers(SECONDS):
                if int.from_bytes(packet.payload[:2], "little") == expected.CODE:
                    report = expected.decode(packet.payload)
                    event = getattr(report, "event_id", event)
                    wrong += [(message, report) for check in checks if not check(report)]
                    break
            else:
                wrong.append((message, None))
    assert not wrong, "\n".join(str(failure) for failure in wrong)

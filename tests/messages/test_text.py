"""Messages for people."""

import pytest

from jausml.live.messages import text


@pytest.mark.parametrize(
    ("payload", "shown"),
    [
        ("0220", []),
        ("02400100000000", ["ReportStatusRec", "  Status: 1 (READY)", "  Reserved: 0"]),
        (
            "1140 03 67f1de5b 3264",
            [
                "TimeRec",
                "  TimeStamp: Milliseconds 359, Seconds 60, Minutes 30, Hour 15, Day 11",
                "  DateStamp: Day 18, Month 1, Year 50",
            ],
        ),
        (
            "0444 0100 ffffff7f",
            ["ReportVelocityStateRec", "  Velocity_X: -0.00500008 meter per second"],
        ),
        ("f021 00 0240", ["QueryEventsVar: 0", "  MessageIDRec", "    MessageCode: 16386"]),
        (
            "f141 0102 02000000 0220",
            [
                "EventRec",
                "  EventID: 1",
                "  SequenceNumber: 2",
                "  ReportMessage: JAUS MESSAGE",
                "    QueryStatus 0x2002 (urn:jaus:jss:core:Management/1.0)",
            ],
        ),
        (
            "f141 0102 02000000 ffff",
            [
                "EventRec",
                "  EventID: 1",
                "  SequenceNumber: 2",
                "  ReportMessage: 2 bytes of JAUS MESSAGE ffff",
                "    message: no message has the code 0xFFFF",
            ],
        ),
        (
            "0246 01 02 ffffffff",
            ["JointPositionList[1]", "  [0]", "    JointPosition: 10.0000000000 meter"],
        ),
        (
            "004b 02 1127 02 610a",
            [
                "ReportIdentificationRec",
                "  QueryType: 2 (Subsystem Identification)",
                "  Type: 10001 (VEHICLE)",
                '  Identification: "a\\n"',
            ],
        ),
    ],
)
def test_fields_have_units_and_names(catalogue, payload, shown):
    service = "ManipulatorJointPositionSensor/1.0"
    decoded = catalogue.decode(bytes.fromhex(payload), service)
    assert list(text.lines(decoded)) == shown

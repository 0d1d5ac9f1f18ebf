"""Requests: what comes back for a command, and why nothing does."""

import asyncio
from pathlib import Path
from queue import SimpleQueue

import pytest
from ports import free_port

import jausml

pytestmark = pytest.mark.ports

VEHICLE, OPERATOR = "100.1.1", "200.1.1"
MODEL = Path(__file__).with_name("drop.ros2jaus")


@pytest.fixture
def port():
    return free_port()


@pytest.fixture
def vehicle(port):
    """Drops one weight at a time, and has a gate that jams when it is told to close."""
    gate = {"Position": "open", "Speed": 1.0}

    def drop(command):
        if command.fields["Count"] == 1:
            return "ConfirmDrop", {"Left": 3}
        return "RejectDrop", {"Reason": "jammed"}

    def move(command):
        if command.fields["Position"] != "closed":
            gate.update(command.fields)

    provides = ["Drop", "GlobalWaypointListDriver"]
    with jausml.Component(VEHICLE, provides=provides, port=port, models=MODEL) as made:
        made.answer("Gate", lambda: gate)
        made.obey("SetGate", move)
        made.obey("DropWeight", drop)
        made.shaken = SimpleQueue()
        made.obey("Shake", lambda command: made.shaken.put(command.fields["Count"]))
        yield made


@pytest.fixture
def operator(port, vehicle):
    assert vehicle.address == VEHICLE
    with jausml.Component(OPERATOR, port=port, models=MODEL, timeout=10) as made:
        yield made


def test_a_command_is_confirmed(operator):
    with operator.control(VEHICLE):
        answer = operator.request(VEHICLE, "DropWeight", {"Count": 1})
    assert answer == jausml.Received("ConfirmDrop", {"Left": 3}, VEHICLE)


def test_a_command_is_rejected_with_the_name_of_the_reason(operator):
    with (
        operator.control(VEHICLE),
        pytest.raises(jausml.Refused, match=r"rejects DropWeight: RejectDrop Reason=1 \(jammed\)"),
    ):
        operator.request(VEHICLE, "DropWeight", {"Count": 2})


def test_what_is_set_is_reported_by_names(operator):
    with operator.control(VEHICLE):
        answer = operator.request(VEHICLE, "SetGate", {"Position": "moving", "Speed": 2.5})
    assert answer.name == "ReportGate"
    assert answer.fields["Position"] == "moving"
    assert answer.fields["Position"] == 2
    assert answer.fields["Speed"] == pytest.approx(2.5, abs=1e-4)


def test_what_is_not_set_is_told(operator):
    with (
        operator.control(VEHICLE),
        pytest.raises(jausml.Refused, match=r"reports Position=0 \(open\) after SetGate$"),
    ):
        operator.request(VEHICLE, "SetGate", {"Position": "closed", "Speed": 1}, timeout=0.3)


def test_a_query_is_a_request(operator):
    assert operator.request(VEHICLE, "QueryGate").fields["Position"] == "open"
    assert operator.request(VEHICLE, "Gate").name == "ReportGate"


def test_a_list_is_given_with_messages_in_its_elements(operator):
    element = {
        "ElementUID": 1,
        "PreviousUID": 0,
        "NextUID": 0,
        "ElementData": {
            "message": {
                "message": "SetGlobalWaypoint",
                "fields": {"Latitude": 46.5, "Longitude": 8.25},
            }
        },
    }
    with operator.control(VEHICLE):
        answer = operator.request(VEHICLE, "SetElement", {"ElementList": [element]})
        assert answer.name == "ConfirmElementRequest"
        found = operator.query(VEHICLE, "Element", {"ElementUID": 1})["ElementData"]
        waypoint = found["message"]["fields"]
        assert found["format"] == "JAUS MESSAGE"
        assert waypoint["Latitude"] == pytest.approx(46.5)
        assert set(waypoint) == {"Latitude", "Longitude"}
        with pytest.raises(jausml.Refused, match=r"ResponseCode=5 \(Element ID not found\)"):
            operator.request(VEHICLE, "DeleteElement", {"DeleteElementList": [{"ElementUID": 7}]})
        # What came back is what may be sent.
        again = {**element, "ElementData": found, "ElementUID": 2, "PreviousUID": 1}
        operator.request(VEHICLE, "SetElement", {"ElementList": [again]})
        order = operator.query(VEHICLE, "ElementList")["ElementList"]
    assert [list_element["ElementUID"] for list_element in order] == [1, 2]


def test_a_command_that_nothing_answers_is_followed_by_the_state(operator, vehicle):
    with operator.control(VEHICLE):
        answer = operator.request(VEHICLE, "Shake", {"Count": 1})
        assert (answer.name, answer.fields["Status"]) == ("ReportStatus", "READY")
        assert vehicle.shaken.get(timeout=30) == 1


@pytest.mark.parametrize("send", ["command", "request"])
def test_without_control_nothing_is_commanded(operator, port, send):
    with pytest.raises(jausml.Refused, match="DropWeight from its controller alone, and we do"):
        getattr(operator, send)(VEHICLE, "DropWeight", {"Count": 1})
    with (
        jausml.Component("201.1.1", port=port) as other,
        other.control(VEHICLE, authority=200),
        pytest.raises(jausml.Refused, match=r"201\.1\.1 controls it with authority 200"),
    ):
        getattr(operator, send)(VEHICLE, "DropWeight", {"Count": 1})


@pytest.mark.parametrize("send", ["command", "request", "emergency", "clear", "status"])
@pytest.mark.usefixtures("vehicle")
def test_who_is_not_there_is_told(port, send):
    with jausml.Component(OPERATOR, port=port, models=MODEL, timeout=0.3) as operator:
        arguments = ("DropWeight", {"Count": 1}) if send in ("command", "request") else ()
        with pytest.raises(jausml.NoAnswer, match=r"100\.1\.9 .*check the id"):
            getattr(operator, send)("100.1.9", *arguments)


def test_a_command_in_standby_says_why_it_has_no_effect(operator):
    with operator.control(VEHICLE):
        assert operator.request(VEHICLE, "Standby").fields["Status"] == "STANDBY"
        for name, fields in (
            ("DropWeight", {"Count": 1}),
            ("SetGate", {"Position": 2, "Speed": 3}),
        ):
            with pytest.raises(jausml.Refused, match="it is in STANDBY, and obeys in READY"):
                operator.request(VEHICLE, name, fields, timeout=0.3)
        assert operator.request(VEHICLE, "Resume").fields["Status"] == "READY"
        assert operator.request(VEHICLE, "DropWeight", {"Count": 1}).name == "ConfirmDrop"


def test_an_emergency_of_another_is_called_one(operator, port):
    with jausml.Component("201.1.1", port=port, timeout=0.5) as other, operator.control(VEHICLE):
        assert operator.status(VEHICLE) == jausml.ComponentStatus("READY", OPERATOR, 127)
        assert other.emergency(VEHICLE).state == "EMERGENCY"
        with pytest.raises(jausml.Refused, match="EMERGENCY"):
            operator.request(VEHICLE, "DropWeight", {"Count": 1}, timeout=0.5)
        with pytest.raises(jausml.Refused, match=r"in EMERGENCY$"):
            operator.command(VEHICLE, "DropWeight", {"Count": 1})
        with (
            jausml.Component("202.1.1", port=port, timeout=0.5) as third,
            pytest.raises(jausml.Refused, match="stays in EMERGENCY after ClearEmergency"),
        ):
            third.clear(VEHICLE)
        assert other.clear(VEHICLE).state == "STANDBY"


@pytest.mark.usefixtures("vehicle")
def test_asyncio(port):
    async def drop():
        async with (
            jausml.AsyncComponent(OPERATOR, port=port, models=MODEL) as operator,
            operator.control(VEHICLE),
        ):
            answer = await operator.request(VEHICLE, "DropWeight", {"Count": 1}, timeout=10)
            status = await operator.status(VEHICLE)
            stopped = await operator.emergency(VEHICLE)
            await operator.clear(VEHICLE)
            return answer.name, status.state, stopped.state

    assert asyncio.run(drop()) == ("ConfirmDrop", "READY", "EMERGENCY")

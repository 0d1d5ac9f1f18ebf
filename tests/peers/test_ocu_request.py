"""`jausml ocu request` against a running component."""

import json

import pytest

from jausml.language.text.notation import NOTATIONS
from jausml.live.messages import load_catalogue
from jausml.live.peers.entry_messages import message_class
from jausml.runtime.services.definitions import Guard

pytestmark = pytest.mark.ports

ELEMENT = {
    "ElementUID": 1,
    "PreviousUID": 0,
    "NextUID": 0,
    "ElementData": {
        "message": {"message": "SetGlobalWaypoint", "fields": {"Latitude": 46.5, "Longitude": 8}}
    },
}


def test_a_list_is_confirmed_and_read_as_it_was_given(jausml, component):
    component()
    fields = json.dumps({"ElementList": [ELEMENT]})
    result = jausml("ocu", "request", "100.1.1", "SetElement", fields, "--format", "json")
    assert result.exit_code == 0, result.output
    assert json.loads(result.stdout)["message"] == "ConfirmElementRequest"
    asked = ("100.1.1", "QueryElement", '{"ElementUID": 1}')
    result = jausml("ocu", "query", *asked, "--format", "json")
    found = json.loads(result.stdout)["fields"]["ElementRec"]["ElementData"]
    assert found["format"] == "JAUS MESSAGE"
    assert found["message"]["message"] == "SetGlobalWaypoint"
    result = jausml("ocu", "query", *asked)
    assert "ElementData.SetGlobalWaypoint.Latitude=46.4999999" in result.stdout
    # What was printed is taken.
    again = json.dumps({"ElementList": [{**ELEMENT, "ElementUID": 2, "ElementData": found}]})
    result = jausml("ocu", "request", "100.1.1", "SetElement", again)
    assert result.exit_code == 1, result.output
    assert "rejects SetElement: RejectElementRequest" in result.stderr
    assert "(Invalid previous element)" in result.stderr


def test_what_was_set_is_asked_for_by_its_type(jausml, component, catalogue):
    target = component(services=("mobility:VelocityStateDriver",))
    query, report, command = (
        message_class(catalogue.message(f"{prefix}VelocityCommand"))
        for prefix in ("Query", "Report", "Set")
    )
    set_by_type = {}

    def take(message, _sender):
        fields = message.fields["VelocityCommandRec"]
        set_by_type[int(fields["CommandType"])] = fields

    def tell(message, _sender):
        kind = message.fields["QueryVelocityCommandRec"]["CommandType"]
        fields = set_by_type.get(int(kind))
        return fields and report(report.ENTRY.completed(fields))

    target.handle(command, take, when=Guard.READY)
    target.provide(query, report, tell)
    fields = ("CommandType=Set maximum allowed values", "Velocity_X=1.5 m/s")
    result = jausml("ocu", "request", "100.1.1", "SetVelocityCommand", *fields)
    assert result.exit_code == 0, result.output
    assert "ReportVelocityCommand  CommandType=1 (Set maximum allowed values)" in result.stdout
    assert "Velocity_X=1.5" in result.stdout


MOTORS = """\
import `jaus.core-1.1`
service Motors {
    urn: "urn:jaus:jss:example:Motors"
    inherits: Management
    inputs: new message_def SetMotors {
        code: 0xD102  isCommand: true  record Body { fixed_field On { type: uint8 } }
    }
    inputs: new message_def QueryMotors { code: 0xD103 }
    outputs: new message_def ReportMotors {
        code: 0xD104  record Body { fixed_field On { type: uint8 } }
    }
    outputs: new message_def RejectMotors {
        code: 0xD105  record Body { variable_length_string Reason }
    }
}
"""


def test_a_rejection_is_told_though_there_is_no_report(jausml, component, tmp_path):
    model = tmp_path / "motors.ros2jaus"
    model.write_text(MOTORS, "utf-8")
    catalogue = load_catalogue([model], notations=NOTATIONS)
    target = component(services=("example:Motors",))
    command, rejection = (
        message_class(catalogue.message(f"{prefix}Motors")) for prefix in ("Set", "Reject")
    )
    refused = rejection({"Body": {"Reason": "the e-stop is pressed"}})
    target.handle(command, lambda _, sender: target.send(refused, sender), when=Guard.READY)
    request = ("ocu", "request", "100.1.1", "SetMotors", "On=1", "--timeout", "1")
    result = jausml(*request, "--model", model)
    assert result.exit_code == 1, result.output
    assert "100.1.1 rejects SetMotors: RejectMotors" in result.stderr
    assert "the e-stop is pressed" in result.stderr


def test_what_needs_no_control_takes_none(jausml, vehicle):
    target = vehicle()
    result = jausml("ocu", "request", "100.1.1", "VelocityState")
    assert result.exit_code == 0, result.output
    assert "ReportVelocityState  Velocity_X=1.2500000 m/s" in result.stdout
    assert "READY" not in result.output
    assert target.status.name == "STANDBY"


def test_a_message_may_be_one_object_as_in_encode(jausml, vehicle):
    vehicle()
    query = '{"message": "QueryVelocityState", "fields": {"PresenceVector": 1}}'
    result = jausml("ocu", "query", "100.1.1", query)
    assert result.exit_code == 0, result.output
    assert "ReportVelocityState  Velocity_X=1.2500000 m/s" in result.stdout
    for wrong, told in (('{"message": 3}', "has a name as"), ('{"a"', "is no JSON")):
        result = jausml("ocu", "query", "100.1.1", wrong)
        assert (result.exit_code, told in result.output) == (2, True), result.output
    result = jausml("ocu", "query", "100.1.1", query, "PresenceVector=1")
    assert "stand in the object of the message already" in result.output


def test_a_command_of_management_ends_in_its_state(jausml, vehicle):
    vehicle()
    result = jausml("ocu", "request", "100.1.1", "Standby")
    assert result.exit_code == 0, result.output
    assert "ReportStatus  Status=2 (STANDBY)" in result.stdout


def test_nobody_there(refused, component):
    component()
    refused("check the id", "ocu", "request", "100.1.9", "SetElement", "{}", "--timeout", "0.3")


def test_a_session_requests(jausml, vehicle):
    vehicle()
    lines = "request 100.1.1 Standby\ncontrol\nrequest Resume\nrequest SetWrenchEffort {}\n"
    result = jausml("ocu", input=lines)
    assert "error: 100.1.1 takes Standby from its controller alone" in result.stdout
    assert "ReportStatus  Status=1 (READY)" in result.stdout
    assert "but not QueryWrenchEffort: it provides PrimitiveDriver" in result.stdout

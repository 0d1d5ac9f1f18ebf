"""`jausml ocu` against a running component."""

import json
import signal
import socket
import subprocess
from threading import Thread

import pytest
import warm
from click.testing import CliRunner

from jausml.cli import main
from jausml.live.peers.entry_messages import message_class
from jausml.live.peers.heard import Heard
from jausml.runtime import Scope
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.counters import Counters
from jausml.runtime.messages import QueryIdentification, ReportControl, RequestControl
from jausml.runtime.services.definitions import Status

pytestmark = pytest.mark.ports

OPERATOR = JausAddress(65000, 1, 1)
TARGET = JausAddress(100, 1, 1)
PEER = "100.1.1=127.0.0.1:%s"


def test_discover_shows_subsystem_component_and_services(jausml, vehicle):
    vehicle()
    result = jausml("ocu", "discover", "--duration", "0.4")
    assert result.exit_code == 0, result.stderr
    assert "subsystem 100 'target' (vehicle)\n  node 1\n    100.1.1 'target'" in result.stdout
    assert "urn:jaus:jss:mobility:VelocityStateSensor 1.0" in result.stdout
    assert "65000" not in result.stdout


def test_discover_in_json(jausml, vehicle):
    vehicle()
    result = jausml("ocu", "discover", "--duration", "0.4", "--format", "json")
    (subsystem,) = json.loads(result.stdout)["subsystems"]
    assert (subsystem["subsystem"], subsystem["type"]) == (100, 10001)
    (component,) = subsystem["components"]
    assert component["id"] == "100.1.1"
    assert {"urn": "urn:jaus:jss:core:Management", "version": "1.1"} in component["services"]


def test_services_of_one_component(jausml, vehicle):
    vehicle()
    result = jausml("ocu", "services", "100.1.1")
    assert result.exit_code == 0, result.stderr
    assert "urn:jaus:jss:mobility:PrimitiveDriver 1.0" in result.stdout.splitlines()


def test_a_known_peer_is_reached_without_multicast(jausml, vehicle, free_port):
    vehicle()
    group = ("--multicast-group", "239.255.77.77")
    peer = ("--peer", f"100.1.1=127.0.0.1:{free_port}")
    result = jausml("ocu", "discover", "--duration", "0.4", *group, *peer)
    assert "100.1.1 'target'" in result.stdout


def test_status_names_state_and_controller(jausml, component):
    target = component(control_timeout=0)
    result = jausml("ocu", "status", "100.1.1")
    assert result.stdout == "100.1.1 STANDBY; not controlled, default authority 0\n"
    target._jaus_access._request(RequestControl(authority_code=7), JausAddress(9, 1, 1))
    result = jausml("ocu", "status", "100.1.1", "--format", "json")
    assert json.loads(result.stdout) == {
        "component": "100.1.1",
        "status": "STANDBY",
        "controller": "9.1.1",
        "authority": 7,
        "control_timeout": 0,
    }


@pytest.mark.parametrize("name", ["QueryVelocityState", "ReportVelocityState", "VelocityState"])
def test_query_by_the_name_of_query_or_report(name, jausml, vehicle):
    vehicle()
    result = jausml("ocu", "query", "100.1.1", name)
    assert result.exit_code == 0, result.stderr
    assert result.stdout.endswith("100.1.1 ReportVelocityState  Velocity_X=1.2500000 m/s\n")


def test_query_with_fields_in_json(jausml, vehicle):
    vehicle()
    fields = '{"PresenceVector": 2}'
    result = jausml("ocu", "query", "100.1.1", "QueryTime", fields, "--format", "json")
    report = json.loads(result.stdout)
    assert (report["message"], report["source"]) == ("ReportTime", "100.1.1")
    assert report["fields"]["TimeRec"]["_pv"] == 2


def test_watch_shows_values_until_enough_have_come(jausml, vehicle, wait_until):
    target = vehicle()
    result = jausml("ocu", "watch", "100.1.1", "VelocityState", "--rate", "50", "--count", "3")
    assert result.exit_code == 0, result.stderr
    assert result.stdout.count("Velocity_X=1.2500000 m/s") == 3
    wait_until(lambda: not target._jaus_events._events)


def test_watch_every_change_in_json(jausml, vehicle, wait_until):
    target = vehicle()
    result = jausml("ocu", "watch", "100.1.1", "Control", "--duration", "0.3", "--format", "json")
    (line,) = result.stdout.splitlines()
    assert json.loads(line)["fields"]["ReportControlRec"]["ComponentID"] == 0
    wait_until(lambda: not target._jaus_events._events)


def test_reports_that_stay_away_are_told(jausml, vehicle, wait_until):
    target = vehicle()

    def stop():
        wait_until(lambda: target._jaus_events._events)
        target.stop()

    stopping = Thread(target=stop)
    stopping.start()
    result = jausml(
        *("ocu", "watch", "100.1.1", "VelocityState", "--rate", "50"),
        *("--duration", "3", "--timeout", "0.5"),
    )
    stopping.join()
    assert result.exit_code == 0, result.stderr
    assert "warning: no report of 100.1.1 for 0.5 s" in result.stderr


def test_an_event_that_is_refused_says_why(jausml, vehicle):
    vehicle()
    result = jausml("ocu", "watch", "100.1.1", "GlobalPose")
    assert result.exit_code == 1
    assert "100.1.1 refuses events of ReportGlobalPose: no report for 2402" in result.stderr


def test_a_command_that_no_service_of_the_component_takes_is_told(jausml, vehicle):
    vehicle()
    result = jausml("ocu", "command", "100.1.1", "SetTravelSpeed", '{"Speed": 1}')
    assert result.exit_code == 0, result.stderr
    released, why = "100.1.1 is released", "warning: 100.1.1 may ignore SetTravelSpeed: it provides"
    # Nothing is controlled while it is looked up.
    assert 0 < result.stderr.index(released) < result.stderr.index(why)
    assert "and not GlobalWaypointDriver" in result.stderr
    known = jausml("ocu", "command", "100.1.1", "SetWrenchEffort", "{}")
    assert "warning" not in known.stderr


def test_command_controls_resumes_sends_and_releases(jausml, vehicle):
    target = vehicle()
    result = jausml(
        *("ocu", "command", "100.1.1", "SetWrenchEffort", '{"PropulsiveLinearEffortX": 50}'),
        *("--rate", "50", "--duration", "0.1"),
    )
    assert result.exit_code == 0, result.stderr
    assert len(target.wrenches) > 1
    assert target.wrenches[0]["PropulsiveLinearEffortX"] == pytest.approx(50, abs=0.01)
    assert (target.status, target.controller) == (Status.STANDBY, None)
    assert "100.1.1 is in READY" in result.stderr
    assert "100.1.1 is released" in result.stderr


def test_a_refusal_says_who_has_control(jausml, vehicle):
    target = vehicle(control_timeout=0)
    target._jaus_access._request(RequestControl(authority_code=255), JausAddress(9, 1, 1))
    result = jausml("ocu", "command", "100.1.1", "SetWrenchEffort", "{}")
    assert result.exit_code == 1
    assert "9.1.1 controls it with authority 255" in result.stderr
    assert target.controller == JausAddress(9, 1, 1)


def test_a_session_on_a_pipe(jausml, vehicle):
    target = vehicle()
    commands = """
        # who is there
        discover 0.4
        services
        control 100.1.1
        resume
        status
        send SetWrenchEffort {"PropulsiveLinearEffortX": 50}
        query VelocityState
        watch VelocityState 20
        wait 0.3
        unwatch
        standby
        release
        quit
        discover
    """
    result = jausml("ocu", input=commands)
    assert result.exit_code == 1, result.output
    errors = [line for line in result.stdout.splitlines() if line.startswith("error")]
    assert errors == ["error: which component? name its id, e.g. 100.1.1; usage: services [ID]"]
    for text in (
        "100.1.1 is controlled",
        "100.1.1 is in READY",
        "100.1.1 READY; controlled by 65000.1.1 with authority 205",
        "SetWrenchEffort sent to 100.1.1",
        "Velocity_X=1.2500000 m/s",
        "100.1.1 is in STANDBY",
        "100.1.1 is released",
    ):
        assert text in result.stdout
    assert len(target.wrenches) == 1
    assert target.controller is None


def test_status_says_when_control_lapses(jausml, component):
    target = component(control_timeout=5)
    target._jaus_access._request(RequestControl(authority_code=7), JausAddress(9, 1, 1))
    result = jausml("ocu", "status", "100.1.1")
    words = "controlled by 9.1.1 with authority 7; control lapses 5 s after the last request"
    assert result.stdout == f"100.1.1 STANDBY; {words}\n"


def test_a_session_that_just_ends_releases_and_cancels(jausml, vehicle, wait_until):
    target = vehicle(control_timeout=0)
    commands = "control 100.1.1\nresume\nwatch VelocityState 20\n"
    result = jausml("ocu", "session", input=commands)
    assert result.exit_code == 0, result.output
    wait_until(lambda: target.controller is None and not target._jaus_events._events)
    assert target.status is Status.STANDBY


def test_an_emergency_in_a_session(jausml, vehicle):
    target = vehicle()
    result = jausml("ocu", input="emergency 100.1.1\n")
    assert "100.1.1 EMERGENCY" in result.stdout
    assert "our emergency of 100.1.1 lasts" in result.stdout
    assert target.status is Status.EMERGENCY
    result = jausml("ocu", input="clear 100.1.1\n")
    assert result.stdout == "100.1.1 STANDBY; not controlled, default authority 0\n"


@pytest.mark.parametrize(
    ("line", "error"),
    [
        ("releas 100.1.1", "no command 'releas'; did you mean release?"),
        ("query 100.1.1", "which message?"),
        ("query 100.1.1 QueryStats", "no message 'QueryStats'"),
        ("query 100.1.1 QueryTime {", "the fields are no JSON"),
        ("query 100.1.1 QueryTime []", "the fields must be a JSON object"),
        ("watch 100.1.1 Status fast", "'fast' is no number"),
        ("resume 100.1.1", "100.1.1 is not controlled by us"),
        ("status 100.1.255", "100.1.255 does not name one component"),
        ("status 100.1.2222", "'100.1.2222' is not a JAUS address"),
    ],
)
def test_what_a_session_does_not_understand(line, error, jausml, component):
    component()
    result = jausml("ocu", input=f"{line}\n")
    assert result.exit_code == 1
    assert f"error: {error}" in result.stdout


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        (("status", "100.1.1"), "100.1.1 does not answer QueryStatus"),
        (("query", "100.1.1", "Time"), "100.1.1 does not answer QueryTime"),
        (("watch", "100.1.1", "Time"), "100.1.1 does not answer CreateEvent"),
        (("services", "100.1.1"), "100.1.1 does not answer QueryServices"),
        (("discover", "--duration", "0.1"), "nobody answers"),
        (("command", "100.1.1", "Resume"), "100.1.1 does not answer RequestControl"),
    ],
)
def test_nobody_there(arguments, error, jausml):
    result = jausml("ocu", *arguments, "--timeout", "0.15")
    assert result.exit_code == 2
    assert error in result.stderr
    causes = result.stderr.partition("nothing at all was heard")[2]
    places = [causes.find(cause) for cause in ("nothing runs", "--interface", "--peer", "firewall")]
    assert places == sorted(places)
    assert -1 not in places


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        (("query", "100.1", "Time"), "'100.1' is not a JAUS address"),
        (("query", "100.1.1", "Tim", "--timeout", "0.1"), "no message 'Tim'"),
        (("query", "100.1.1", "Time", "{"), "the fields are no JSON"),
        (("query", "100.1.1", "Time", '{"PresenceVectors": 1}'), "did you mean PresenceVector?"),
        (("command", "100.1.1", "SetWrenchEffort", '{"X": 1}'), "unknown field"),
        (("command", "100.1.1", "SetTime", '{"Day": 1, "Day": 2}'), "'Day' stands twice"),
        (("command", "100.1.1", "Resume", "--rate", "5"), "--rate needs a --duration"),
        (("watch", "100.1.1", "Time", "--rate", "1", "--every-change"), "exclude each other"),
        (("status", "100.1.1", "--id", "1.1.255"), "does not name one component"),
        (("status", "100.1.1", "--model", "absent.xmi"), "absent.xmi"),
    ],
)
def test_wrong_usage_exits_with_2_before_anything_is_sent(arguments, error, refused):
    refused(error, "ocu", *arguments)


def test_options_may_stand_before_the_command(component, free_port):
    component()
    options = ("--port", str(free_port), "--format", "json")
    result = CliRunner().invoke(main, ["ocu", *options, "status", "100.1.1"])
    assert json.loads(result.stdout)["status"] == "STANDBY", result.stderr


MUTE = ("AccessControl", "Management", "Liveness", "Transport")


def test_a_component_without_discovery_is_shown_as_one(jausml, component):
    component(names=MUTE)
    result = jausml("ocu", "discover", "--duration", "0.4")
    assert result.exit_code == 0, result.stderr
    assert "    100.1.1 answers, but offers no Discovery\n" in result.stdout
    result = jausml("ocu", "services", "100.1.1", "--timeout", "0.3")
    assert result.exit_code == 2
    assert "100.1.1 answers (ReportStatus, ReportControl), but not QueryServices" in result.stderr
    assert "firewall" not in result.stderr


def test_what_a_component_asks_while_it_starts_is_no_answer(network, catalogue):
    heard = Heard(catalogue, network, Counters())
    heard.note(QueryIdentification(query_type=Scope.SYSTEM).encode(), TARGET)
    told = heard.why(TARGET, "QueryStatus", "ReportStatus", ())
    assert told.startswith("100.1.1 sends QueryIdentification, but does not answer QueryStatus yet")
    control = ReportControl(subsystem_id=0, node_id=0, component_id=0, authority_code=0)
    heard.note(control.encode(), TARGET)
    told = heard.why(TARGET, "QueryStatus", "ReportStatus", ())
    assert told.startswith("100.1.1 answers (ReportControl), but not QueryStatus: it does not")


def test_a_component_without_the_service_is_told_from_a_silent_one(jausml, component):
    component(services=("mobility:PrimitiveDriver",))
    result = jausml("ocu", "query", "100.1.1", "VelocityState", "--timeout", "0.3")
    assert result.exit_code == 2
    assert "but not QueryVelocityState: it provides Transport, Events, " in result.stderr
    assert "and not VelocityStateSensor" in result.stderr


def test_what_a_peer_calls_its_services_moves_no_cursor(jausml, component):
    component(services=("mobility:\x1b[2J",))
    result = jausml("ocu", "query", "100.1.1", "VelocityState", "--timeout", "0.3")
    assert "and not VelocityStateSensor" in result.stderr
    assert "\x1b" not in result.stderr


def test_a_component_without_data_is_told_from_a_silent_one(jausml, component):
    component(services=("mobility:VelocityStateSensor",))
    result = jausml("ocu", "query", "100.1.1", "VelocityState", "--timeout", "0.3")
    assert "it provides VelocityStateSensor, so it has no data yet or refuses" in result.stderr


def test_a_report_that_cannot_be_read_is_said_to_be_that(jausml, component, catalogue):
    target = component()
    state = message_class(catalogue.message("ReportVelocityState"))
    payload = state({"ReportVelocityStateRec": {"Velocity_X": 1.0}}).encode() + b"\1"
    target.handle(
        message_class(catalogue.message("QueryVelocityState")),
        lambda _, sender: target.transport.send(TARGET, sender, payload),
    )
    result = jausml("ocu", "query", "100.1.1", "VelocityState", "--timeout", "0.3")
    assert (
        "100.1.1 answers QueryVelocityState with a ReportVelocityState that cannot be read: "
        "1 bytes follow the body of ReportVelocityState" in result.stderr
    )


def test_datagrams_of_an_older_protocol_are_told(jausml, free_port):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as old:
        old.bind(("127.0.0.1", free_port))
        thread = Thread(target=lambda: old.sendto(b"\1" + bytes(20), old.recvfrom(999)[1]))
        thread.start()
        result = jausml("ocu", "status", "100.1.1", "--timeout", "0.3", "--peer", PEER % free_port)
        thread.join()
    assert "datagrams came that cannot be used (judp.version_1 1)" in result.stderr


def test_another_component_that_was_heard_is_named(jausml, component):
    component()
    result = jausml("ocu", input="discover 0.3\nstatus 100.1.2\n")
    assert "nothing came from it, but from 100.1.1: check the id and that it runs" in result.stdout


TEXT_MODEL = """
winch {
    JAUS SetWinch ( uint16 length { units: "cm" } ) { code: 0xD111  isCommand: true }
    ROS std_msgs/UInt16
    ROS->JAUS ( data -> length )
}
"""


@pytest.mark.parametrize(
    ("arguments", "output"),
    [
        (("ocu", "command", "100.1.1", "SetWinch", '{"length": 7}'), "SetWinch sent to 100.1.1"),
        (("conformance", "100.1.1", "--only", "liveness"), "0 failed"),
    ],
)
def test_a_model_in_text_is_taken(arguments, output, jausml, component, tmp_path):
    component()
    (tmp_path / "acme.ros2jaus").write_text(TEXT_MODEL)
    result = jausml(*arguments, "--model", tmp_path / "acme.ros2jaus")
    assert result.exit_code == 0, result.output
    assert output in result.output


def test_ctrl_c_releases_control(vehicle, free_port, wait_until):
    target = vehicle(control_timeout=0)
    line = [*warm.command(), "ocu", "command", "100.1.1", "SetWrenchEffort", "{}"]
    line += ["--rate", "20", "--duration", "60", "--port", str(free_port)]
    process = subprocess.Popen(line, stderr=subprocess.PIPE)
    try:
        wait_until(lambda: len(target.wrenches) > 3, 30)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=30)
    finally:
        process.kill()
        process.wait()
    assert process.returncode == 0, err
    assert (target.status, target.controller) == (Status.STANDBY, None)

"""`jausml conformance` from the command line: formats, choices, exit status."""

import json
import os
import pty
import subprocess
from xml.etree import ElementTree

import pytest
import warm

from jausml.runtime.services.definitions import Status

pytestmark = pytest.mark.ports

QUICK = ("--timeout", "0.4", "--quiet-time", "0.06")


def test_text_shows_groups_checks_and_a_summary(jausml, component):
    component()
    result = jausml("conformance", "100.1.1", "--only", "liveness", "--only", "time", *QUICK)
    assert result.exit_code == 0, result.stderr
    lines = result.stdout.splitlines()
    assert lines[0].startswith("JAUS conformance of 100.1.1 at 127.0.0.1:")
    assert "  urn:jaus:jss:core:Liveness 1.1" in lines
    assert "liveness" in lines
    assert any(line.startswith("  pass  liveness.pulse ") for line in lines)
    assert lines[-1] == "4 checks: 4 passed, 0 failed"


def test_a_failure_shows_its_evidence_and_exits_with_1(jausml, peer):
    peer("has no pulse")
    result = jausml("conformance", "100.1.1", "--only", "liveness", *QUICK)
    assert result.exit_code == 1
    assert "  FAIL  liveness.pulse" in result.stdout
    assert "QueryHeartbeatPulse is not answered with ReportHeartbeatPulse" in result.stdout
    assert ">> 65000.1.1 > 100.1.1" in result.stdout
    assert "0222" in result.stdout  # the bytes of the query


def test_a_choice_without_any_check_of_the_target_exits_with_1(jausml, component):
    component()
    result = jausml("conformance", "100.1.1", "--only", "codecs.Livenes", *QUICK)
    assert (result.exit_code, result.stdout.splitlines()[-1]) == (1, "0 checks: 0 failed")


@pytest.mark.needs("setsid")
def test_an_emergency_ends_when_the_terminal_goes(component, free_port, wait_until):
    target = component()
    ours, theirs = pty.openpty()
    line = ["conformance", "100.1.1", "--only", "management.clear-by-other", "--quiet-time", "60"]
    process = subprocess.Popen(
        ["setsid", "--ctty", *warm.command(), *line, "--port", str(free_port)],
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
    )
    os.close(theirs)
    wait_until(lambda: target.status is Status.EMERGENCY)
    os.close(ours)
    wait_until(lambda: target.status is Status.STANDBY)
    process.wait(timeout=20)


def test_json_has_all_that_a_program_needs(jausml, peer, tmp_path):
    peer("has no pulse")
    file = tmp_path / "report.json"
    options = ("--only", "liveness", "--format", "json", "--output", file, *QUICK)
    result = jausml("conformance", "100.1.1", *options)
    assert (result.exit_code, result.stdout) == (1, "")
    report = json.loads(file.read_text())
    assert (report["schema"], report["target"], report["passed"]) == (1, "100.1.1", False)
    assert report["summary"]["fail"] == 2
    pulse = report["checks"][0]
    assert (pulse["id"], pulse["verdict"]) == ("liveness.pulse", "fail")
    assert pulse["evidence"][0]["direction"] == "sent"
    assert bytes.fromhex(pulse["evidence"][0]["hex"])[:1] == b"\x02"


def test_junit_is_read_by_build_servers(jausml, peer):
    peer("has no pulse")
    options = ("--only", "liveness", "--only", "time", "--format", "junit", *QUICK)
    result = jausml("conformance", "100.1.1", *options)
    root = ElementTree.fromstring(result.stdout)  # noqa: S314 - our own
    assert root.tag == "testsuites"
    suites = {suite.get("name"): suite for suite in root}
    assert (suites["liveness"].get("tests"), suites["liveness"].get("failures")) == ("2", "2")
    assert suites["time"].get("skipped") == "2"
    case = suites["liveness"].find("testcase")
    assert case.get("name").startswith("liveness.pulse: ")
    assert "not answered" in case.find("failure").get("message")
    assert suites["time"].find("testcase/skipped").get("message").startswith("the target announces")


def test_list_names_every_check(jausml):
    result = jausml("conformance", "--list")
    assert result.exit_code == 0
    assert "access.equal-authority " in result.stdout
    assert "management.shutdown " in result.stdout
    assert "codecs.SERVICE.QUERY" in result.stdout


def test_list_of_one_group(jausml):
    result = jausml("conformance", "--list", "--only", "liveness")
    words = [line.split()[0] for line in result.stdout.splitlines()]
    assert words == ["liveness.pulse", "liveness.event"]


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        ((), "Missing argument 'TARGET_ID'"),
        (("100.1",), "not a JAUS address"),
        (("100.1.255",), "does not name one component"),
        (("65000.1.7",), "choose another --id"),
        (("100.1.1", "--peer", "100.1.1"), "is not ID=HOST:PORT"),
        (("100.1.1", "--interface", "224.0.0.1"), "must be the IPv4 address"),
        (("100.1.1", "--only", "nothing"), "no check 'nothing'"),
        (("100.1.1", "--skip", "access.reqest"), "did you mean access.request"),
        (("100.1.1", *QUICK), "100.1.1 does not answer"),
        (("100.1.1", "--interface", "192.0.2.1", *QUICK), "the network cannot be used"),
    ],
)
def test_usage_and_environment_exit_with_2(arguments, error, refused):
    refused(error, "conformance", *arguments)


def test_a_run_that_is_ended_from_outside_clears_its_emergency(component, free_port, wait_until):
    target = component(control_timeout=0)
    line = [*warm.command(), "conformance", "100.1.1", "--only", "management"]
    line += ["--port", str(free_port), "--quiet-time", "0.2"]
    process = subprocess.Popen(line, stdout=subprocess.PIPE, text=True)
    try:
        wait_until(lambda: target.status is Status.EMERGENCY, 60)
        process.terminate()
        out, _ = process.communicate(timeout=30)
    finally:
        process.kill()
        process.wait()
    assert process.returncode == 1
    assert "(interrupted)" in out
    wait_until(lambda: (target.status, target.controller) == (Status.STANDBY, None))

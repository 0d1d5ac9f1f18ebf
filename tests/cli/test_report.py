"""`jausml report`: what it prints, and what it refuses."""

import json
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CAR = ROOT / "models" / "catvehicle" / "catvehicle.xmi"


def test_text_by_default(jausml):
    result = jausml("report", CAR)
    assert result.exit_code == 0, result.output
    assert result.stdout.startswith("system catvehicle\n")
    assert "steering_command" in result.stdout


def test_json_into_a_file(jausml, tmp_path):
    output = tmp_path / "report.json"
    result = jausml("report", CAR, "--format", "json", "-o", output, "--assume-rate", "pose=3")
    assert result.exit_code == 0, result.output
    found = json.loads(output.read_text(encoding="utf-8"))
    assert found["system"] == "catvehicle"
    assert found["assumptions"]["rates_hz"] == {"pose": 3}


def test_one_bridge_alone(jausml):
    result = jausml("report", CAR, "--format", "json", "--bridge", "bridge")
    assert [component["name"] for component in json.loads(result.stdout)["components"]] == [
        "bridge"
    ]


def test_assumptions_change_what_is_assumed_alone(jausml):
    def loads(*options):
        found = json.loads(jausml("report", CAR, "--format", "json", *options).stdout)
        (bridge,) = (component for component in found["components"] if component["is_bridge"])
        return {connection["name"]: connection["load"] for connection in bridge["connections"]}

    usual, quick = loads(), loads("--assume-rate", "50", "--assume-rate", "bridge.cruise_speed=1")
    assert usual["odometry"] == quick["odometry"]
    assert quick["speed_command"]["messages_sent_per_s"] == 50
    assert quick["cruise_speed"]["messages_received_per_s"] == 1


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (["--bridge", "none"], "no bridge 'none'; there are: bridge"),
        (["--assume-rate", "fast"], "'fast' is no rate above 0 in hertz"),
        (["--assume-rate", "0"], "'0' is no rate above 0 in hertz"),
        (["--assume-rate", "nan"], "'nan' is no rate above 0 in hertz"),
        (["--assume-rate", "1e-320"], "'1e-320' is no rate above 0 in hertz"),
        (["--assume-length", "-1"], "'-1' is no number of elements"),
        (["--assume-length", "9" * 5000], "is no number of elements"),
        (["--assume-length", "nobody=5"], "no connection 'nobody' of which to assume something"),
    ],
)
def test_wrong_options(refused, options, complaint):
    refused(complaint, "report", CAR, *options)


@pytest.mark.usefixtures("folder")
def test_a_model_with_errors_is_shown(jausml):
    result = jausml("report", "bad.xmi")
    assert result.exit_code == 1
    assert result.stdout == ""
    assert "bad.xmi:" in result.stderr


def test_no_system(refused):
    told = "no system, where one is needed"
    refused(told, "report", ROOT / "models" / "library" / "ros" / "std_msgs.xmi")

"""The verbs that take models take ros2jaus text."""

import json
from pathlib import Path

import pytest

SYSTEM = """\
component sensor { address: 10.1.1  type: vehicle  provides: VelocityStateSensor }
bridge sensor_bridge {
  address: 10.1.2
  uses: VelocityStateSensor
  velocity {
    JAUS ReportVelocityState
    ROS geometry_msgs/TwistStamped
    JAUS->ROS (
      clock -> header.stamp
      "base_link" -> header.frame_id
      Velocity_X -> twist.linear.x { whenAbsent: dropMessage }
      YawRate -> twist.angular.z : negate { whenAbsent: dropMessage }
    )
  }
  connection velocity { map: velocity  exchange: periodicEvent  peers: sensor  topic velocity {} }
}
"""
MAPS = SYSTEM[SYSTEM.index("  velocity {") : SYSTEM.index("  connection")]

pytestmark = pytest.mark.usefixtures("folder")


@pytest.fixture
def text(folder):
    path = folder / "demo.ros2jaus"
    path.write_text(SYSTEM)
    return path


def contents(folder):
    files = (path for path in Path(folder).rglob("*") if path.is_file())
    return {str(file.relative_to(folder)): file.read_text() for file in files}


def test_validates(jausml, text):
    result = jausml("validate", text)
    assert (result.exit_code, result.stderr) == (0, "no problems in 1 file\n")


def test_finds_texts_in_folders(jausml, text):
    for file_name in ("bad.xmi", "doubtful.xmi"):
        text.with_name(file_name).unlink()
    result = jausml("validate", text.parent)
    assert result.stderr == "no problems in 2 files\n"


def test_errors_of_the_grammar_names_and_rules_in_one_run(jausml, text):
    broken = SYSTEM.replace("type: vehicle", "type = vehicle").replace("YawRate", "YawRat")
    text.write_text(broken.replace("uses: Velocity", "uses: Velocty"))
    result = jausml("validate", "demo.ros2jaus", "--format", "json")
    assert result.exit_code == 1
    rules = {diagnostic["rule"] for diagnostic in json.loads(result.stdout)["diagnostics"]}
    assert rules >= {"JML701", "JML215", "JML411"}


def test_generates_what_the_same_xmi_generates(jausml, text):
    converted = jausml("convert", text, "demo.xmi")
    assert converted.exit_code == 0, converted.stderr
    assert jausml("generate", text, "-o", "ours").exit_code == 0
    assert jausml("generate", "demo.xmi", "-o", "theirs").exit_code == 0
    ours, theirs = contents("ours"), contents("theirs")
    manifest = ".jausml/manifest.json"
    processes = [json.loads(content.pop(manifest))["models"] for content in (ours, theirs)]
    assert processes[0] == processes[1]
    assert {
        name: text.replace("demo.xmi", "demo.ros2jaus") for name, text in theirs.items()
    } == ours


def test_frequency_reaches_the_code_and_leaves_stated_rates_alone(jausml, text):
    line = ("generate", text, "-o", "out", "--target", "bridge", "--frequency", "12.5")
    result = jausml(*line)
    assert result.exit_code == 0, result.stderr
    base = Path("out/sensor_bridge/sensor_bridge/sensor_bridge_base.py")
    assert "frequency=12.5" in base.read_text()
    assert "rate=0.0" in base.read_text()  # the frequency of the bridge
    text.write_text(SYSTEM.replace("peers: sensor", "peers: sensor  rate: 40"))
    assert jausml(*line).exit_code == 0
    assert "rate=40.0" in base.read_text()


@pytest.mark.parametrize("frequency", ["0", "-1", "nan", "inf", "1092.1", "fast"])
def test_impossible_frequency_is_a_usage_error(refused, text, frequency):
    refused("--frequency", "generate", text, "-o", "out", "--frequency", frequency)
    assert not Path("out").exists()


def test_maps_alone_say_what_to_add(jausml, text):
    text.write_text(MAPS)
    assert jausml("validate", text).exit_code == 0
    result = jausml("generate", text, "-o", "out")
    assert result.exit_code == 2
    assert "connection velocity { map: velocity" in result.stderr
    assert "<subsystem>.<node>.<component>" in result.stderr
    assert not Path("out").exists()


def test_nothing_is_written_when_a_text_has_errors(jausml, text):
    text.write_text(SYSTEM.replace("Velocity_X", "Velocty_X"))
    result = jausml("generate", text, "-o", "out")
    assert result.exit_code == 1
    assert "did you mean 'Velocity_X'" in result.stderr
    assert not Path("out").exists()


def test_declared_messages_are_listed_and_encoded(jausml, text):
    text.write_text("m { JAUS WinchStatus ( uint16 length ) ROS Winch ( uint16 length ) }")
    result = jausml("list", "messages", "--model", text)
    assert "0xD000  WinchStatus" in result.stdout


@pytest.mark.parametrize("rule", ["JML215", "JML701", "JML711"])
def test_rules_are_explained(jausml, rule):
    assert rule in jausml("rules").stdout
    assert "Good:" in jausml("explain", rule).stdout.replace("\n", " ")


def test_peers_may_stand_in_the_system_of_another_file(jausml, text):
    sensor, bridge = SYSTEM.split("\n", 1)
    text.with_name("parts.ros2jaus").write_text(sensor)
    text.write_text(f'import "parts.ros2jaus"\n{bridge}')
    result = jausml("generate", "demo.ros2jaus", "-o", "out")
    assert result.exit_code == 0, result.stderr
    assert Path("out/sensor_bridge").is_dir()
    assert not Path("out/sensor").exists()
    base = Path("out/sensor_bridge/sensor_bridge/sensor_bridge_base.py").read_text()
    assert "JausAddress(10, 1, 1)" in base

"""`jausml top` with JAUS alone: there is no rclpy where these tests look."""

import json
import sys
import time

import pytest
import warm

from jausml import installing
from jausml.live.peers.operator import running_operator
from jausml.live.systems.monitoring import ROUND
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import CreateEvent, QueryControl, QueryStatus, RequestControl

MODEL = """\
import `jaus.mobility`
speed {
  JAUS ReportVelocityState
  ROS std_msgs/Float64
  JAUS->ROS ( Velocity_X -> data )
}
component rover { address: 100.1.1  provides: VelocityStateSensor }
bridge speeds {
  address: 100.1.2
  connection speed { map: speed  exchange: everyChangeEvent  peers: rover  topic speed {} }
}
"""


@pytest.fixture(autouse=True)
def _no_ros(monkeypatch):
    monkeypatch.setitem(sys.modules, "rclpy", None)


@pytest.mark.ports
def test_components_are_shown_without_ros(jausml, component, network, catalogue):
    component()
    with running_operator(network, catalogue) as operator:
        operator.control(JausAddress(100, 1, 1), 200)
        result = jausml("top", "--once", "--duration", "2.5")
    assert result.exit_code == 0, result.output
    table = result.stdout
    (line,) = [line for line in table.splitlines() if " 100.1.1 " in line]
    assert "target" in line
    assert "STANDBY" in line
    assert "65000.1.1 (authority 200, lapses after" in line
    assert "no ROS here" in table


@pytest.mark.parametrize(
    ("name", "text", "complaint"),
    [
        ("none.ros2jaus", None, "none.ros2jaus: No such file or directory"),
        ("empty.ros2jaus", "", "empty.ros2jaus:1:1: JML714 the file is empty"),
        ("empty.xmi", "", "empty.xmi:1:1: JML003 the file is empty"),
        ("bad.xmi", "<nothing/>", "bad.xmi:1:1: JML101 root element"),
        (".", None, "is a folder; name one model file"),
    ],
)
def test_a_model_that_cannot_be_read_is_told_and_is_no_state_of_a_system(
    jausml, tmp_path, name, text, complaint
):
    path = tmp_path / name
    if text is not None:
        path.write_text(text, encoding="utf-8")
    result = jausml("top", "--once", "--duration", "0.1", path)
    assert result.exit_code == 2  # 1 would say that something is in WARN
    assert complaint in result.stderr


@pytest.mark.ports
def test_in_a_project_its_system_is_expected(jausml, tmp_path, monkeypatch):
    (tmp_path / "speed.ros2jaus").write_text(MODEL, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    watch = ("top", "--once", "--duration", "0.1")
    assert "speeds" not in jausml(*watch).stdout
    (tmp_path / ".project").write_text("<projectDescription/>", encoding="utf-8")
    result = jausml(*watch)
    assert result.exit_code == 2, result.output
    assert "not asked" in result.stdout
    (tmp_path / "other.ros2jaus").write_text(MODEL, encoding="utf-8")
    result = jausml(*watch)
    assert result.exit_code == 2
    assert "several models have a system: name one (other.ros2jaus, speed.ros2jaus)" in (
        result.stderr
    )


@pytest.mark.ports
def test_observing_asks_little_and_takes_nothing(jausml, component):
    target, questions, others = component(), [], []
    for query in (QueryStatus, QueryControl):
        target.on_message(query, lambda message, _: questions.append(type(message)))
    for message in (RequestControl, CreateEvent):
        target.on_message(message, lambda message, _: others.append(message))
    begin = time.monotonic()
    result = jausml("top", "--once", "--duration", "3.5")
    rounds = (time.monotonic() - begin) / ROUND + 1
    assert result.exit_code == 0, result.output
    assert 1 <= questions.count(QueryStatus) <= rounds
    assert 1 <= questions.count(QueryControl) <= rounds
    assert others == []


@pytest.mark.ports
def test_what_a_model_declares_is_not_heard(jausml, component, tmp_path):
    model = tmp_path / "speed.ros2jaus"
    model.write_text(MODEL)
    component()
    result = jausml("top", model, "--once", "--json", "--duration", "2.5")
    assert result.exit_code == 2, result.output
    found = json.loads(result.stdout)
    levels = {entry["id"]: entry["level"] for entry in found["components"]}
    assert levels == {"100.1.1": "ok", "100.1.2": "not heard"}
    (speed,) = found["connections"]
    assert (speed["connection"], speed["level"]) == ("speed", "unknown")
    assert "no ROS here" in speed["reason"]
    assert speed["model"]["topics"] == {"/speed": "std_msgs/msg/Float64"}
    assert found["health"] == "error"


@pytest.mark.ports
def test_nothing_heard_is_exit_status_2(jausml):
    result = jausml("top", "--once", "--duration", "0.3")
    assert result.exit_code == 2
    assert "nothing is heard" in result.stdout


@pytest.mark.ports
def test_neither_ros_nor_a_network_is_an_error(refused):
    refused("the network cannot be used", "top", "--once", "--interface", "203.0.113.7")


def test_without_its_extra_it_says_so(refused, monkeypatch):
    monkeypatch.setitem(sys.modules, "textual", None)
    refused(installing.command("top"), "top")


@pytest.mark.slow
@pytest.mark.ports
@pytest.mark.skipif(sys.platform == "win32", reason="has no pseudo terminals")
@pytest.mark.parametrize("key", ["q", "\x03"], ids=["q", "Ctrl-C"])
def test_the_view_ends_and_leaves_the_terminal_as_it_was(key, free_port, tmp_path):
    from terminal import at_terminal

    line = (*warm.command(), "top", "--port", str(free_port))
    environment = {"TERM": "xterm-256color"}
    with at_terminal(*line, cwd=tmp_path, environment=environment) as terminal:
        terminal.wait_for("nothing is heard")
        terminal.type(key)
        screen = terminal.read_all()
        assert terminal.status() == 0
    assert screen.index("\x1b[?1049h") < screen.index("\x1b[?1049l")


def test_what_is_no_terminal_is_refused(refused):
    refused("this is no terminal; --once and --json do without", "top")


def test_an_id_is_not_taken_for_a_file(refused):
    refused("jausml ocu status 100.1.1", "top", "--once", "100.1.1")

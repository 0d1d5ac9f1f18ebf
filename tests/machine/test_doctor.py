"""`jausml doctor`: what a machine lacks, and how to fix it."""

import json
import os
import socket
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import needs
import pytest
from click.testing import CliRunner
from ports import free_port

from jausml import installing
from jausml.cli import main
from jausml.live.machine.programs import PROGRAMS
from jausml.live.peers.makes.rover import JausPlusPlus
from jausml.live.peers.makes.vehicle import Place, Vehicle
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.settings import TransportSettings
from jausml.views.diagrams.writers import svg

CATVEHICLE = Path(__file__).resolve().parents[2] / "models" / "catvehicle" / "catvehicle.xmi"
ROS_VARIABLES = (
    "ROS_DOMAIN_ID",
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_LOCALHOST_ONLY",
    "RMW_IMPLEMENTATION",
    "CYCLONEDDS_URI",
    "FASTDDS_DEFAULT_PROFILES_FILE",
    "FASTRTPS_DEFAULT_PROFILES_FILE",
    "ROS_DISTRO",
    "ROS_SECURITY_ENABLE",
    "ROS_SECURITY_KEYSTORE",
    "ROS_SECURITY_STRATEGY",
)


@pytest.fixture
def doctor(monkeypatch):
    """Runs the verb; returns the exit status, and the checks by topic and name."""
    for ros_variable in ROS_VARIABLES:
        monkeypatch.delenv(ros_variable, raising=False)

    def run(*arguments):
        words = ["doctor", "--format", "json", *map(str, arguments)]
        done = CliRunner().invoke(main, words)
        checks = json.loads(done.output)["checks"] if done.exit_code < 2 else []
        return done.exit_code, {(check["topic"], check["name"]): check for check in checks}

    return run


def test_a_machine_that_has_all(doctor):
    needs.ask("rclpy")
    status, checks = doctor("--port", free_port(), CATVEHICLE)
    assert status == 0
    assert checks["ros", "rclpy"]["verdict"] == "ok"
    assert checks["network", "multicast"]["verdict"] == "ok"
    assert checks["model", "nav_msgs"]["verdict"] == "ok"
    assert checks["network", "interface"]["verdict"] == "note"


def test_the_text_is_for_people():
    done = CliRunner().invoke(main, ["doctor", "--port", str(free_port())])
    assert "\nnetwork\n  note     interface: 127.0.0.1 is this host alone\n" in done.output
    assert " -> name the interface of the vehicle's network by --interface" in done.output
    assert done.output.splitlines()[-1].startswith("0 errors, ")


@pytest.mark.parametrize("words", [["doctor", "--quiet"], ["--quiet", "doctor"]])
def test_quietly_it_leaves_out_what_is_in_order(words):
    done = CliRunner().invoke(main, [*words, "--port", str(free_port())])
    assert "interface: 127.0.0.1 is this host alone" in done.output
    assert not [line for line in done.output.splitlines() if line.startswith("  ok ")]


@pytest.mark.ports
@pytest.mark.parametrize(
    ("kind", "name"), [(socket.SOCK_DGRAM, "udp port"), (socket.SOCK_STREAM, "tcp port")]
)
def test_a_port_that_is_held(doctor, kind, name):
    port = free_port()
    with socket.socket(socket.AF_INET, kind) as held:
        held.bind(("127.0.0.1", port))
        status, checks = doctor("--port", port)
    assert status == 0
    assert checks["network", f"{name} {port}"]["verdict"] == "warning"
    assert checks["network", f"{name} {port}"]["text"].startswith("held by")


@pytest.mark.needs("setpriv")
@pytest.mark.skipif(os.geteuid() != 0, reason="root alone gives a capability away")
def test_a_port_that_others_may_not_have():
    command = ("setpriv", "--bounding-set=-net_bind_service", sys.executable, "-m", "jausml")
    arguments = ("doctor", "--port", "80", "--format", "json")
    done = subprocess.run([*command, *arguments], capture_output=True, text=True)
    assert done.returncode == 1, done.stderr
    found = {check["name"]: check for check in json.loads(done.stdout)["checks"]}
    for name in ("udp port 80", "tcp port 80"):
        assert found[name]["verdict"] == "error"
        assert found[name]["text"] == "Permission denied"
        assert found[name]["cure"] == "take another port by --port"


@pytest.mark.parametrize(("missing", "verdict"), [(-1, "ok"), (0, "ok"), (1, "note")])
def test_a_receive_buffer_that_the_kernel_does_not_grant(
    doctor, monkeypatch, tmp_path, missing, verdict
):
    limit = tmp_path / "rmem_max"
    limit.write_text(f"{TransportSettings().receive_buffer - missing}\n")
    monkeypatch.setattr("jausml.live.machine.network._BUFFER_LIMIT", limit)
    status, checks = doctor("--port", free_port())
    assert status == 0
    assert checks["network", "receive buffer"]["verdict"] == verdict


def test_an_interface_of_another_host(doctor):
    status, checks = doctor("--interface", "192.0.2.1")
    assert status == 1
    assert checks["network", "interface"]["verdict"] == "error"
    assert ("network", "multicast") not in checks


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--interface", "rover"], "interface 'rover' is no IPv4 address"),
        (["--multicast-group", "10.0.0.1"], "is not an IPv4 multicast group"),
        (["nowhere.xmi"], "nowhere.xmi"),
    ],
)
def test_options_that_mean_nothing(arguments, words):
    done = CliRunner().invoke(main, ["doctor", *arguments])
    assert done.exit_code == 2
    assert words in done.output


@pytest.mark.parametrize(
    ("variable", "value", "name", "verdict"),
    [
        ("ROS_DOMAIN_ID", "7", "domain", "ok"),
        ("ROS_DOMAIN_ID", "150", "domain", "warning"),
        ("ROS_DOMAIN_ID", "233", "domain", "error"),
        ("ROS_DOMAIN_ID", "seven", "domain", "error"),
        ("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST", "discovery", "ok"),
        ("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF", "discovery", "warning"),
        ("ROS_AUTOMATIC_DISCOVERY_RANGE", "EVERYWHERE", "discovery", "error"),
        ("ROS_LOCALHOST_ONLY", "1", "discovery", "warning"),
        ("RMW_IMPLEMENTATION", "rmw_nobody_cpp", "middleware", "error"),
        ("CYCLONEDDS_URI", "file:///nowhere/dds.xml", "middleware settings", "error"),
        ("FASTDDS_DEFAULT_PROFILES_FILE", __file__, "middleware settings", "ok"),
        ("ROS_DISTRO", "jazzy", "rclpy", "ok"),
        ("ROS_DISTRO", "kilted", "rclpy", "ok"),
        ("ROS_DISTRO", "humble", "rclpy", "warning"),
        ("ROS_SECURITY_ENABLE", "true", "security", "error"),
    ],
)
def test_settings_of_ros(doctor, monkeypatch, variable, value, name, verdict):
    if name in ("middleware", "rclpy"):
        needs.ask("rclpy")
    monkeypatch.setenv(variable, value)
    status, checks = doctor("--port", free_port())
    assert checks["ros", name]["verdict"] == verdict
    assert status == (verdict == "error")


@pytest.mark.parametrize(
    ("made", "strategy", "verdict"),
    [("keys", "", "error"), ("keys/enclaves", "", "warning"), ("keys/enclaves", "Enforce", "ok")],
)
def test_keys_of_ros(doctor, monkeypatch, tmp_path, made, strategy, verdict):
    (tmp_path / made).mkdir(parents=True)
    monkeypatch.setenv("ROS_SECURITY_ENABLE", "true")
    monkeypatch.setenv("ROS_SECURITY_KEYSTORE", str(tmp_path / "keys"))
    monkeypatch.setenv("ROS_SECURITY_STRATEGY", strategy)
    _, checks = doctor("--port", free_port())
    assert checks["ros", "security"]["verdict"] == verdict


def test_shared_memory_that_is_nearly_full_is_told(doctor, monkeypatch):
    _, checks = doctor("--port", free_port())
    assert checks["ros", "shared memory"]["verdict"] == "ok"
    monkeypatch.setattr("jausml.live.machine.ros._SHARED_BY_A_NODE", 1 << 60)
    status, checks = doctor("--port", free_port())
    assert (status, checks["ros", "shared memory"]["verdict"]) == (0, "warning")
    assert "KiB left" in checks["ros", "shared memory"]["text"]


def test_extras_are_those_that_verbs_need(doctor, monkeypatch, tmp_path):
    _, checks = doctor("--port", free_port())
    assert {name for topic, name in checks if topic == "python"} == {
        *("version", "diagram", "studio", "editor", "top", "record")
    }
    assert checks["python", "diagram"]["verdict"] == "ok"
    monkeypatch.setattr(
        "jausml.live.machine.python.is_installed", lambda name: name != "graphviz-pure"
    )
    _, checks = doctor("--port", free_port())
    assert checks["python", "diagram"]["cure"] == installing.command("diagram")
    monkeypatch.setattr("jausml.live.machine.python._PAGE_OF_THE_STUDIO", tmp_path / "index.html")
    _, checks = doctor("--port", free_port())
    assert checks["python", "studio"]["verdict"] == "note"
    assert "make wheel" in checks["python", "studio"]["cure"]


@pytest.mark.parametrize("named", ["", "no-such-compiler"])
def test_without_a_compiler_there_is_a_note(doctor, monkeypatch, tmp_path, named):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("CXX", named)
    status, checks = doctor("--port", free_port())
    assert status == 0
    assert checks["programs", "compiler"]["verdict"] == "note"
    assert (named or "g++") in checks["programs", "compiler"]["text"]
    assert "CXX" in checks["programs", "compiler"]["cure"]


def test_programs_that_are_missing_are_told_with_their_packages(doctor, monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    status, checks = doctor("--port", free_port())
    told = {name: check["cure"] for (topic, name), check in checks.items() if topic == "programs"}
    assert status == 0
    assert told.keys() == {*(program.name for program in PROGRAMS), "fonts"}
    assert (told["tshark"], told["nft"]) == ("apt install tshark", "apt install nftables")
    (tmp_path / "nft").write_text("#!/bin/sh\n")
    (tmp_path / "nft").chmod(0o755)
    _, checks = doctor("--port", free_port())
    assert checks["programs", "nft"]["verdict"] == "ok"
    assert str(tmp_path / "nft") in checks["programs", "nft"]["text"]
    assert checks["programs", "git"]["verdict"] == "note"


def test_fonts_for_pictures_are_told(doctor, monkeypatch):
    svg.installed_font.cache_clear()
    monkeypatch.setattr(svg, "FONTS", ("No Such Font",))
    _, checks = doctor("--port", free_port())
    svg.installed_font.cache_clear()
    found = checks["programs", "fonts"]
    assert (found["verdict"], found["cure"]) == ("note", "apt install fonts-liberation")
    assert "No Such Font" in found["text"]


def test_the_compiler_that_is_named_is_told(doctor, monkeypatch, tmp_path):
    program = tmp_path / "own-c++"
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    monkeypatch.setenv("CXX", str(program))
    _, checks = doctor("--port", free_port())
    assert checks["programs", "compiler"]["verdict"] == "ok"
    assert str(program) in checks["programs", "compiler"]["text"]


@pytest.mark.parametrize("release", ["jazzy", "kilted"])
def test_messages_that_nobody_installed(doctor, tmp_path, monkeypatch, release):
    if find_spec("geographic_msgs"):
        pytest.skip("geographic_msgs is installed")
    monkeypatch.setenv("ROS_DISTRO", release)
    model = tmp_path / "model.ros2jaus"
    model.write_text("import ros.geographic_msgs\n\nsystem rover {\n}\n", encoding="utf-8")
    _, checks = doctor("--port", free_port(), model)
    assert checks["model", "geographic_msgs"]["verdict"] == "error"
    assert f"ros-{release}-geographic-msgs" in checks["model", "geographic_msgs"]["cure"]


@pytest.mark.slow
def test_peers_are_told_of_as_they_are(doctor):
    address, port = JausAddress(152, 1, 1), free_port()
    vehicle = Vehicle(address, lambda _code: None, lambda *_: None, dies_of_updates=True)
    peer = JausPlusPlus(vehicle, Place(port=port))
    try:
        line = ["--port", str(port), "--peer", f"{address}=127.0.0.2:{port}"]
        done = CliRunner().invoke(main, ["doctor", *line])
        status, checks = doctor(*line, "--peer", f"153.1.1=127.0.0.3:{port}")
    finally:
        peer.close()
    assert "ok       152.1.1: answers; 7 services" in done.output
    assert "note     152.1.1: acknowledges without the version of JUDP (no version)" in done.output
    assert "note     152.1.1: knows no wildcards in QueryServices" in done.output
    assert not vehicle.is_dead
    assert status == 1
    assert checks["peers", "153.1.1"]["verdict"] == "error"

"""Generated bridges as deployments change them: parameter files, command lines, launch options."""

import signal
import time
from functools import cache
from pathlib import Path

import needs
import pytest
import yaml
from generated import model_of
from ports import free_port
from sweeps import sweep

needs.ask("rclpy")

from workspaces import kept, packages_of

from jausml.generation.target import load_targets
from jausml.generation.workspace import select

from .bridge_support import Process, wait_for

pytestmark = pytest.mark.live

EXAMPLES = Path(__file__).resolve().parents[2] / "models" / "examples"
BRIDGES = {"waypoints": "waypoint_vehicle", "catvehicle": "bridge"}
# Lifting an emergency is an act, and no setting that a file could hold.
OF_ROS = ("lift_emergency", "qos_overrides.", "start_type_description_service", "use_sim_time")


@cache
def workspace(model):
    """What is generated of a model if nothing else is asked for."""
    document = EXAMPLES / model / f"{model}.ros2jaus"
    targets = select(load_targets()).targets
    return kept(model_of(document, allow_outside=True), targets)


@pytest.fixture
def bridge(tmp_path):
    started = []

    def start(model, *arguments):
        line = ["-m", f"{BRIDGES[model]}.main", *arguments]
        process = Process(line, packages_of(workspace(model)), tmp_path / str(len(started)))
        started.append(process)
        return process

    yield start
    for process in started:
        process.close()


def config(model):
    return workspace(model) / f"{model}_bringup" / "config" / f"{BRIDGES[model]}.yaml"


def running(process, words="runs as"):
    wait_for(lambda: words in process.log.read_text() or process.popen.poll() is not None, words)
    assert words in process.log.read_text(), process.log.read_text()
    return process


def values(ros, node, names):
    from rcl_interfaces.srv import GetParameters
    from rclpy.parameter import parameter_value_to_python

    request = GetParameters.Request(names=names)
    found = ros.call(GetParameters, f"{node}/get_parameters", request).values
    return {
        name: parameter_value_to_python(value) for name, value in zip(names, found, strict=True)
    }


@pytest.mark.parametrize(
    ("model", "node"),
    sweep([("waypoints", "/vehicle/waypoint_vehicle"), ("catvehicle", "/bridge")], every=2),
)
def test_the_parameter_file_has_all_parameters_with_their_values(model, node, bridge, ros):
    from rcl_interfaces.srv import ListParameters

    file = config(model)
    port = str(free_port())
    plain = running(bridge(model, "--jaus-port", port))
    names = ros.call(ListParameters, f"{node}/list_parameters", ListParameters.Request())
    own = [name for name in names.result.names if not name.startswith(OF_ROS)]
    expected = yaml.safe_load(file.read_text())["/**"]["ros__parameters"]
    assert values(ros, node, own) == expected
    assert plain.stop() == 0
    # rclpy reads it as it stands, and nothing in it is unknown.
    same = running(bridge(model, "--ros-args", "--params-file", str(file)))
    assert same.stop() == 0
    assert "has no parameter" not in same.log.read_text()


@pytest.mark.slow
def test_what_the_parameter_file_comments_out_are_parameters_too(bridge, ros, tmp_path):
    from rcl_interfaces.srv import ListParameters

    file = tmp_path / "all.yaml"
    text = config("catvehicle").read_text().replace("# qos_overrides", "qos_overrides")
    file.write_text(text)
    given = yaml.safe_load(text)["/**"]["ros__parameters"]
    port = str(free_port())
    found = running(
        bridge("catvehicle", "--jaus-port", port, "--ros-args", "--params-file", str(file))
    )
    names = ros.call(ListParameters, "/bridge/list_parameters", ListParameters.Request())
    quality = {name for name in given if name.startswith("qos_overrides")}
    assert quality
    assert quality <= set(names.result.names)
    assert found.stop() == 0
    assert "has no parameter" not in found.log.read_text()


@pytest.mark.slow
def test_a_deployment_changes_what_the_bridge_is(bridge, ros, tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text(
        "/**:\n  ros__parameters:\n"
        f"    jaus_id: 100.7.7\n    jaus_port: {free_port()}\n"
        "    velocity_state.topic: wheel_odom\n    local_waypoint.frame_id: map\n"
    )
    process = bridge("waypoints", "--ros-args", "--params-file", str(file))
    running(process, "/vehicle/waypoint_vehicle runs as 100.7.7")
    wait_for(
        lambda: ros.node.get_subscriptions_info_by_topic("/vehicle/wheel_odom"), "renamed topic"
    )
    node = "/vehicle/waypoint_vehicle"
    assert values(ros, node, ["local_waypoint.frame_id"]) == {"local_waypoint.frame_id": "map"}
    assert process.stop() == 0
    # The command line goes before the file; an empty option, as of launch files, says nothing.
    arguments = ["--jaus-id=100.8.8", "--jaus-interface=", "--ros-args", "--params-file", str(file)]
    process = bridge("waypoints", *arguments, "-r", "__ns:=/second")
    running(process, "/second/waypoint_vehicle runs as 100.8.8")
    assert process.stop() == 0


# What a bridge reads together, it tells of together.
WRONG = [
    {
        "global_pose.imu.freshness:=-1.0": "imu.freshness is -1.0; it must lie in 0.001..1e+09",
        "velocity_state.topic:=[]": "velocity_state.topic is []: write a text",
    },
    {
        "global_pose.imu.freshness:=nan": "global_pose.imu.freshness is nan; it must lie in",
        "velocity_state.topic:=y": """needs quotes here, velocity_state.topic:='"y"'""",
    },
    {
        "autostart:=0": "autostart is 0: write true or false",
        "global_pose.imu.freshness:='0.5'": "freshness is 0.5: write a number, such as 0.5, wi",
    },
    {
        "jaus_id:=home": "jaus_id is home: 'home' is not a JAUS address",
        "jaus_port:=0": "jaus_port is 0; it must lie in 1..65535",
        "jaus_transport:=carrier_pigeon": "carrier_pigeon is none of judp, jtcp, node-manager",
    },
    {"velocity_state.topic:=a b": "topic 'a b'"},
    {"jaus_id:=[]": "jaus_id is []: write a text"},
    {"jaus_id:=100.1.255": "100.1.255 does not name one component"},
    {"qos_overrides./vehicle/odom.subscription.reliability:=fast": "fast"},
    {"jaus_interface:=0.0.0.0": "interface 0.0.0.0"},
    {"jaus_interface:=wlan0": "wlan0"},
]


@pytest.mark.parametrize("wrong", sweep(WRONG, every=3), ids=" ".join)
def test_each_value_that_does_not_do_is_a_line_and_the_status_is_2(wrong, bridge):
    process = bridge(
        "waypoints", "--ros-args", *(word for value in wrong for word in ("-p", value))
    )
    assert process.popen.wait(timeout=30) == 2
    log = process.log.read_text()
    said = [line for line in log.splitlines() if "ERROR" in line]
    assert all("waypoint_vehicle cannot run: " in line for line in said)
    for words in wrong.values():
        assert len([line for line in said if words in line]) == 1, (words, said)
    assert len(said) == len(wrong)
    assert "Traceback" not in log


def test_the_command_line_goes_before_a_file_with_a_value_of_another_type(bridge, tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text("/**:\n  ros__parameters:\n    jaus_port: true\n")
    words = ("--params-file", str(file), "-p", "waypoint_vehicle:jaus_port:=0")
    process = bridge("waypoints", "--ros-args", *words)
    assert process.popen.wait(timeout=30) == 2
    assert "jaus_port is 0; it must lie in 1..65535" in process.log.read_text()


@pytest.mark.parametrize(
    ("name", "value"), [("ROS_DOMAIN_ID", "300"), ("RMW_IMPLEMENTATION", "rmw_none_cpp")]
)
def test_what_of_the_environment_keeps_from_ros_is_one_line(bridge, monkeypatch, name, value):
    monkeypatch.setenv(name, value)
    process = bridge("waypoints")
    assert process.popen.wait(timeout=30) == 2
    (said,) = process.log.read_text().splitlines()
    assert "waypoint_vehicle cannot run: " in said
    assert value in said


def test_what_ros_does_not_know_is_one_line_and_status_2(bridge):
    process = bridge("waypoints", "--ros-args", "--jaus-port", "3800")
    assert process.popen.wait(timeout=30) == 2
    lines = process.log.read_text().splitlines()
    (said,) = [line for line in lines if "ERROR" in line]
    assert "waypoint_vehicle cannot run: " in said
    assert "--jaus-port" in said
    assert not any("Traceback" in line for line in lines)


@pytest.mark.slow
def test_a_misspelt_name_is_told_and_the_bridge_runs(bridge):
    arguments = ["--jaus-port", str(free_port()), "--ros-args", "-p", "velocity_state.topc:=x"]
    process = running(bridge("waypoints", *arguments), "did you mean")
    told = "has no parameter velocity_state.topc; did you mean velocity_state.topic?"
    assert told in process.log.read_text()
    assert running(process).stop() == 0


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_further_signals_do_no_harm(bridge, number):
    process = running(bridge("waypoints", "--jaus-port", str(free_port())))
    for _ in range(500):
        process.popen.send_signal(number)
        time.sleep(0.005)
        if process.popen.poll() is not None:
            break
    assert process.popen.wait(timeout=30) == 0
    assert "Traceback" not in process.log.read_text()

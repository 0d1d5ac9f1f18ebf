"""The bring-up package: launch files that are run against a stand-in, parameters, processes."""

import json
from pathlib import Path

import needs
import pytest
import yaml
from generated import model_of, text_of
from sweeps import sweep

from jausml.generation.rendering import render
from jausml.language.metamodel.classes import bridge, ros
from jausml.language.semantics.connections import stops
from jausml.runtime.base.settings import TransportSettings
from jausml_generators.bringup.processes import SETTINGS
from jausml_generators.bringup.target import TARGET as BRINGUP

from .node_support import CASES, ROOT, artifacts, ros_environment, run, write

STOPS = ROOT / "tests" / "live" / "stops.ros2jaus"
LISTS = ROOT / "models" / "examples" / "waypoint_list" / "waypoint_list.ros2jaus"

# As much of launch as the generated files use; every call is checked like a real one would be.
STAND_IN = {
    "ament_index_python/packages.py": """
        def get_package_share_directory(package_name):
            return "/share/" + package_name
        """,
    "launch/__init__.py": """
        class LaunchDescription:
            def __init__(self, initial_entities=None):
                self.entities = list(initial_entities)
        """,
    "launch/actions.py": """
        class DeclareLaunchArgument:
            def __init__(self, name, *, default_value=None, description=None):
                assert isinstance(name, str) and isinstance(description, str)
                self.said = {"argument": name, "default": default_value}
        class GroupAction:
            def __init__(self, actions):
                self.said = {"group": [each.said for each in actions]}
        class SetEnvironmentVariable:
            def __init__(self, name, value):
                self.said = {"variable": name, "value": value}
        class ExecuteProcess:
            def __init__(self, *, cmd, name=None, output="log"):
                self.said = {"command": cmd, "name": name, "output": output}
        """,
    "launch/substitutions.py": """
        class LaunchConfiguration:
            def __init__(self, variable_name):
                self.said = "$" + variable_name
        class EnvironmentVariable:
            def __init__(self, name, *, default_value=None):
                assert isinstance(default_value, str)
                self.said = "env " + name + " or " + default_value
        """,
    "launch_ros/actions.py": """
        class Node:
            def __init__(self, *, package, executable, name=None, namespace=None,
                         parameters=None, arguments=None, ros_arguments=None, output="log"):
                self.said = {
                    "node": package + "/" + executable, "name": name, "namespace": namespace,
                    "parameters": parameters, "arguments": arguments,
                    "ros_arguments": ros_arguments, "output": output,
                }
        class PushRosNamespace:
            def __init__(self, namespace):
                self.said = {"pushed": namespace}
        class SetParameter:
            def __init__(self, name, value=None):
                self.said = {"set": name, "value": value}
        """,
    "launch_ros/substitutions.py": """
        class ExecutableInPackage:
            def __init__(self, executable, package):
                self.said = package + "/" + executable
        """,
}
RUN = """
import json, runpy, sys
namespace = runpy.run_path(sys.argv[1])
description = namespace["generate_launch_description"]()
print(json.dumps([each.said for each in description.entities], default=lambda each: each.said))
"""
TRANSPORT = [
    ["--jaus-interface=", "$jaus_interface"],
    ["--jaus-transport=", "$jaus_transport"],
    ["--jaus-port=", "$jaus_port"],
    ["--jaus-multicast-group=", "$jaus_multicast_group"],
    ["--jaus-multicast-ttl=", "$jaus_multicast_ttl"],
    ["--jaus-fragment-size=", "$jaus_fragment_size"],
    ["--log-level=", "$log_level"],
]


def options(identity="jaus_id"):
    return [["--jaus-id=", f"${identity}"], *TRANSPORT]


def parameter_file(package, name):
    return f"/share/{package}/config/{name}.yaml"


@pytest.fixture(scope="module")
def stand_in(tmp_path_factory):
    folder = tmp_path_factory.mktemp("stand_in")
    for name, text in STAND_IN.items():
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        (path.parent / "__init__.py").touch()
        lines = text.splitlines()
        path.write_text("\n".join(line[8:] for line in lines))
    return folder


class Launch:
    """What a launch file describes."""

    def __init__(self, file, stand_in):
        done = run("-c", RUN, file, PYTHONPATH=str(stand_in))
        assert done.returncode == 0, done.stderr
        self.entities = json.loads(done.stdout)
        self.arguments = {e["argument"]: e["default"] for e in self.entities if "argument" in e}
        self.variables = {e["variable"]: e["value"] for e in self.entities if "variable" in e}
        (group,) = (entity["group"] for entity in self.entities if "group" in entity)
        self.namespaces = [entity["pushed"] for entity in group if "pushed" in entity]
        self.parameters = {entity["set"]: entity["value"] for entity in group if "set" in entity}
        self.entities += group
        self.commands = {e["name"]: e["command"] for e in self.entities if "command" in e}
        self.nodes = {e["name"]: e for e in self.entities if "node" in e}
        processes = [*self.nodes.values(), *(e for e in self.entities if "command" in e)]
        assert all(process["output"] == "screen" for process in processes)


def launches(case, out, stand_in):
    write(case, out, (BRINGUP,))
    (folder,) = out.glob("*_bringup/launch")
    files = sorted(folder.iterdir())
    return {file.name.removesuffix(".launch.py"): Launch(file, stand_in) for file in files}


@pytest.fixture(scope="module")
def fleet(tmp_path_factory, stand_in):
    return launches("hosts", tmp_path_factory.mktemp("fleet"), stand_in)


def settings(interface="", port="", group="", ttl=""):
    return {
        "jaus_interface": interface, "jaus_transport": "", "jaus_port": port,
        "jaus_multicast_group": group, "jaus_multicast_ttl": ttl, "jaus_fragment_size": "",
    }  # fmt: skip


def files(package, **arguments):
    return {key: parameter_file(package, name) for key, name in arguments.items()}


NODES = {"namespace": "", "use_sim_time": "false"}
GENERAL = {"ros_domain_id": "env ROS_DOMAIN_ID or 9", "log_level": "info"}


def test_one_host_has_one_launch_file(tmp_path, stand_in):
    ((name, launch),) = launches("one_host", tmp_path, stand_in).items()
    assert name == "alone"
    # What the one process has anyway is not said again: a parameter file may say otherwise.
    assert launch.arguments["jaus_port"] == ""
    assert launch.arguments["jaus_id"] == ""
    assert launch.commands == {"arm": ["arm/arm", *options()]}
    assert list(launch.nodes) == ["display"]


def test_several_hosts_have_a_launch_file_each(fleet):
    # A host may have the name of the system.
    assert list(fleet) == ["fleet", "fleet_eye", "fleet_fleet", "fleet_robot"]


def test_a_host_has_its_own_transport(fleet):
    own = {"jaus_id": "", **settings()}
    assert fleet["fleet_robot"].arguments == {**GENERAL, **own}
    display = files("fleet_bringup", params_file="display")
    assert fleet["fleet_fleet"].arguments == {**GENERAL, **NODES, **own, **display}
    camera = files("fleet_bringup", params_file="camera")
    assert fleet["fleet_eye"].arguments == {**GENERAL, **NODES, **camera}
    assert fleet["fleet_robot"].namespaces == []
    assert fleet["fleet_eye"].namespaces == ["$namespace"]


def test_simulated_time_is_an_argument_for_all_nodes(fleet):
    assert fleet["fleet"].parameters == {"use_sim_time": "$use_sim_time"}
    assert fleet["fleet_robot"].parameters == {}
    for name in ("camera", "display"):
        # The parameters of a node come after those of the launch file, and would undo the argument.
        assert "use_sim_time" not in parameters("hosts", name)


def test_a_host_starts_what_is_placed_there(fleet):
    assert {name: [*launch.commands, *launch.nodes] for name, launch in fleet.items()} == {
        "fleet": ["arm", "operator", "camera", "display"],
        "fleet_eye": ["camera"],
        "fleet_fleet": ["operator", "display"],
        "fleet_robot": ["arm"],
    }


def test_everything_on_one_computer_has_one_transport(fleet):
    whole = fleet["fleet"]
    assert whole.arguments == {
        **GENERAL,
        **NODES,
        "arm_jaus_id": "",
        "operator_jaus_jaus_id": "",
        **settings("192.168.0.7", port="3800", group="239.255.0.1", ttl="4"),
        **files("fleet_bringup", camera_params_file="camera", display_params_file="display"),
    }
    # Named like a module of Python, so the package is named otherwise.
    expected = ["operator_jaus/operator_jaus", *options("operator_jaus_jaus_id")]
    assert whole.commands["operator"] == expected


def test_arguments_are_declared_before_they_are_used(fleet):
    for launch in fleet.values():
        kinds = ["argument" in entity for entity in launch.entities]
        assert kinds == sorted(kinds, reverse=True)
        assert launch.variables == {"ROS_DOMAIN_ID": "$ros_domain_id"}


def test_a_node_has_its_name_namespace_and_parameters(fleet):
    assert fleet["fleet"].nodes["camera"] == {
        "node": "camera/camera", "name": "camera", "namespace": "front",
        "parameters": ["$camera_params_file"], "arguments": None,
        "ros_arguments": ["--log-level", "$log_level"], "output": "screen",
    }  # fmt: skip
    assert fleet["fleet"].nodes["display"]["namespace"] is None


def test_a_bridge_takes_arguments_of_both_sides(tmp_path, stand_in):
    model = CASES.parents[2] / "models" / "minimal" / "minimal.xmi"
    write(model.with_suffix(""), tmp_path, (BRINGUP,))
    launch = Launch(tmp_path / "minimal_bringup" / "launch" / "minimal.launch.py", stand_in)
    bridge = launch.nodes["sensor_bridge"]
    waiting = ["--ros-waiting=", "$ros_waiting"]
    assert bridge["arguments"] == [*options("sensor_bridge_jaus_id"), waiting]
    assert launch.arguments["ros_waiting"] == ""
    # Of two values ROS takes one by its type: what equals the model is not stated once more.
    assert bridge["parameters"] == ["$params_file"]
    assert launch.arguments["params_file"] == parameter_file("minimal_bringup", "sensor_bridge")
    assert launch.commands["sensor"] == ["sensor/sensor", *options("sensor_jaus_id")]


def test_hostile_launch_files_run_nothing(tmp_path, stand_in, monkeypatch):
    canary = tmp_path / "canary"
    monkeypatch.setenv("CANARY", str(canary))
    launch = launches("hostile", tmp_path / "ws", stand_in)["hostile"]
    assert launch.nodes["quiet"]["namespace"] == 'x", y="\\'
    assert not canary.exists()


# ------------------------------------------------------------------ parameters


def parameters(case, name):
    (text,) = (
        a.text for path, a in artifacts(case, BRINGUP).items() if path.endswith(f"/{name}.yaml")
    )
    content = yaml.safe_load(text)
    assert list(content) == ["/**"]
    assert list(content["/**"]) == ["ros__parameters"]
    return content["/**"]["ros__parameters"]


def test_parameters_are_the_modelled_values():
    values = parameters("features", "everything")
    assert values == {
        "gain": 1e-7, "tries": 3, "limit": -(2**63), "frame": "base_link", "nothing": "",
        "number_like": "1e3", "active": True, "passive": False, "plain": 1e22,
    }  # fmt: skip
    assert [type(values[name]) for name in ("gain", "plain", "tries")] == [float, float, int]


def test_words_of_yaml_are_names_and_nothing_is_there_twice():
    values = parameters("features", "Odometry")
    assert list(values) == ["context", "publishers", "on", "use_sim_time", "lambda"]
    assert values["on"] is True


def test_hostile_values_arrive_unchanged():
    values = parameters("hostile", "victim")
    node = next(
        n for n in model_of(CASES / "hostile.xmi").instances(ros.Node) if n.name == "victim"
    )
    assert {p.name: p.value for p in node.parameters} == values


def test_a_stop_of_the_map_is_not_taken_away_by_the_parameter_file():
    model = model_of(STOPS, allow_outside=True)
    files = [artifact for artifact in render(model, [BRINGUP]) if artifact.path.endswith(".yaml")]
    seconds = {}
    for file in files:
        values = yaml.safe_load(file.text)["/**"]["ros__parameters"]
        for name, value in values.items():
            if name.endswith(".silence_timeout"):
                seconds[Path(file.path).stem, name.partition(".")[0]] = value
    made = {
        (owner.name, connection.name): stops.silence_timeout(connection)
        for owner in model.instances(bridge.Bridge, library=False)
        for connection in owner.bridgeConnections
    }
    assert set(made.values()) == {0.0, 1.0}
    assert seconds == made


def test_a_list_is_not_shaped():
    robot = text_of(model_of(LISTS), [BRINGUP], "robot.yaml")
    values = yaml.safe_load(robot)["/**"]["ros__parameters"]
    assert {name for name in values if name.startswith("waypoints.")} == {
        "waypoints.action",
        "waypoints.frame_id",
    }


READ = """
import json, sys, rclpy
from PACKAGE.PACKAGE import CLASS
rclpy.init(args=["--ros-args", "--params-file", sys.argv[1]])
node = CLASS()
print(json.dumps({name: node.get_parameter(name).value for name in json.loads(sys.argv[2])}))
node.destroy_node()
rclpy.shutdown()
"""


@pytest.mark.live
@pytest.mark.parametrize("name", sweep(["everything", "Odometry"], every=2))
def test_rclpy_accepts_the_parameter_file(name, tmp_path):
    needs.ask("rclpy")
    write("features", tmp_path)
    file = tmp_path / "features_bringup" / "config" / f"{name}.yaml"
    # Other values than the defaults of the code, so that they can only come from the file.
    text = file.read_text().replace("1.0e-07", "2.0e-07").replace('"no context"', '"a context"')
    text = text.replace('"base_link"', '"h\\u00f6h\\U0001f600"').replace(
        '"on": true', '"on": false'
    )
    file.write_text(text)
    expected = yaml.safe_load(text)["/**"]["ros__parameters"]
    package = name.lower()
    script = READ.replace("PACKAGE", package).replace("CLASS", package.capitalize())
    done = run("-c", script, file, json.dumps([*expected]), **ros_environment(tmp_path))
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout.splitlines()[-1]) == expected


# ------------------------------------------------------------------ processes


def test_processes_are_recorded_for_the_command_line():
    assert BRINGUP.processes(model_of(CASES / "hosts.xmi")) == [
        {
            "name": "arm", "kind": "component", "package": "arm", "module": "arm.main",
            "arguments": [],
        },
        {
            "name": "operator", "kind": "component", "package": "operator_jaus",
            "module": "operator_jaus.main", "arguments": [],
        },
        *(
            {
                "name": name, "kind": "node", "package": name, "module": f"{name}.main",
                "arguments": [], "domain": 9,
            }
            for name in ("camera", "display")
        ),
    ]  # fmt: skip


def test_a_file_is_passed_that_says_what_the_code_does_not():
    entries = {
        process["name"]: process for process in BRINGUP.processes(model_of(CASES / "features.xmi"))
    }
    files = {name: process.get("parameters") for name, process in entries.items()}
    assert files["Odometry"] == "features_bringup/config/Odometry.yaml"  # it states use_sim_time
    assert files["everything"] is None


def test_options_are_those_of_the_runtime():
    known = TransportSettings()
    assert {setting.option: setting.default for setting in SETTINGS} == {
        "--jaus-interface": known.interface,
        "--jaus-transport": known.transport.value,
        "--jaus-port": str(known.port),
        "--jaus-multicast-group": known.multicast_group,
        "--jaus-multicast-ttl": str(known.multicast_ttl),
        "--jaus-fragment-size": str(known.fragment_size),
    }

"""Node packages: clean by every tool, true to the model in a real rclpy process, safe from it."""

import ast
import json
import keyword
import os
import re
import shutil

import needs
import pytest
from generated import WITHOUT_PLUGINS, model_of, texts_of

from jausml.generation.artifact import Kind
from jausml.generation.contract.finding import FindingKind
from jausml.generation.drift import drift
from jausml.generation.manifest import read_manifest
from jausml.generation.python import Imports, Modules, Origin
from jausml.generation.rendering import render
from jausml.language.metamodel.classes import ros, system
from jausml_generators.common.ros import RosType, local_names
from jausml_generators.ros_node.target import TARGET as ROS_NODE
from jausml_generators.ros_node.target import NodeView

from .node_support import CASES, ROOT, artifacts, ros_environment, run, write

# The rules of this repository, apart from:
#   ARG     a default handler does not use what it is given
#   TC      a skeleton imports message types for the code that users add
#   PTH207  setup.py globs as those of ROS do
#   S101    pytest asserts
RULES = (
    "A,ANN,B,C4,C90,D,E,F,FBT,I,N,PIE,PLC,PLE,PLW,PT,PTH,RET,RUF,S,SIM,SLF,T10,T20,UP,W",
    "D105,D107,PTH207,RUF001,RUF002,RUF003,S101",
)
# What untyped ROS packages force.
MYPY = """\
[mypy]
strict = True
python_version = 3.10
ignore_missing_imports = True
disallow_untyped_calls = False
disallow_subclassing_any = False
warn_return_any = False
explicit_package_bases = True
"""
ORDINARY = ("features", "talk", "hosts", "one_host")


@pytest.fixture(scope="module")
def workspace(tmp_path_factory):
    out = tmp_path_factory.mktemp("features")
    write("features", out)
    return out


@pytest.fixture
def talk(tmp_path):
    out = tmp_path / "ws"
    write("talk", out)
    return out


def described(name="everything"):
    whole = model_of(CASES / "features.xmi").instances(system.System)[0]
    node = next(node for node in whole.nodes if node.name == name)
    return NodeView(node, whole.name, "features.xmi")


# ------------------------------------------------------------------ tools


@pytest.mark.parametrize("case", [*ORDINARY, "hostile"])
def test_ruff_would_format_nothing_anew(case, tmp_path):
    write(case, tmp_path)
    done = run(
        "-m", "ruff", "format", "--isolated", "--no-cache", "--line-length=100", "--diff", tmp_path
    )
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("case", ORDINARY)
def test_ruff_finds_nothing(case, tmp_path):
    write(case, tmp_path)
    select, ignore = RULES
    options = ["--isolated", "--no-cache", "--line-length=100", "--target-version=py310"]
    options += [f"--select={select}", f"--ignore={ignore}"]
    options += ["--config=lint.pydocstyle.convention='google'", "--output-format=concise"]
    options += ["--exclude=jausml_runtime"]
    # From the workspace, where the folders of packages tell ruff which imports are their own.
    done = run("-m", "ruff", "check", *options, ".", cwd=tmp_path)
    assert done.returncode == 0, done.stdout


@pytest.mark.slow
def test_mypy_is_content(workspace, tmp_path):
    (tmp_path / "mypy.ini").write_text(MYPY)
    packages = [workspace / name for name in ("everything", "odometry", "idle")]
    files = [
        file for package in packages for file in package.rglob("*.py") if file.name != "setup.py"
    ]
    assert len(files) == 15
    done = run(
        *("-m", "mypy", "--config-file", tmp_path / "mypy.ini"),
        *("--cache-dir", f"{os.environ['MYPY_CACHE_DIR']}-ros"),
        *files,
        cwd=workspace,
        MYPYPATH=":".join(map(str, [*packages, workspace / "jausml_runtime"])),
    )
    assert done.returncode == 0, done.stdout + done.stderr


# ------------------------------------------------------------------ the node in ROS


@pytest.mark.live
def test_generated_tests_pass_and_can_fail(workspace, tmp_path):
    needs.ask("rclpy")
    options = (
        *["-m", "pytest", "-q", "-p", "no:cacheprovider", "-c", "/dev/null", "--rootdir"],
        tmp_path,
    )
    tests = [workspace / name / "test" for name in ("everything", "odometry", "idle")]
    done = run(*options, *tests, cwd=tmp_path, **ros_environment(workspace, **WITHOUT_PLUGINS))
    assert "15 passed" in done.stdout, done.stdout
    broken = shutil.copytree(workspace, tmp_path / "broken")
    base = broken / "everything" / "everything" / "everything_base.py"
    base.write_text(base.read_text().replace('"cmd_vel"', '"cmd"').replace('"/brake"', '"/break"'))
    test = broken / "everything" / "test"
    done = run(*options, test, cwd=tmp_path, **ros_environment(broken, **WITHOUT_PLUGINS))
    assert "test_publishers" in done.stdout
    assert "test_clients" in done.stdout
    assert "2 failed, 5 passed" in done.stdout, done.stdout


INSPECT = """
import json, time, rclpy
from rclpy.parameter import Parameter
from everything.everything import Everything

def parameter(name):
    said = node.describe_parameter(name)
    ranges = [*said.integer_range, *said.floating_point_range]
    limits = [[each.from_value, each.to_value] for each in ranges]
    return node.get_parameter(name).value, said.type, limits, said.read_only, said.description

def profile(find, topic):
    end = time.monotonic() + 20
    while not (found := find(topic)):
        assert time.monotonic() < end, topic
        time.sleep(0.01)
    qos = found[0].qos_profile
    policies = (qos.reliability, qos.durability, qos.history, qos.liveliness)
    times = (qos.deadline, qos.lifespan, qos.liveliness_lease_duration)
    return [each.name for each in policies] + [each.nanoseconds / 1e9 for each in times]

def attempt(name, value):
    return node.set_parameters([Parameter(name, value=value)])[0].successful

def refusal(publisher, message):
    try:
        publisher.publish(message)
    except Exception as error:
        return f"{type(error).__name__}: {error}"

rclpy.init(args=[])
node = Everything()
small = node.publisher_small
names = NAMES
result = {
    "parameters": {name: parameter(name) for name in names},
    "properties": {name: getattr(node, "parameter_" + name) for name in names},
    "attempts": [attempt(*pair) for pair in ATTEMPTS],
    "gain": node.parameter_gain,
    "publisher": profile(node.get_publishers_info_by_topic, "/robot/arm/cmd_vel"),
    "default": profile(node.get_publishers_info_by_topic, "/small"),
    "subscription": profile(
        node.get_subscriptions_info_by_topic,
        "/robot/arm/pose_of_the_arm_that_has_a_name_that_is_rather_long",
    ),
    "refusals": [refusal(small, small.msg_type(data=each)) for each in (True, 200)],
    "overrides": sorted(name for name in node.get_parameters_by_prefix("qos_overrides./small")),
}
print(json.dumps(result))
node.destroy_node()
rclpy.shutdown()
"""

ATTEMPTS = [("gain", 2.5), ("gain", -2.0), ("frame", "map"), ("tries", 0)]


@pytest.fixture(scope="module")
def inspected(workspace):
    needs.ask("rclpy")
    names = [parameter.ros_name for parameter in described().parameters]
    done = run(
        "-c",
        INSPECT.replace("NAMES", repr(names)).replace("ATTEMPTS", repr(ATTEMPTS)),
        **ros_environment(workspace),
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.live
def test_parameters_are_declared_as_modelled(inspected):
    gain = (
        "Gain of the controller: radians of steering for each metre of distance from the path,"
        " positive to the left."
    )
    boolean, integer, double, string = 1, 2, 3, 4  # rcl_interfaces/msg/ParameterType
    assert inspected["parameters"] == {
        "gain": [1e-7, double, [[-1.5, 1e22]], False, gain],
        "tries": [3, integer, [[1, 2**63 - 1]], False, "Attempts."],
        "limit": [-(2**63), integer, [], True, ""],
        "frame": ["base_link", string, [], True, "Frame of the commands."],
        "nothing": ["", string, [], False, ""],
        "number_like": ["1e3", string, [], False, ""],
        "active": [True, boolean, [], False, ""],
        "passive": [False, boolean, [], False, ""],
        "plain": [1e22, double, [], False, ""],
    }


@pytest.mark.live
def test_properties_follow_the_parameters(inspected):
    values = {name: said[0] for name, said in inspected["parameters"].items()}
    assert inspected["properties"] == values
    assert inspected["attempts"] == [True, False, False, False]
    assert inspected["gain"] == 2.5


@pytest.mark.live
def test_topics_have_the_modelled_quality_of_service(inspected):
    policies = ["BEST_EFFORT", "TRANSIENT_LOCAL"]
    published, subscribed = inspected["publisher"], inspected["subscription"]
    assert published[:2] == policies
    assert published[3:] == ["MANUAL_BY_TOPIC", 0.5, 2.0, 1.5]
    assert inspected["default"][:2] == ["RELIABLE", "VOLATILE"]
    assert subscribed[:2] == ["BEST_EFFORT", "VOLATILE"]
    assert inspected["overrides"] == [
        f"publisher.{name}" for name in ("depth", "history", "reliability")
    ]


@pytest.mark.live
def test_values_that_do_not_fit_are_refused_by_name(inspected):
    truth, byte = inspected["refusals"]
    assert truth is None
    assert "data: 200 does not fit" in byte


# ------------------------------------------------------------------ names


def test_no_name_hides_another():
    files = artifacts("features", ROS_NODE)
    for name in ("odometry_base", "odometry"):
        tree = ast.parse(files[f"odometry/odometry/{name}.py"].text)
        imported = [
            alias.asname or alias.name
            for node in ast.walk(tree)
            if isinstance(node, ast.ImportFrom)
            for alias in node.names
        ]
        (cls,) = (node for node in tree.body if isinstance(node, ast.ClassDef))
        methods = [node.name for node in cls.body if isinstance(node, ast.FunctionDef)]
        assert len({*imported, cls.name}) == len(imported) + 1
        assert len(set(methods)) == len(methods)
        assert not any(map(keyword.iskeyword, methods))
    assert {"StdMsgsEmpty", "StdSrvsEmpty", "NavMsgsOdometry"} <= set(imported)
    assert {"on_timer", "on_timer_", "on_map", "on_map_again", "on_class"} <= set(methods)


def test_no_generated_member_replaces_one_of_rclpy(workspace):
    needs.ask("rclpy")
    from rclpy.node import Node

    members = set(vars(Node))
    for base in workspace.glob("*/*/*_base.py"):
        text = base.read_text()
        made = set(re.findall(r"self\.(\w+) = |    def (\w+)\(", text))
        assert not {name for pair in made for name in pair if name} - {"__init__"} & members


def test_types_of_one_name_are_told_apart():
    pose, other = RosType("geometry_msgs", "msg", "Pose"), RosType("turtlesim", "msg", "Pose")
    node, warning = RosType("demo", "msg", "Node"), RosType("demo", "msg", "Warning")
    twice = RosType("demo", "srv", "Warning")
    names = local_names([pose, other, node, warning, twice], {"Node"})
    assert names == {
        pose: "GeometryMsgsPose",
        other: "TurtlesimPose",
        node: "DemoNode",
        warning: "DemoWarning",
        twice: "DemoWarning_2",
    }
    assert local_names([pose], {"Node"}) == {pose: "Pose"}


def test_imports_are_sorted_as_ruff_sorts_them(tmp_path):
    names = [
        *(("std_msgs.msg", name) for name in ("Int8", "Int16", "UInt8", "Float64", "ABC", "Abc")),
        *(("b.msg", name) for name in ("Zed", "Pose as BPose", "Arm as BArm")),
        *((f"tf{number}.msg", "Tree") for number in ("", 2, 10, "_x")),
        *(("long.msg", f"ATypeOfQuiteSomeLength{number}") for number in range(9)),
        ("launch", "LaunchDescription"),
        ("ament.packages", "find"),
        ("ament.packages", "Error"),
    ]
    file = tmp_path / "module.py"
    origins = {
        local or name: Origin(module, name)
        for module, (name, _, local) in ((pair[0], pair[1].partition(" as ")) for pair in names)
    }
    body = f"from __future__ import annotations\n\nEVERY = {sorted(origins)}\n".replace("'", "")
    file.write_text(Modules().finished(body, Imports(origins)))
    line = [
        "-m", "ruff", "check", "--isolated", "--no-cache", "--line-length=100", "--select=I",
        "--diff",
    ]  # fmt: skip
    done = run(*line, file)
    assert done.returncode == 0, done.stdout


# ------------------------------------------------------------------ skeletons


def findings(out):
    rendered = render(model_of(CASES / "talk.xmi"), [ROS_NODE])
    return drift(rendered, out, read_manifest(out))


def test_a_new_skeleton_has_not_drifted(talk):
    assert findings(talk) == []


@pytest.mark.parametrize(
    ("before", "after", "kind", "names"),
    [
        ("def on_word(", "def helper(", FindingKind.MISSING, "on_word"),
        ("def on_word(", "def on_sentence(", FindingKind.ORPHAN, "on_sentence"),
        ("def on_double(", "def on_doubled(", FindingKind.RENAMED, "renamed to on_double?"),
        ("self, message: String", "self", FindingKind.SIGNATURE, "on_word(self, message)"),
        ("(ListenerBase)", "", FindingKind.NO_BASE, "ListenerBase"),
    ],
)
def test_drift_of_a_skeleton_is_found(before, after, kind, names, talk):
    file = talk / "listener" / "listener" / "listener.py"
    text = file.read_text()
    assert text.count(before) == 1
    file.write_text(text.replace(before, after))
    found = {finding.kind: finding for finding in findings(talk)}
    assert names in found[kind].message


def test_a_renamed_endpoint_is_recognised_by_its_topic(talk, tmp_path):
    model = tmp_path / "talk.xmi"
    text = (CASES / "talk.xmi").read_text(encoding="utf-8")
    start = text.index('<nodes name="listener"')
    renamed = text[start:].replace('<subscriptions name="word"', '<subscriptions name="utterance"')
    model.write_text(text[:start] + renamed, encoding="utf-8")
    rendered = render(model_of(model), [ROS_NODE])
    (finding,) = drift(rendered, talk, read_manifest(talk))
    assert finding.kind is FindingKind.RENAMED
    assert finding.message == "on_word: renamed to on_utterance"
    compile(f"class C:\n{finding.stub}", "stub", "exec")


def test_every_stub_fits_its_base():
    for node in model_of(CASES / "features.xmi").instances(ros.Node):
        view = NodeView(node, "features", "features.xmi")
        for method in view.contract().methods:
            (function,) = ast.parse(f"class C:\n{method.stub}").body[0].body
            assert function.name == method.name
            assert [a.arg for a in function.args.args] == ["self", *method.parameters]


def test_generating_again_changes_nothing_and_keeps_the_skeleton(talk):
    file = talk / "listener" / "listener" / "listener.py"
    mine = file.read_text() + "\n\nANSWER = 42\n"
    file.write_text(mine)
    before = {path: path.read_bytes() for path in talk.rglob("*") if path.is_file()}
    plan = write("talk", talk)
    assert plan.is_up_to_date
    assert {path: path.read_bytes() for path in talk.rglob("*") if path.is_file()} == before
    assert file.read_text() == mine


def test_output_is_the_same_wherever_the_model_lies(tmp_path):
    copy = tmp_path / "elsewhere" / "features.xmi"
    copy.parent.mkdir()
    copy.write_bytes((CASES / "features.xmi").read_bytes())
    texts = texts_of(model_of(copy), [ROS_NODE])
    assert texts == texts_of(model_of(CASES / "features.xmi"), [ROS_NODE])
    assert not any(str(ROOT) in text or str(tmp_path) in text for text in texts.values())


def test_a_node_without_endpoints_is_still_a_node():
    files = artifacts("features", ROS_NODE)
    skeleton = files["idle/idle/idle.py"]
    assert skeleton.kind is Kind.SKELETON
    assert skeleton.contract.methods == ()
    base = files["idle/idle/idle_base.py"].text
    assert "import QoS" not in base
    assert "import Parameter" not in base
    assert 'super().__init__("idle")' in base


# ------------------------------------------------------------------ hostile models


@pytest.fixture(scope="module")
def hostile(tmp_path_factory):
    out = tmp_path_factory.mktemp("hostile")
    write("hostile", out)
    return out


def test_hostile_text_stays_text(hostile):
    tree = ast.parse((hostile / "victim" / "victim" / "victim_base.py").read_text())
    calls = {
        node.func.id
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    }
    assert calls == {"super", "ParameterDescriptor", "QoSProfile", "checked_answers"}
    strings = {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)}
    node = next(
        n for n in model_of(CASES / "hostile.xmi").instances(ros.Node) if n.name == "victim"
    )
    assert {parameter.value for parameter in node.parameters} <= strings
    assert {endpoint.topic for endpoint in (*node.publishers, *node.subscriptions)} <= strings
    assert {server.service for server in node.serviceServers} <= strings
    description = next(iter(node.parameters)).documentation
    assert " ".join(description.split()) in strings


def test_hostile_models_run_nothing(hostile, tmp_path):
    needs.ask("rclpy")
    canary = tmp_path / "canary"
    for file in hostile.rglob("*.py"):
        compile(file.read_text(encoding="utf-8"), str(file), "exec", dont_inherit=True)
    script = "import victim, victim.main, victim.victim, quiet.main"
    done = run("-c", script, cwd=tmp_path, **ros_environment(hostile, CANARY=str(canary)))
    assert done.returncode == 0, done.stderr
    for package in ("victim", "quiet", "hostile_bringup"):
        done = run(
            "-W", "ignore", "setup.py", "--version", cwd=hostile / package, CANARY=str(canary)
        )
        assert done.stdout.splitlines()[-1] == "0.1.0", done.stderr
    assert not canary.exists()

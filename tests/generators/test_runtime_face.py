"""The face of the runtime: all that generated code imports stands there, by name."""

import ast
import importlib
import inspect
import os
import shutil

import pytest
from generated import model_of
from sweeps import sweep

from jausml import runtime
from jausml.generation.rendering import render
from jausml.generation.workspace import generate
from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.bringup.target import TARGET as BRINGUP
from jausml_generators.jaus_component.target import TARGET as COMPONENT
from jausml_generators.messages.target import TARGET as MESSAGES
from jausml_generators.python import package as public
from jausml_generators.ros_node.target import TARGET as ROS_NODE
from jausml_generators.runtime.target import TARGET as RUNTIME

from .node_support import ROOT, run

SYSTEMS = (
    "models/catvehicle/catvehicle.xmi", "models/minimal/minimal.xmi",
    "models/examples/winch/winch.xmi", "tests/generators/components.xmi",
    "tests/generators/lamp.xmi", "tests/generators/narrow_bridge.xmi",
)  # fmt: skip
PUBLIC = {
    public.FACE, public.MESSAGES, public.CONVERSIONS, public.OCTETS, public.WIRE, public.LIGHT,
    public.VALUES,
}  # fmt: skip


def original(module):
    """The module that a module of the copy is a copy of."""
    return importlib.import_module(module.replace("jausml_runtime", "jausml.runtime", 1))


def imports_of_the_runtime(text):
    """Yields what a module imports of the runtime, as module and name."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and node.level == 0:
            if node.module.split(".")[0] == public.FACE:
                yield from ((node.module, alias.name) for alias in node.names)
        elif isinstance(node, ast.Import):
            assert not any(alias.name.split(".")[0] == public.FACE for alias in node.names)


def is_public(module, name):
    """Whether a name may be imported: a public module of a package, or what it exports."""
    if f"{module}.{name}" in PUBLIC:
        return True
    found = original(module)
    imports = [
        node for node in ast.walk(ast.parse(inspect.getsource(found))) if hasattr(node, "names")
    ]
    own_use = {alias.name for node in imports for alias in node.names if not alias.asname}
    return hasattr(found, name) and name not in own_use


@pytest.mark.parametrize("system", SYSTEMS)
def test_generated_code_imports_what_is_public(system):
    used = {
        (artifact.path, module, name)
        for artifact in render(model_of(ROOT / system), (COMPONENT, BRIDGE, ROS_NODE, BRINGUP))
        if artifact.path.endswith(".py")
        for module, name in imports_of_the_runtime(artifact.text)
    }
    assert used
    assert {module for _, module, _ in used} <= PUBLIC
    assert [usage for usage in used if not is_public(usage[1], usage[2])] == []


def test_shipped_skeletons_import_what_is_public():
    texts = [path.read_text("utf-8") for path in (ROOT / "models").glob("**/src/**/*.py")]
    used = {usage for text in texts for usage in imports_of_the_runtime(text)}
    assert used
    assert {module for module, _ in used} <= PUBLIC
    assert [usage for usage in used if not is_public(*usage)] == []


def test_the_face_needs_no_ros():
    script = (
        "import sys, jausml.runtime\n"
        "print(sorted({'rclpy', 'diagnostic_msgs', 'rcl_interfaces'} & set(sys.modules)))\n"
    )
    done = run("-c", script, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "[]\n"


# ------------------------------------------------------------------ the version of the API


def test_generated_code_asks_for_the_api_that_the_runtime_has():
    assert runtime.API_VERSION == public.API_VERSION


@pytest.fixture(scope="module")
def talk(tmp_path_factory):
    """A workspace of a component and the runtime."""
    folder = tmp_path_factory.mktemp("talk")
    model = model_of(ROOT / "tests" / "generators" / "lamp.xmi")
    generate(model, (COMPONENT, MESSAGES, RUNTIME), folder)
    return folder


@pytest.mark.parametrize(
    ("version", "remedy"),
    sweep(
        [
            ("(1, 0)", None),
            ("(1, 3)", None),
            ("(2, 0)", "generate the package anew with the jausml that brought the runtime"),
            (
                "(0, 9)",
                "an older runtime is found first: build and source the newer workspace anew",
            ),
        ],
        every=2,
    ),
)
def test_another_api_is_refused(talk, tmp_path, version, remedy):
    shutil.copytree(talk / "jausml_runtime", tmp_path / "jausml_runtime")
    doctored = tmp_path / "jausml_runtime" / "jausml_runtime" / "base" / "api.py"
    text = doctored.read_text("utf-8")
    assert "\nAPI_VERSION = (1, 0)\n" in text
    doctored.write_text(text.replace("\nAPI_VERSION = (1, 0)\n", f"\nAPI_VERSION = {version}\n"))
    package = next(path for path in talk.iterdir() if (path / path.name / "main.py").is_file())
    messages = next(talk.glob("*_messages"))
    found = os.pathsep.join(map(str, (tmp_path / "jausml_runtime", messages, package)))
    done = run("-m", f"{package.name}.main", "--help", cwd=tmp_path, PYTHONPATH=found)
    if remedy is None:
        assert done.returncode == 0, done.stderr
        return
    has = version.strip("()").replace(", ", ".")
    assert done.stderr.splitlines()[-1] == (
        f"jausml_runtime.base.api.ApiVersionError: {package / package.name / 'main.py'} needs"
        f" API 1.0 of jausml_runtime, and {doctored.parents[1]} has {has}: {remedy}"
    )

"""The copy of the whole runtime: complete, unchanged, and in need of nothing else."""

import ast
import re

import pytest
from workspaces import share_runtime

from jausml.generation.artifact import DIGEST_MARK, has_valid_header
from jausml_generators.runtime.target import TARGET as RUNTIME

from .node_support import ROOT, artifacts, run

SOURCE = ROOT / "jausml" / "runtime"
FOLDER = "jausml_runtime/jausml_runtime/"


@pytest.fixture(scope="module")
def files():
    return artifacts("talk", RUNTIME)


@pytest.fixture(scope="module")
def copies(files):
    return {
        path.removeprefix(FOLDER): artifact.text
        for path, artifact in files.items()
        if path.startswith(FOLDER) and path.endswith(".py")
    }


def test_every_module_is_copied(files, copies):
    assert set(copies) == {path.relative_to(SOURCE).as_posix() for path in SOURCE.rglob("*.py")}
    others = {path for path in files if path.removeprefix(FOLDER) not in copies}
    assert others == {
        "jausml_runtime/package.xml", "jausml_runtime/resource/jausml_runtime",
        "jausml_runtime/setup.cfg", "jausml_runtime/setup.py", f"{FOLDER}py.typed",
    }  # fmt: skip


def test_a_copy_is_the_original_below_a_header(copies):
    for name, text in copies.items():
        assert has_valid_header(text)
        notice, digest, body = text.split("\n", 2)
        # A long path is cut at its front.
        assert f"runtime/{name}".endswith(
            notice.split(" from ")[1].partition(";")[0].split("...")[-1][-len(name) :]
        )
        assert DIGEST_MARK in digest
        assert body.encode() == (SOURCE / name).read_bytes()


def imported(text):
    """Yields the modules that a text imports absolutely."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield node.module


def test_no_module_knows_the_toolchain(copies):
    for name, text in copies.items():
        assert not [m for m in imported(text) if m.split(".")[0].startswith("jausml")], name


def test_the_manifest_names_what_is_imported(files):
    text = files["jausml_runtime/package.xml"].text
    # The interface packages have no module without ROS either.
    assert re.findall("<exec_depend>(.*?)</exec_depend>", text) == [
        *("action_msgs", "diagnostic_msgs", "rcl_interfaces"),
        *("rclpy", "rosgraph_msgs", "rosidl_parser"),
    ]


def needs_more(name, text):
    """Tells whether a module imports rclpy, or is of the ROS side, or imports of it."""
    inside = [n.module or "" for n in ast.walk(ast.parse(text)) if isinstance(n, ast.ImportFrom)]
    return (
        name.startswith("bridge/ros/")
        or "rclpy" in set(imported(text))
        or any({"ros", "rclpy"} & set(module.split(".")) for module in inside)
    )


def test_what_components_need_is_the_copy_alone(tmp_path, copies):
    share_runtime(tmp_path)
    names = [name for name, text in sorted(copies.items()) if not needs_more(name, text)]
    assert {
        "component/process.py", "component/component.py", "bridge/bridge.py", "services/events.py",
    } <= set(names)  # fmt: skip
    modules = [name.removesuffix(".py").replace("/", ".") for name in names]
    pure = [f"jausml_runtime.{name}".removesuffix(".__init__") for name in modules]
    # -I and -S: neither the environment nor site-packages; the checkout is not there either.
    script = (
        "import importlib, sys; sys.path.append(sys.argv[1])\n"
        "for name in sys.argv[2:]: importlib.import_module(name)\n"
        "print(sorted({name.split('.')[0] for name in sys.modules} & {'jausml', 'rclpy'}))\n"
    )
    done = run("-I", "-S", "-W", "error", "-c", script, tmp_path / "jausml_runtime", *pure, cwd="/")
    assert done.returncode == 0, done.stderr
    assert done.stdout == "[]\n"

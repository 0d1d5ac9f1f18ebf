"""What makes a folder an ament_python package: manifests, metadata, and a real installation."""

import configparser
import os
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import needs
import pytest
from for_each import for_each
from generated import model_of
from lxml import etree

from jausml.generation.errors import GenerationError
from jausml.generation.target import source_of, system_of
from jausml.language.model import read_models
from jausml_generators.python.package import PackageView, package_view
from jausml_generators.ros_node.target import TARGET as ROS_NODE
from jausml_generators.runtime.target import TARGET as RUNTIME

from .node_support import CASES, ROOT, artifacts, ros_environment, run, write

# REP 149: what a manifest of format 3 must have, and in what order schema-minded tools expect it.
ORDER = ("name", "version", "description", "maintainer", "license", "exec_depend", "test_depend")
ONCE = ("name", "version", "description", "export")
DEPENDENCIES = {
    "everything": [
        *("geometry_msgs", "jausml_runtime", "rcl_interfaces", "rclpy", "std_msgs", "std_srvs")
    ],
    "odometry": ["jausml_runtime", "nav_msgs", "rcl_interfaces", "rclpy", "std_msgs", "std_srvs"],
    "idle": ["jausml_runtime", "rclpy"],
    "features_bringup": [
        *("ament_index_python", "everything", "idle", "launch", "launch_ros", "odometry")
    ],
}


def manifest(text):
    return etree.fromstring(text.encode(), etree.XMLParser(resolve_entities=False))


def check_rep_149(root):
    """Checks the rules of REP 149 that need no network."""
    assert root.tag == "package"
    assert root.attrib == {"format": "3"}
    tags = [child.tag for child in root]
    assert tags == sorted(tags, key=[*ORDER, "export"].index)
    assert all(tags.count(tag) == 1 for tag in ONCE)
    assert re.fullmatch(r"[a-z](_?[a-z0-9]+)*", root.findtext("name"))
    assert re.fullmatch(r"\d+\.\d+\.\d+", root.findtext("version"))
    assert root.findtext("description").strip()
    for maintainer in root.findall("maintainer"):
        assert maintainer.text.strip()
        assert re.fullmatch(r"[^@\s]+@[^@\s]+\.[^@\s]+", maintainer.get("email"))
    assert root.findtext("license").strip()
    assert [child.tag for child in root.find("export")] == ["build_type"]
    assert root.findtext("export/build_type") == "ament_python"
    depends = [match.text for match in root.findall("exec_depend")]
    assert depends == sorted(set(depends))


@for_each("case", ["features", "hostile", "talk", "hosts", "one_host"])
def test_package_xml_obeys_rep_149(case):
    files = [
        artifact for path, artifact in artifacts(case).items() if path.endswith("/package.xml")
    ]
    assert files
    for file in files:
        root = manifest(file.text)
        check_rep_149(root)
        assert root.findtext("name") == file.path.split("/")[0]


@pytest.mark.parametrize("package", sorted(DEPENDENCIES))
def test_package_xml_names_what_the_package_needs(package):
    root = manifest(artifacts("features")[f"{package}/package.xml"].text)
    assert [match.text for match in root.findall("exec_depend")] == DEPENDENCIES[package]
    tests = [] if package.endswith("_bringup") else ["python3-pytest"]
    assert [match.text for match in root.findall("test_depend")] == tests
    assert root.findtext("version") == "1.2.3"
    assert root.findtext("maintainer") == "Maintainer"
    assert root.findtext("license") == "BSD-3-Clause"


def test_hostile_metadata_arrives_unchanged():
    root = manifest(artifacts("hostile")["victim/package.xml"].text)
    system = system_of(model_of(CASES / "hostile.xmi"))
    assert root.findtext("maintainer") == system.maintainer
    assert root.findtext("license") == system.license
    assert root.findtext("description") == next(iter(system.nodes)).documentation


@pytest.mark.parametrize("package", sorted(DEPENDENCIES))
def test_a_package_has_its_markers(package):
    files = artifacts("features")
    assert files[f"{package}/resource/{package}"].text == ""
    config = configparser.ConfigParser(interpolation=None)
    config.read_string(files[f"{package}/setup.cfg"].text)
    folder = f"$base/lib/{package}"
    assert dict(config["develop"]) == {"script_dir": folder}
    assert dict(config["install"]) == {"install_scripts": folder}
    is_python = not package.endswith("_bringup")
    assert (f"{package}/{package}/py.typed" in files) is is_python
    assert (f"{package}/{package}/__init__.py" in files) is is_python


@pytest.fixture(scope="module")
def workspace(tmp_path_factory):
    out = tmp_path_factory.mktemp("talk")
    write("talk", out, (ROS_NODE, RUNTIME))
    write("features", out / "features")
    return out


def install_as_colcon_does(package, prefix):
    command = ("-W", "ignore", "setup.py", "-q", "build", "--build-base", prefix / "build")
    command += ("install", "--prefix", prefix, "--record", prefix / "record")
    done = run(*command, "--single-version-externally-managed", cwd=package)
    assert done.returncode == 0, done.stdout + done.stderr
    return {
        Path(line).relative_to(prefix).as_posix()
        for line in (prefix / "record").read_text().splitlines()
    }


def test_installation_puts_files_where_ros_looks(workspace, tmp_path):
    files = install_as_colcon_does(workspace / "talker", tmp_path)
    assert "share/ament_index/resource_index/packages/talker" in files
    assert "share/talker/package.xml" in files
    assert "lib/talker/talker" in files
    modules = {name.split("site-packages/")[1] for name in files if "site-packages/talker/" in name}
    sources = ("__init__.py", "main.py", "py.typed", "talker.py", "talker_base.py")
    assert {name for name in modules if not name.endswith(".pyc")} == {
        f"talker/{name}" for name in sources
    }


def test_installation_of_launch_files_and_parameters(workspace, tmp_path):
    files = install_as_colcon_does(workspace / "features" / "features_bringup", tmp_path)
    share = {name for name in files if name.startswith("share/features_bringup/")}
    assert {name.removeprefix("share/features_bringup/") for name in share} - {
        name for name in share if name.endswith(".pyc")
    } == {
        "package.xml", "launch/features.launch.py", "config/everything.yaml",
        "config/Odometry.yaml", "config/idle.yaml", "security/everything.policy.xml",
        "security/Odometry.policy.xml", "security/idle.policy.xml",
    }  # fmt: skip


@pytest.mark.slow
def test_installation_of_the_runtime_has_its_subpackages(workspace, tmp_path):
    files = install_as_colcon_does(workspace / "jausml_runtime", tmp_path)
    installed = {
        name.split("site-packages/jausml_runtime/")[1]
        for name in files
        if "site-packages/jausml_runtime/" in name and name.endswith(".py")
    }
    copied = workspace / "jausml_runtime" / "jausml_runtime"
    assert installed == {path.relative_to(copied).as_posix() for path in copied.rglob("*.py")}
    assert "base/process.py" in installed


@pytest.mark.slow
def test_pip_installs_without_a_network(workspace, tmp_path):
    options = ("--no-deps", "--no-build-isolation", "--no-index", "--disable-pip-version-check")
    done = run("-m", "pip", "install", "-q", *options, "--target", tmp_path, workspace / "talker")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "bin" / "talker").is_file()
    assert (tmp_path / "share" / "talker" / "package.xml").is_file()


@pytest.mark.slow
@pytest.mark.live
def test_the_installed_script_starts_and_ends_by_a_signal(workspace, tmp_path):
    needs.ask("rclpy")
    files = install_as_colcon_does(workspace / "talker", tmp_path)
    (library,) = {name.split("/talker/")[0] for name in files if name.endswith("talker/main.py")}
    found = os.pathsep.join(map(str, (tmp_path / library, workspace / "jausml_runtime")))
    environment = ros_environment(PYTHONPATH=found)
    script = [sys.executable, str(tmp_path / "lib" / "talker" / "talker")]
    with subprocess.Popen(script, env=environment, stderr=subprocess.PIPE, text=True) as process:
        try:
            # The skeleton has no timer code yet and says so, which is the sign of life.
            line = process.stderr.readline()
            process.terminate()
            rest = process.communicate(timeout=30)[1]
        finally:
            process.kill()
    assert "on_timer is not implemented" in line
    assert process.returncode == 0, line + rest
    assert "Traceback" not in rest


def test_a_view_may_replace_what_the_system_says():
    package = PackageView("p", "element", "source", "text", "1.0.0", "m", "m@example.com", "MIT")
    assert package.test_dependencies == ("python3-pytest",)
    files = artifacts("features", RUNTIME)
    root = manifest(files["jausml_runtime/package.xml"].text)
    assert root.findtext("license") == "Apache-2.0"
    assert root.findtext("version") != "1.2.3"
    assert root.findtext("maintainer") == "jausml"  # of no model: all of a workspace share it


def test_the_source_is_named_without_its_folder():
    assert source_of(model_of(CASES / "talk.xmi")) == "talk.xmi"


def test_a_workspace_is_made_of_exactly_one_system():
    library = read_models([ROOT / "models" / "library" / "ros" / "std_msgs.xmi"]).model
    with pytest.raises(GenerationError, match="holds no system, where one is needed"):
        system_of(library)
    # The system of another file is referred to, and has a workspace of its own.
    both = read_models([CASES / "talk.xmi", CASES / "hosts.xmi"]).model
    assert system_of(both).name == "talk"


def test_what_the_users_code_needs_joins_the_dependencies():
    system = SimpleNamespace(
        version="1.0.0", maintainer="m", maintainerEmail="m@example.com", license="MIT"
    )
    element = SimpleNamespace(dependencies=["zlib", "catvehicle", "rclpy"])
    view = package_view(
        system,
        "node",
        dependencies=("std_msgs", "rclpy"),
        element=element,
        element_id="node:node",
        source="model.xmi",
        description="A node.",
    )
    assert view.dependencies == ("catvehicle", "rclpy", "std_msgs", "zlib")

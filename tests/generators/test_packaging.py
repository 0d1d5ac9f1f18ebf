"""Generated packages as colcon, rosdep and bloom read them, by the library that all three use."""

import ast
import sys
from pathlib import Path

import pytest
from catkin_pkg.package import parse_package
from catkin_pkg.topological_order import topological_order
from generated import model_of

from jausml.generation.target import load_targets
from jausml.generation.workspace import generate

MODELS = Path(__file__).resolve().parents[2] / "models"
EXAMPLES = [MODELS / "catvehicle" / "catvehicle.xmi", MODELS / "examples" / "winch" / "winch.xmi"]


@pytest.fixture(scope="module", params=EXAMPLES, ids=lambda path: path.stem)
def workspace(request, tmp_path_factory):
    out = tmp_path_factory.mktemp(request.param.stem)
    targets = [target for target in load_targets().values() if not target.is_on_request]
    generate(model_of(request.param), targets, out)
    return out


def packages(workspace):
    return {path.parent: parse_package(str(path)) for path in workspace.glob("*/package.xml")}


def test_each_package_is_valid_without_a_warning(workspace):
    found = packages(workspace)
    assert {folder.name for folder in found} == {package.name for package in found.values()}
    for package in found.values():
        warnings: list[str] = []
        package.validate(warnings=warnings)
        assert warnings == []
        assert package.get_build_type() in ("ament_python", "ament_cmake")


def test_no_package_waits_for_itself(workspace):
    names = [package.name for _, package in topological_order(str(workspace))]
    assert sorted(names) == sorted(package.name for package in packages(workspace).values())


def test_what_is_imported_is_depended_on(workspace):
    for folder, package in packages(workspace).items():
        known = {exec_depend.name for exec_depend in package.exec_depends} | {package.name}
        unknown = imports(folder / package.name) - known
        assert unknown <= set(sys.stdlib_module_names), package.name


def imports(folder):
    """Returns the first names of the modules that a package imports, of itself apart."""
    found = set()
    for path in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                found |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.level == 0:
                found.add(node.module.partition(".")[0])
    return found

"""Each folder of code is a package: what is left of one that moved would be imported as well."""

import sys
from pathlib import Path

import grimp
import pytest
from scripts import ran
from sources import PACKAGES, ROOT

GUARDS = ("pyproject.toml",)

PAGES = ("templates", "page", "__pycache__")
"""Folders of what is no code."""


def test_each_folder_of_modules_says_what_it_is():
    silent = [
        str(folder)
        for package in PACKAGES.values()
        for folder in {path.parent for path in package.rglob("*.py")}
        if not set(folder.parts) & set(PAGES)
        if not (folder / "__init__.py").is_file()
        or not (folder / "__init__.py").read_text(encoding="utf-8").startswith('"""')
    ]
    assert silent == []


def test_no_folder_holds_more_modules_than_one_can_look_over():
    known = {"cli": 61, "semantics": 44, "editing": 26, "bridge": 25}
    crowded = {
        folder.name: len(modules)
        for package in PACKAGES.values()
        for folder in [package, *(path for path in package.rglob("*") if path.is_dir())]
        if len(modules := [path for path in folder.glob("*.py") if path.stem != "__init__"]) > 24
    }
    assert {name: count for name, count in crowded.items() if count > known.get(name, 24)} == {}


@pytest.mark.skipif(sys.version_info < (3, 11), reason="needs Python 3.11")
def test_the_wheel_takes_the_data_of_each_package():
    import tomllib

    told = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"][
        "setuptools"
    ]
    folders = {"jausml": "jausml", **told["package-dir"]}
    taken = set()
    for name, place in folders.items():
        for folder in {
            ROOT / place,
            *(path.parent for path in (ROOT / place).rglob("__init__.py")),
        }:
            package = ".".join([name, *folder.relative_to(ROOT / place).parts])
            for pattern in (*told["package-data"].get(package, ()), *told["package-data"]["*"]):
                taken.update(folder.glob(pattern))
    listed = ran(["git", "ls-files", "-z", *folders.values()], cwd=ROOT).stdout.split("\0")
    data = {Path(ROOT, path) for path in listed if path and not path.endswith(".py")}
    # Of a skeleton beside its model the modules are enough: who generates it gets the rest.
    lost = {datum for datum in data if datum.is_file() and "src" not in datum.parts} - taken
    assert data
    assert lost == set()


# -- imports of types included ---------------------------------------------------------------------


def circles():
    """All groups of modules that import each other, directly or through others."""
    graph = grimp.build_graph(*PACKAGES, cache_dir=None)
    assert {module_name.partition(".")[0] for module_name in graph.modules} == set(PACKAGES)
    found = set()
    for module in graph.modules:
        others = graph.find_upstream_modules(module) & graph.find_downstream_modules(module)
        if others - {module}:
            found.add(frozenset({module} | others))
    return found


def test_there_are_no_circles():
    assert circles() == set()

"""The shipped library is found and read in one place, once for all threads."""

import ast
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from threading import Event

import pytest
from click.testing import CliRunner

import jausml
import jausml_generators
from jausml.cli.authoring.new_parts import component, node, service
from jausml.language import project as of_library
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.model.library import has_package, library_paths, library_root, module_of

GUARDS = ("jausml", "generators")
SOURCES = [Path(module_type.__file__).parent for module_type in (jausml, jausml_generators)]
WALKS = frozenset({"rglob", "glob", "walk", "iterdir", "scandir"})
HOME = "jausml/language/model/library.py"


def test_all_threads_get_the_same_library(monkeypatch):
    """Elements of two readings of it know nothing of each other."""
    second = Event()
    read = []

    def reading(*_):
        read.append(object())
        if len(read) > 1:
            second.set()
        second.wait(0.2)
        return read[-1]

    monkeypatch.setattr(of_library, "_library", cache(reading))
    with ThreadPoolExecutor(4) as threads:
        found = list(threads.map(lambda _: of_library.library(), range(4)))
    assert found == read * 4


@pytest.mark.parametrize(
    ("verb", "arguments"),
    [(component, ["rover", "--provides", "Management"]), (service, ["Sonar"]), (node, ["camera"])],
)
def test_parts_are_added_without_reading_the_ready_maps(verb, arguments, monkeypatch, tmp_path):
    asked = set()
    real = of_library._library

    def reading(kind, suffixes):
        asked.add(suffixes)
        return real(kind, suffixes)

    monkeypatch.setattr(of_library, "_library", reading)
    done = CliRunner().invoke(verb, [*arguments, "-m", str(tmp_path / "model.xmi")])
    assert done.exit_code == 0, done.output
    assert asked <= {(".xmi",)}


def test_the_library_without_maps_has_all_services():
    whole, parts = of_library.library(), of_library.library(with_maps=False)
    services = [[instance.urn for instance in of.instances(jaus.Service)] for of in (whole, parts)]
    assert services[0] == services[1]
    assert whole.instances(bridge.AttributeMap)
    assert not parts.instances(bridge.AttributeMap)


@pytest.mark.parametrize(
    ("kind", "has", "has_not"),
    [("jaus", jaus.Service, ros.MessageType), ("ros", ros.MessageType, jaus.Service)],
)
def test_a_folder_of_it_is_read_alone(kind, has, has_not):
    model = of_library.library(kind)
    assert model.instances(has)
    assert not model.instances(has_not)
    assert model is of_library.library(kind)


def test_its_files_by_kind_and_their_names():
    every = library_paths()
    assert every == tuple(sorted(every))
    assert set(library_paths("ros")) < set(every)
    assert {library_path.parent.name for library_path in library_paths("ros")} == {"ros"}
    assert module_of(library_root() / "jaus" / "mobility.xmi") == "jaus.mobility"
    assert has_package("geometry_msgs")
    assert not has_package("abyss_msgs")
    assert not has_package("")


def walks_of_the_library(path):
    """Yields the lines of functions that ask for the library and look into folders."""
    text = path.read_text(encoding="utf-8")
    tree = ast.parse(text if "library_root" in text else "")
    for function in ast.walk(tree):
        if isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef):
            names = {
                syntax.id if isinstance(syntax, ast.Name) else syntax.attr
                for syntax in ast.walk(function)
                if isinstance(syntax, ast.Name | ast.Attribute)
            }
            if "library_root" in names and names & WALKS:
                yield function.lineno


@pytest.mark.slow
def test_nobody_else_looks_into_its_folders():
    files = [path for root in SOURCES for path in root.rglob("*.py")]
    found = {
        f"{file.as_posix()}:{line}"
        for file in files
        if not file.as_posix().endswith(HOME)
        for line in walks_of_the_library(file)
    }
    assert len(files) > 500
    assert found == set()


def test_a_walk_is_seen(tmp_path):
    path = tmp_path / "walking.py"
    path.write_text("def f():\n    return sorted(library_root().rglob('*.xmi'))\n", "utf-8")
    assert list(walks_of_the_library(path)) == [1]

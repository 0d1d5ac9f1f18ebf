"""What the tests of the editor share."""

import importlib.util
from pathlib import Path

import pytest

from jausml.authoring.editor.places import Place
from jausml.authoring.editor.workbench import Workbench
from jausml.language.project import library


@pytest.fixture(scope="session")
def library_bench():
    """A workbench that has read the library."""
    library()
    return Workbench()


@pytest.fixture
def bench(library_bench):
    """A workbench without open texts."""
    library_bench.texts.clear()
    yield library_bench
    for path in list(library_bench.texts):
        library_bench.forget(path)


@pytest.fixture
def at(bench, tmp_path):
    """Opens a text with a mark `¦`, and returns its file and the place of the mark."""

    def open_(text, name="robot.ros2jaus"):
        position = text.index("¦")
        path = tmp_path / name
        bench.texts[path] = text.replace("¦", "", 1)
        line = text.count("\n", 0, position) + 1
        return path, Place(line, position - text.rfind("\n", 0, position))

    return open_


@pytest.fixture(scope="session")
def client_class():
    """The client of the protocol."""
    file = Path(__file__).with_name("client.py")
    specification = importlib.util.spec_from_file_location("editor_client", file)
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module.Client

"""The package of a system's messages: each class once, and packages that name what they use."""

import ast
import re
from collections import Counter
from pathlib import Path

import pytest
from generated import STRICT, model_in, model_of, texts_of
from lxml import etree
from workspaces import python_path, write

from jausml.generation.rendering import render
from jausml_generators.bridge.target import TARGET as BRIDGES
from jausml_generators.jaus_component.target import TARGET as COMPONENTS
from jausml_generators.messages.target import TARGET as MESSAGES
from jausml_generators.ros_node.target import TARGET as NODES
from jausml_generators.runtime.target import TARGET as RUNTIME

from .node_support import CASES, ROOT, run

EXAMPLE = ROOT / "models" / "catvehicle" / "catvehicle.xmi"
NAMESAKES = """
service_set own {
  service Bell { urn: "urn:own:a:Bell"
    inputs: new message_def Ring { code: 0xD120 }, new message_def Stop { code: 0xD122 } }
  service bell { urn: "urn:own:b:Bell"
    inputs: new message_def Ring { code: 0xD121 }, new message_def Stop { code: 0xD122 } }
}
system yard {
  component tower { address: 1.1.1  provides: Bell }
  component desk { address: 1.1.2  provides: bell }
  component nothing { address: 1.1.3 }
}
"""


@pytest.fixture(scope="module")
def files():
    return texts_of(model_of(EXAMPLE), [BRIDGES, COMPONENTS, MESSAGES])


@pytest.fixture(scope="module")
def namesakes(tmp_path_factory):
    folder = tmp_path_factory.mktemp("namesakes")
    model = model_in(folder, NAMESAKES, "yard.ros2jaus")
    write(model, [COMPONENTS, MESSAGES, RUNTIME], folder / "src")
    return folder / "src"


def test_each_class_of_a_message_stands_once(files):
    names = Counter(
        name
        for text in files.values()
        for name in re.findall(r"^class (\w+)\((?:Stamped)?Message\)", text, re.M)
    )
    assert len(names) == 14
    assert set(names.values()) == {1}


def test_a_module_for_each_service(files):
    modules = [
        path for path in files if path.startswith("catvehicle_messages/catvehicle_messages/")
    ]
    assert [Path(path).name for path in modules] == [
        "__init__.py", "local_pose_sensor.py", "primitive_driver.py", "py.typed",
        "velocity_state_driver.py", "velocity_state_sensor.py",
    ]  # fmt: skip


def test_packages_depend_on_the_messages_that_they_use(files):
    def needs(package):
        root = etree.fromstring(files[f"{package}/package.xml"].encode())
        return {match.text for match in root.findall("exec_depend")}

    for package in ("vehicle", "bridge", "operator_control_unit"):
        assert {"catvehicle_messages", "jausml_runtime"} <= needs(package)
    assert needs("catvehicle_messages") == {"jausml_runtime"}


def test_a_package_names_what_it_uses_and_no_more(files):
    tree = ast.parse(files["vehicle/vehicle/messages.py"])
    modules = {node.module for node in tree.body if isinstance(node, ast.ImportFrom)}
    assert modules == {
        f"catvehicle_messages.{name}"
        for name in ("local_pose_sensor", "primitive_driver", "velocity_state_sensor")
    }


def test_messages_of_one_name_keep_it_where_they_are_used(namesakes):
    script = (
        "from tower.messages import Ring as first, Stop\n"
        "from desk.messages import Ring as second, Stop as same\n"
        "import nothing.messages\n"
        "assert (first.CODE, second.CODE) == (0xD120, 0xD121)\n"
        "assert Stop is same, 'defined twice, in one way'\n"
        "assert nothing.messages.__all__ == []\n"
    )
    done = run("-c", script, PYTHONPATH=python_path(namesakes))
    assert done.returncode == 0, done.stderr
    assert (namesakes / "yard_messages" / "yard_messages" / "bell_2.py").is_file()
    assert "yard_messages" not in (namesakes / "nothing" / "package.xml").read_text("utf-8")


@pytest.mark.slow
def test_the_package_is_clean(namesakes):
    path = python_path(namesakes)
    config = ("--config", ROOT / "pyproject.toml", "--no-cache")
    for place in ("tower/tower/messages.py", "nothing/nothing/messages.py", "yard_messages"):
        for check in (("format", "--check"), ("check",)):
            done = run("-m", "ruff", *check, *config, place, cwd=namesakes)
            assert done.returncode == 0, done.stdout
    modules = ("-m", "tower.messages", "-m", "desk.messages", "-m", "nothing.messages")
    mypy = ("-m", "mypy", *STRICT)
    done = run(*mypy, *modules, MYPYPATH=path)
    assert done.returncode == 0, done.stdout


def test_a_system_without_messages_has_no_such_package():
    assert render(model_of(CASES / "talk.xmi"), [MESSAGES, NODES])
    assert render(model_of(CASES / "talk.xmi"), [MESSAGES]) == []

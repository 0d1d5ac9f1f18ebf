"""The page on the core services: its code runs, and it names what there is."""

import re
from dataclasses import dataclass, fields
from pathlib import Path

import pytest

from jausml.runtime import ComponentSettings, Guard, JausComponent, ServiceIdentity
from jausml.runtime.base.address import JausAddress
from jausml.runtime.messages import SetAuthority

from .state_tables import CORE_NAMES, V1_1, core_services

PAGE = Path(__file__).parents[3] / "docs" / "how-to" / "core-services.md"


@pytest.fixture(scope="module")
def text():
    return PAGE.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def names(text):
    """What the page's code defines."""
    found = {}
    for block in re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        exec(block.replace("jausml_runtime", "jausml.runtime"), found)  # noqa: S102
    return found


def test_settings_and_methods_exist(text):
    settings = {field.name for field in fields(ComponentSettings)}
    for line in text.splitlines():
        for name in re.findall(r"^\| (.*?) \|", line):
            for term in re.findall(r"`(\w+)(?:\(.*?\))?`", name):
                assert term in settings or hasattr(JausComponent, term), term


def test_counters_exist(text):
    source = "".join(
        path.read_text(encoding="utf-8")
        for path in (PAGE.parents[2] / "jausml" / "runtime").rglob("*.py")
    )
    for name in re.findall(r"`(\w+\.\w+)`", text.split("## Counters")[1]):
        assert f'"{name}"' in source


def test_guard(names):
    @dataclass
    class Command:
        command_type: int

    assert [names["guard_of"](Command(kind)) for kind in range(2)] == [
        Guard.READY,
        Guard.CONTROLLED,
    ]


class Waypoint(SetAuthority):
    CODE = 0x040C
    NAME = "SetGlobalWaypoint"


class RaiseMast(SetAuthority):
    CODE = 0x1F00
    NAME = "RaiseMast"


def test_commands_and_lists(world, names, capsys):
    services = (
        *core_services(V1_1, *CORE_NAMES),
        ServiceIdentity("urn:jaus:jss:core:ListManager", 1, 1),
        ServiceIdentity("urn:jaus:jss:mobility:GlobalWaypointListDriver", 1, 0),
    )
    robot = world.component("1.1.1", kind=names["Mast"], services=services)
    robot.handle(RaiseMast, robot.on_raise_mast, when=Guard.READY)
    robot.start()
    operator = world.started("2.1.1", services=())
    operator.control(robot.address, authority=100)
    world.settle()
    names["drive_round"](operator, JausAddress(1, 1, 1), [Waypoint(1), Waypoint(2)], RaiseMast())
    world.settle()
    assert len(robot.elements) == 2
    assert robot.elements.circular
    assert capsys.readouterr().out == ""
    robot.step(2.1)
    world.settle()
    assert capsys.readouterr().out == "arrived: True\n"

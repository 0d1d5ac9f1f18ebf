"""Random commands on models of several files, in both notations, that refer to each other."""

import random
from pathlib import Path

import pytest
from generated import model_of
from hypothesis import settings
from random_commands import Commands

from jausml.authoring.editing.commands import EditError, Move, Remove, Rename
from jausml.authoring.editing.project import Project
from jausml.language.model.library import LIBRARY_URI
from jausml.language.text.writing.unparsing import to_text

WINCH = Path("models/examples/winch")
SEEDS = max(4, settings().max_examples // 10)
OUR_FAULTS = ("something else", "do not go together", "cannot be read")


@pytest.fixture
def folder(tmp_path):
    """A service set in XMI, and a system that uses it: in XMI in a folder below, and as text."""
    (tmp_path / "below").mkdir()
    service = (WINCH / "service.xmi").read_text(encoding="utf-8")
    (tmp_path / "service.xmi").write_text(service.replace("../../library/", LIBRARY_URI))
    system = (WINCH / "winch.xmi").read_text(encoding="utf-8")
    system = system.replace("../../library/", LIBRARY_URI)
    beside = tmp_path / "winch.xmi"
    beside.write_text(system)
    model = model_of(beside)
    (tmp_path / "text.ros2jaus").write_text(
        to_text([model.root], model, tmp_path / "text.ros2jaus")
    )
    (tmp_path / "below" / "winch.xmi").write_text(system.replace('"service', '"../service'))
    beside.unlink()
    return tmp_path


def contents(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("seed", range(SEEDS))
def test_references_follow_over_files_and_undo_gives_the_same_bytes(folder, seed):
    before = contents(folder)
    project = Project(folder)
    chance = random.Random(seed)
    several = 0
    for _ in range(8):
        commands = Commands(project, "service.xmi", chance)
        kinds = ("Service", "MessageDef", "ServiceSet")
        commands.own = [element for element in commands.own if element.eClass.name in kinds]
        command = chance.choice([commands.rename, commands.move, commands.remove, commands.add])()
        if command is None:
            continue
        try:
            several += len(project.do([command], "any").files) > 1
        except EditError as error:
            if any(our_fault in str(error) for our_fault in OUR_FAULTS):
                raise
    while project.undo():
        pass
    assert contents(folder) == before


def test_a_text_and_an_xmi_file_follow_what_they_refer_to(folder):
    project = Project(folder)
    message = "service.xmi#Winch.ReportWinchState"
    entry = project.do([Rename(message, "ReportState")], "rename")
    assert entry.files == ("service.xmi", "text.ros2jaus")
    text = (folder / "text.ros2jaus").read_text()
    assert "ReportState" in text
    assert "ReportWinchState" not in text
    found = {referrer.element.partition("#")[0] for referrer in project.referrers(message)}
    assert {"text.ros2jaus", "below/winch.xmi"} <= found
    removed = project.do([Remove(message)], "remove")
    assert set(removed.files) == {"service.xmi", "text.ros2jaus", "below/winch.xmi"}
    assert not any(project.model(file.path).has_errors for file in project.files)


def test_what_moves_between_owners_is_found_by_all(folder):
    project = Project(folder)
    owner = "service.xmi#Winch"
    project.do([Move("service.xmi#Winch.ReportWinchState", owner, "inputs", 0)], "move")
    assert not any(project.model(file.path).has_errors for file in project.files)


def test_the_root_of_a_file_holds_what_it_refers_to_as_validation_does(tmp_path):
    (tmp_path / ".git").mkdir()
    (tmp_path / "other").mkdir()
    for name, text in {
        "robot/lib/services.ros2jaus": "system lib {\n}\n",
        "robot/sys/two.ros2jaus": 'import "../lib/services.ros2jaus"\nsystem two {\n}\n',
        "robot/sys/one.ros2jaus": "system one {\n}\n",
    }.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    project = Project(tmp_path / "robot" / "sys" / "two.ros2jaus")
    assert (project.root, project.opened) == (tmp_path / "robot", "sys/two.ros2jaus")
    assert not project.model(project.opened).diagnostics
    # Nothing wider than it needs.
    assert Project(tmp_path / "robot" / "sys" / "one.ros2jaus").root == tmp_path / "robot" / "sys"

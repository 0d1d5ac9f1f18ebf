"""Commands that meet a change beneath them: planned again by element, or given back."""

import fcntl
import os
import threading
from pathlib import Path

import pytest

from jausml.authoring.editing.commands import EditError, Place, Remove, Rename, Set
from jausml.authoring.editing.project import Project
from jausml.language.metamodel.classes import jaus

FILE = "boat.ros2jaus"
TEXT = """\
component helm { address: 1.1.1 }
component winch { address: 1.1.2 }
component sounder { address: 1.1.3 }
"""


@pytest.fixture
def project(tmp_path: Path) -> Project:
    (tmp_path / FILE).write_text(TEXT, encoding="utf-8")
    return Project(tmp_path)


def text(project: Project) -> str:
    return (project.root / FILE).read_text(encoding="utf-8")


def save(project: Project, new: str) -> None:
    (project.root / FILE).write_text(new, encoding="utf-8")


def component(project: Project, name: str) -> jaus.Component:
    found = project.model(FILE).model.instances(jaus.Component, library=False)
    return next(candidate for candidate in found if candidate.name == name)


def ref(project: Project, name: str) -> str:
    return project.ref(component(project, name), project.model(FILE).model)


def documented(project: Project, name: str, words: str = "said") -> Set:
    return Set(ref(project, name), "documentation", (words,))


def test_two_projects_change_different_elements_and_keep_both(project):
    other = Project(project.root)
    first = Rename(ref(project, "helm"), "rudder")
    second = Rename(ref(other, "winch"), "crane")
    project.do([first], "one", project.revision)
    other.do([second], "two", other.revision)
    assert "component rudder" in text(project)
    assert "component crane" in text(project)
    # The other one is told of what it met, and may take both back.
    assert [change.file for change in other.refresh()] == [FILE]
    other.undo()
    other.undo()
    assert text(project) == TEXT


@pytest.mark.parametrize("told", [True, False], ids=["told", "met"])
def test_a_command_finds_its_element_where_positions_have_shifted(project, *, told):
    base, command = project.revision, documented(project, "winch")
    save(project, f"component anchor {{ address: 1.1.9 }}\n{TEXT}")
    if told:
        project.refresh([FILE])
    project.do([command], "say", base)
    assert component(project, "winch").documentation == "said"
    assert text(project).count("said") == 1


def test_what_both_have_changed_is_given_back_and_can_be_insisted_on(project):
    base, command = project.revision, Set(ref(project, "winch"), "address", ("1.1.77",))
    changed = TEXT.replace("1.1.2", "1.1.55")
    save(project, changed)
    with pytest.raises(EditError, match=r"address of .*winch.* to 1\.1\.55") as caught:
        project.do([command], "address", base)
    assert caught.value.conflict
    assert text(project) == changed
    project.do([command], "address", base, is_first=False)
    assert text(project) == TEXT.replace("1.1.2", "1.1.77")


@pytest.mark.parametrize("make", [Remove, lambda reference: Rename(reference, "x")])
def test_what_is_gone_or_has_another_name_is_given_back(project, make):
    base, command = project.revision, make(ref(project, "winch"))
    changed = TEXT.replace("winch", "crane")
    save(project, changed)
    with pytest.raises(EditError, match=r"winch.* is gone or has another name") as caught:
        project.do([command], "change", base)
    assert caught.value.conflict
    assert text(project) == changed


def test_what_somebody_has_worked_on_is_not_removed(project):
    base, command = project.revision, Remove(ref(project, "winch"))
    changed = TEXT.replace("1.1.2 }", "1.1.2  provides: VelocityStateSensor }")
    save(project, f"import jaus.mobility\n{changed}")
    with pytest.raises(EditError, match=r"winch.* was changed meanwhile") as caught:
        project.do([command], "remove", base)
    assert caught.value.conflict


def test_what_has_no_name_is_found_by_what_it_is_or_not_at_all(tmp_path):
    model = (
        '<?xml version="1.0" encoding="UTF-8"?>\n<system:System xmi:version="2.0"'
        ' xmlns:xmi="http://www.omg.org/XMI" xmlns:system="http://www.jausml.org/system/1.0"'
        ' name="robot">\n  <nodes namespace="a"/>\n  <nodes namespace="b"/>\n</system:System>\n'
    )
    path = tmp_path / "robot.xmi"
    path.write_text(model, encoding="utf-8")
    project = Project(tmp_path)
    command = Set("robot.xmi#//@nodes.1", "documentation", ("said",))
    path.write_text(model.replace("  <nodes", '  <nodes namespace="c"/>\n  <nodes', 1))
    project.do([command], "say", 0)
    assert '<nodes documentation="said" namespace="b"/>' in path.read_text()
    with pytest.raises(EditError, match="gone or has another name"):
        project.do([Set("robot.xmi#//@nodes.2", "documentation", ("x",))], "say", 0)
    path.write_text(model.replace('"b"', '"z"'))
    with pytest.raises(EditError, match="gone or has another name") as caught:
        project.do([command], "say", 0)
    assert caught.value.conflict


def test_adding_moving_and_placing_follow_their_owners(project):
    base = project.revision
    winch, sounder = ref(project, "winch"), ref(project, "sounder")
    commands = [
        Set(winch, "controls", (sounder,)),
        Place(FILE, "system", {"component:winch": (4, 5)}),
    ]
    save(project, f"component anchor {{ address: 1.1.9 }}\n{TEXT}")
    project.do(commands, "control", base)
    assert [control.name for control in component(project, "winch").controls] == ["sounder"]
    assert project.positions(FILE, "system") == {"component:winch": (4, 5)}


def test_an_edit_of_a_file_that_cannot_be_read_is_a_conflict(project):
    base, command = project.revision, documented(project, "winch")
    broken = TEXT.replace("winch {", "winch {{{ ??")
    save(project, broken)
    with pytest.raises(EditError, match="cannot be parsed") as caught:
        project.do([command], "say", base)
    assert caught.value.conflict
    assert text(project) == broken
    # When it can be read again it is done after all, wherever its element stands now.
    save(project, f"component anchor {{ address: 1.1.9 }}\n{TEXT}")
    project.refresh()
    project.do([command], "say", base)
    assert component(project, "winch").documentation == "said"


def test_undo_of_what_others_did_is_followed_too(project):
    save(project, f"component anchor {{ address: 1.1.9 }}\n{TEXT}")
    project.refresh()
    base, command = project.revision, documented(project, "winch")
    project.undo()
    project.do([command], "say", base)
    assert component(project, "winch").documentation == "said"


def test_projects_that_write_at_once_lose_nothing(project):
    projects = [project, Project(project.root)]
    owners = ("helm", "winch")
    faults: list[Exception] = []

    def work(own: Project, owner: str) -> None:
        try:
            for number in range(12):
                base = own.revision
                own.do([documented(own, owner, f"{owner} {number}")], "say", base)
        except Exception as error:
            faults.append(error)

    threads = [
        threading.Thread(target=work, args=pair) for pair in zip(projects, owners, strict=True)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(timeout=60)
    assert faults == []
    found = Project(project.root)
    assert [component(found, owner).documentation for owner in owners] == ["helm 11", "winch 11"]


def test_a_program_that_holds_the_folder_is_not_waited_for_forever(project, monkeypatch):
    monkeypatch.setattr("jausml.authoring.editing.reading._PATIENCE", 0.05)
    held = os.open(project.root, os.O_RDONLY)
    fcntl.flock(held, fcntl.LOCK_EX)
    with pytest.raises(EditError, match="for too long") as caught:
        project.do([documented(project, "helm")], "say")
    assert caught.value.conflict
    os.close(held)
    project.do([documented(project, "helm")], "say")


def test_a_preview_is_of_the_elements_that_were_meant(project):
    base, command = project.revision, Remove(ref(project, "winch"))
    save(project, f"component anchor {{ address: 1.1.9 }}\n{TEXT}")
    project.refresh()
    assert "-component winch" in project.preview([command], base).diff

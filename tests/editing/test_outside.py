"""Files that other programs change, delete or break; writes that are cut off."""

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from jausml.authoring.editing.commands import Add, Create, EditError, Place, Remove, Rename, Set
from jausml.authoring.editing.project import Project

MODEL = """\
<?xml version="1.0" encoding="UTF-8"?>
<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"\
 xmlns:system="http://www.jausml.org/system/1.0" name="robot">
  <nodes name="driver"/>
</system:System>
"""
OTHER = MODEL.replace("driver", "pilot")
BROKEN = MODEL.replace("<nodes", "<nodes <")
NODE = "robot.xmi#//@nodes.0"


@pytest.fixture
def project(tmp_path):
    (tmp_path / "robot.xmi").write_text(MODEL)
    return Project(tmp_path)


def save(project, text):
    (project.root / "robot.xmi").write_text(text)


def text(project):
    return (project.root / "robot.xmi").read_text()


def node(project):
    return project.model("robot.xmi").model.root.nodes[0]


def test_what_another_program_saves_is_taken_over_and_can_be_undone(project):
    save(project, OTHER)
    (change,) = project.refresh(["robot.xmi"])
    assert '+  <nodes name="pilot"/>' in change.diff
    assert (node(project).name, project.log[-1].is_outside) == ("pilot", True)
    project.undo()
    assert text(project) == MODEL


def test_what_the_project_wrote_itself_is_no_news(project):
    project.do([Rename(NODE, "pilot")], "rename")
    assert project.refresh(["robot.xmi"]) == ()
    assert project.refresh() == ()
    assert len(project.log) == 1


def test_what_was_just_saved_is_not_overwritten(project):
    save(project, OTHER)
    with pytest.raises(EditError) as caught:
        project.do([Rename(NODE, "captain")], "rename")
    assert caught.value.conflict
    assert text(project) == OTHER
    project.do([Rename(NODE, "captain")], "rename")
    assert text(project) == MODEL.replace("driver", "captain")


@pytest.mark.parametrize(
    "edit",
    [
        Rename(NODE, "captain"),
        Remove(NODE),
        Add("robot.xmi#/", "nodes", "ros.Node", {"name": ("cook",)}),
    ],
)
def test_a_program_that_has_not_seen_the_last_edit_makes_a_conflict(project, edit):
    project.do([edit], "edit")
    done = text(project)
    noted = MODEL.replace("<system", "<!-- a note -->\n<system")
    save(project, noted)
    [change] = project.refresh()
    assert change.is_conflict
    # What it did stands in the file, what was done here in the history.
    assert text(project) == noted
    project.undo()
    assert text(project) == done


def test_a_program_that_goes_on_from_the_last_edit_makes_none(project):
    project.do([Rename(NODE, "captain")], "rename")
    save(project, text(project).replace('"robot"', '"rover"'))
    assert [change.is_conflict for change in project.refresh()] == [False]
    save(project, MODEL)
    assert [change.is_conflict for change in project.refresh()] == [False]


def test_a_program_that_has_both_lines_has_seen_the_last_edit(project):
    project.do([Rename(NODE, "pilot")], "rename")
    both = '<nodes name="driver"/>\n  <nodes name="pilot"/>'
    save(project, MODEL.replace('<nodes name="driver"/>', both))
    (change,) = project.refresh()
    assert not change.is_conflict


def test_undoing_over_a_change_that_nobody_told_is_refused(project):
    project.do([Rename(NODE, "captain")], "rename")
    save(project, OTHER)
    with pytest.raises(EditError) as caught:
        project.undo()
    assert caught.value.conflict
    assert text(project) == OTHER
    labels = [entry.label for entry in (project.undo(), project.undo())]
    assert labels == ["robot.xmi was changed by another program", "rename"]
    assert text(project) == MODEL


def test_a_command_for_an_older_revision_finds_its_element(project):
    added = Add("robot.xmi#/", "nodes", "ros.Node", {"name": ("a",)}, position=0)
    project.do([added], "add")
    project.do([Rename(NODE, "pilot")], "rename", base=0)
    names = [model_node.name for model_node in project.model("robot.xmi").model.root.nodes]
    assert names == ["a", "pilot"]
    project.undo()
    project.undo()
    project.do([Rename("robot.xmi#//@nodes.1", "captain")], "rename", base=1)
    assert node(project).name == "captain"
    project.do([Remove(NODE)], "remove", base=0)
    with pytest.raises(EditError, match="gone") as caught:
        project.do([Rename(NODE, "again")], "rename", base=0)
    assert caught.value.conflict


def test_a_command_for_what_another_program_has_changed_since_is_a_conflict(project):
    save(project, OTHER)
    project.refresh()
    with pytest.raises(EditError) as caught:
        project.do([Remove(NODE)], "remove", base=0)
    assert caught.value.conflict
    project.do([Remove(NODE)], "remove", base=project.revision)
    assert "pilot" not in text(project)


def test_a_broken_file_keeps_its_last_model_and_is_never_overwritten(project):
    save(project, BROKEN)
    project.refresh(["robot.xmi"])
    assert [file.is_stale for file in project.files] == [True]
    result = project.model("robot.xmi")
    assert (result.model.root.nodes[0].name, result.has_errors) == ("driver", True)
    assert "JML004" in [diagnostic.rule for diagnostic in result.diagnostics]
    with pytest.raises(EditError, match="fix"):
        project.do([Rename(NODE, "x")], "rename")
    assert text(project) == BROKEN
    save(project, OTHER)
    project.refresh(["robot.xmi"])
    assert [file.is_stale for file in project.files] == [False]
    assert node(project).name == "pilot"


@pytest.mark.parametrize("data", [b"", b"\xff\xfe\x00", b"<<<<<<< ours\n", BROKEN.encode()])
def test_a_file_that_was_broken_from_the_start_is_left_alone(tmp_path, data):
    (tmp_path / "robot.xmi").write_bytes(data)
    project = Project(tmp_path)
    assert project.model("robot.xmi").has_errors
    with pytest.raises(EditError):
        project.do([Rename(NODE, "x")], "rename")
    assert (tmp_path / "robot.xmi").read_bytes() == data
    (tmp_path / "robot.xmi").write_text(BROKEN)
    project.refresh()
    assert [diagnostic.rule for diagnostic in project.model("robot.xmi").diagnostics] == ["JML004"]
    (tmp_path / "robot.xmi").write_text(MODEL)
    project.refresh()
    project.do([Rename(NODE, "x")], "rename")
    assert node(project).name == "x"


def test_a_file_that_was_deleted_comes_back_by_undo(project):
    (project.root / "robot.xmi").unlink()
    assert [change.file for change in project.refresh()] == ["robot.xmi"]
    assert project.files == ()
    project.undo()
    assert text(project) == MODEL


def test_files_that_come_are_found(project):
    (project.root / "sub").mkdir()
    (project.root / "sub" / "new.xmi").write_text(OTHER)
    (project.root / ".hidden.xmi").write_text(OTHER)
    (project.root / "link.xmi").symlink_to("/etc/passwd")
    assert [change.file for change in project.refresh()] == ["sub/new.xmi"]
    assert [file.path for file in project.files] == ["robot.xmi", "sub/new.xmi"]
    assert project.refresh(["../elsewhere.xmi", "link.xmi", ".hidden.xmi"]) == ()


def test_what_leads_out_of_the_folder_or_is_no_file_is_left_alone(project, tmp_path_factory):
    outside = tmp_path_factory.mktemp("outside")
    (outside / "other.xmi").write_text(OTHER)
    (project.root / "sub").symlink_to(outside)
    (project.root / "other.xmi").symlink_to(outside / "other.xmi")
    (project.root / "robot.layout.json").symlink_to(outside / "layout.json")
    os.mkfifo(project.root / "pipe.xmi")
    assert [file.path for file in Project(project.root).files] == ["robot.xmi"]
    for command in (
        Create("sub/new.xmi", "system.System", {}),
        Set("other.xmi#/", "name", ("x",)),
        Place("robot.xmi", "system", {"node:driver": (1, 2)}),
    ):
        with pytest.raises(EditError):
            project.do([command], "out")
    assert [path.name for path in outside.iterdir()] == ["other.xmi"]
    assert (outside / "other.xmi").read_text() == OTHER


def test_nothing_of_two_files_is_written_when_one_cannot_be(project):
    (project.root / "sub").mkdir()
    other = project.root / "sub" / "other.xmi"
    other.write_text(MODEL.replace('name="driver"', 'name="x"'))
    project.refresh()
    other.unlink()
    (project.root / "sub").rmdir()
    (project.root / "sub").write_text("in the way")
    commands = [Rename(NODE, "a"), Rename("sub/other.xmi#//@nodes.0", "b")]
    with pytest.raises(EditError):
        project.do(commands, "both")
    assert text(project) == MODEL


def test_threads_take_turns(project):
    def rename(number):
        for count in range(5):
            project.do([Set(NODE, "documentation", (f"{number} {count}",))], "set")

    threads = [threading.Thread(target=rename, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(project.log) == 20
    while project.undo():
        pass
    assert text(project) == MODEL


WRITER = """
import sys
from jausml.authoring.editing.commands import Set
from jausml.authoring.editing.project import Project
project = Project(sys.argv[1])
print("ready", flush=True)
while True:
    for text in ("old", "new" * 100_000):
        project.do([Set("robot.xmi#//@nodes.0", "documentation", (text,))], "set")
"""


def test_a_writer_that_is_killed_leaves_a_whole_file(project):
    old = MODEL.replace('"driver"', '"driver" documentation="old"')
    new = MODEL.replace('"driver"', f'"driver" documentation="{"new" * 100_000}"')
    for pause in range(3):
        command = [sys.executable, "-c", WRITER, str(project.root)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as writer:
            assert writer.stdout.readline() == "ready\n"
            first = text(project)
            # Killed in the midst of some write, a different one each time.
            for _ in range(2000 * pause):
                if text(project) != first:
                    break
            os.kill(writer.pid, signal.SIGKILL)
        assert text(project) in (MODEL, old, new)
    left = [path.name for path in Path(project.root).iterdir() if path.name != "robot.xmi"]
    assert all(name.startswith(".") for name in left)
    assert [file.path for file in Project(project.root).files] == ["robot.xmi"]

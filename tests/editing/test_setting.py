"""Setting of attributes in XMI: the edit and nothing else changes in the file."""

from __future__ import annotations

import pytest

from jausml.authoring.editing.commands import EditError, Set
from jausml.authoring.editing.project import Project

MODEL = """\
<?xml version="1.0" encoding="UTF-8"?>
<!-- ours -->
<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"\
 xmlns:system="http://www.jausml.org/system/1.0" name='robot'>
  <components name="arm"   address='1.1.1'/>  <!-- the arm -->
  <nodes
      name="driver"
      documentation="It drives."/>
</system:System>
"""


@pytest.fixture
def project(tmp_path):
    path = tmp_path / "robot.xmi"
    path.write_bytes(MODEL.encode())
    return Project(path)


def text(project):
    data = (project.root / "robot.xmi").read_bytes()
    assert data == project.text("robot.xmi")
    return data.decode()


def test_a_value_keeps_its_quotation_marks(project):
    project.do([Set("robot.xmi#//@components.0", "address", ("2.1.1",))], "address")
    assert text(project) == MODEL.replace("'1.1.1'", "'2.1.1'")
    project.do([Set("robot.xmi#/", "name", ('it\'s "new" & <best>',))], "name")
    assert "name='it&apos;s \"new\" &amp; &lt;best>'>" in text(project)


def test_a_new_value_stands_where_the_metamodel_has_it(project):
    project.do([Set("robot.xmi#//@components.0", "documentation", ("An arm.",))], "say what")
    wanted = MODEL.replace('name="arm"  ', 'name="arm" documentation="An arm."  ')
    assert text(project) == wanted


def test_a_value_that_goes_takes_its_whitespace(project):
    project.do([Set("robot.xmi#//@nodes.0", "documentation", ())], "say nothing")
    assert text(project) == MODEL.replace('\n      documentation="It drives."', "")


def test_a_value_that_stands_there_is_no_edit(project):
    entry = project.do([Set("robot.xmi#//@nodes.0", "name", ("driver",))], "nothing")
    assert (entry.number, project.log, project.revision) == (0, (), 0)


def test_what_was_done_is_undone_and_done_again(project):
    first = project.do([Set("robot.xmi#/", "name", ("one",))], "one")
    second = project.do([Set("robot.xmi#/", "name", ("another",))], "two")
    after = text(project)
    assert (project.undo(), project.undo(), project.undo()) == (second, first, None)
    assert text(project) == MODEL
    assert (project.redo(), project.redo(), project.redo()) == (first, second, None)
    assert text(project) == after


def test_what_is_no_value_is_refused(project):
    with pytest.raises(EditError, match="address"):
        project.do([Set("robot.xmi#//@components.0", "address", ("here",))], "address")
    assert text(project) == MODEL


def test_a_preview_changes_nothing(project):
    preview = project.preview([Set("robot.xmi#/", "name", ("other",))])
    assert "+<system:System" in preview.diff
    assert text(project) == MODEL

"""Setting of attributes in XMI: the edit changes a file as Eclipse lays it out, and no more."""

import pytest

from jausml.authoring.editing.commands import EditError, Rename, Set
from jausml.authoring.editing.project import Project

MODEL = """\
<?xml version="1.0" encoding="UTF-8"?>
<!-- ours -->
<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"\
 xmlns:system="http://www.jausml.org/system/1.0" name="robot">
  <components name="arm" address="1.1.1"/>  <!-- the arm -->
  <nodes name="driver" documentation="It drives."/>
</system:System>
"""
NODE = "robot.xmi#//@nodes.0"


@pytest.fixture
def project(tmp_path):
    path = tmp_path / "robot.xmi"
    path.write_bytes(MODEL.encode())
    return Project(path)


def text(project):
    data = (project.root / "robot.xmi").read_bytes()
    assert data == project.text("robot.xmi")
    return data.decode()


def test_a_value_is_escaped(project):
    project.do([Set("robot.xmi#//@components.0", "address", ("2.1.1",))], "address")
    assert text(project) == MODEL.replace("1.1.1", "2.1.1")
    project.do([Set("robot.xmi#/", "name", ('it\'s "new" & <best>',))], "name")
    assert 'name="it\'s &quot;new&quot; &amp; &lt;best>">' in text(project)


def test_a_new_value_stands_where_the_metamodel_has_it(project):
    project.do([Set("robot.xmi#//@components.0", "documentation", ("An arm.",))], "say what")
    assert text(project) == MODEL.replace('name="arm"', 'name="arm" documentation="An arm."')


def test_a_value_may_go(project):
    project.do([Set("robot.xmi#//@nodes.0", "documentation", ())], "say nothing")
    assert text(project) == MODEL.replace(' documentation="It drives."', "")


@pytest.mark.parametrize("command", [Set(NODE, "name", ("helm",)), Rename(NODE, "helm")])
def test_what_has_no_name_gets_it_as_an_attribute(tmp_path, command):
    named = MODEL.replace("driver", "helm")
    (tmp_path / "robot.xmi").write_bytes(named.replace(' name="helm"', "").encode())
    project = Project(tmp_path)
    project.do([command], "name it")
    assert text(project) == named


@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
def test_the_first_edit_lays_a_file_out_and_says_so(tmp_path, line_end):
    loose = MODEL.replace(' name="driver"', "\n      name='driver'").replace("\n", line_end)
    (tmp_path / "robot.xmi").write_bytes(loose.encode())
    project = Project(tmp_path)
    address = Set("robot.xmi#//@components.0", "address", ("2.1.1",))
    assert project.do([address], "set address").label == "set address, and format robot.xmi"
    assert text(project) == MODEL.replace("1.1.1", "2.1.1").replace("\n", line_end)
    again = Set("robot.xmi#//@components.0", "address", ("3.1.1",))
    assert project.do([again], "set address").label == "set address"
    project.undo()
    project.undo()
    assert text(project) == loose


def test_what_was_not_read_stays_as_it_is_written(tmp_path):
    """A reference that leads nowhere, a value that is none and an unknown feature are kept."""
    odd = (
        MODEL.replace(
            ' address="1.1.1"/>  <!-- the arm -->',
            """ address="here">
    <provides href="gone.xmi#//@services.0"/>
    <wheels size="2">
      <!-- round -->
      <tyre/>
    </wheels>
  </components>""",
        )
        .replace("<!-- ours -->\n", "")
        .replace("<nodes name", '<nodes colour="red" name')
    )
    (tmp_path / "robot.xmi").write_text(odd)
    project = Project(tmp_path)
    entry = project.do([Set("robot.xmi#/", "name", ("other",))], "name")
    assert text(project) == odd.replace('name="robot"', 'name="other"')
    assert entry.label == "name"


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

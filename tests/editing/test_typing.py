"""What is typed: written as it is, read as far as it goes, and undone by what was typed at once."""

import math

import pytest

from jausml.authoring.editing.commands import EditError, Rename, Set
from jausml.authoring.editing.project import Project
from jausml.authoring.editing.splices import common_ends

FILE = "robot.ros2jaus"
TEXT = "component arm { address: 1.1.1 }\n"


@pytest.fixture
def project(tmp_path):
    (tmp_path / FILE).write_text(TEXT)
    return Project(tmp_path)


def names(project):
    return [component.name for component in project.model(FILE).model.root.components]


def write(project, text):
    return project.write_text(FILE, text, project.revision)


def test_what_is_typed_is_written_and_read(project):
    write(project, TEXT + "component leg { address: 1.1.2 }\n")
    assert (project.root / FILE).read_text() == TEXT + "component leg { address: 1.1.2 }\n"
    assert names(project) == ["arm", "leg"]


def test_a_broken_text_is_written_and_its_model_stays(project):
    write(project, TEXT + "component leg {")
    assert (project.root / FILE).read_text() == TEXT + "component leg {"
    assert names(project) == ["arm"]
    assert [(file.is_stale, file.is_dirty) for file in project.files] == [(True, True)]
    with pytest.raises(EditError, match="fix it first"):
        project.do([Set(f"{FILE}#//@components.0", "address", ("1.1.9",))], "edit")
    write(project, TEXT + "component leg {}")
    assert names(project) == ["arm", "leg"]
    assert [file.is_stale for file in project.files] == [False]


def test_what_is_typed_without_a_pause_is_one_entry(project):
    project.typing_pause = math.inf
    for end in range(1, 8):
        entry = write(project, TEXT + "// done"[:end])
    assert (entry.number, len(project.log)) == (1, 1)
    project.do([Set(f"{FILE}#//@components.0", "address", ("1.1.9",))], "edit")
    write(project, TEXT)
    assert len(project.log) == 3
    project.undo()
    project.undo()
    project.undo()
    assert (project.root / FILE).read_text() == TEXT
    project.redo()
    assert (project.root / FILE).read_text() == TEXT + "// done"
    # What follows an undo is an entry of its own.
    project.undo()
    write(project, TEXT + "// else")
    project.undo()
    assert (project.root / FILE).read_text() == TEXT


def test_a_pause_begins_another_entry(project):
    project.typing_pause = -1.0
    write(project, TEXT + "//")
    write(project, TEXT + "// a")
    assert len(project.log) == 2


def test_a_text_that_others_changed_is_not_overwritten(project):
    base = project.revision
    project.do([Set(f"{FILE}#//@components.0", "address", ("1.1.9",))], "edit")
    with pytest.raises(EditError) as found:
        project.write_text(FILE, TEXT + "// mine", base)
    assert found.value.conflict
    (project.root / FILE).write_text("component other {}\n")
    with pytest.raises(EditError) as found:
        write(project, TEXT + "// mine")
    assert found.value.conflict
    assert (project.root / FILE).read_text() == "component other {}\n"


def test_line_ends_and_mark_stay(project, tmp_path):
    data = b"\xef\xbb\xbfcomponent arm {}\r\nnode n\r\n"
    (tmp_path / FILE).write_bytes(data)
    project.refresh()
    write(project, "component arm {}\nnode n\n// more\n")
    assert (tmp_path / FILE).read_bytes() == data + b"// more\r\n"
    entry = write(project, "component arm {}\nnode n\n// more\n")
    assert entry.number == 0


def test_half_a_character_is_refused(project):
    with pytest.raises(EditError, match="U\\+D800"):
        write(project, "// \ud800")
    assert (project.root / FILE).read_text() == TEXT


def test_xmi_is_not_typed(tmp_path):
    (tmp_path / "a.xmi").write_text("<a/>")
    with pytest.raises(EditError, match="is no text"):
        Project(tmp_path).write_text("a.xmi", "<b/>", 0)


# -- what two texts have in common -----------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new", "ends"),
    [("abcd", "abxd", (2, 1)), ("aa", "a", (1, 0)), ("", "ab", (0, 0)), ("ab", "ab", (2, 0))],
)
def test_common_ends_never_overlap(old, new, ends):
    assert common_ends(old, new) == ends


def test_no_edit_loses_what_cannot_be_parsed(project):
    """In a text that was so from the start, and in one that has to follow a new name."""
    broken = TEXT.replace("{", "{ to JAUS { }")
    (project.root / FILE).write_text(broken)
    with pytest.raises(EditError, match="fix it first"):
        Project(project.root).do([Set(f"{FILE}#//@components.0", "address", ("1.1.9",))], "edit")
    assert (project.root / FILE).read_text() == broken
    using = f'import "{FILE}"\ncomponent leg {{ provides: Walking }}\n'
    (project.root / FILE).write_text('service_set legs { service Walking { urn: "urn:a:b:W" } }\n')
    (project.root / "leg.ros2jaus").write_text(using)
    project = Project(project.root)
    project.write_text("leg.ros2jaus", f"{using}// half\ncomponent {{", project.revision)
    with pytest.raises(EditError, match=r"leg\.ros2jaus .* fix it first"):
        project.do([Rename(f"{FILE}#//@services.0", "Running")], "rename")
    assert (project.root / "leg.ros2jaus").read_text().endswith("// half\ncomponent {")

"""Workspaces of which files are replaced: their tests see the replaced ones, and only these."""

import sys

import pytest

from jausml.mutating.broken_workspace import BrokenWorkspace

GUARDS = ("jausml/mutating",)

CODE, TEST = "lamp/lamp/code.py", "lamp/test/test_code.py"
FILES = {
    "lamp/lamp/__init__.py": "",
    CODE: '"""Lamp."""\n\nVALUE = 1\nOTHER = 1\n',
    TEST: "from lamp.code import VALUE\n\n\ndef test_value():\n    assert VALUE == 1\n",
    "lamp/package.xml": "<package/>\n",
    "figures/figures/__init__.py": "FIGURE = 1\n",
    "rest/rest/__init__.py": "",
    "rest/test/test_rest.py": "def test_rest():\n    import rest\n",
}


@pytest.fixture(autouse=True, scope="module")
def no_plugins():
    """Loads no plugins for the tests of packages, as in a campaign: it takes long."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
        yield


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """A folder, and the workspace in it whose tests pass: whatever is replaced comes back."""
    folder = tmp_path_factory.mktemp("lamp")
    made = BrokenWorkspace(folder, FILES)
    assert made.sound() == {}
    return folder, made


@pytest.fixture
def workspace(sound):
    """That workspace."""
    return sound[1]


def noticed(workspace, **changed):
    """Returns what fails with the code of the lamp, or other files, changed."""
    files = {**FILES, CODE: changed.pop("code", FILES[CODE]), **changed}
    return workspace.failing(files, workspace.differing(files))


def test_a_test_that_fails_is_named(workspace):
    # The text has the same size and comes within the same second.
    assert "test_value" in noticed(workspace, code=FILES[CODE].replace("VALUE = 1", "VALUE = 2"))
    assert noticed(workspace) == ""


def test_what_no_test_sees_survives(workspace):
    assert noticed(workspace, code=FILES[CODE].replace("OTHER = 1", "OTHER = 2")) == ""


def test_files_are_as_before_afterwards(sound):
    folder, workspace = sound
    noticed(workspace, code="VALUE = 2\n", **{"lamp/lamp/more.py": "MORE = 1\n"})
    assert (folder / CODE).read_text() == FILES[CODE]
    assert not (folder / "lamp" / "lamp" / "more.py").exists()


def test_a_file_that_is_gone_is_noticed(workspace):
    files = {path: text for path, text in FILES.items() if path != CODE}
    assert workspace.differing(files) == [CODE]
    assert workspace.failing(files, [CODE]) == "ERROR test/test_code.py"


def test_a_process_that_ends_is_noticed(workspace):
    assert noticed(workspace, code=f"import os\n{FILES[CODE]}os._exit(3)\n") == "ended with 3"


def test_tests_stay_those_of_what_is_not_broken(workspace):
    files = {**FILES, TEST: "def test_nothing():\n    pass\n"}
    assert workspace.differing(files) == []


def test_why_no_test_can_see_a_change(workspace):
    assert "no Python code" in workspace.why_unseen(["lamp/package.xml"])
    assert workspace.why_unseen([CODE]) == ""
    assert workspace.why_unseen(["figures/figures/__init__.py"]) == ""  # for all may import it


@pytest.mark.parametrize(
    "text", [FILES[CODE].replace("Lamp.", "A lamp."), f"# lamp\n{FILES[CODE]}"]
)
def test_comments_and_docstrings_are_no_difference(workspace, text):
    assert workspace.differing({**FILES, CODE: text}) == []


def test_a_text_that_is_a_value_is_a_difference(workspace):
    text = FILES[CODE].replace("VALUE = 1", 'VALUE = "1"')
    assert workspace.differing({**FILES, CODE: text}) == [CODE]


def test_tests_that_fail_without_a_mutation_say_nothing(tmp_path):
    files = {**FILES, "rest/test/test_rest.py": "def test_rest():\n    assert False\n"}
    made = BrokenWorkspace(tmp_path, files)
    assert list(made.sound()) == ["rest"]
    assert made.packages == ["lamp"]


COMMAND = [sys.executable, "-c", "from lamp.code import OTHER; assert OTHER == 1, 'not lit'"]


def refused(folder, text, command=COMMAND):
    """Returns what a command says of another code of the lamp."""
    made = BrokenWorkspace(folder, FILES, command)
    assert made.sound_command() == ""
    return made.refusing({**FILES, CODE: text}, [CODE])


def test_a_command_notices_what_no_test_sees(tmp_path):
    text = FILES[CODE].replace("OTHER = 1", "OTHER = 2")
    assert refused(tmp_path, text) == "AssertionError: not lit"
    assert refused(tmp_path, FILES[CODE]) == ""
    assert (tmp_path / CODE).read_text() == FILES[CODE]


def test_a_command_is_told_the_folder(tmp_path):
    path = f"os.environ['JAUSML_WORKSPACE'] + '/{CODE}'"
    command = [sys.executable, "-c", f"import os; assert 'VALUE = 1' in open({path}).read()"]
    assert refused(tmp_path, "VALUE = 2\n", command) == "AssertionError"


def test_a_command_that_fails_without_a_mutation_says_nothing(tmp_path):
    made = BrokenWorkspace(tmp_path, FILES, [sys.executable, "-c", "raise SystemExit('no robot')"])
    assert made.sound_command() == "no robot"
    assert made.refusing({**FILES, CODE: "VALUE = 2\n"}, [CODE]) == ""


def test_a_command_that_cannot_begin(tmp_path):
    made = BrokenWorkspace(tmp_path, FILES, [str(tmp_path)])
    assert "Permission denied" in made.sound_command()

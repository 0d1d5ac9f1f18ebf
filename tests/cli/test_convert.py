"""`jausml convert`: what it writes, what it says, and what it leaves alone."""

import os
import stat

import pytest

from jausml.language.metamodel import load_metamodels
from jausml.language.model import read_models
from jausml.language.model.comparison import compare
from jausml.language.text.notation import NOTATIONS


def root(path):
    result = read_models([path], notations=NOTATIONS)
    assert not result.has_errors, result.diagnostics
    return result.model.root


def test_xmi_becomes_text_and_xmi_again_with_readable_ids(jausml, folder):
    done = jausml("convert", "good.xmi", "good.ros2jaus")
    assert done.exit_code == 0
    assert done.stdout == ""
    assert done.stderr.startswith("good.ros2jaus: 1 root, ")
    assert done.stderr.endswith(" elements, written\n")
    assert "http" not in (folder / "good.ros2jaus").read_text(encoding="utf-8")
    assert jausml("convert", "good.ros2jaus", "back.xmi").exit_code == 0
    differences = compare(root(folder / "good.xmi"), root(folder / "back.xmi"), load_metamodels())
    assert differences == []
    assert not [path for path in folder.iterdir() if "tmp" in path.name]
    (bridge,) = root(folder / "good.xmi").bridges
    written = (folder / "back.xmi").read_text(encoding="utf-8")
    assert f'map="{bridge.maps[0].name}"' in written
    assert f'<maps xmi:id="{bridge.maps[0].name}"' in written


def test_a_file_that_differs_is_overwritten_by_force_alone(jausml, refused, folder):
    out = folder / "out.ros2jaus"
    out.write_text("precious", encoding="utf-8")
    refused("--force", "convert", "good.xmi", "out.ros2jaus")
    assert out.read_text(encoding="utf-8") == "precious"
    assert jausml("convert", "good.xmi", "out.ros2jaus", "--force").exit_code == 0
    assert "precious" not in out.read_text(encoding="utf-8")
    before = out.stat().st_mtime_ns
    done = jausml("convert", "good.xmi", "out.ros2jaus")
    assert done.exit_code == 0
    assert "unchanged" in done.stderr
    assert out.stat().st_mtime_ns == before


@pytest.mark.parametrize("target", ["good.xmi", "./good.xmi", "link.xmi"])
def test_the_source_is_never_overwritten(refused, folder, target):
    (folder / "link.xmi").symlink_to(folder / "good.xmi")
    before = (folder / "good.xmi").read_bytes()
    refused("is the file to convert", "convert", "good.xmi", target, "--force")
    assert (folder / "good.xmi").read_bytes() == before


def test_errors_are_placed_and_nothing_is_written(jausml, folder):
    path = folder / "broken.xmi"
    text = (folder / "good.xmi").read_text(encoding="utf-8")
    path.write_text(text.replace("<topics ", "<topicz "), encoding="utf-8")
    done = jausml("convert", "broken.xmi", "out.ros2jaus")
    assert done.exit_code == 1
    line = 1 + text[: text.index("<topics ")].count("\n")
    assert f"broken.xmi:{line}:" in done.stdout
    assert "nothing written" in done.stderr
    assert not (folder / "out.ros2jaus").exists()


def test_text_with_errors_is_placed_and_nothing_is_written(jausml, folder):
    (folder / "bad.ros2jaus").write_text("bridge a {\n  adress: 1.1.1\n", encoding="utf-8")
    done = jausml("convert", "bad.ros2jaus", "out.xmi")
    assert done.exit_code == 1
    assert "bad.ros2jaus:2:3: error" in done.stdout
    assert not (folder / "out.xmi").exists()


@pytest.mark.usefixtures("folder")
def test_models_that_break_rules_are_converted(jausml):
    """Who turns a draft into text wants to fix it there."""
    assert jausml("validate", "bad.xmi").exit_code == 1
    assert jausml("convert", "bad.xmi", "bad.ros2jaus").exit_code == 0


def test_comments_that_stay_behind_are_counted(jausml, folder):
    (folder / "a.ros2jaus").write_text(
        '// one\n/** Kept. */\nhost here { /* "two */ port: 3795 interface: "//" } // three\n',
        encoding="utf-8",
    )
    done = jausml("convert", "a.ros2jaus", "a.xmi")
    assert done.exit_code == 0
    assert "a.ros2jaus: warning: 3 comments stay behind" in done.stderr
    assert 'documentation="Kept."' in (folder / "a.xmi").read_text(encoding="utf-8")
    assert "comment" not in jausml("convert", "a.ros2jaus", "a.xmi", "-q").stderr


def test_xmi_keeps_its_ids(jausml, folder):
    assert jausml("convert", "good.xmi", "copy.xmi").exit_code == 0
    ids = [
        [part.split('"')[0] for part in (folder / name).read_text().split('xmi:id="')[1:]]
        for name in ("good.xmi", "copy.xmi")
    ]
    assert ids[0] == ids[1]
    assert ids[0]


def test_references_to_text_are_told_and_imports_lead_to_the_same_files(jausml, folder):
    (folder / "hosts.ros2jaus").write_text("host here { port: 3795 }", encoding="utf-8")
    (folder / "robot.ros2jaus").write_text(
        'import "hosts.ros2jaus"\nplacement { host: here }', encoding="utf-8"
    )
    done = jausml("convert", "robot.ros2jaus", "robot.xmi")
    assert done.exit_code == 0
    assert "refers to hosts.ros2jaus, which Eclipse cannot read" in done.stderr
    (folder / "deeper").mkdir()
    assert jausml("convert", "robot.ros2jaus", "deeper/robot.ros2jaus").exit_code == 0
    text = (folder / "deeper" / "robot.ros2jaus").read_text(encoding="utf-8")
    assert text == 'import "../hosts.ros2jaus"\n\nplacement { host: here }\n'
    assert jausml("convert", "deeper/robot.ros2jaus", "deeper/robot.xmi").exit_code == 0
    assert root(folder / "deeper" / "robot.xmi").placements[0].host.name == "here"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["absent.xmi", "a.ros2jaus"], "absent.xmi"),
        (["good.xmi", "a.txt"], "must end with .xmi or .ros2jaus"),
        ([".", "a.ros2jaus"], "is a folder"),
        (["good.xmi", "nowhere/a.ros2jaus"], "nowhere"),
        (["good.xmi", "taken.ros2jaus"], "is no file"),
    ],
)
def test_faults_of_use_are_told(refused, folder, arguments, message):
    (folder / "taken.ros2jaus").mkdir()
    refused(message, "convert", *arguments)


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="permissions of POSIX")
def test_a_folder_that_cannot_be_written(refused, folder):
    locked = folder / "locked"
    locked.mkdir()
    locked.chmod(stat.S_IRUSR | stat.S_IXUSR)
    refused("cannot write locked/a.ros2jaus", "convert", "good.xmi", "locked/a.ros2jaus")

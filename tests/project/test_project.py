"""What a project is: its folder, the root of references, and its model files."""

import os

import pytest

from jausml.language.metamodel.classes import jaus, ros
from jausml.language.model.library import library_root
from jausml.language.model.project import (
    InputError,
    find_project_root,
    is_model_file,
    made_project,
    model_files,
    project_folder,
)
from jausml.language.project import Index, Models, index_around, own_instances
from jausml.language.text.notation import NOTATIONS


def touch(*paths):
    for path in paths:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("", encoding="utf-8")


@pytest.mark.parametrize(
    ("marks", "project", "root", "made"),
    [
        ([".project"], "", "", ""),
        ([".git/HEAD"], "", "", None),
        # The project is a part of the checkout, to whose other parts it may refer.
        ([".git/HEAD", "a/.project"], "a", "", "a"),
        # A project above a checkout is another one.
        ([".project", "a/.git/HEAD"], "a", "a", None),
        ([".project", "a/b/.project"], "a/b", "a/b", "a/b"),
    ],
)
def test_its_folder_and_the_root_of_references(tmp_path, marks, project, root, made):
    file = tmp_path / "a" / "b" / "robot.xmi"
    touch(file, *(tmp_path / mark for mark in marks))
    assert project_folder(file) == tmp_path / project
    assert find_project_root([file]) == tmp_path / root
    assert made_project(file.parent) == (None if made is None else tmp_path / made)


def test_a_file_alone_is_in_no_project(tmp_path):
    touch(tmp_path / "robot.xmi")
    assert project_folder(tmp_path / "robot.xmi") is None
    assert made_project(tmp_path) is None


def test_its_model_files(tmp_path):
    outside = tmp_path / "outside.xmi"
    root = tmp_path / "root"
    mine = [root / "b.xmi", root / "models" / "a.ros2jaus"]
    left = [
        *(root / folder / "x.xmi" for folder in (".hidden", "build", "install", "log")),
        *(root / folder / "x.xmi" for folder in ("node_modules", "__pycache__")),
        root / ".x.xmi",
        root / "notes.txt",
    ]
    touch(outside, *mine, *left)
    (root / "linked.xmi").symlink_to(outside)
    (root / "inside.xmi").symlink_to(root / "b.xmi")
    os.mkfifo(root / "pipe.xmi")
    copy = root / "library" / "jaus" / "mobility.xmi"
    touch(copy)
    copy.write_bytes((library_root() / "jaus" / "mobility.xmi").read_bytes())
    assert list(model_files(root)) == ["b.xmi", "inside.xmi", "models/a.ros2jaus"]
    copy.write_bytes(copy.read_bytes() + b"\n")
    assert is_model_file("library/jaus/mobility.xmi", root)
    assert is_model_file("new.xmi", root)
    assert not is_model_file("../outside.xmi", root)


# -- the index of a project ------------------------------------------------------------------------


PACKAGE = """\
<?xml version="1.0" encoding="UTF-8"?>
<ros:InterfacePackage xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"\
 xmlns:ros="http://www.jausml.org/ros/1.0" name="{name}_msgs">
  <messages name="Tank"/>
</ros:InterfacePackage>
"""
SYSTEM = 'import "a.xmi"\nsystem robot { node sonar { } }\n'


@pytest.fixture
def root(tmp_path):
    """A project of a system that imports one of two packages, and of a broken text."""
    (tmp_path / ".project").write_text("", encoding="utf-8")
    (tmp_path / "robot.ros2jaus").write_text(SYSTEM, encoding="utf-8")
    for name in ("a", "b"):
        (tmp_path / f"{name}.xmi").write_text(PACKAGE.format(name=name), encoding="utf-8")
    (tmp_path / "broken.ros2jaus").write_text("map_library {{{\n", encoding="utf-8")
    return tmp_path


def packages(models):
    return [package.name for package in own_instances(models, ros.InterfacePackage)]


def test_own_comes_before_the_rest_of_the_project(root):
    index = Index(root)
    assert packages([index.model("robot.ros2jaus")]) == ["a_msgs"]
    both = [index.model("robot.ros2jaus"), index.beside("robot.ros2jaus")]
    assert packages(both) == ["a_msgs", "b_msgs"]
    # Each counts once, although the file beside it is read with the package too.
    assert packages([index.model("b.xmi"), index.beside("b.xmi")]) == ["b_msgs", "a_msgs"]
    assert not own_instances(both, jaus.Service)


def test_what_has_not_changed_is_not_read_again(root):
    models = Models(root, NOTATIONS)
    first = Index(root, models=models)
    before = first.model("robot.ros2jaus"), first.beside("robot.ros2jaus")
    again = Index(root, models=models)
    assert (again.model("robot.ros2jaus"), again.beside("robot.ros2jaus")) == before
    (root / "b.xmi").write_text(PACKAGE.format(name="c"), encoding="utf-8")
    changed = Index(root, models=models)
    assert changed.model("robot.ros2jaus") is before[0]
    assert packages([changed.beside("robot.ros2jaus")])[-1] == "c_msgs"


def test_what_an_editor_holds_counts(root):
    held = {**Index(root).contents, "b.xmi": PACKAGE.format(name="held").encode()}
    assert "held_msgs" in packages([Index(root, held).beside("robot.ros2jaus")])


@pytest.mark.parametrize(
    "text",
    [
        "system robot { }\n",
        "bridge b { address: 100.1.1 }\n",
        "  component c { address: 100.1.1 }\n",
    ],
)
def test_the_only_system(root, text):
    (root / "robot.ros2jaus").write_text(text, encoding="utf-8")
    assert Index(root).only_system() == root / "robot.ros2jaus"
    (root / "other.ros2jaus").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"name one \(other.ros2jaus, robot.ros2jaus\)"):
        Index(root).only_system()


def test_a_project_without_a_system_says_what_makes_one(root):
    (root / "robot.ros2jaus").unlink()
    with pytest.raises(InputError, match=r"no model in .* has a system: name one, or make"):
        Index(root).only_system()


def test_around_a_folder_and_here(root, monkeypatch, tmp_path_factory):
    (root / "deep").mkdir()
    assert index_around(root / "deep").root == root
    monkeypatch.chdir(root / "deep")
    assert Index.here().root == root
    apart = tmp_path_factory.mktemp("apart")
    assert index_around(apart).root == apart
    monkeypatch.chdir(apart)
    assert Index.here() is None

"""What a project is: its folder, the root of references, and its model files."""

import os

import pytest

from jausml.language.model.library import library_root
from jausml.language.model.project import (
    find_project_root,
    is_model_file,
    made_project,
    model_files,
    project_folder,
)


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

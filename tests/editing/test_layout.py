"""The layout file: readable differences, bad ones do no harm, boxes keep their place."""

import json

import pytest

from jausml.authoring.editing.commands import Add, Place, Remove, Rename
from jausml.authoring.editing.layout import read_layout, write_layout
from jausml.authoring.editing.project import Project

MODEL = """\
<?xml version="1.0" encoding="UTF-8"?>
<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"\
 xmlns:system="http://www.jausml.org/system/1.0" name="robot">
  <nodes name="driver"/>
  <nodes name="logger"/>
</system:System>
"""


@pytest.fixture
def project(tmp_path):
    (tmp_path / "robot.xmi").write_text(MODEL)
    project = Project(tmp_path)
    boxes = {"node:logger": (30, 40), "node:driver": (-10, 20)}
    project.do([Place("robot.xmi", "system", boxes)], "place")
    return project


def test_a_box_is_a_line(project):
    data = (project.root / "robot.layout.json").read_text()
    assert data == (
        '{\n  "views": {\n    "system": {\n      "node:driver": [-10, 20],\n'
        '      "node:logger": [30, 40]\n    }\n  }\n}\n'
    )
    assert project.log[-1].files == ("robot.layout.json",)
    project.do([Place("robot.xmi", "system", {"node:driver": None, "node:logger": None})], "forget")
    assert not (project.root / "robot.layout.json").exists()
    assert project.positions("robot.xmi", "system") == {}
    project.undo()
    assert (project.root / "robot.layout.json").read_text() == data


def test_a_renamed_box_keeps_its_place_and_one_that_went_leaves_none(project):
    entry = project.do([Rename("robot.xmi#//@nodes.1", "recorder")], "rename")
    assert entry.files == ("robot.layout.json", "robot.xmi")
    assert project.positions("robot.xmi", "system") == {
        "node:recorder": (30, 40),
        "node:driver": (-10, 20),
    }
    project.do([Remove("robot.xmi#//@nodes.0")], "remove")
    assert project.positions("robot.xmi", "system") == {"node:recorder": (30, 40)}
    project.undo()
    project.undo()
    assert project.positions("robot.xmi", "system")["node:logger"] == (30, 40)
    project.do([Add("robot.xmi#/", "nodes", "ros.Node", {"name": ("n",)}, position=0)], "add")
    assert project.positions("robot.xmi", "system")["node:logger"] == (30, 40)


@pytest.mark.parametrize(
    "content",
    [
        "",
        "<<<<<<< ours\n",
        "[]",
        '{"views": []}',
        '{"views": {"system": 3}}',
        "[" * 100_000,
        '{"views": {"system": {"node:driver": [1, NaN], "node:logger": [1]}}}',
        '{"views": {"system": {"node:driver": [1, 1e300], "node:logger": [true, 2]}}}',
        '{"views": {"system": {"node:driver": [10000000000, 0], "node:logger": "here"}}}',
        "\x00\xff",
    ],
)
def test_a_bad_file_places_nothing_and_stops_nobody(project, content):
    path = project.root / "robot.layout.json"
    path.write_bytes(content.encode("latin-1"))
    project.refresh(["robot.layout.json"])
    assert project.positions("robot.xmi", "system") == {}
    project.do([Place("robot.xmi", "system", {"node:driver": (1, 2)})], "place")
    assert project.positions("robot.xmi", "system") == {"node:driver": (1, 2)}
    assert json.loads(path.read_text())
    project.undo()
    assert path.read_bytes() == content.encode("latin-1")


def test_what_is_written_is_read_again():
    layout = {'map:a "b"': {"x/ü:\ud800": (1, -2)}, "system": {}}
    assert read_layout(write_layout(layout)) == {'map:a "b"': {"x/ü:\ud800": (1, -2)}}

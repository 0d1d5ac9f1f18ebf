"""Copies of elements: described, and pasted in either notation under names that are free."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from jausml.editing.commands import Create, EditError
from jausml.editing.describing import free_name
from jausml.editing.project import Project
from jausml.metamodel.filling import contents
from jausml.model import read_models
from jausml.model.comparison import Policy, compare
from jausml.model.xmi.writer import write_model
from jausml.text.notation import NOTATIONS

EXAMPLE = Path(__file__).parents[2] / "models" / "examples" / "catvehicle"
NAMES = Policy(ignored=frozenset({"name"}))
FILES = ("catvehicle.xmi", "catvehicle.ros2jaus")


@pytest.fixture
def project(tmp_path):
    folder = tmp_path / "catvehicle"
    shutil.copytree(EXAMPLE, folder)
    model = read_models([folder / FILES[1]], notations=NOTATIONS).model
    write_model(model.documents[0].roots, model, folder / FILES[0])
    return Project(folder)


def own(project, file, name):
    model = project.model(file).model
    return next(each for each in model.root.eAllContents() if getattr(each, "name", "") == name)


@pytest.mark.parametrize("target", FILES)
@pytest.mark.parametrize("source", FILES)
@pytest.mark.parametrize("name", ["vehicle", "velocity_controller", "velocity_state", "onboard"])
def test_a_copy_holds_the_same(project, source, target, name):
    model = project.model(source).model
    original = own(project, source, name)
    commands = project.describe([project.ref(original, model)])
    before = (project.root / target).read_bytes()
    owner = own(project, target, "bridge") if name == "velocity_state" else None
    there = project.model(target).model
    ref = project.ref(owner or there.root, there)
    entry = project.paste(commands, ref, "paste")
    obj, found = project.find(entry.created[0])
    assert obj.name == f"{name}_2"
    assert compare(own(project, source, name), obj, found.metamodels, NAMES) == []
    project.undo()
    assert (project.root / target).read_bytes() == before


def test_copies_refer_to_each_other(project):
    model = project.model("catvehicle.ros2jaus").model
    bridge = own(project, "catvehicle.ros2jaus", "bridge")
    chosen = [bridge.maps[0], bridge.bridgeConnections[0]]
    commands = project.describe([project.ref(each, model) for each in chosen])
    assert commands[1].values["map"] == ("new:0",)
    # What stands beside is as good as the owner itself.
    entry = project.paste(commands, project.ref(bridge.maps[2], model), "paste")
    copied = project.find(entry.created[1])[0]
    assert (copied.name, copied.map.name) == ("odometry_2", "velocity_state_2")


def test_a_copy_goes_into_a_new_file(project):
    project.do([Create("other.ros2jaus", "system.System", {"name": ("other",)})], "create")
    model = project.model("catvehicle.xmi").model
    component = own(project, "catvehicle.xmi", "vehicle")
    commands = project.describe([project.ref(component, model)])
    entry = project.paste(commands, "other.ros2jaus#/", "paste")
    copied = project.find(entry.created[0])[0]
    assert copied.name == "vehicle"
    assert [
        each.name
        for each in contents(copied, model.metamodels.class_of(copied).features["provides"])
    ] == [each.name for each in component.provides]


def test_what_has_no_place_is_refused(project):
    model = project.model("catvehicle.xmi").model
    node = own(project, "catvehicle.xmi", "odometry")
    commands = project.describe([project.ref(node, model)])
    with pytest.raises(EditError, match="has no place in catvehicle"):
        project.paste(commands, "catvehicle.xmi#/", "paste")


def test_free_names():
    assert free_name("a", set()) == "a"
    assert free_name("a", {"a"}) == "a_2"
    assert free_name("a_2", {"a", "a_2", "a_3"}) == "a_4"
    assert free_name("speed10", {"speed10"}) == "speed_11"

"""Copies of elements: described, and pasted in either notation under names that are free."""

import itertools
import shutil
from pathlib import Path

import pytest
from generated import model_of
from sweeps import sweep

from jausml.authoring.editing.commands import Create, EditError, Move
from jausml.authoring.editing.describing import numbered_name
from jausml.authoring.editing.project import Project
from jausml.language.metamodel.filling import contents
from jausml.language.model.comparison import Policy, compare
from jausml.language.model.xmi.writer import write_model

EXAMPLE = Path(__file__).parents[2] / "models" / "examples" / "catvehicle"
NAMES = Policy(ignored=frozenset({"name"}))
NAMES_AND_TABLES = Policy(ignored=frozenset({"name", "table"}))
FILES = ("catvehicle.xmi", "catvehicle.ros2jaus")
COPIED = ("vehicle", "velocity_controller", "velocity_state", "onboard")
COPIES = itertools.product(FILES, FILES, COPIED)


@pytest.fixture
def project(tmp_path):
    folder = tmp_path / "catvehicle"
    shutil.copytree(EXAMPLE, folder)
    model = model_of(folder / FILES[1])
    write_model(model.documents[0].roots, model, folder / FILES[0])
    return Project(folder)


def pasted(project, text, owner):
    clip = project.clip(text, owner)
    assert clip.left_out == ()
    return project.paste(clip.commands, owner, "paste")


def own(project, file, name):
    model = project.model(file).model
    return next(
        element for element in model.root.eAllContents() if getattr(element, "name", "") == name
    )


@pytest.mark.parametrize(("target", "source", "name"), sweep(COPIES, every=3))
def test_a_copy_holds_the_same(project, target, source, name):
    model = project.model(source).model
    original = own(project, source, name)
    text = project.copy([project.ref(original, model)])
    before = (project.root / target).read_bytes()
    owner = own(project, target, "bridge") if name == "velocity_state" else None
    there = project.model(target).model
    ref = project.ref(owner or there.root, there)
    entry = pasted(project, text, ref)
    obj, found = project.find(entry.created[0])
    assert obj.name == f"{name}_2"
    assert compare(own(project, source, name), obj, found.metamodels, NAMES) == []
    project.undo()
    assert (project.root / target).read_bytes() == before


def test_copies_refer_to_each_other(project):
    model = project.model("catvehicle.ros2jaus").model
    bridge = own(project, "catvehicle.ros2jaus", "bridge")
    chosen = [bridge.maps[0], bridge.bridgeConnections[0]]
    text = project.copy([project.ref(element, model) for element in chosen])
    # What stands beside is as good as the owner itself.
    entry = pasted(project, text, project.ref(bridge.maps[2], model))
    copied = project.find(entry.created[1])[0]
    assert (copied.name, copied.map.name) == ("odometry_2", "velocity_state_2")


@pytest.mark.parametrize("target", FILES)
@pytest.mark.parametrize("source", FILES)
def test_a_copied_bridge_uses_its_own_maps(project, source, target):
    model = project.model(source).model
    original = own(project, source, "bridge")
    before = (project.root / target).read_bytes()
    text = project.copy([project.ref(original, model)])
    there = project.model(target).model
    entry = pasted(project, text, project.ref(there.root, there))
    copied = project.find(entry.created[0])[0]
    assert [attribute_map.name for attribute_map in copied.maps] == [
        attribute_map.name for attribute_map in original.maps
    ]
    for now, then in zip(copied.bridgeConnections, original.bridgeConnections, strict=True):
        assert now.name == then.name
        assert then.map.eContainer() is original
        assert now.map.eContainer() is copied
        assert now.map.name == then.map.name
        for topic, its in zip(now.topics, then.topics, strict=True):
            assert topic.join is None or topic.join.eContainer() is now.map
            assert (topic.join is None) is (its.join is None)
    found = project.find(entry.created[0])[1].metamodels
    assert (
        compare(original, copied, found, Policy(ignored=frozenset({"name", "map", "join"}))) == []
    )
    # A peer that was not copied is that of the original.
    if source == target:
        peers = [peer.name for one in original.bridgeConnections for peer in one.peers]
        assert [peer.name for one in copied.bridgeConnections for peer in one.peers] == peers
    project.undo()
    assert (project.root / target).read_bytes() == before


@pytest.mark.parametrize("target", FILES)
def test_a_copied_map_uses_its_own_tables(project, target):
    library = EXAMPLE.parents[1] / "library" / "mappings" / "illumination.ros2jaus"
    shutil.copy(library, project.root / "lights.ros2jaus")
    project.refresh()
    model = project.model("lights.ros2jaus").model
    original = own(project, "lights.ros2jaus", "set_lamps")
    there = project.model(target).model
    owner = project.ref(own(project, target, "bridge"), there)
    entry = pasted(project, project.copy([project.ref(original, model)]), owner)
    copied, found = project.find(entry.created[0])
    assert copied.name == "set_lamps"
    conversions = [e for e in copied.eAllContents() if e.eClass.name == "Conversion" and e.table]
    assert conversions
    assert {conversion.table.eContainer() for conversion in conversions} == {copied}
    assert compare(original, copied, found.metamodels, NAMES_AND_TABLES) == []


def test_what_is_copied_together_refers_to_each_other_in_any_order(project):
    file = "catvehicle.xmi"
    model = project.model(file).model
    chosen = [own(project, file, name) for name in ("bridge", "operator_control_unit", "vehicle")]
    text = project.copy([project.ref(element, model) for element in chosen])
    entry = pasted(project, text, project.ref(model.root, model))
    bridge, unit, vehicle = (project.find(reference)[0] for reference in entry.created[:3])
    assert [element.name for element in (bridge, unit, vehicle)] == [
        f"{element.name}_2" for element in chosen
    ]
    peers = {peer.name for one in bridge.bridgeConnections for peer in one.peers}
    assert peers
    assert peers <= {vehicle.name, unit.name}
    assert {connection.provider for connection in unit.connections} <= {vehicle, bridge, None}
    assert [control.name for control in unit.controls] == [
        f"{control.name}_2" for control in chosen[1].controls
    ]


def test_a_copy_goes_into_a_new_file(project):
    project.do([Create("other.ros2jaus", "system.System", {"name": ("other",)})], "create")
    model = project.model("catvehicle.xmi").model
    component = own(project, "catvehicle.xmi", "vehicle")
    text = project.copy([project.ref(component, model)])
    entry = pasted(project, text, "other.ros2jaus#/")
    copied = project.find(entry.created[0])[0]
    assert copied.name == "vehicle"
    assert [
        content.name
        for content in contents(copied, model.metamodels.class_of(copied).features["provides"])
    ] == [provide.name for provide in component.provides]


def test_what_has_no_place_is_refused(project):
    model = project.model("catvehicle.xmi").model
    node = own(project, "catvehicle.xmi", "odometry")
    text = project.copy([project.ref(node, model)])
    with pytest.raises(EditError, match="has no place in catvehicle"):
        pasted(project, text, "catvehicle.xmi#/")


def test_a_text_keeps_its_elements_and_says_how_they_get_elsewhere(project):
    model = project.model("catvehicle.ros2jaus").model
    node = project.ref(own(project, "catvehicle.ros2jaus", "logger"), model)
    with pytest.raises(EditError, match=r"logger is named in .* copy it into the other file"):
        project.do([Move(node, "catvehicle.xmi#/", "nodes")], "move")


def test_free_names():
    assert numbered_name("a", set()) == "a"
    assert numbered_name("a", {"a"}) == "a_2"
    assert numbered_name("a_2", {"a", "a_2", "a_3"}) == "a_4"
    assert numbered_name("speed10", {"speed10"}) == "speed_11"

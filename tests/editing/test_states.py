"""Targets of transitions follow the states that they name, in XMI and in text."""

from pathlib import Path

import pytest
from generated import model_of

from jausml.authoring.editing.commands import Place, Remove, Rename
from jausml.authoring.editing.project import Project
from jausml.language.metamodel.classes import jaus
from jausml.language.model.library import LIBRARY_URI
from jausml.language.text.writing.unparsing import to_text
from jausml.language.validation.engine import check
from jausml.views.diagrams.views import graph_of

WINCH = Path(__file__).parents[2] / "models" / "examples" / "winch" / "service.xmi"


@pytest.fixture(params=["service.xmi", "service.ros2jaus"])
def project(request, tmp_path):
    text = WINCH.read_text(encoding="utf-8").replace("../../library/", LIBRARY_URI)
    (tmp_path / "service.xmi").write_text(text, encoding="utf-8")
    if request.param.endswith(".ros2jaus"):
        model = model_of(tmp_path / "service.xmi")
        path = tmp_path / request.param
        path.write_text(to_text(model.documents[0].roots, model, path), encoding="utf-8")
        (tmp_path / "service.xmi").unlink()
    return Project(tmp_path), request.param


def states(project, file):
    model = project.model(file).model
    return {state.name: state for state in model.instances(jaus.State, library=False)}


def targets(project, file):
    model = project.model(file).model
    return [e.target for e in model.instances(jaus.Transition, library=False) if e.target]


def ref(project, file, name):
    return project.ref(states(project, file)[name], project.model(file).model)


def errors(project, file):
    found = check(project.model(file)).diagnostics
    return [diagnostic for diagnostic in found if diagnostic.severity.value == "error"]


@pytest.mark.parametrize(
    ("name", "new", "old_target", "new_target"),
    [
        ("Moving", "Turning", "Moving.PayingOut", "Turning.PayingOut"),
        ("PayingIn", "Pulling", "Moving.PayingIn", "Moving.Pulling"),
        ("PayingIn", "Pulling", "PayingIn", "Pulling"),
        ("Locked", "Held.Fast", "Locked", "Held.Fast"),
    ],
)
def test_targets_follow_a_state_that_is_renamed(project, name, new, old_target, new_target):
    project, file = project
    before = project.text(file)
    was = targets(project, file)
    assert old_target in was
    entry = project.do([Rename(ref(project, file, name), new)], "rename")
    now = targets(project, file)
    assert old_target not in now
    assert now.count(new_target) >= was.count(old_target)
    assert errors(project, file) == []
    assert len(entry.files) == 1
    project.undo()
    assert project.text(file) == before


def test_targets_that_do_not_name_the_state_stay(project):
    project, file = project
    project.do([Rename(ref(project, file, "Locked"), "MovingNot")], "rename")
    was = targets(project, file)
    project.do([Rename(ref(project, file, "Moving"), "Turning")], "rename")
    now = targets(project, file)
    for name in ("MovingNot", "PayingIn"):  # neither goes through the state
        assert now.count(name) == was.count(name) > 0
    assert errors(project, file) == []


def test_transitions_into_a_state_go_with_it_and_are_told_before(project):
    project, file = project
    remove = [Remove(ref(project, file, "Locked"))]
    told = project.preview(remove).referrers
    assert len([referrer for referrer in told if "Transition" in referrer.label]) == 2
    project.do(remove, "remove")
    assert "Locked" not in targets(project, file)
    assert errors(project, file) == []


def test_a_box_that_was_placed_keeps_its_place_when_its_state_is_renamed(project):
    project, file = project

    def key(title):
        graph = graph_of(project.model(file).model, "machine:ReceiveFSM")
        return next(node.key for node in graph.nodes if node.title == title)

    view = "machine:Winch.ReceiveFSM"
    project.do([Place(file, view, {key("Idle"): (30, 40)})], "place")
    project.do([Rename(ref(project, file, "Idle"), "Waiting")], "rename")
    assert project.positions(file, view) == {key("Waiting"): (30, 40)}

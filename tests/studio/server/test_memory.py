"""Opening again: boxes and lines stand where they stood, dropped ones where one dropped them."""

import json
from pathlib import Path
from typing import Any

from jausml.authoring.editing.project import Project
from jausml.authoring.studio.context import StudioContext
from jausml.authoring.studio.handlers import editing, showing
from jausml.authoring.studio.memory import FOLDER
from jausml.language.metamodel.classes import bridge, system

FILE, SYSTEM = "catvehicle.xmi", "system"


def opened(folder: Path) -> StudioContext:
    return StudioContext(Project(folder / FILE))


def drawn(context: StudioContext) -> dict[str, Any]:
    graph: dict[str, Any] = showing.view(context, FILE, SYSTEM)["graph"]
    return graph


def corners(graph: dict[str, Any]) -> dict[str, tuple[float, float]]:
    return {node["key"]: (node["x"], node["y"]) for node in graph["nodes"]}


def edit(context: StudioContext, *commands: dict[str, Any], **more: Any) -> dict[str, Any]:
    return editing._edit(context, commands, "Try", context.project.revision, **more)


def test_opening_again_moves_nothing_after_an_edit(folder):
    context = opened(folder)
    before = drawn(context)
    model = context.project.model(FILE).model
    connections = model.instances(bridge.Connection, library=False)
    gone = context.project.ref(next(iter(connections)), model)
    edit(context, {"kind": "remove", "element": gone})
    after = drawn(context)
    kept = corners(after).items()
    assert kept <= corners(before).items()

    again = drawn(opened(folder))
    assert again["nodes"] == after["nodes"]
    assert again["edges"] == after["edges"]
    assert (folder / FOLDER / ".gitignore").read_text(encoding="utf-8") == "*\n"


def test_what_is_damaged_is_drawn_anew(folder):
    before = drawn(opened(folder))
    [kept] = folder.glob(f"{FOLDER}/*.json")
    views = json.loads(kept.read_text(encoding="utf-8"))
    _, corner = next(iter(views["views"][SYSTEM]["shown"].values()))
    corner[0] = float("nan")
    for told in (json.dumps(views), "[1]", '{"views": {"system": {"boxes": []}}}', "NaN"):
        kept.write_text(told, encoding="utf-8")
        assert drawn(opened(folder)) == before, told


def test_a_folder_that_leads_elsewhere_is_left_alone(folder, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (folder / FOLDER).symlink_to(elsewhere)
    drawn(opened(folder))
    assert list(elsewhere.iterdir()) == []


def test_what_is_dropped_stands_where_it_was_dropped_by_one_edit(folder):
    context = opened(folder)
    before = corners(drawn(context))
    model = context.project.model(FILE).model
    whole = context.project.ref(next(iter(model.instances(system.System, library=False))), model)
    place = editing.Dropped(FILE, SYSTEM, 1000, -150)
    values = {"name": ["gps"]}
    added = {"kind": "add", "owner": whole, "feature": "nodes", "type": "ros.Node"}
    edit(context, {**added, "values": values}, at=place)
    after = corners(drawn(context))
    [new] = after.keys() - before.keys()
    assert after[new] == (1000, -150)
    assert before.items() <= after.items()
    assert len(context.project.log) == 1
    context.project.undo()
    assert corners(drawn(context)) == before
    context.project.redo()
    assert corners(drawn(context)) == after

"""What is remembered of views: what it is good for, and that faults in it keep nobody out."""

import logging

from large_systems import large_system

from jausml.authoring.editing.project import Project
from jausml.authoring.studio.context import StudioContext
from jausml.authoring.studio.drawing import Drawings
from jausml.authoring.studio.handlers import editing, showing
from jausml.language.metamodel.classes import bridge
from jausml.views.diagrams.graph import Graph, Node


def test_a_broken_memory_of_places_does_not_keep_a_view_from_being_shown(tmp_path, caplog):
    drawings = Drawings(tmp_path)
    shown = Graph("system", "s", tuple(Node(name, "component", name, key=name) for name in "ab"))
    first = drawings.draw("m.xmi", shown, {})
    view = drawings._view("m.xmi", "system")
    view.standing.boxes.clear()
    view.standing.shown["a"] = None  # type: ignore[assignment] - what no code should ever do

    with caplog.at_level(logging.ERROR):
        again = drawings.draw(
            "m.xmi", Graph("system", "s", (*shown.nodes, Node("c", "component", "c", key="c"))), {}
        )

    assert [node["key"] for node in again["nodes"]] == ["a", "b", "c"]
    assert len(first["nodes"]) == 2
    assert "is drawn anew" in caplog.text
    assert "Traceback" in caplog.text


def test_a_view_whose_element_is_renamed_keeps_the_places_of_its_boxes(tmp_path):
    drawings = Drawings(tmp_path)

    def draw(name: str) -> dict[str, tuple[float, float]]:
        boxes = ("service", name), ("messages", f"{name}!takes"), ("messages", f"{name}!sends")
        nodes = tuple(Node(box_id, kind, box_id, key=box_id) for kind, box_id in boxes)
        found = drawings.draw("m.xmi", Graph(f"service:{name}", name, nodes, downwards=True), {})
        return {node["key"]: (node["x"], node["y"]) for node in found["nodes"]}

    drawings.follow("m.xmi", ["service:Winch", "service:Other"])
    drawings._view("m.xmi", "service:Winch").standing.boxes |= {"Winch": (7, 70)}
    before = draw("Winch")
    assert before["Winch"] == (7, 70)
    drawings.follow("m.xmi", ["service:Hoist", "service:Other"])
    assert list(draw("Hoist").values()) == list(before.values())
    drawings.follow("m.xmi", ["service:Winch", "service:Other"])
    assert draw("Winch") == before
    assert draw("Other")["Other"] != (7, 70)


def test_a_large_system_is_drawn_at_once_and_again_with_its_verdict(tmp_path):
    file = "large.ros2jaus"
    (tmp_path / file).write_text(large_system(31), encoding="utf-8")
    context = StudioContext(Project(tmp_path))
    first = showing.view(context, file, "system")
    assert not first["checked"]
    showing.problems(context, context.verdicts.of(file))
    seen = showing.view(context, file, "system", (), first["picture"])
    assert seen["checked"]

    model = context.project.model(file).model
    edited = next(iter(model.instances(bridge.Connection, library=False)))
    rate = {"kind": "set", "feature": "rate", "values": ["-1"]}
    command = {**rate, "element": context.project.ref(edited, model)}
    editing._edit(context, (command,), "Set", context.project.revision)
    unjudged = showing.view(context, file, "system", (), seen["picture"])
    assert not unjudged["checked"]
    showing.problems(context, context.verdicts.of(file))
    now = showing.view(context, file, "system", (), unjudged["picture"])
    assert now["checked"]
    (closed,) = now["changes"]["nodes"]["put"]
    assert [finding["message"] for finding in closed["findings"]] == ["1 error in it"]

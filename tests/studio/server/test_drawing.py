"""A view whose past cannot be understood is drawn anew, and its fault is told."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from jausml.authoring.studio.drawing import Drawings
from jausml.views.diagrams.graph import Graph, Node

if TYPE_CHECKING:
    import pytest


def test_a_broken_memory_of_places_does_not_keep_a_view_from_being_shown(
    caplog: pytest.LogCaptureFixture,
) -> None:
    drawings = Drawings()
    shown = Graph("system", "s", tuple(Node(each, "component", each, key=each) for each in "ab"))
    first = drawings.draw("m.xmi", shown, {})
    view = drawings._view("m.xmi", "system")
    view.standing.boxes.clear()
    view.standing.shown["a"] = None  # type: ignore[assignment] - what no code should ever do

    with caplog.at_level(logging.ERROR):
        again = drawings.draw(
            "m.xmi", Graph("system", "s", (*shown.nodes, Node("c", "component", "c", key="c"))), {}
        )

    assert [each["key"] for each in again["nodes"]] == ["a", "b", "c"]
    assert len(first["nodes"]) == 2
    assert "is drawn anew" in caplog.text
    assert "Traceback" in caplog.text


def test_a_view_whose_element_is_renamed_keeps_the_places_of_its_boxes() -> None:
    drawings = Drawings()

    def draw(name: str) -> dict[str, tuple[float, float]]:
        boxes = ("service", name), ("messages", f"{name}!takes"), ("messages", f"{name}!sends")
        nodes = tuple(Node(each, kind, each, key=each) for kind, each in boxes)
        found = drawings.draw("m.xmi", Graph(f"service:{name}", name, nodes, downwards=True), {})
        return {each["key"]: (each["x"], each["y"]) for each in found["nodes"]}

    drawings.follow("m.xmi", ["service:Winch", "service:Other"])
    drawings._view("m.xmi", "service:Winch").standing.boxes |= {"Winch": (7, 70)}
    before = draw("Winch")
    assert before["Winch"] == (7, 70)
    drawings.follow("m.xmi", ["service:Hoist", "service:Other"])
    assert list(draw("Hoist").values()) == list(before.values())
    drawings.follow("m.xmi", ["service:Winch", "service:Other"])
    assert draw("Winch") == before
    assert draw("Other")["Other"] != (7, 70)

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

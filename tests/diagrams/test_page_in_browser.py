"""The page in a real browser: what its script does with what is drawn."""

from __future__ import annotations

import pytest
from browser import browser, page  # noqa: F401 - fixtures
from diagram_support import CAR, read
from test_pictures import HOSTILE, hostile

from jausml.diagrams.layout.graphviz import Graphviz
from jausml.diagrams.views import graph_of
from jausml.diagrams.writers import html

pytest.importorskip("pygraphviz", reason="layout needs jausml[diagram]")


@pytest.fixture(scope="module")
def car(tmp_path_factory):
    report = read(CAR)
    path = tmp_path_factory.mktemp("page") / "car.html"
    graph = graph_of(report.model, "system", report.diagnostics)
    path.write_text(html.render(graph, Graphviz()), encoding="utf-8")
    return path.as_uri()


def test_a_row_is_told_when_it_is_clicked(page, car):  # noqa: F811
    page.goto(car)
    page.get_by_text("odometry", exact=True).first.click()
    details = page.locator("#details")
    details.wait_for()
    assert details.locator("h2").inner_text() == "odometry"
    assert "ReportVelocityState" in details.inner_text()
    page.keyboard.press("Escape")
    details.wait_for(state="hidden")


@pytest.mark.parametrize("text", HOSTILE[:1] + HOSTILE[4:5])
def test_texts_are_data(page, text, tmp_path):  # noqa: F811
    path = tmp_path / "page.html"
    path.write_text(html.render(hostile(text), Graphviz()), encoding="utf-8")
    asked = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("dialog", lambda dialog: asked.append(dialog.message))
    page.goto(path.as_uri())
    page.locator(".box").first.click()
    assert page.locator("#details h2").inner_text() == " ".join(text.split())
    assert asked == [path.as_uri()]

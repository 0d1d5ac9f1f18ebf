"""What a page is shown of a project."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from studio_client import RefusedError

from jausml import __version__

if TYPE_CHECKING:
    from studio_client import Page

pytestmark = pytest.mark.ports

FILE = "catvehicle.xmi"


def test_hello_tells_of_the_project(page: Page) -> None:
    assert page.project["name"] == "project"
    assert page.project["opened"] == FILE
    assert page.project["version"] == __version__
    assert [each["path"] for each in page.project["files"]] == [FILE, "service.xmi"]


def test_views_are_those_of_the_file(page: Page) -> None:
    views = page.ask("views", file=FILE)["views"]
    assert {"name": "system", "kind": "system", "title": "system", "library": False} in views
    assert any(each["kind"] == "service" and each["library"] for each in views)


def test_the_system_is_a_graph(page: Page) -> None:
    graph = page.ask("view", file=FILE, view="system")["graph"]
    assert {each["kind"] for each in graph["nodes"]} >= {"component", "bridge", "node"}
    assert all(each["width"] > 0 and each["key"] for each in graph["nodes"])


def test_an_unknown_view_is_refused(page: Page) -> None:
    with pytest.raises(RefusedError, match="no view 'system2'"):
        page.ask("view", file=FILE, view="system2")


def test_problems_of_the_example_are_none(page: Page) -> None:
    found = page.ask("problems", file=FILE)
    assert [each for each in found["problems"] if each["severity"] == "error"] == []
    assert found["files"] == [FILE]

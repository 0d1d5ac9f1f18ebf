"""What a page is shown of a project."""

import pytest
from studio_client import RefusedError

pytestmark = pytest.mark.ports

FILE = "catvehicle.xmi"


def test_hello_tells_of_the_project(page):
    assert page.project["name"] == "project"
    assert page.project["opened"] == FILE
    assert [file["path"] for file in page.project["files"]] == [FILE, "service.xmi"]


def test_views_are_those_of_the_file(page):
    views = page.ask("views", file=FILE)["views"]
    assert {"name": "system", "kind": "system", "title": "system", "library": False} in views
    assert any(view["kind"] == "service" and view["library"] for view in views)


def test_the_system_is_a_graph(page):
    graph = page.ask("view", file=FILE, view="system")["graph"]
    assert {node["kind"] for node in graph["nodes"]} >= {"component", "bridge", "node"}
    assert all(node["width"] > 0 and node["key"] for node in graph["nodes"])


def test_an_unknown_view_is_refused(page):
    with pytest.raises(RefusedError, match="no view 'system2'"):
        page.ask("view", file=FILE, view="system2")


def test_problems_of_the_example_are_none(page):
    found = page.ask("problems", file=FILE)
    assert [problem for problem in found["problems"] if problem["severity"] == "error"] == []


def test_the_outline_reaches_what_no_diagram_shows(page):
    rows = page.ask("outline", file=FILE)["rows"]
    assert [row["depth"] for row in rows[:2]] == [0, 1]
    assert {"host", "placement", "bridge"} <= {row["kind"] for row in rows}
    bridge = next(row for row in rows if row["kind"] == "bridge")
    assert bridge["inner"]
    assert not bridge["is_open"]
    opened = page.ask("outline", file=FILE, opened=[bridge["element"]])["rows"]
    assert len(opened) == len(rows) + bridge["inner"]
    found = page.ask("outline", file=FILE, query="placement")["rows"]
    assert [row["kind"] for row in found] == ["placement"]
    assert page.ask("form", element=found[0]["element"])["class"] == "placement"


def test_only_what_has_changed_is_sent_to_who_has_the_picture_before(page):
    first = page.ask("view", file=FILE, view="system")
    again = page.ask("view", file=FILE, view="system", base=first["picture"])
    assert "graph" not in again
    assert again["changes"]["base"] == first["picture"]
    for name in ("nodes", "groups", "edges"):
        assert again["changes"][name] == {"put": [], "gone": [], "order": None}
    assert "graph" in page.ask("view", file=FILE, view="system", base=first["picture"] + 1000)


def test_a_box_is_found_by_the_element_of_its_row(page):
    graph = page.ask("view", file=FILE, view="system")["graph"]
    bridge = next(drawn for drawn in graph["nodes"] if drawn["kind"] == "bridge")
    row = bridge["ports"][0]["element"]
    # Where several boxes have a row of it, the first is looked at.
    node = next(
        drawn for drawn in graph["nodes"] if row in [row["element"] for row in drawn["ports"]]
    )
    left, top = page.ask("where", file=FILE, view="system", element=row)["place"]
    assert node["x"] < left < node["x"] + node["width"]
    assert node["y"] < top < node["y"] + node["height"]
    assert page.ask("where", file=FILE, view="system", element="x.xmi#y")["place"] is None


# -- texts -----------------------------------------------------------------------------------------


def test_the_text_of_a_file_is_what_is_stored(page, folder):
    found = page.ask("text", file=FILE)
    assert found["text"] == (folder / FILE).read_text(encoding="utf-8")
    assert not found["editable"]


def test_an_element_is_found_in_its_text_and_the_text_leads_back(page):
    graph = page.ask("view", file=FILE, view="system")["graph"]
    [element] = [node["element"] for node in graph["nodes"] if node["kind"] == "bridge"]
    place = page.ask("source", element=element)
    text = page.ask("text", file=FILE)["text"]
    assert place["file"] == FILE
    assert text[place["start"] : place["end"]].startswith("<bridges")
    assert page.ask("at", file=FILE, offset=place["start"]) == {"element": element}


def test_library_texts_are_shown_and_nothing_else_of_the_computer(page):
    library = page.ask("text", file="library:/jaus/core-1.1.xmi")
    assert not library["editable"]
    assert "AccessControl" in library["text"]
    for file in ("library:/../__init__.py", "library:/jaus", "/etc/passwd", "../project/a.xmi"):
        with pytest.raises(RefusedError):
            page.ask("text", file=file)


def test_a_map_has_all_its_members(page):
    views = page.ask("views", file=FILE)["views"]
    view = next(entry["name"] for entry in views if entry["kind"] == "map" and not entry["library"])
    graph = page.ask("view", file=FILE, view=view)["graph"]
    shown = {node["id"]: {port["id"] for port in node["ports"]} for node in graph["nodes"]}
    sides = page.ask("members", file=FILE, view=view)["sides"]
    assert {side["node"] for side in sides} == set(shown)
    for side in sides:
        assert shown[side["node"]] <= {member["path"] for member in side["members"]}
    with pytest.raises(RefusedError, match="no view of a map"):
        page.ask("members", file=FILE, view="system")

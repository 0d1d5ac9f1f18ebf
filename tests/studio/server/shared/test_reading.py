"""What a page is shown of texts."""

import pytest
from studio_client import RefusedError

pytestmark = pytest.mark.ports

FILE = "catvehicle.xmi"


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

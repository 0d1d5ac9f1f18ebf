"""Edits by a page, and by two of them."""

import re

import pytest
from studio_client import Page, RefusedError

pytestmark = pytest.mark.ports

FILE = "catvehicle.xmi"


def node_of(page: Page, kind: str) -> str:
    graph = page.ask("view", file=FILE, view="system")["graph"]
    ref: str = next(node["element"] for node in graph["nodes"] if node["kind"] == kind)
    return ref


def named(element: str, name: str) -> dict[str, object]:
    return {"kind": "set", "element": element, "feature": "documentation", "values": [name]}


def test_an_edit_changes_the_file_and_undo_brings_it_back(page, folder):
    before, log = (folder / FILE).read_bytes(), page.ask("log")
    done = page.ask("edit", commands=[named(node_of(page, "node"), "driven")], label="describe")
    assert b'"driven"' in (folder / FILE).read_bytes()
    assert done["created"] == []
    then = page.ask("log")
    assert then["at"] == log["at"] + 1
    assert then["entries"][log["at"]]["label"] == f"describe, and format {FILE}"
    page.ask("undo")
    assert (folder / FILE).read_bytes() == before
    now = page.ask("log")
    assert (now["entries"][now["at"] :], now["at"]) == (then["entries"][log["at"] :], log["at"])
    page.ask("redo")
    assert b'"driven"' in (folder / FILE).read_bytes()


def test_a_dry_edit_tells_its_difference_and_writes_nothing(page, folder):
    before = (folder / FILE).read_bytes()
    commands = [named(node_of(page, "node"), "driven")]
    told = page.ask("edit", commands=commands, label="describe", dry=True)
    assert "+" in told["diff"]
    assert "driven" in told["diff"]
    assert (folder / FILE).read_bytes() == before


def test_edits_that_are_sent_at_once_are_done_in_turn(page):
    element = node_of(page, "node")
    edits = [
        page.send("edit", commands=[named(element, f"text {i}")], label=f"edit {i}")
        for i in range(20)
    ]
    undo = page.send("undo")
    for edit in edits:
        page.answer(edit)
    assert page.answer(undo)["entry"]["label"] == "edit 19"


def test_all_pages_are_told(server):
    with server.page() as one, server.page() as other:
        one.ask("edit", commands=[named(node_of(one, "node"), "driven")], label="describe")
        assert other.await_told("changed")["by"] == "edit"
        assert other.ask("log")["entries"][-1]["label"] == f"describe, and format {FILE}"


def test_an_edit_of_an_older_revision_is_a_conflict(page):
    element = node_of(page, "node")
    base = page.ask("hello")["revision"]
    page.ask("edit", commands=[{"kind": "remove", "element": element}], label="remove")
    with pytest.raises(RefusedError, match="is gone meanwhile") as refused:
        page.ask("edit", commands=[named(element, "two")], label="describe", base=base)
    assert refused.value.data["conflict"]


def test_what_was_copied_is_pasted_beside_it(page):
    element = node_of(page, "node")
    text = page.ask("copy", elements=[element])["text"]
    assert re.search("^node ", text, re.MULTILINE)
    done = page.ask("paste", owner=element, text=text)
    assert len(done["created"]) == 1
    assert page.ask("log")["entries"][-1]["label"] == f"Paste, and format {FILE}"


def test_a_copied_bridge_stands_for_itself(page):
    element = node_of(page, "bridge")
    text = page.ask("copy", elements=[element])["text"]
    done = page.ask("paste", owner=element, text=text)
    form = page.ask("form", element=done["created"][0])
    values = {field["feature"]: field["values"] for field in form["fields"]}
    assert values["name"] == ["bridge_2"]
    # Two components of one address would be an error.
    found = page.ask("problems", file=FILE)["problems"]
    assert [problem for problem in found if problem["severity"] == "error"] == []
    page.ask("undo")
    assert "bridge_2" not in page.ask("text", file=FILE)["text"]


def test_problems_come_with_each_change(page):
    page.ask("problems", file=FILE)
    element = node_of(page, "component")
    clash = {"kind": "set", "element": element, "feature": "address", "values": ["0.0.0"]}
    revision = page.ask("edit", commands=[clash], label="break")["revision"]
    told = page.await_told("problems", lambda notification: notification["revision"] == revision)
    found = [problem for problem in told["problems"] if problem["severity"] == "error"]
    assert any(problem["element"] == element and problem["file"] == FILE for problem in found)


def test_a_problem_is_cured_by_its_cure(page):
    element = node_of(page, "component")
    before = page.ask("form", element=element)
    address = next(field for field in before["fields"] if field["feature"] == "address")["values"]
    bridge = node_of(page, "bridge")
    same = {"kind": "set", "element": bridge, "feature": "address", "values": address}
    page.ask("edit", commands=[same], label="break")
    found = page.ask("problems", file=FILE)["problems"]
    cure = next(offered for problem in found for offered in problem["cures"])
    page.ask("edit", commands=cure["commands"], label=cure["label"])
    assert page.ask("problems", file=FILE)["problems"] == []


def test_an_open_decision_is_a_problem_until_somebody_takes_it_away(page):
    form = page.ask("form", element=node_of(page, "bridge"))
    maps = next(child for child in form["children"] if child["feature"] == "maps")
    owner = maps["elements"][0]["element"]
    add = {"kind": "add", "owner": owner, "feature": "openDecisions"}
    add |= {"type": "bridge.OpenDecision", "values": {"text": ["whose axes are these?"]}}
    page.ask("edit", commands=[add], label="ask")
    [open_] = page.ask("problems", file=FILE)["problems"]
    assert (open_["rule"], open_["severity"]) == ("JML498", "error")
    children = page.ask("form", element=owner)["children"]
    listed = next(child["elements"] for child in children if child["feature"] == "openDecisions")
    assert [(decision["label"], decision["element"]) for decision in listed] == [
        ("whose axes are these?", open_["element"])
    ]
    values = page.ask("form", element=open_["element"])["fields"]
    assert {value["feature"] for value in values} == {"text", "blocking"}
    [cure] = open_["cures"]
    page.ask("edit", commands=cure["commands"], label=cure["label"])
    assert page.ask("problems", file=FILE)["problems"] == []

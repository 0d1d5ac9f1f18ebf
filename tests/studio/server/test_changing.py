"""Edits by a page, by two of them, and by other programs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from studio_client import RefusedError

if TYPE_CHECKING:
    from pathlib import Path

    from studio_client import Page, Server

pytestmark = pytest.mark.ports

FILE = "catvehicle.xmi"


def node_of(page: Page, kind: str) -> str:
    graph = page.ask("view", file=FILE, view="system")["graph"]
    ref: str = next(each["element"] for each in graph["nodes"] if each["kind"] == kind)
    return ref


def named(element: str, name: str) -> dict[str, object]:
    return {"kind": "set", "element": element, "feature": "documentation", "values": [name]}


def test_an_edit_changes_the_file_and_undo_brings_it_back(page: Page, folder: Path) -> None:
    before = (folder / FILE).read_bytes()
    done = page.ask("edit", commands=[named(node_of(page, "node"), "driven")], label="describe")
    assert b'"driven"' in (folder / FILE).read_bytes()
    assert done["entry"]["label"] == "describe"
    assert page.ask("log")["at"] == 1
    page.ask("undo")
    assert (folder / FILE).read_bytes() == before
    assert page.ask("log") == {"entries": [done["entry"]], "at": 0}
    page.ask("redo")
    assert b'"driven"' in (folder / FILE).read_bytes()


def test_a_dry_edit_tells_its_difference_and_writes_nothing(page: Page, folder: Path) -> None:
    before = (folder / FILE).read_bytes()
    commands = [named(node_of(page, "node"), "driven")]
    told = page.ask("edit", commands=commands, label="describe", dry=True)
    assert "+" in told["diff"]
    assert "driven" in told["diff"]
    assert (folder / FILE).read_bytes() == before


def test_edits_that_are_sent_at_once_are_done_in_turn(page: Page) -> None:
    element = node_of(page, "node")
    edits = [
        page.send("edit", commands=[named(element, f"text {i}")], label=f"edit {i}")
        for i in range(20)
    ]
    undo = page.send("undo")
    for each in edits:
        page.answer(each)
    assert page.answer(undo)["entry"]["label"] == "edit 19"


def test_all_pages_are_told(server: Server) -> None:
    with server.page() as one, server.page() as other:
        one.ask("edit", commands=[named(node_of(one, "node"), "driven")], label="describe")
        told = other.await_told("changed")
        assert told["by"] == "edit"
        assert told["entry"]["label"] == "describe"


def test_an_edit_of_an_older_revision_is_a_conflict(page: Page) -> None:
    element = node_of(page, "node")
    base = page.ask("hello")["revision"]
    page.ask("edit", commands=[{"kind": "remove", "element": element}], label="remove")
    with pytest.raises(RefusedError, match="is gone meanwhile") as refused:
        page.ask("edit", commands=[named(element, "two")], label="describe", base=base)
    assert refused.value.data["conflict"]


def test_what_was_copied_is_pasted_beside_it(page: Page) -> None:
    element = node_of(page, "node")
    commands = page.ask("copy", elements=[element])["commands"]
    assert [(each["kind"], each["type"]) for each in commands] == [("add", "ros.Node")]
    done = page.ask("paste", owner=element, commands=commands)
    assert (done["entry"]["label"], len(done["created"])) == ("Paste", 1)


def test_a_copied_bridge_stands_for_itself(page: Page) -> None:
    element = node_of(page, "bridge")
    commands = page.ask("copy", elements=[element])["commands"]
    done = page.ask("paste", owner=element, commands=commands)
    form = page.ask("form", element=done["created"][0])
    values = {each["feature"]: each["values"] for each in form["fields"]}
    assert values["name"] == ["bridge_2"]
    # Two components of one address would be an error.
    found = page.ask("problems", file=FILE)["problems"]
    assert [each for each in found if each["severity"] == "error"] == []
    page.ask("undo")
    assert "bridge_2" not in page.ask("text", file=FILE)["text"]


def test_problems_come_with_each_change(page: Page) -> None:
    page.ask("problems", file=FILE)
    element = node_of(page, "component")
    clash = {"kind": "set", "element": element, "feature": "address", "values": ["0.0.0"]}
    revision = page.ask("edit", commands=[clash], label="break")["revision"]
    told = page.await_told("problems", lambda each: each["revision"] == revision)
    found = [each for each in told["problems"] if each["severity"] == "error"]
    assert any(each["element"] == element and each["file"] == FILE for each in found)


def test_a_problem_is_cured_by_its_cure(page: Page) -> None:
    element = node_of(page, "component")
    before = page.ask("form", element=element)
    address = next(each for each in before["fields"] if each["feature"] == "address")["values"]
    bridge = node_of(page, "bridge")
    same = {"kind": "set", "element": bridge, "feature": "address", "values": address}
    page.ask("edit", commands=[same], label="break")
    found = page.ask("problems", file=FILE)["problems"]
    cure = next(each for problem in found for each in problem["cures"])
    page.ask("edit", commands=cure["commands"], label=cure["label"])
    assert page.ask("problems", file=FILE)["problems"] == []


def test_a_change_by_another_program_appears(page: Page, folder: Path) -> None:
    page.ask("problems", file=FILE)
    text = (folder / FILE).read_text(encoding="utf-8")
    (folder / FILE).write_text(text.replace("<system:System", "<system:System ", 1))
    shown = page.await_told("outside")
    assert shown["file"] == FILE
    assert "+<system:System " in shown["diff"]
    told = page.await_told("changed")
    assert told["by"] == "outside"
    assert told["entry"]["outside"]
    page.await_told("problems", lambda each: each["revision"] == told["revision"])


def test_a_broken_file_keeps_its_last_good_model_and_is_stale(page: Page, folder: Path) -> None:
    element = node_of(page, "node")
    (folder / FILE).write_text("<system:System", encoding="utf-8")
    told = page.await_told("changed")
    assert [each["stale"] for each in told["files"]] == [True]
    problems = page.ask("problems", file=FILE)["problems"]
    assert any(each["severity"] == "error" and each["line"] == 1 for each in problems)
    assert node_of(page, "node") == element
    assert (folder / FILE).read_text(encoding="utf-8") == "<system:System"


BROKEN = "bridge nav {{{ ??\n"
MARKED = "<<<<<<< HEAD\nbridge a { }\n=======\nbridge b { }\n>>>>>>> other\n"


@pytest.mark.parametrize(
    ("broken", "state"), [(BROKEN, "unreadable"), (MARKED, "conflict")], ids=["faulty", "merging"]
)
def test_what_cannot_be_read_gets_no_verdict_and_no_code(
    page: Page, folder: Path, broken: str, state: str
) -> None:
    text = folder / "boat.ros2jaus"
    text.write_text("component helm { address: 1.2.3 }\n", encoding="utf-8")
    page.await_told("changed")
    file = text.name
    good = page.ask("view", file=file, view="system")
    assert good["freshness"]["state"] == "current"
    plan = page.ask("plan", file=file)
    assert (plan["problems"], plan["freshness"]["state"]) == ("", "current")

    text.write_text(f"component helm {{ address: 1.2.3 }}\n{broken}", encoding="utf-8")
    told = page.await_told("changed", lambda each: each["revision"] > good["revision"])
    # The picture is that of before, and says so; nothing else is of the past.
    seen = page.ask("view", file=file, view="system")
    assert [each["title"] for each in seen["graph"]["nodes"]] == ["helm"]
    assert seen["freshness"]["state"] == state
    assert seen["freshness"]["since"] == good["revision"]
    verdict = page.ask("problems", file=file)
    assert "JML701" in {each["rule"] for each in verdict["problems"]}
    assert {each["line"] for each in verdict["problems"]} <= set(range(2, 8))
    assert file in verdict["fault"]
    refused = page.ask("plan", file=file)
    assert (refused["files"], refused["digest"]) == ([], "")
    assert file in refused["problems"]
    assert refused["revision"] == told["revision"]
    with pytest.raises(RefusedError, match=file):
        page.ask("generate", file=file, out="", digest=plan["digest"])
    assert [each.name for each in folder.iterdir() if each.is_dir()] == []

    text.write_text("component helm { address: 1.2.4 }\n", encoding="utf-8")
    page.await_told("changed", lambda each: each["revision"] > told["revision"])
    assert page.ask("problems", file=file)["freshness"]["state"] == "current"


def test_a_file_that_another_one_uses_and_that_cannot_be_read_counts_too(
    page: Page, folder: Path
) -> None:
    parts = "component compass { address: 1.2.4 }\n"
    (folder / "parts.ros2jaus").write_text(parts, encoding="utf-8")
    (folder / "boat.ros2jaus").write_text(
        'import "parts.ros2jaus"\ncomponent helm { address: 1.2.3  controls: compass }\n',
        encoding="utf-8",
    )
    page.await_told("changed", lambda each: len(each["files"]) == 3)
    before = page.ask("problems", file="boat.ros2jaus")
    assert before["freshness"]["state"] == "current"
    (folder / "parts.ros2jaus").write_text(BROKEN, encoding="utf-8")
    page.await_told("changed", lambda each: each["revision"] > before["revision"])
    told = page.ask("problems", file="boat.ros2jaus")
    assert told["freshness"]["state"] == "unreadable"
    assert {each["file"] for each in told["problems"]} == {"parts.ros2jaus"}


def test_what_is_generated_is_what_stands_on_the_disk(page: Page, folder: Path) -> None:
    digest = page.ask("plan", file=FILE)["digest"]
    # Nobody has told of it yet when the button is pressed.
    (folder / FILE).write_text("<system:System", encoding="utf-8")
    with pytest.raises(RefusedError, match="cannot be read"):
        page.ask("generate", file=FILE, out="", digest=digest)
    assert [each.name for each in folder.iterdir()] == [FILE]


def test_a_new_file_appears(page: Page, folder: Path) -> None:
    (folder / "maps.ros2jaus").write_text("", encoding="utf-8")
    told = page.await_told("changed")
    assert [each["path"] for each in told["files"]] == [FILE, "maps.ros2jaus"]

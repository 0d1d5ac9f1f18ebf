"""Changes by other programs, broken ones among them."""

import pytest
from studio_client import RefusedError

from jausml.authoring.studio.memory import FOLDER

pytestmark = pytest.mark.ports

FILE = "catvehicle.xmi"


def test_a_change_by_another_program_appears(page, folder):
    page.ask("problems", file=FILE)
    text = (folder / FILE).read_text(encoding="utf-8")
    (folder / FILE).write_text(text.replace("<system:System", "<system:System ", 1))
    shown = page.await_told("outside")
    assert shown["file"] == FILE
    assert "+<system:System " in shown["diff"]
    told = page.await_told("changed")
    assert told["by"] == "outside"
    page.await_told("problems", lambda notification: notification["revision"] == told["revision"])


def test_a_broken_file_keeps_its_last_good_model_and_is_stale(page, folder):
    boxes = page.ask("view", file=FILE, view="system")["graph"]["nodes"]
    (folder / FILE).write_text("<system:System", encoding="utf-8")
    told = page.await_told("changed")
    assert [file["stale"] for file in told["files"]] == [True]
    problems = page.ask("problems", file=FILE)["problems"]
    assert any(problem["severity"] == "error" and problem["line"] == 1 for problem in problems)
    again = page.ask("view", file=FILE, view="system")["graph"]["nodes"]
    assert [node["element"] for node in again] == [box["element"] for box in boxes]
    assert (folder / FILE).read_text(encoding="utf-8") == "<system:System"


BROKEN = "bridge nav {{{ ??\n"
MARKED = "<<<<<<< HEAD\nbridge a { }\n=======\nbridge b { }\n>>>>>>> other\n"


@pytest.mark.parametrize(
    ("broken", "state"), [(BROKEN, "unreadable"), (MARKED, "conflict")], ids=["faulty", "merging"]
)
def test_what_cannot_be_read_gets_no_verdict_and_no_code(page, folder, broken, state):
    text = folder / "boat.ros2jaus"
    text.write_text("component helm { address: 1.2.3 }\n", encoding="utf-8")
    page.await_told("changed")
    file = text.name
    good = page.ask("view", file=file, view="system")
    assert good["freshness"]["state"] == "current"
    plan = page.ask("plan", file=file)
    assert plan["problems"] == ""

    text.write_text(f"component helm {{ address: 1.2.3 }}\n{broken}", encoding="utf-8")
    told = page.await_told(
        "changed", lambda notification: notification["revision"] > good["revision"]
    )
    # The picture is that of before, and says so; nothing else is of the past.
    seen = page.ask("view", file=file, view="system")
    assert [node["title"] for node in seen["graph"]["nodes"]] == ["helm"]
    assert seen["freshness"]["state"] == state
    assert seen["freshness"]["since"] == good["revision"]
    verdict = page.ask("problems", file=file)
    rule = "JML009" if state == "conflict" else "JML701"
    assert rule in {problem["rule"] for problem in verdict["problems"]}
    assert {problem["line"] for problem in verdict["problems"]} <= set(range(2, 8))
    assert file in verdict["fault"]
    refused = page.ask("plan", file=file)
    assert (refused["files"], refused["digest"]) == ([], "")
    assert file in refused["problems"]
    with pytest.raises(RefusedError, match=file):
        page.ask("generate", file=file, out="", digest=plan["digest"])
    assert [path.name for path in folder.iterdir() if path.is_dir()] == [FOLDER]

    text.write_text("component helm { address: 1.2.4 }\n", encoding="utf-8")
    page.await_told("changed", lambda notification: notification["revision"] > told["revision"])
    assert page.ask("problems", file=file)["fault"] == ""


def test_a_file_that_another_one_uses_and_that_cannot_be_read_counts_too(page, folder):
    parts = "component compass { address: 1.2.4 }\n"
    (folder / "parts.ros2jaus").write_text(parts, encoding="utf-8")
    (folder / "boat.ros2jaus").write_text(
        'import "parts.ros2jaus"\ncomponent helm { address: 1.2.3  controls: compass }\n',
        encoding="utf-8",
    )
    page.await_told("changed", lambda notification: len(notification["files"]) == 3)
    before = page.ask("problems", file="boat.ros2jaus")
    assert before["fault"] == ""
    (folder / "parts.ros2jaus").write_text(BROKEN, encoding="utf-8")
    page.await_told("changed", lambda notification: notification["revision"] > before["revision"])
    told = page.ask("problems", file="boat.ros2jaus")
    assert "parts.ros2jaus" in told["fault"]
    assert {problem["file"] for problem in told["problems"]} == {"parts.ros2jaus"}


def test_what_is_generated_is_what_stands_on_the_disk(page, folder):
    digest = page.ask("plan", file=FILE)["digest"]
    # Nobody has told of it yet when the button is pressed.
    (folder / FILE).write_text("<system:System", encoding="utf-8")
    with pytest.raises(RefusedError, match="cannot be read"):
        page.ask("generate", file=FILE, out="", digest=digest)
    assert {path.name for path in folder.iterdir()} <= {FILE, FOLDER}


def test_a_new_file_appears(page, folder):
    (folder / "maps.ros2jaus").write_text("", encoding="utf-8")
    told = page.await_told("changed")
    assert [file["path"] for file in told["files"]] == [FILE, "maps.ros2jaus"]

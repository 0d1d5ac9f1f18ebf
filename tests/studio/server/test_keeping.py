"""Edits that met a change beneath them are kept; faults of the studio can be read."""

import os
import resource
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from studio_client import LONGEST, Page, RefusedError, Server, serving, started

from jausml.authoring.editing.project import Project
from jausml.authoring.studio.context import StudioContext
from jausml.authoring.studio.handlers import showing

pytestmark = pytest.mark.ports


@pytest.fixture
def held(folder: Path, built: Path) -> Iterator[Server]:
    """A process that tests halt and limit."""
    with serving(folder / "catvehicle.xmi", built, start=started) as server:
        yield server


FILE = "boat.ros2jaus"
TEXT = "component helm { address: 1.1.1 }\ncomponent winch { address: 1.1.2 }\n"


def begin(page: Page, folder: Path) -> tuple[str, int]:
    """Makes a file; returns the ref of the winch, and the revision."""
    (folder / FILE).write_text(TEXT, encoding="utf-8")
    page.await_told("changed")
    seen = page.ask("view", file=FILE, view="system")
    ref = next(node["element"] for node in seen["graph"]["nodes"] if node["title"] == "winch")
    return ref, seen["revision"]


def addressed(element: str, address: str) -> dict[str, object]:
    return {"kind": "set", "element": element, "feature": "address", "values": [address]}


def test_an_edit_that_met_another_is_kept_until_it_is_done_or_discarded(page, folder):
    ref, base = begin(page, folder)
    (folder / FILE).write_text(TEXT.replace("1.1.2", "1.1.55"), encoding="utf-8")
    commands = [addressed(ref, "1.1.77")]
    with pytest.raises(RefusedError, match=r"to 1\.1\.55.* is kept") as refused:
        page.ask("edit", commands=commands, label="Set address of winch", base=base)
    assert refused.value.data["conflict"]
    (kept,) = page.ask("kept")["edits"]
    assert kept["label"] == "Set address of winch"
    assert kept["commands"][0]["values"] == ["1.1.77"]
    assert page.await_told("kept")["edits"] == [kept]
    # What it met is told, too, though nothing was done.
    assert page.await_told("outside")["file"] == FILE

    # Until somebody has decided nothing is made of the file.
    assert "Set address of winch" in page.ask("plan", file=FILE)["problems"]
    assert page.ask("view", file=FILE, view="system")["freshness"]["state"] == "conflict"

    page.ask("kept.again", number=kept["number"])
    assert (folder / FILE).read_text(encoding="utf-8") == TEXT.replace("1.1.2", "1.1.77")
    assert page.ask("kept")["edits"] == []
    assert page.ask("plan", file=FILE)["problems"] == ""
    with pytest.raises(RefusedError, match="no more"):
        page.ask("kept.again", number=kept["number"])


@contextmanager
def full_disk(server: Server) -> Iterator[None]:
    """Lets a studio store nothing as long as the context lasts, as a full disk does."""
    _, most = resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE)
    before = resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE, (0, most))
    try:
        yield
    finally:
        resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE, before)


@contextmanager
def halted(*servers: Server) -> Iterator[None]:
    """Halts studios as long as the context lasts, as a busy computer does."""
    for studio in servers:
        os.kill(studio.process.pid, signal.SIGSTOP)
    try:
        yield
    finally:
        for studio in servers:
            os.kill(studio.process.pid, signal.SIGCONT)


def seen_alike(*pages: Page) -> list[dict[str, Any]]:
    """Returns the pictures once they are the same: a studio learns soon what another one wrote."""
    end = time.monotonic() + LONGEST
    while True:
        seen = [page.ask("view", file=FILE, view="system") for page in pages]
        first, *others = (picture["graph"]["nodes"] for picture in seen)
        if all(nodes == first for nodes in others):
            return seen
        assert time.monotonic() < end, seen
        time.sleep(0.05)


def send(page: Page, view: dict[str, Any], wanted: tuple[str, str]) -> int:
    """Sends another address for a box of a picture; returns what names the answer."""
    title, address = wanted
    boxes = view["graph"]["nodes"]
    ref = next(box["element"] for box in boxes if box["title"] == title)
    commands = [addressed(ref, address)]
    return page.send("edit", commands=commands, label="Set", base=view["revision"])


@pytest.mark.slow
def test_a_full_disk_and_two_studios_at_the_same_moment_lose_nothing(held, folder, built):
    with serving(folder, built, start=started) as other, held.page() as one, other.page() as two:
        ref, base = begin(one, folder)
        two.await_told("changed")
        theirs = TEXT.replace("1.1.2", "1.1.55")
        (folder / FILE).write_text(theirs, encoding="utf-8")
        with pytest.raises(RefusedError, match="is kept"):
            one.ask("edit", commands=[addressed(ref, "1.1.77")], label="Set", base=base)
        (kept,) = one.ask("kept")["edits"]
        with full_disk(held):
            with pytest.raises(RefusedError, match="cannot be written"):
                one.ask("kept.again", number=kept["number"])
            assert one.ask("kept")["edits"] == [kept]
            assert (folder / FILE).read_text(encoding="utf-8") == theirs
        one.ask("kept.again", number=kept["number"])
        assert (folder / FILE).read_text(encoding="utf-8") == TEXT.replace("1.1.2", "1.1.77")
        assert one.ask("kept")["edits"] == []

        for turn in range(3):
            seen = seen_alike(one, two)
            wanted = [("helm", f"1.2.{turn + 1}"), ("winch", f"1.3.{turn + 1}")]
            with halted(held, other):
                sent = [send(*request) for request in zip((one, two), seen, wanted, strict=True)]
            for page, number in zip((one, two), sent, strict=True):
                assert page.answer(number)["created"] == []
            text = (folder / FILE).read_text(encoding="utf-8")
            assert f"1.2.{turn + 1}" in text
            assert f"1.3.{turn + 1}" in text
        # Of the same property one is done; the other is kept, with what it was to be.
        seen = seen_alike(one, two)
        wanted = [("helm", "1.4.1"), ("helm", "1.4.2")]
        with halted(held, other):
            sent = [send(*request) for request in zip((one, two), seen, wanted, strict=True)]
        refused = []
        for page, number in zip((one, two), sent, strict=True):
            try:
                page.answer(number)
            except RefusedError:
                refused.append(page)
        (late,) = refused
        (kept,) = late.ask("kept")["edits"]
        mine, theirs = ("1.4.1", "1.4.2") if late is one else ("1.4.2", "1.4.1")
        assert kept["commands"][0]["values"] == [mine]
        assert theirs in (folder / FILE).read_text(encoding="utf-8")


@pytest.mark.slow
def test_an_edit_whose_element_is_gone_stays_kept(page, folder):
    ref, base = begin(page, folder)
    (folder / FILE).write_text(TEXT.replace("winch", "crane"), encoding="utf-8")
    with pytest.raises(RefusedError, match="gone or has another name"):
        page.ask("edit", commands=[addressed(ref, "1.1.77")], label="Set", base=base)
    (kept,) = page.ask("kept")["edits"]
    with pytest.raises(RefusedError, match="gone or has another name"):
        page.ask("kept.again", number=kept["number"])
    (again,) = page.ask("kept")["edits"]
    assert again["commands"] == kept["commands"]
    page.ask("kept.discard", number=again["number"])
    assert page.ask("kept")["edits"] == []


def test_a_view_that_fails_is_shown_as_it_was_and_its_fault_can_be_read(folder, monkeypatch):
    (folder / FILE).write_text(TEXT, encoding="utf-8")
    context = StudioContext(Project(folder))
    first = showing.view(context, FILE, "system")

    def fail(*_: object) -> None:
        raise ZeroDivisionError("a fault of the view")

    with monkeypatch.context() as patched, context.faults.kept():
        patched.setattr(showing, "graph_of", fail)
        (folder / FILE).write_text(f"{TEXT}\n", encoding="utf-8")
        context.refresh()
        seen = showing.view(context, FILE, "system")
    assert seen["graph"] == first["graph"]
    assert seen["freshness"]["state"] == "stale"
    assert seen["freshness"]["since"] == first["revision"]
    (fault,) = context.faults.all
    assert "cannot be drawn" in fault["text"]
    assert "ZeroDivisionError: a fault of the view" in fault["details"]
    assert showing.view(context, FILE, "system")["freshness"]["state"] == "current"


@pytest.mark.slow
def test_a_host_is_drawn_and_used_before_anything_runs_there(page, folder):
    text = "system boat {\n  host deck { }\n  host engine { }\n"
    text += "  component helm { address: 1.1.1 }\n}\n"
    (folder / FILE).write_text(text, encoding="utf-8")
    page.await_told("changed")
    graph = page.ask("view", file=FILE, view="system")["graph"]
    assert [group["title"].split()[1] for group in graph["groups"]] == ["deck"]
    (empty,) = (node for node in graph["nodes"] if node["kind"] == "host")
    assert empty["title"].startswith("host engine")
    (helm,) = (node for node in graph["nodes"] if node["title"] == "helm")
    # No line begins or ends at a host.
    ends = [{"node": node["id"], "port": ""} for node in (helm, empty)]
    assert page.ask("ends", file=FILE, view="system", **ends[1])["ends"] == []
    refused = page.ask("connect", file=FILE, view="system", source=ends[0], target=ends[1])
    assert (refused["options"], bool(refused["refusal"])) == ([], True)

    option = page.ask("host", file=FILE, nodes=[helm["id"]], host=empty["id"])
    page.ask("edit", commands=option["commands"], label=option["label"])
    after = page.ask("view", file=FILE, view="system")["graph"]
    assert [group["title"].split()[1] for group in after["groups"]] == ["engine"]
    assert [node["title"].split()[1] for node in after["nodes"] if node["kind"] == "host"] == [
        "deck"
    ]

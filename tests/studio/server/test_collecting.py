"""Garbage: nobody waits for the collector at rest, nor for what stays forever."""

import asyncio
import gc
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from jausml.authoring.editing.project import Project
from jausml.authoring.studio import checking
from jausml.authoring.studio.checking import Checking, Verdict, Verdicts, prepare
from jausml.authoring.studio.context import StudioContext
from jausml.authoring.studio.session import Session

FILE = "catvehicle.xmi"


@pytest.fixture
def collections() -> Iterator[list[int]]:
    """The collections of all generations since the test began."""
    seen: list[int] = []

    def note(phase: str, info: dict[str, Any]) -> None:
        if phase == "start" and info["generation"] == 2:
            seen.append(gc.get_freeze_count())

    gc.callbacks.append(note)
    yield seen
    gc.callbacks.remove(note)
    gc.unfreeze()


def test_garbage_is_collected_once_after_a_change_and_never_at_rest(
    folder, collections, monkeypatch
):
    monkeypatch.setattr(checking, "_PAUSE", 0.01)
    thresholds = gc.get_threshold()
    prepare()
    before = len(collections)
    told = threading.Event()

    def tell(_: Verdict) -> None:
        told.set()

    looking = Checking(Verdicts(Project(folder / FILE)), lambda: [FILE], tell)
    looking.start()
    for _ in range(2):
        looking.begin()
        assert told.wait(30)
        told.clear()
        threading.Event().wait(0.5)  # many pauses
    looking.close()
    looking.join(30)
    after = collections[before:]
    assert 1 <= len(after) <= 2
    # What stays forever is looked at by none of them, and it is most of what there is.
    assert all(frozen > len(gc.get_objects()) / 2 for frozen in after)
    assert gc.get_freeze_count() == 0
    assert gc.get_threshold() == thresholds


# -- a session ends in order -----------------------------------------------------------------------


def test_what_another_program_wrote_is_taken_over_before_the_end(folder):
    project = Project(folder)
    asyncio.run(asyncio.wait_for(closed_while_busy(Session(StudioContext(project)), folder), 120))
    assert project.log
    assert all(entry.is_outside for entry in project.log)


async def closed_while_busy(session: Session, folder: Path) -> None:
    """Ends a session while changes take long and another one waits for its turn."""
    answering, may_go_on = session._answering, threading.Event()
    turns = answering._changes._work_queue
    async with session.running():
        busy = asyncio.ensure_future(answering.in_turn(lambda: may_go_on.wait(60)))
        file = folder / "catvehicle.xmi"
        text = file.read_text(encoding="utf-8")
        # The watcher may not be there yet: it sees one of several changes.
        while turns.empty():
            file.write_text(f"{text}<!-- {len(text)} -->\n", encoding="utf-8")
            text += "\n"
            await asyncio.sleep(0.2)
        asyncio.get_running_loop().call_later(0.5, may_go_on.set)
    await busy

"""Garbage: nobody waits for the collector at rest, nor for what stays forever."""

import gc
import threading
from collections.abc import Iterator
from typing import Any

import pytest

from jausml.authoring.editing.project import Project
from jausml.authoring.studio import checking
from jausml.authoring.studio.checking import Checking, Verdict, Verdicts, prepare

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

"""Targets are found through entry points."""

from __future__ import annotations

from importlib.metadata import EntryPoint

import pytest

from jausml import generation as gen
from jausml.generation import target as target_module

ALPHA = gen.Target("alpha", "A target.", lambda _: [])
BETA = gen.Target("beta", "A target.", lambda _: [])


@pytest.fixture
def install(monkeypatch):
    def run(*entries):
        points = [Point(name, value, target_module.ENTRY_POINT_GROUP) for name, value in entries]
        monkeypatch.setattr(target_module, "entry_points", lambda **_: points)

    return run


class Point(EntryPoint):
    """An entry point into this module, which pytest does not import under a stable name."""

    def load(self):
        if self.value.startswith("here:"):
            return globals()[self.value[5:]]
        return super().load()


def test_targets_are_sorted_by_name(install):
    install(("beta", "here:BETA"), ("alpha", "here:ALPHA"))

    assert list(gen.load_targets().items()) == [("alpha", ALPHA), ("beta", BETA)]


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        ([("alpha", "here:ALPHA"), ("alpha", "here:BETA")], "two installed targets have the name"),
        ([("alpha", "here:BETA")], "calls itself 'beta'"),
        ([("gone", "no_such_module_here:X")], r"target 'gone' \(no_such_module_here:X\)"),
        ([("odd", "os:sep")], "is no Target"),
    ],
)
def test_a_broken_installation_is_told(install, entries, message):
    install(*entries)

    with pytest.raises(gen.GenerationError, match=message):
        gen.load_targets()


def test_the_installed_group_is_the_documented_one(monkeypatch):
    asked = []
    monkeypatch.setattr(target_module, "entry_points", lambda group: asked.append(group) or [])

    assert gen.load_targets() == {}
    assert asked == ["jausml.targets"]

"""Targets are found through entry points."""

from importlib.metadata import EntryPoint

import pytest

from jausml.generation import target as target_module
from jausml.generation.errors import GenerationError
from jausml.generation.target import Target, load_targets

ALPHA = Target("alpha", "A target.", lambda _: [])
BETA = Target("beta", "A target.", lambda _: [])


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

    assert list(load_targets().items()) == [("alpha", ALPHA), ("beta", BETA)]


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

    with pytest.raises(GenerationError, match=message):
        load_targets()


def test_the_installed_group_is_the_documented_one(monkeypatch):
    asked = []
    monkeypatch.setattr(target_module, "entry_points", lambda group: asked.append(group) or [])

    assert load_targets() == {}
    assert asked == ["jausml.targets"]

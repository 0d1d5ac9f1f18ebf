"""Where items of a text stand is found by need: it is what a walk over the whole tree finds."""

from __future__ import annotations

from pathlib import Path

import pytest
from sweeps import sweep

from jausml.authoring.editing.text.source import Outline, TextSource
from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml.language.text.tree import Assignment, Element, Feature, lists_of

FILES = sorted(Path("models").rglob("*.ros2jaus"))


def outline_of(path):
    document = read_models([path], notations=NOTATIONS).model.documents[0]
    return Outline(document.written.tree, TextSource(document, path.name)), document.written.tree


def items_within(items):
    """All items of a tree, each with the block that has it, which may be a value."""
    pending = [(None, each) for each in items]
    for _, item in pending:
        owners = [each for each in getattr(item, "values", ()) if isinstance(each, Element)]
        for owner in owners if isinstance(item, Feature) else [item]:
            pending += [(owner, inner) for held, _ in lists_of(owner) for inner in held]
    return pending


@pytest.mark.parametrize("path", sweep(FILES, every=4), ids=lambda each: each.stem)
def test_what_is_found_by_need_is_what_a_walk_finds(path):
    outline, tree = outline_of(path)
    found = items_within(tree.items)
    assert found
    for owner, item in reversed(found):  # the innermost first: nothing is known around them
        body, index = outline.place(item)
        assert body.items[index] is item
        assert outline.holder(item) is None
        if isinstance(owner, Element):
            assert body is outline.body(owner)
        if isinstance(item, Feature):
            blocks = [each for each in item.values if isinstance(each, Element)]
            assert all(outline.holder(each) is item for each in blocks)
        if isinstance(item, Assignment):
            assert all(outline.holder(each) is item for each in item.conversions)

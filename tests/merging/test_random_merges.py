"""Random changes of both sides: a merge never fails, and where one side did nothing, is the other.

`JAUSML_EXAMPLES` raises how many are tried.
"""

import os
import random
import sys
from pathlib import Path

import pytest

from jausml.authoring.differences.finding import changes
from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.project import Project
from jausml.authoring.merging.merging import UnmergeableError, merged
from jausml.authoring.projects.texts import text_of
from jausml.language.model import LIBRARY_URI, read_models
from jausml.language.text.notation import NOTATIONS

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "editing"))

XMI = (ROOT / "models" / "minimal" / "minimal.xmi").read_text(encoding="utf-8")
BASES = {
    "model.xmi": XMI.replace("../library/", LIBRARY_URI),
    "model.ros2jaus": text_of(XMI, "minimal"),
}
SEEDS = range(min(int(os.environ.get("JAUSML_EXAMPLES", "2")), 100))
STEPS = 3


def edited(folder, name, chance):
    """Returns the base after some random commands that leave a model that can be read."""
    from random_commands import Commands

    folder.mkdir()
    (folder / name).write_text(BASES[name], encoding="utf-8")
    project = Project(folder)
    done = 0
    for _ in range(20 * STEPS):
        try:
            project.do([Commands(project, name, chance).any()], "random")
        except EditError:
            continue
        if project.model(name).has_errors:
            project.undo()
            continue
        done += 1
        if done == STEPS:
            break
    return project.text(name)


@pytest.mark.parametrize("name", BASES)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_merge_is_one_side_or_both(tmp_path, seed, name):
    ours = edited(tmp_path / "ours", name, random.Random(seed))
    theirs = edited(tmp_path / "theirs", name, random.Random(-1 - seed))
    root = (tmp_path / "merged").resolve()
    root.mkdir()

    def merge(*states):
        return merged(name, root, *states)

    base = BASES[name].encode()
    mine = merge(base, ours, base)
    assert (mine.data, mine.findings) == (ours, ())
    other = merge(base, base, theirs)
    assert other.findings == ()
    assert differences(tmp_path, name, other.data, theirs) == []
    try:
        both = merge(base, ours, theirs)
    except UnmergeableError as error:
        pytest.fail(f"the sides can be read, and what is merged must be too: {error}")
    assert not read(tmp_path / "both", name, both.data).has_errors


def differences(folder, name, one, other):
    first, second = (read(folder / n, name, d).model for n, d in (("one", one), ("other", other)))
    found = changes(first, second, list(zip(first.roots[:1], second.roots[:1], strict=True)))
    return [(change.element, change.path, change.text) for change in found]


def read(folder, name, data):
    folder.mkdir()
    (folder / name).write_bytes(data)
    return read_models([folder / name], notations=NOTATIONS)

"""Random edits of texts: the model is the old one and the command, and all can be taken back.

What an edit has written is formatted, and no comment is lost.
"""

import shutil
from pathlib import Path

import pytest
from editing_support import Commands, Edited, dense, loosened
from sweeps import sweep

from jausml.authoring.editing.commands import EditError, Remove, Set
from jausml.language.text.comments import ordinary_comments
from jausml.language.text.reading.parsing import parse
from jausml.language.text.writing.layout import lay_out

ROOT = Path(__file__).parents[3]
FILES = sorted((ROOT / "models").rglob("*.ros2jaus"))
LAYOUTS = {
    "canonical": lambda text: text,
    "loose": loosened,
    "dense": dense,
    "returns": lambda text: text.replace("\n", "\r\n"),
}
STEPS = 5
CASES = [(file, list(LAYOUTS)[at % len(LAYOUTS)]) for at, file in enumerate(FILES)]
CASES += [(file, layout) for file in FILES if file.stem == "catvehicle" for layout in LAYOUTS]


@pytest.mark.parametrize(
    ("file", "layout"),
    sweep(dict.fromkeys(CASES), every=12),
    ids=lambda parameter: getattr(parameter, "stem", parameter),
)
def test_random_edits(tmp_path, file, layout):
    folder = tmp_path / "models"
    shutil.copytree(file.parent, folder)
    path = folder / file.name
    path.write_bytes(LAYOUTS[layout](file.read_text()).encode())
    edited = Edited(path)
    commands = Commands(edited, seed=FILES.index(file))
    done = 0
    for _ in range(STEPS):
        command = commands.one()
        before = edited.data
        refusal = ""
        try:
            assert edited.differences(command) == [], command
            done += 1
        except EditError as error:
            refusal = str(error)
        # A plan that does not do what it says is one that should have been refused.
        assert "so nothing is done" not in refusal, command
        assert not refusal or edited.data == before
        if edited.data != before:
            check_layout(edited.data.decode(), before.decode(), command)
    assert done > STEPS // 3
    assert edited.undo_all() == edited.first


def check_layout(text, before, command):
    """What was written is as `jausml format` has it; a comment goes with what it is of alone."""
    laid_out = lay_out(parse(text).document)
    assert text.replace("\r\n", "\n") == laid_out
    if not isinstance(command, Remove) and not (isinstance(command, Set) and not command.values):
        old, new = (sorted(map(plain, ordinary_comments(source))) for source in (before, text))
        assert old == new, command


def plain(comment):
    return comment.replace("\r", "")

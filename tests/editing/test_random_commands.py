"""Random commands on all shipped XMI models, however they are written.

That an edit does what it says, `Project.do` checks itself; that check failing is a failure here.
"""

from __future__ import annotations

import random
import re
import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_commands import Commands

from jausml.editing.commands import EditError
from jausml.editing.project import Project
from jausml.model.uris import LIBRARY_URI
from jausml.model.xmi.writer import to_xmi

MODELS = sorted(Path("models").rglob("*.xmi"))
STEPS = 8
OUR_FAULTS = ("something else", "do not go together", "cannot be read")


def with_library(text, path):
    """Returns a model that names the library by its URI, so that it can stand anywhere."""

    def uri(match):
        target = (path.parent / match[1]).resolve()
        library = Path("models/library").resolve()
        is_in = target.is_relative_to(library)
        return f'href="{LIBRARY_URI}{target.relative_to(library)}#' if is_in else match[0]

    return re.sub(r'href="((?:\.\./)*[^"#:]+\.xmi)#', uri, text)


def with_comments(text):
    """Returns a model with comments wherever these may stand, and attributes on their own lines."""
    text = re.sub(r"(?m)^( +)(<\w)", r"\1<!-- ours: <x/> -->\n\1\2", text)
    text = re.sub(r"(?m)/>$", "/>  <!-- behind -->", text)
    return re.sub(r'" (\w+="[^"]*"/>)', r'"\n      \1', text)


VARIANTS = {
    "canonical": lambda text: text.encode(),
    "commented": lambda text: with_comments(text).encode(),
    "crlf": lambda text: with_comments(text).replace("\n", "\r\n").encode(),
    "one line": lambda text: re.sub(r">\s+<", "><", text).encode(),
    "tabs": lambda text: re.sub(r"(?m)^ +", lambda m: "\t" * (len(m[0]) // 2), text).encode(),
    "utf-8 with bom": lambda text: text.encode("utf-8-sig"),
    "utf-16": lambda text: text.replace("UTF-8", "UTF-16").encode("utf-16"),
    "utf-16 big endian": lambda text: ("\ufeff" + text.replace("UTF-8", "UTF-16")).encode(
        "utf-16-be"
    ),
    "latin-1": lambda text: text.replace("UTF-8", "ISO-8859-1").encode(
        "latin-1", "xmlcharrefreplace"
    ),
}


@pytest.mark.parametrize("path", MODELS, ids=str)
@given(data=st.data())
@settings(max_examples=max(1, settings().max_examples // 10))
def test_what_random_commands_do_is_undone_to_the_byte(path, data):
    variant = data.draw(st.sampled_from(sorted(VARIANTS)), label="variant")
    chance = random.Random(data.draw(st.integers(0, 2**32), label="seed"))
    text = with_library(path.read_text(encoding="utf-8"), path)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.xmi"
        file.write_bytes(VARIANTS[variant](text))
        before = file.read_bytes()
        project = Project(folder)
        states = [before]
        for _ in range(STEPS):
            entry = do_any(project, chance)
            if entry is not None and entry.number:
                states.append(file.read_bytes())
        for state in reversed(states):
            assert file.read_bytes() == state
            project.undo()
        for state in states:
            assert file.read_bytes() == state
            project.redo()


CANONICAL = [
    path
    for path in MODELS
    if path.name in ("minimal.xmi", "core-1.1.xmi", "mobility.xmi", "nav_msgs.xmi")
]


@pytest.mark.parametrize("path", CANONICAL, ids=str)
@given(seed=st.integers(0, 2**32))
@settings(max_examples=max(1, settings().max_examples // 10))
def test_a_model_as_eclipse_writes_it_stays_one(path, seed):
    chance = random.Random(seed)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.xmi"
        file.write_text(with_library(path.read_text(encoding="utf-8"), path), encoding="utf-8")
        project = Project(folder)
        assert lines_of(project) == written_lines(project)
        for _ in range(STEPS):
            do_any(project, chance)
            assert lines_of(project) == written_lines(project)


def lines_of(project):
    return without_namespaces(project.text("model.xmi").decode())


def written_lines(project):
    model = project.model("model.xmi").model
    return without_namespaces(to_xmi(model.documents[0].roots, model, project.root / "model.xmi"))


def without_namespaces(text):
    """Namespaces stay declared when nothing is of them any more."""
    return re.sub(r' xmlns:\w+="[^"]*"', "", text).splitlines()


def do_any(project, chance):
    command = Commands(project, "model.xmi", chance).any()
    try:
        return project.do([command], "any")
    except EditError as error:
        if any(each in str(error) for each in OUR_FAULTS):
            raise
        return None

"""Random commands on all shipped XMI models, however they are written.

That an edit does what it says, `Project.do` checks itself; that check failing is a failure here.
"""

import difflib
import random
import re
import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_commands import Commands
from sweeps import sweep

from jausml.authoring.editing.commands import Add, EditError, Remove, Set
from jausml.authoring.editing.project import Project
from jausml.language.model.library import LIBRARY_URI
from jausml.language.model.xmi.writer import to_xmi, write_model

MODELS = sorted(Path("models").rglob("*.xmi"))
STEPS = 5
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


LAYOUTS = {
    "canonical": lambda text: text,
    "commented": with_comments,
    "one line": lambda text: re.sub(r">\s+<", "><", text),
    "tabs": lambda text: re.sub(r"(?m)^ +", lambda m: "\t" * (len(m[0]) // 2), text),
}
"""How a file may be laid out; an edit lays it out anew."""

WRITINGS = {
    "utf-8": lambda text: text.encode(),
    "crlf": lambda text: text.replace("\n", "\r\n").encode(),
    "utf-8 with bom": lambda text: text.encode("utf-8-sig"),
    "utf-16": lambda text: text.replace("UTF-8", "UTF-16").encode("utf-16"),
    "utf-16 big endian": lambda text: ("\ufeff" + text.replace("UTF-8", "UTF-16")).encode(
        "utf-16-be"
    ),
    "latin-1": lambda text: text.replace("UTF-8", "ISO-8859-1").encode(
        "latin-1", "xmlcharrefreplace"
    ),
}
"""How its characters and line ends may be written; an edit keeps that."""


@pytest.mark.parametrize("path", sweep(MODELS, every=8), ids=str)
@given(data=st.data())
@settings(max_examples=max(1, settings().max_examples // 25))
def test_what_random_commands_do_is_undone_to_the_byte(path, data):
    layout = LAYOUTS[data.draw(st.sampled_from(sorted(LAYOUTS)), label="layout")]
    writing = WRITINGS[data.draw(st.sampled_from(sorted(WRITINGS)), label="writing")]
    chance = random.Random(data.draw(st.integers(0, 2**32), label="seed"))
    text = with_library(path.read_text(encoding="utf-8"), path)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.xmi"
        file.write_bytes(writing(layout(text)))
        before = file.read_bytes()
        project = Project(folder)
        states = [before]
        for _ in range(STEPS):
            command, entry = do_any(project, chance)
            if entry is not None and entry.number:
                states.append(file.read_bytes())
                if "model.xmi" in entry.files:
                    check_print(project, writing)
                    check_comments(states[-2], states[-1], command)
        for state in reversed(states):
            assert file.read_bytes() == state
            project.undo()
        for state in states:
            assert file.read_bytes() == state
            project.redo()


def check_print(project, writing):
    """Sees to it that a model is printed as EMF saves it, but for comments and encoding."""
    model = project.model("model.xmi").model
    if model.unread:
        return  # EMF would lose what we keep
    saved = writing(to_xmi(model.documents[0].roots, model, project.root / "model.xmi"))
    data = project.text("model.xmi")
    encoding = model.documents[0].encoding
    assert (b"\r\n" in data) == (b"\r\n" in saved)
    ours, theirs = (written.decode(encoding).replace("\r\n", "\n") for written in (data, saved))
    assert comments_gone(ours).splitlines() == theirs.splitlines()


def comments_gone(text):
    text = re.sub(r"(?m)^ *<!--.*?-->\n", "", text)
    text = re.sub(r"(?m)(?:  <!--.*?-->)+$", "", text)
    # What held comments alone is empty without them.
    return re.sub(r"(?m)^( *<([\w:]+)\b[^<>]*)(?<!/)>\n *</\2>$", r"\1/>", text)


def check_comments(before, after, command):
    """A comment goes with what it is of, and at no other time."""
    before, after = (data.replace(b"\0", b"").count(b"<!--") for data in (before, after))
    if not isinstance(command, Remove) and not (isinstance(command, Set) and not command.values):
        assert before == after, command


def laid_out(project, file):
    """Returns a project whose model is as EMF would save it."""
    model = project.model(file.name).model
    write_model(model.documents[0].roots, model, file)
    return Project(file.parent)


def do_any(project, chance):
    command = Commands(project, "model.xmi", chance).any()
    try:
        return command, project.do([command], "any")
    except EditError as error:
        if any(our_fault in str(error) for our_fault in OUR_FAULTS):
            raise
        return command, None


@given(seed=st.integers(0, 2**32))
@settings(max_examples=max(2, settings().max_examples // 10))
def test_a_difference_shows_the_edit_and_nothing_else(seed):
    chance = random.Random(seed)
    path = Path("models/catvehicle/catvehicle.xmi")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.xmi"
        file.write_text(with_library(path.read_text(encoding="utf-8"), path), encoding="utf-8")
        project = Project(folder)
        project = laid_out(project, file)
        commands = Commands(project, "model.xmi", chance)
        command = chance.choice([commands.rename, commands.add, commands.set])()
        if command is None:
            return
        before = project.text("model.xmi").decode().splitlines(keepends=True)
        obj, model = project.find(command.owner if isinstance(command, Add) else command.element)
        line = model.location(obj).line
        try:
            project.do([command], "any")
        except EditError:
            return
        after = project.text("model.xmi").decode().splitlines(keepends=True)
        matcher = difflib.SequenceMatcher(None, before, after, autojunk=False)
        changed = [opcode for opcode in matcher.get_opcodes() if opcode[0] != "equal"]
        gone = [at for _, start, end, _, _ in changed for at in range(start + 1, end + 1)]
        own = lines_of_element(before, line)
        if isinstance(command, Add):
            # The tag of an owner of nothing is opened, and references by position shift.
            own |= {at for at, text in enumerate(before, 1) if "@" in text} | namespaces(before)
        assert set(gone) <= own | namespaces(before), (command, [before[at - 1] for at in gone])


def lines_of_element(lines, line):
    """Returns the lines of an element, from that of its start tag on."""
    tag = re.search(r"<(\w+(?::\w+)?)", lines[line - 1])[1]
    depth = 0
    for at in range(line, len(lines) + 1):
        text = re.sub(r"<!--.*?-->", "", lines[at - 1])
        depth += len(re.findall(rf"<{tag}\b", text)) - len(re.findall(rf"</{tag}>", text))
        depth -= len(re.findall(r"/>", text)) if depth == 1 and is_closed_by(text, tag) else 0
        if depth <= 0:
            return set(range(line, at + 1))
    return set(range(line, len(lines) + 1))


def is_closed_by(text, tag):
    """Tells whether a line ends the tag of an element, which may have begun before."""
    return "/>" in text and (f"<{tag}" in text or "<" not in text)


def namespaces(lines):
    return {at for at, line in enumerate(lines, 1) if "xmlns" in line}

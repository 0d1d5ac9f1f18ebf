"""Random sequences of two studios, an editor and git on one folder: nothing is lost or pretended.

Each step is judged by what stands on the disk before and after it. Components are told apart by
their addresses, which nobody changes.
"""

from __future__ import annotations

import random
import shutil
import subprocess
from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import pytest

from jausml.editing.commands import EditError
from jausml.editing.project import Project
from jausml.editing.reading import can_be_parsed
from jausml.metamodel.classes import jaus
from jausml.model import read_models
from jausml.proposals.elements import AnswerError
from jausml.studio.asking import editing, generating, showing
from jausml.studio.desk import Desk
from jausml.studio.typed import typed
from jausml.text.notation import NOTATIONS

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

FILE = "boat.ros2jaus"
BEGINNING = "\n".join(f"component c{i} {{ address: 1.1.{i} }}" for i in range(1, 5)) + "\n"
GARBAGE = "component {{{ ??\n"
STEPS = 40

Components = dict[str, tuple[str, str]]
"""Name and documentation of each component by its address."""


@dataclass
class Studio:
    """A studio, and a page of it that may show what was long ago."""

    root: Path
    refs: dict[str, str] = field(default_factory=dict)
    base: int = 0
    digest: str = ""

    def __post_init__(self) -> None:
        self.open()

    def open(self) -> None:
        """Begins anew, as after a kill: what only the process knew is gone."""
        self.desk = Desk(Project(self.root))
        self.methods = {
            name: method
            for module in (showing, editing, generating)
            for name, method in module.methods(self.desk).items()
        }
        self.first = (self.root / FILE).read_bytes()
        self.look()

    def ask(self, name: str, **params: object) -> Any:
        method = self.methods[name]
        return method.answer(typed(method.params, dict(params)))

    def look(self) -> None:
        """Brings the page to what the project knows now."""
        project = self.desk.project
        model = project.model(FILE).model
        found = model.instances(jaus.Component, library=False)
        self.refs = {str(each.address): project.ref(each, model) for each in found}
        self.base = project.revision


@dataclass
class Walk:
    """The folder with all who work on it."""

    root: Path
    chance: random.Random
    studios: list[Studio] = field(default_factory=list)
    done: list[str] = field(default_factory=list)
    count: int = 10
    outcomes: Counter[bool] = field(default_factory=Counter)

    def __post_init__(self) -> None:
        (self.root / FILE).write_text(BEGINNING, encoding="utf-8")
        self.git("init", "-q")
        self.git("add", FILE)
        self.commit()
        self.studios = [Studio(self.root), Studio(self.root)]

    def git(self, *words: str) -> None:
        who = ("-c", "user.name=Sailor", "-c", "user.email=sailor@example.org")
        subprocess.run(["git", *who, *words], cwd=self.root, check=True, capture_output=True)

    def commit(self) -> None:
        self.git("commit", "-q", "--allow-empty", "-a", "-m", "state")

    @property
    def data(self) -> bytes:
        return (self.root / FILE).read_bytes()

    def fresh(self, letter: str) -> str:
        self.count += 1
        return f"{letter}{self.count}"

    def components(self) -> Components | None:
        """Returns what stands on the disk, None where that cannot be read."""
        if not can_be_parsed(FILE, self.data):
            return None
        model = read_models([self.root / FILE], notations=NOTATIONS).model
        found = model.instances(jaus.Component, library=False)
        return {str(e.address): (str(e.name), e.documentation or "") for e in found}

    # What may happen

    def describe(self, studio: Studio) -> None:
        self.edit(studio, _set, 1)

    def rename(self, studio: Studio) -> None:
        self.edit(studio, lambda ref, new: {"kind": "rename", "element": ref, "name": new}, 0)

    def edit(
        self, studio: Studio, make: Callable[[str, str], Mapping[str, object]], part: int
    ) -> None:
        """Sends an edit of what the page shows, however old that is."""
        if not studio.refs:
            return
        address, ref = self.chance.choice(sorted(studio.refs.items()))
        new = self.fresh("w")

        def expected(before: Components) -> Components:
            name, words = before[address]
            return {**before, address: (name, new) if part else (new, words)}

        self.send(studio, make(ref, new), expected)

    def add(self, studio: Studio) -> None:
        new, address = self.fresh("w"), f"1.2.{self.count}"
        owner = f"{FILE}#/"
        values = {"name": [new], "address": [address]}
        command = {"kind": "add", "owner": owner, "feature": "components", "values": values}
        command["type"] = "jaus.Component"
        self.send(studio, command, lambda before: {**before, address: (new, "")})

    def remove(self, studio: Studio) -> None:
        if len(studio.refs) < 3:
            return
        address, ref = self.chance.choice(sorted(studio.refs.items()))

        def expected(before: Components) -> Components:
            return {at: each for at, each in before.items() if at != address}

        self.send(studio, {"kind": "remove", "element": ref}, expected)

    def place(self, studio: Studio) -> None:
        positions = {"component:c1": [self.count, 5]}
        command = {"kind": "place", "file": FILE, "view": "system", "positions": positions}
        self.send(studio, command, lambda before: before)

    def send(
        self,
        studio: Studio,
        command: Mapping[str, object],
        expected: Callable[[Components], Components],
    ) -> None:
        before, data, kept = self.components(), self.data, len(studio.desk.kept.all)
        refused: EditError | None = None
        try:
            studio.ask("edit", commands=[command], label="Edit", base=studio.base)
        except EditError as error:
            refused = error
        self.outcomes[refused is not None] += 1
        if refused is not None:
            # Nothing was done, and what was wanted is there to be done again.
            assert self.data == data, refused
            assert len(studio.desk.kept.all) == kept + refused.conflict, refused
        elif command["kind"] != "place":
            # It did what it says, and nothing that stood there went.
            assert before is not None
            assert self.components() == expected(before)

    def again(self, studio: Studio) -> None:
        edits = studio.ask("kept")["edits"]
        if not edits:
            return
        data = self.data
        try:
            studio.ask("kept.again", number=edits[0]["number"])
        except EditError:
            assert self.data == data
            assert len(studio.desk.kept.all) == len(edits)
        else:
            assert len(studio.desk.kept.all) == len(edits) - 1

    def discard(self, studio: Studio) -> None:
        for each in studio.ask("kept")["edits"]:
            studio.ask("kept.discard", number=each["number"])

    def undo(self, studio: Studio) -> None:
        self.step(studio, "undo")

    def redo(self, studio: Studio) -> None:
        self.step(studio, "redo")

    def step(self, studio: Studio, way: str) -> None:
        data = self.data
        try:
            studio.ask(way)
        except EditError:
            assert self.data == data

    def told(self, studio: Studio) -> None:
        studio.desk.refresh()
        studio.look()

    def judge(self, studio: Studio) -> None:
        """Asks for all that may be of the past: it says so, or it is not."""
        studio.desk.refresh()
        is_readable, is_kept = self.components() is not None, bool(studio.desk.kept.all)
        wanted = "unreadable" if not is_readable else "conflict" if is_kept else "current"
        picture = studio.ask("view", file=FILE, view="system")
        verdict = studio.ask("problems", file=FILE)
        plan = studio.ask("plan", file=FILE)
        assert {each["freshness"]["state"] for each in (picture, verdict, plan)} == {wanted}
        if wanted == "current":
            titles = sorted(each["title"] for each in picture["graph"]["nodes"])
            assert titles == sorted(name for name, _ in (self.components() or {}).values())
            assert verdict["fault"] == ""
            studio.digest = plan["digest"] or studio.digest
            return
        assert plan["problems"]
        assert not plan["files"]
        assert bool(verdict["fault"]) == (not is_readable)
        with pytest.raises(AnswerError):
            studio.ask("generate", file=FILE, out="", digest=studio.digest)

    def generate_unseen(self, studio: Studio) -> None:
        """Presses the button before anybody has told what stands on the disk."""
        if self.components() is None:
            with pytest.raises(AnswerError):
                studio.ask("generate", file=FILE, out="", digest=studio.digest)
        assert not [each for each in self.root.iterdir() if each.name.endswith("_ws")]

    def kill(self, studio: Studio) -> None:
        studio.open()

    def type(self, _: Studio) -> None:
        """Changes a word in an editor that shows what is stored."""
        text = self.data.decode()
        new = f"component {self.fresh('e')} {{ address: 1.3.{self.count} }}\n"
        lines = text.splitlines(keepends=True)
        top = 1 if text.startswith("component ") else len(lines)
        if self.components() is not None and top == 1:
            (self.root / FILE).write_text(new + text, encoding="utf-8")

    def break_it(self, _: Studio) -> None:
        (self.root / FILE).write_bytes(self.data + GARBAGE.encode())

    def mend_it(self, _: Studio) -> None:
        (self.root / FILE).write_bytes(self.data.replace(GARBAGE.encode(), b""))

    def check_in(self, _: Studio) -> None:
        if self.components() is not None:
            self.commit()

    def check_out(self, _: Studio) -> None:
        self.git("checkout", "-q", "-f", "HEAD", "--", FILE)


def _set(ref: str, new: str) -> Mapping[str, object]:
    return {"kind": "set", "element": ref, "feature": "documentation", "values": [new]}


OFTEN = {
    Walk.describe: 30,
    Walk.rename: 10,
    Walk.add: 8,
    Walk.remove: 6,
    Walk.place: 4,
    Walk.undo: 8,
    Walk.redo: 5,
    Walk.told: 20,
    Walk.judge: 12,
    Walk.generate_unseen: 5,
    Walk.again: 6,
    Walk.discard: 6,
    Walk.kill: 4,
    Walk.type: 10,
    Walk.break_it: 5,
    Walk.mend_it: 8,
    Walk.check_in: 4,
    Walk.check_out: 4,
}


@pytest.mark.skipif(shutil.which("git") is None, reason="needs git")
@pytest.mark.parametrize("seed", range(12))
def test_a_random_walk_loses_nothing_and_pretends_nothing(tmp_path: Path, seed: int) -> None:
    walk = Walk(tmp_path, random.Random(seed))
    for _ in range(STEPS):
        [step] = walk.chance.choices(list(OFTEN), OFTEN.values())
        studio = walk.chance.choice(walk.studios)
        walk.done.append(f"{step.__name__} {walk.studios.index(studio)}")
        try:
            step(walk, studio)
        except AssertionError as error:
            raise AssertionError(f"{error}\nafter: {', '.join(walk.done)}") from error
    assert walk.outcomes.total() > 5
    for studio in walk.studios:
        studio.desk.refresh()
        while studio.ask("undo")["entry"] is not None:
            pass
        assert walk.data == studio.first, f"after: {', '.join(walk.done)}"

"""Random sequences of two studios, an editor, git, slow lines and full disks: nothing is lost.

Nothing is pretended either. Each step is judged by what stands on the disk before and after it.
Components are told apart by their addresses, which nobody changes.
"""

from __future__ import annotations

import random
import resource
import subprocess
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from generated import model_of
from sweeps import sweep

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.project import Project
from jausml.authoring.editing.reading import can_be_parsed
from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.context import StudioContext
from jausml.authoring.studio.session import methods_of
from jausml.language.metamodel.classes import jaus
from jausml.live.serving.rpc import as_json, typed

pytestmark = pytest.mark.slow


FILE = "boat.ros2jaus"
BEGINNING = "\n".join(f"component c{i} {{ address: 1.1.{i} }}" for i in range(1, 5)) + "\n"
GARBAGE = "component {{{ ??\n"
STEPS = 50

Components = dict[str, tuple[str, str]]
"""Name and documentation of each component by its address."""


@dataclass
class Studio:
    """A studio, and a page of it that may show what was long ago."""

    root: Path
    refs: dict[str, str] = field(default_factory=dict)
    base: int = 0
    digest: str = ""
    seen: Components = field(default_factory=dict)
    """What stood on the disk when the page looked last."""
    looked: int = 0
    """After how many steps it did."""
    late: list[Callable[[], None]] = field(default_factory=list)
    """Edits that are on their way."""

    def __post_init__(self) -> None:
        self.open()

    def open(self) -> None:
        """Begins anew, as after a kill: what only the process knew is gone."""
        self.context = StudioContext(Project(self.root))
        self.late.clear()
        self.methods = methods_of(self.context)
        self.first = (self.root / FILE).read_bytes()
        self.look()

    def ask(self, name: str, **params: object) -> Any:
        return as_json(typed(self.methods[name].answer, dict(params))())

    def look(self) -> None:
        """Brings the page to what the project knows now."""
        project = self.context.project
        model = project.model(FILE).model
        found = model.instances(jaus.Component, library=False)
        self.refs = {str(component.address): project.ref(component, model) for component in found}
        self.base = project.revision
        self.seen = {str(e.address): (str(e.name), e.documentation or "") for e in found}


@dataclass
class Walk:
    """The folder with all who work on it."""

    root: Path
    chance: random.Random
    studios: list[Studio] = field(default_factory=list)
    done: list[str] = field(default_factory=list)
    count: int = 10
    outcomes: Counter[bool] = field(default_factory=Counter)
    changed: dict[tuple[str, int], tuple[int, Studio | None]] = field(default_factory=dict)
    """After how many steps, and by which studio, name or documentation became what it is."""
    last: Components = field(default_factory=dict)

    def __post_init__(self) -> None:
        (self.root / FILE).write_text(BEGINNING, encoding="utf-8")
        self.git("init", "-q")
        self.git("add", FILE)
        self.commit()
        self.studios = [Studio(self.root), Studio(self.root)]
        self.last = self.components() or {}

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
        model = model_of(self.root / FILE)
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
        new, judge = self.fresh("w"), self.unseen(studio, address, part)

        def expected(before: Components) -> Components:
            judge(before)
            name, words = before[address]
            return {**before, address: (name, new) if part else (new, words)}

        self.send(studio, make(ref, new), expected)

    def hold(self, studio: Studio) -> None:
        """Sends an edit by a slow line: it arrives when others have gone on."""
        if studio.refs:
            address, ref = self.chance.choice(sorted(studio.refs.items()))
            new, judge, base = self.fresh("w"), self.unseen(studio, address, 1), studio.base

            def expected(before: Components) -> Components:
                judge(before)
                return {**before, address: (before[address][0], new)}

            studio.late.append(lambda: self.send(studio, _set(ref, new), expected, base))

    def arrive(self, studio: Studio) -> None:
        while studio.late:
            studio.late.pop(0)()

    def unseen(self, studio: Studio, address: str, part: int) -> Callable[[Components], None]:
        """Returns what asserts that nothing is overwritten that others made and nobody saw."""
        shown, looked = studio.seen[address][part], studio.looked

        def judge(before: Components) -> None:
            when, who = self.changed.get((address, part), (0, None))
            assert when <= looked or who is studio or before[address][part] == shown

        return judge

    def take(self, step: Callable[[Walk, Studio], None], studio: Studio) -> None:
        """Does a step, and notes who has changed what."""
        step(self, studio)
        after = self.components()
        if after is None:
            return
        who = studio if step in OF_STUDIOS else None
        for address, values in after.items():
            old = self.last.get(address, ("", ""))
            for part in (0, 1):
                if old[part] != values[part]:
                    self.changed[address, part] = (len(self.done), who)
        self.last = after

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
            return {at: component for at, component in before.items() if at != address}

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
        base: int | None = None,
    ) -> None:
        base = studio.base if base is None else base
        before, data, kept = self.components(), self.data, len(studio.context.kept)
        refused: EditError | None = None
        try:
            studio.ask("edit", commands=[command], label="Edit", base=base)
        except EditError as error:
            refused = error
        self.outcomes[refused is not None] += 1
        if refused is not None:
            # Nothing was done, and what was wanted is there to be done again.
            assert self.data == data, refused
            assert len(studio.context.kept) == kept + refused.conflict, refused
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
            assert len(studio.context.kept) == len(edits)
        else:
            assert len(studio.context.kept) == len(edits) - 1

    def discard(self, studio: Studio) -> None:
        for edit in studio.ask("kept")["edits"]:
            studio.ask("kept.discard", number=edit["number"])

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

    def on_a_full_disk(self, studio: Studio) -> None:
        """Nothing can be stored: nothing is done then, and nothing that was kept is lost."""
        doing = self.chance.choice([Walk.describe, Walk.rename, Walk.add, Walk.again, Walk.undo])
        data, kept = self.data, {edit.number for edit in studio.context.kept}
        with full_disk():
            doing(self, studio)
        assert self.data == data
        assert kept <= {edit.number for edit in studio.context.kept}

    def told(self, studio: Studio) -> None:
        studio.context.refresh()
        studio.look()
        studio.looked = len(self.done)

    def judge(self, studio: Studio) -> None:
        """Asks for all that may be of the past: it says so, or it is not."""
        studio.context.refresh()
        is_readable, is_kept = self.components() is not None, bool(studio.context.kept)
        wanted = "unreadable" if not is_readable else "conflict" if is_kept else "current"
        picture = studio.ask("view", file=FILE, view="system")
        verdict = studio.ask("problems", file=FILE)
        plan = studio.ask("plan", file=FILE)
        assert picture["freshness"]["state"] == wanted
        if wanted == "current":
            titles = sorted(node["title"] for node in picture["graph"]["nodes"])
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
        assert not [path for path in self.root.iterdir() if path.name.endswith("_ws")]

    def kill(self, studio: Studio) -> None:
        studio.open()
        studio.looked = len(self.done)

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


@contextmanager
def full_disk() -> Iterator[None]:
    """Lets this process store nothing as long as the context lasts."""
    least, most = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, most))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (least, most))


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
    Walk.hold: 12,
    Walk.arrive: 8,
    Walk.on_a_full_disk: 6,
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


OF_STUDIOS = frozenset(OFTEN) - {
    Walk.type,
    Walk.break_it,
    Walk.mend_it,
    Walk.check_in,
    Walk.check_out,
}


@pytest.mark.needs("git")
@pytest.mark.parametrize("seed", sweep(range(20), every=7))
def test_a_random_walk_loses_nothing_and_pretends_nothing(tmp_path, seed):
    walk = Walk(tmp_path, random.Random(seed))
    for _ in range(STEPS):
        [step] = walk.chance.choices(list(OFTEN), OFTEN.values())
        studio = walk.chance.choice(walk.studios)
        walk.done.append(f"{step.__name__} {walk.studios.index(studio)}")
        try:
            walk.take(step, studio)
        except AssertionError as error:
            raise AssertionError(f"{error}\nafter: {', '.join(walk.done)}") from error
    assert walk.outcomes.total() > 5
    for studio in walk.studios:
        studio.context.refresh()
        while studio.ask("undo")["entry"] is not None:
            pass
        assert walk.data == studio.first, f"after: {', '.join(walk.done)}"

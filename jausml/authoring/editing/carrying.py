"""Carrying out of commands in a draft, one after the other, each checked by reading again."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.authoring.editing.applying import Applying
from jausml.authoring.editing.batches import with_created
from jausml.authoring.editing.commands import NEW, Add, Create, EditError, Move, Place, Rename, Set
from jausml.authoring.editing.comparing import renewed
from jausml.authoring.editing.creating import new_document
from jausml.authoring.editing.following import followed
from jausml.authoring.editing.forest import Forest
from jausml.authoring.editing.layout import layout_file, placed, read_layout, write_layout
from jausml.authoring.editing.planning import Context
from jausml.authoring.editing.records import Referrer
from jausml.authoring.editing.text.planner import TextPlanner
from jausml.authoring.editing.xmi.planner import XmiPlanner
from jausml.language.model import refs
from jausml.language.model.collector import without_collector
from jausml.language.text.notation import SUFFIX

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from jausml.authoring.editing.commands import Command, Remove
    from jausml.authoring.editing.drafts import Draft
    from jausml.authoring.editing.forest import Thing
    from jausml.authoring.editing.layout import Layout
    from jausml.authoring.editing.planning import Planner
    from jausml.language.metamodel import ClassTable
    from jausml.language.model.model import Model
    from jausml.language.model.refs import Ref

_NAMING = ("name", "urn", "version")
"""The features by which texts find elements: of one service in several versions the newest."""
_BY_NAME = re.compile(rb"""#/+[^/@"'\s]|@\w+\[|["'\s]//[^@"'\s]""")


@dataclass(frozen=True, slots=True)
class Outcome:
    """What commands did.

    Attributes:
        forest: The elements of the files that were changed, and of those that refer to them.
        shifts: How each command changed refs: new ones by old ones, empty for what is gone.
    """

    created: tuple[Ref, ...]
    referrers: tuple[Referrer, ...]
    forest: Forest
    shifts: tuple[Mapping[Ref, Ref], ...]


def planner_of(file: str) -> Planner:
    """Returns the planner of the notation of a file."""
    if file.endswith(SUFFIX):
        return TextPlanner()
    return XmiPlanner()


def carry_out(commands: Sequence[Command], draft: Draft, known: Forest | None = None) -> Outcome:
    """Carries out commands in a draft.

    Args:
        known: The forest of an earlier outcome, which spares making one where it still holds. It
            is worth nothing any more.

    Raises:
        EditError: They cannot be carried out; the draft is worth nothing any more.
    """
    with without_collector():
        work = _Work(draft, known)
        for each in commands:
            work.carry_out(each)
        return work.outcome()


def names_elements(file: str, data: bytes) -> bool:
    """Tells whether a file may refer to elements by their names."""
    return file.endswith(SUFFIX) or _BY_NAME.search(data.replace(b"\0", b"")) is not None


def referrers(ref: Ref, draft: Draft) -> tuple[Referrer, ...]:
    """Returns what refers to an element or to what it owns, in all files."""
    models = {each: draft.read(each).model for each in draft.referring(draft.editable(ref))}
    forest = Forest.grown(models, draft.root)
    targets = set(thing_of(ref, forest).everything())
    fragments = forest.fragments()
    return tuple(
        Referrer(forest.ref(thing, fragments), thing.label, name)
        for thing, name in forest.referrers(targets)
        if thing not in targets
    )


def thing_of(ref: Ref, forest: Forest) -> Thing:
    """Returns the thing of a ref of one of the files of a forest."""
    thing = forest.find(ref)
    if thing is None:
        raise EditError(f"there is no element {ref} any more", conflict=True)
    return thing


class _Work:
    """Work on a draft.

    The forest of one command is compared with what is read after it, and becomes that of the next.
    """

    def __init__(self, draft: Draft, known: Forest | None) -> None:
        self._draft = draft
        is_current = known is not None and all(
            file in draft.files and draft.read(file).model is model
            for file, model in known.models.items()
        )
        self._forest = known if known is not None and is_current else Forest({}, draft.root)
        self._created: list[Thing] = []
        self._referrers: list[Referrer] = []
        self._shifts: list[Mapping[Ref, Ref]] = []

    def outcome(self) -> Outcome:
        fragments = self._forest.fragments() if self._created else {}
        created = [self._forest.ref(each, fragments) for each in self._created]
        shifts = tuple(self._shifts)
        return Outcome(tuple(created), tuple(self._referrers), self._forest, shifts)

    def carry_out(self, command: Command) -> None:
        """Plans a command, makes the changes in the draft, and checks them."""
        if isinstance(command, Place):
            self._place(command)
        elif isinstance(command, Create):
            self._create(command)
        else:
            self._edit(with_created(command, self._known))

    def _place(self, command: Place) -> None:
        if command.file not in self._draft.models:
            raise EditError(f"{command.file} is no model file of the opened folder")
        layout = placed(self._layout_of(command.file), command.view, command.positions)
        self._draft.put(layout_file(command.file), write_layout(layout) or None)

    def _layout_of(self, file: str) -> Layout:
        held = self._draft.files.get(layout_file(file))
        return read_layout(held.data) if held is not None else {}

    def _create(self, command: Create) -> None:
        data, later = new_document(command, self._draft)
        self._draft.put(command.file, data)
        self._take([command.file])
        self._created.append(self._forest.roots[command.file][0])
        number = len(self._created) - 1
        for name, values in later.items():
            self.carry_out(Set(f"{NEW}{number}", name, values))

    def _edit(self, command: Set | Add | Remove | Move | Rename) -> None:
        files = self._concerned(command)
        self._take(files)
        forest = self._forest
        paths = forest.paths()
        is_shifting = not isinstance(command, Set | Rename)
        before = forest.refs(paths) if is_shifting else {}
        applying = Applying(forest, self._find, self._draft.read(files[0]).model.metamodels)
        applying.apply(command)
        self._referrers += _referrers_of(applying, paths)
        plans = {}
        for file in files:
            model = self._draft.read(file).model
            context = Context(file, self._draft.root, model, forest, paths, self._draft.locate)
            plans[file] = planner_of(file).plan(applying.steps, context)
        for file, splices in plans.items():
            self._draft.apply(file, splices)
        self._check(applying)
        if is_shifting:
            self._shifts.append(_shift(before, self._forest.refs()))

    def _check(self, applying: Applying) -> None:
        """Reads what was changed, and sees to it that it is what was meant."""
        models = self._read(list(self._forest.roots))
        read = renewed(self._forest, models, applying.changed.keys())
        for file in self._forest.roots:
            if layout_file(file) in self._draft.files:
                layout = followed(self._layout_of(file), file, self._forest, read)
                self._draft.put(layout_file(file), write_layout(layout) or None)
        there = set(read.things.values()) if self._created else set()
        self._created = [each for each in self._created if each in there]
        self._created += applying.created
        self._forest = read

    def _take(self, files: Sequence[str]) -> None:
        """Has the forest hold the elements of some files, and of those where something was made."""
        wanted = dict.fromkeys([*(self._forest.roots if self._created else ()), *files])
        if set(wanted) == set(self._forest.roots):
            return
        forest = Forest.grown(self._read(list(wanted)), self._draft.root)
        created = [self._forest.ref(each) for each in self._created]
        self._created = [thing_of(each, forest) for each in created]
        self._forest = forest

    def _read(self, files: Sequence[str]) -> dict[str, Model]:
        for file in files:
            self._draft.check(file)
        return {file: self._draft.read(file).model for file in files}

    def _concerned(self, command: Set | Add | Remove | Move | Rename) -> list[str]:
        """Returns the files that a command may change, that of its element first."""
        named = [] if isinstance(command, Add) else [command.element]
        named += [command.owner] if isinstance(command, Add | Move) else []
        for each in named:
            self._draft.element(each)
        files = [self._draft.editable(each) for each in named]
        if isinstance(command, Set) and command.feature not in _NAMING:
            return files
        found = dict.fromkeys(f for each in files for f in self._draft.referring(each))
        if isinstance(command, Set | Rename):
            return [f for f in found if f in files or names_elements(f, self._draft.files[f].data)]
        return list(found)

    def _find(self, ref: Ref) -> tuple[Thing | Ref, ClassTable]:
        if refs.split(ref)[0] in self._forest.models:
            thing = thing_of(ref, self._forest)
            return thing, thing.table
        obj, model = self._draft.locate(ref)
        return refs.ref_of(obj, model, self._draft.root), model.metamodels.class_of(obj)

    def _known(self, ref: Ref) -> Ref:
        """Returns what `new:0` and `new:0/@maps.1` stand for, and any other ref as it is."""
        if not ref.startswith(NEW):
            return ref
        number, parting, path = ref.removeprefix(NEW).partition("/")
        if not number.isdecimal() or int(number) >= len(self._created):
            raise EditError(f"{ref} is nothing that was added before")
        return f"{self._forest.ref(self._created[int(number)])}{parting}{path}"


def _shift(before: Mapping[Thing, Ref], after: Mapping[Thing, Ref]) -> dict[Ref, Ref]:
    """Returns the new refs of things by the old ones where they differ, empty for what is gone."""
    pairs = ((ref, after.get(thing, "")) for thing, ref in before.items())
    return {old: new for old, new in pairs if old != new}


def _referrers_of(applying: Applying, paths: Mapping[Thing, str]) -> Iterable[Referrer]:
    """Yields what goes with an element that is removed, and what loses its reference to it."""
    for thing in applying.removed[1:]:
        yield Referrer(f"{thing.file}#{paths[thing]}", thing.label, "")
    for thing, names in applying.changed.items() if applying.removed else ():
        for name in names:
            yield Referrer(f"{thing.file}#{paths[thing]}", thing.label, name)

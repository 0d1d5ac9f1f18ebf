"""Carrying out of commands in a draft, one after the other, each checked by reading again."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

from jausml.editing.applying import Applying
from jausml.editing.commands import NEW, Add, Child, EditError, Move, Remove, Rename, Set
from jausml.editing.comparing import matched
from jausml.editing.forest import Forest, Thing
from jausml.editing.planning import Context
from jausml.editing.records import Referrer
from jausml.editing.xmi.planner import XmiPlanner
from jausml.model import refs
from jausml.text.notation import SUFFIX

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from jausml.editing.commands import Command, Values
    from jausml.editing.drafts import Draft
    from jausml.editing.planning import Planner
    from jausml.metamodel import ClassTable
    from jausml.model.refs import Ref

AddedT = TypeVar("AddedT", Add, Child)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What commands did: the elements that they made, and what lost its reference or went too."""

    created: tuple[Ref, ...] = ()
    referrers: tuple[Referrer, ...] = ()


def planner_of(file: str) -> Planner:
    """Returns the planner of the notation of a file."""
    if file.endswith(SUFFIX):
        raise EditError(f"{file} is text, which cannot be edited by commands yet")
    return XmiPlanner()


def carry_out(commands: Sequence[Command], draft: Draft) -> Outcome:
    """Carries out commands in a draft.

    Args:
        commands: The commands, each of which finds what those before it did.
        draft: The draft.

    Raises:
        EditError: They cannot be carried out; the draft is worth nothing any more.
    """
    work = _Work(draft)
    for each in commands:
        work.carry_out(each)
    return work.outcome()


class _Work:
    """Work on a draft.

    The forest of one command is compared with what is read after it, which is that of the next.
    """

    def __init__(self, draft: Draft) -> None:
        self._draft = draft
        self._forest = Forest({}, draft.root)
        self._created: list[Thing] = []
        self._referrers: list[Referrer] = []

    def outcome(self) -> Outcome:
        fragments = self._forest.fragments()
        created = [self._forest.ref(each, fragments) for each in self._created]
        return Outcome(tuple(created), tuple(self._referrers))

    def carry_out(self, command: Command) -> None:
        """Plans a command, makes the changes in the draft, and checks them."""
        command = self._resolved(command)
        files = self._concerned(command)
        self._take(files)
        forest = self._forest
        paths = forest.paths()
        model = self._draft.read(files[0]).model
        applying = Applying(forest, self._find, model.metamodels)
        applying.apply(command)
        self._referrers += self._referrers_of(applying, paths)
        plans = {}
        for file in files:
            read = self._draft.read(file).model
            context = Context(file, self._draft.root, read, forest, paths, self._class_of)
            plans[file] = planner_of(file).plan(applying.steps, context)
        for file, splices in plans.items():
            self._draft.apply(file, splices)
        self._check(applying)

    def _check(self, applying: Applying) -> None:
        read = self._grown(list(self._forest.roots))
        found = matched(self._forest, read)
        self._created = [found[each] for each in self._created if each in found]
        self._created += [found[each] for each in applying.created]
        self._forest = read

    def _take(self, files: Sequence[str]) -> None:
        """Has the forest hold the elements of some files."""
        if set(files) <= set(self._forest.roots):
            return
        wanted = dict.fromkeys([*self._forest.roots, *files])
        forest = self._grown(list(wanted))
        found = matched(self._forest, forest) if self._created else {}
        self._created = [found[each] for each in self._created]
        self._forest = forest

    def _grown(self, files: Sequence[str]) -> Forest:
        for file in files:
            if self._draft.files[file].is_stale:
                raise EditError(f"the edit would leave {file} in a state that cannot be read")
        models = {file: self._draft.read(file).model for file in files}
        return Forest(models, self._draft.root)

    def _concerned(self, command: Command) -> list[str]:
        """Returns the files that a command may change."""
        owners = [command.owner] if isinstance(command, Add | Move) else []
        if not isinstance(command, Add):
            owners.append(command.element)  # type: ignore[union-attr]
        files = [self._draft.editable(each) for each in owners]
        for ref in owners:
            self._draft.element(ref)
        if isinstance(command, Set) and command.feature != "name":
            return list(dict.fromkeys(files))
        return list(dict.fromkeys(f for each in files for f in self._draft.referring(each)))

    def _find(self, ref: Ref) -> tuple[Thing | Ref, ClassTable]:
        file, _ = refs.split(ref)
        for each in (self._forest.models[file],) if file in self._forest.models else ():
            obj = refs.find(ref, each, self._draft.root)
            if obj is None:
                raise EditError(f"there is no element {ref} any more", conflict=True)
            thing = self._forest.things[obj]
            return thing, thing.table
        obj, model = self._draft.locate(ref)
        return refs.ref_of(obj, model, self._draft.root), model.metamodels.class_of(obj)

    def _class_of(self, ref: Ref) -> ClassTable:
        obj, model = self._draft.locate(ref)
        return model.metamodels.class_of(obj)

    def _referrers_of(self, applying: Applying, paths: Mapping[Thing, str]) -> Iterable[Referrer]:
        if not applying.removed:
            return
        for thing in applying.removed[1:]:
            yield Referrer(f"{thing.file}#{paths[thing]}", thing.label, "")
        for thing, names in applying.changed.items():
            for name in names:
                yield Referrer(f"{thing.file}#{paths[thing]}", thing.label, name)

    def _resolved(self, command: Command) -> Command:
        """Returns a command with what was created before in place of `new:0`."""
        if isinstance(command, Set):
            values = self._known_values(command.values)
            return replace(command, element=self._known(command.element), values=values)
        if isinstance(command, Rename | Remove):
            return replace(command, element=self._known(command.element))
        if isinstance(command, Move):
            element, owner = self._known(command.element), self._known(command.owner)
            return replace(command, element=element, owner=owner)
        if isinstance(command, Add):
            return replace(self._known_inside(command), owner=self._known(command.owner))
        return command

    def _known_inside(self, made: AddedT) -> AddedT:
        values = {name: self._known_values(each) for name, each in made.values.items()}
        children = tuple(map(self._known_inside, made.children))
        return replace(made, values=values, children=children)

    def _known_values(self, values: Values) -> Values:
        return tuple(map(self._known, values))

    def _known(self, ref: Ref) -> Ref:
        if not ref.startswith(NEW):
            return ref
        number = ref.removeprefix(NEW)
        if not number.isdecimal() or int(number) >= len(self._created):
            raise EditError(f"{ref} is nothing that was added before")
        return self._forest.ref(self._created[int(number)])

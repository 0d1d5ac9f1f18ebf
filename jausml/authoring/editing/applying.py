"""What commands mean: done to the things of a forest, with all that follows from them."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar, cast

from jausml.authoring.editing.commands import IDENTIFIER, Add, EditError, Move, Remove, Rename, Set
from jausml.authoring.editing.forest import Thing, default_text, open_features
from jausml.authoring.editing.joins import paths_through
from jausml.authoring.editing.sketches import converted
from jausml.authoring.editing.states import bereft_transitions, targets_through
from jausml.language.metamodel import FeatureKind
from jausml.language.model.values import suggest
from jausml.language.model.xmi.writer import lexical

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from jausml.authoring.editing.commands import Child, Command, Values
    from jausml.authoring.editing.forest import Forest
    from jausml.language.metamodel import ClassTable, FeatureTable, Metamodels
    from jausml.language.model.refs import Ref

NAME = "name"
ValuesT = TypeVar("ValuesT", bound="Sequence[object]")


class Applying:
    """Applies one command to a forest.

    Args:
        find: Returns the thing of a ref, or the ref itself when it is of a file that the forest
            has not; and the class of either.

    Attributes:
        steps: The command, and what follows from it: all of the state before it.
        removed: What goes, the owners alone.
    """

    def __init__(
        self,
        forest: Forest,
        find: Callable[[Ref], tuple[Thing | Ref, ClassTable]],
        metamodels: Metamodels,
    ) -> None:
        self._forest = forest
        self._find = find
        self._metamodels = metamodels
        self.steps: list[Command] = []
        self.removed: list[Thing] = []
        self.changed: dict[Thing, dict[str, None]] = {}
        self.created: list[Thing] = []

    def apply(self, command: Command) -> None:
        """Applies the command.

        Raises:
            EditError: It makes no sense; the forest is worth nothing any more.
        """
        if isinstance(command, Set):
            self._set(command)
        elif isinstance(command, Rename):
            self._rename(command)
        elif isinstance(command, Remove):
            self._remove(self._thing(command.element))
        elif isinstance(command, Add):
            self._add(command)
        elif isinstance(command, Move):
            self._move(command)

    def _thing(self, ref: Ref) -> Thing:
        found, _ = self._find(ref)
        if isinstance(found, str):
            raise EditError(f"{ref} cannot be changed")
        return found

    def _set(self, command: Set) -> None:
        thing = self._thing(command.element)
        feature = feature_of(thing.table, command.feature)
        if command.feature == NAME and len(command.values) == 1:
            self._rename(Rename(command.element, command.values[0]))
            return
        if feature.kind is FeatureKind.CONTAINMENT:
            raise EditError(f"{feature.name} of {thing.label} owns elements: add or remove them")
        self.steps.append(command)
        self._give(thing, feature, command.values)

    def _rename(self, command: Rename) -> None:
        thing = self._thing(command.element)
        self.steps.append(command)
        paths = paths_through(thing, command.name)
        targets = targets_through(thing, command.name, self._forest)
        for each, name, text in [*paths, *targets]:
            self.steps.append(Set(self._forest.ref(each), name, (text,)))
            self._give(each, feature_of(each.table, name), (text,))
        self._give(thing, feature_of(thing.table, NAME), (command.name,))

    def _give(self, thing: Thing, feature: FeatureTable, values: Values) -> None:
        if not feature.settable or feature.kind is FeatureKind.CONTAINER:
            raise EditError(f"{feature.name} of {thing.label} follows from the rest of the model")
        if len(values) > 1 and not feature.many:
            raise EditError(f"{feature.name} of {thing.label} takes one value")
        if feature.kind is FeatureKind.ATTRIBUTE:
            _put(thing.values, feature.name, canonical(values, feature))
            thing.open.discard(feature.name)
            if not values:
                thing.open |= open_features(thing.table, thing.file) & {feature.name}
        else:
            targets = [self._target(each, feature) for each in values]
            _put(thing.references, feature.name, list(dict.fromkeys(targets)))
        self._note(thing, feature)

    def _note(self, thing: Thing, feature: FeatureTable) -> None:
        self.changed.setdefault(thing, {})[feature.name] = None

    def _target(self, ref: Ref, feature: FeatureTable) -> Thing | Ref:
        target, table = self._find(ref)
        wanted = cast("ClassTable", feature.target)
        if table not in wanted.subtypes:
            what = f"{ref} is a {table.qualified_name}"
            raise EditError(f"{feature.name} refers to a {wanted.qualified_name}, but {what}")
        return target

    def _add(self, command: Add) -> None:
        owner = self._thing(command.owner)
        made = self._made(owner.file, command)
        self._own(owner, command.feature, made, command.position)
        self.steps.append(command)
        self.created.append(made)

    def _made(self, file: str, command: Add | Child) -> Thing:
        table = self._metamodels.classes.get(command.kind)
        if table is None or table.abstract:
            what = "abstract" if table is not None else "unknown"
            hint = suggest(command.kind, self._metamodels.classes)
            raise EditError(f"{command.kind} is an {what} class {f'({hint})' if hint else ''}")
        thing = Thing(table, file)
        thing.open = open_features(table, file)
        for name, values in command.values.items():
            if name == IDENTIFIER:
                thing.identifier = "".join(values)
            else:
                self._give(thing, feature_of(table, name), tuple(values))
        for child in command.children:
            self._own(thing, child.feature, self._made(file, child), None)
        self.changed.pop(thing, None)
        return thing

    def _own(self, owner: Thing, name: str, thing: Thing, position: int | None) -> None:
        feature = feature_of(owner.table, name)
        wanted = feature.target
        if feature.kind is not FeatureKind.CONTAINMENT or wanted is None:
            raise EditError(f"{name} of {owner.label} owns no elements")
        if thing.table not in wanted.subtypes:
            what = f"{name} of {owner.label} takes a {wanted.qualified_name}"
            raise EditError(f"{what}, and {thing.label} is none")
        siblings = owner.owned.setdefault(name, [])
        if not feature.many and (siblings or owner.references.get(name)):
            raise EditError(f"{owner.label} has its {name} already: change or remove it first")
        siblings.insert(len(siblings) if position is None else position, thing)
        thing.owner, thing.feature = owner, name

    def _move(self, command: Move) -> None:
        thing = self._thing(command.element)
        owner = self._thing(command.owner)
        if any(each is owner for each in thing.everything()):
            raise EditError(f"{thing.label} cannot be moved into itself")
        if thing.owner is None:
            raise EditError(f"{thing.label} is the root of its file, which cannot be moved")
        self._drop(thing)
        self._own(owner, command.feature, thing, command.position)
        self.steps.append(command)

    def _drop(self, thing: Thing) -> None:
        """Takes a thing from its owner or its file."""
        if thing.owner is None:
            self._forest.roots[thing.file].remove(thing)
            return
        siblings = thing.owner.owned[thing.feature]
        siblings.remove(thing)
        if not siblings:
            del thing.owner.owned[thing.feature]

    def _remove(self, thing: Thing) -> None:
        if thing.owner is None and len(self._forest.roots[thing.file]) == 1:
            raise EditError(f"{thing.label} is all of {thing.file}: delete the file")
        going: set[Thing] = set()
        pending = [thing]
        while pending:
            each = pending.pop()
            if each in going:
                continue
            gone = set(each.everything())
            going |= gone
            self.removed.append(each)
            pending += self._bereft(gone, going)
        # What stands in something else that goes needs no mention.
        inner = {part for each in self.removed for part in each.everything() if part is not each}
        self.removed = [each for each in self.removed if each not in inner]
        self._unlink(going)
        fragments = self._forest.fragments()
        for each in self.removed:
            self.steps.append(Remove(self._forest.ref(each, fragments)))
        for each, names in self.changed.items():
            for name in names:
                values = [self._as_ref(v, fragments) for v in each.references.get(name, ())]
                self.steps.append(Set(self._forest.ref(each, fragments), name, tuple(values)))
        for each in self.removed:
            self._drop(each)

    def _bereft(self, gone: set[Thing], going: set[Thing]) -> Sequence[Thing]:
        """Returns what cannot be without something that goes."""
        found = []
        for thing, name in self._forest.referrers(gone):
            feature = thing.table.features[name]
            is_needed = feature.lower > 0 and not feature.many
            if thing not in going and is_needed and thing.owner is not None:
                found.append(_whole(thing))
        lost = bereft_transitions(going, self._forest)
        return [*found, *(each for each in lost if each not in going)]

    def _unlink(self, going: set[Thing]) -> None:
        for thing, name in list(self._forest.referrers(going)):
            if thing not in going:
                left = [each for each in thing.references[name] if each not in going]
                _put(thing.references, name, left)
                self._note(thing, thing.table.features[name])

    def _as_ref(self, target: Thing | Ref, fragments: Mapping[Thing, str]) -> Ref:
        return target if isinstance(target, str) else self._forest.ref(target, fragments)


def _whole(thing: Thing) -> Thing:
    """Returns the outermost owner that cannot be without a thing, which may be itself."""
    while thing.owner is not None and thing.owner.owner is not None:
        feature = thing.owner.table.features[thing.feature]
        if feature.many or feature.lower == 0:
            break
        thing = thing.owner
    return thing


def _put(values: dict[str, ValuesT], name: str, new: ValuesT) -> None:
    if new:
        values[name] = new
    else:
        values.pop(name, None)


def feature_of(table: ClassTable, name: str) -> FeatureTable:
    """Returns a feature of a class."""
    feature = table.features.get(name)
    if feature is None:
        hint = suggest(name, table.features)
        raise EditError(f"a {table.name} has no {name}{f' ({hint})' if hint else ''}")
    return feature


def canonical(values: Values, feature: FeatureTable) -> tuple[str, ...]:
    """Returns values of an attribute as EMF writes them; none where the default need not stand."""
    found = [lexical(each, feature) for each in converted(values, feature)]
    if feature.many or feature.unsettable or found != [default_text(feature)]:
        return tuple(dict.fromkeys(found)) if feature.unique else tuple(found)
    return ()

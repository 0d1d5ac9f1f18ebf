"""Commands applied to a working copy, with all that follows from them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, TypeVar, cast

from jausml.authoring.editing.commands import (
    IDENTIFIER,
    Add,
    Child,
    EditError,
    ElementCommand,
    Move,
    Remove,
    Rename,
    Set,
    Values,
)
from jausml.authoring.editing.following import orphaned_transitions, paths_through, targets_through
from jausml.authoring.editing.working_copy import (
    ElementCopy,
    WorkingCopy,
    default_text,
    open_features,
)
from jausml.language.metamodel import (
    ClassTable,
    DataTypeTable,
    FeatureKind,
    FeatureTable,
    Metamodels,
)
from jausml.language.model.refs import Ref
from jausml.language.model.values import convert, suggest
from jausml.language.model.xmi.writer import lexical

NAME = "name"
ValuesT = TypeVar("ValuesT", bound="Sequence[object]")


class Applying:
    """Applies one command to a working copy.

    Args:
        find: Returns the copy of a ref, or the ref itself when it is of a file that the working
            copy has not; and the class of either.

    Attributes:
        steps: The command, and what follows from it: all of the state before it.
    """

    def __init__(
        self,
        working_copy: WorkingCopy,
        find: Callable[[Ref], tuple[ElementCopy | Ref, ClassTable]],
        metamodels: Metamodels,
    ) -> None:
        self._working_copy = working_copy
        self._find = find
        self._metamodels = metamodels
        self.steps: list[ElementCommand] = []
        self.changed: dict[ElementCopy, dict[str, None]] = {}
        self.created: list[ElementCopy] = []

    def apply(self, command: ElementCommand) -> None:
        """Applies the command.

        `EditError`: it makes no sense; the working copy is worth nothing any more.
        """
        if isinstance(command, Set):
            self._set(command)
        elif isinstance(command, Rename):
            self._rename(command)
        elif isinstance(command, Remove):
            self._remove(self._copy(command.element))
        elif isinstance(command, Add):
            self._add(command)
        elif isinstance(command, Move):
            for move in command.single_moves:
                self._move(move)

    def _copy(self, ref: Ref) -> ElementCopy:
        copy, _ = self._find(ref)
        if isinstance(copy, str):
            raise EditError(f"{ref} cannot be changed")
        return copy

    def _set(self, command: Set) -> None:
        copy = self._copy(command.element)
        feature = feature_of(copy.table, command.feature)
        # A new name must be followed by all that names the element.
        if command.feature == NAME and len(command.values) == 1:
            self._rename(Rename(command.element, command.values[0]))
            return
        if feature.kind is FeatureKind.CONTAINMENT:
            raise EditError(f"{feature.name} of {copy.label} owns elements: add or remove them")
        self.steps.append(command)
        self._give(copy, feature, command.values)

    def _rename(self, command: Rename) -> None:
        copy = self._copy(command.element)
        self.steps.append(command)
        paths = paths_through(copy, command.name)
        targets = targets_through(copy, command.name, self._working_copy)
        for referrer, name, text in [*paths, *targets]:
            self.steps.append(Set(self._working_copy.ref(referrer), name, (text,)))
            self._give(referrer, feature_of(referrer.table, name), (text,))
        self._give(copy, feature_of(copy.table, NAME), (command.name,))

    def _give(self, copy: ElementCopy, feature: FeatureTable, values: Values) -> None:
        if not feature.settable or feature.kind is FeatureKind.CONTAINER:
            raise EditError(f"{feature.name} of {copy.label} follows from the rest of the model")
        if len(values) > 1 and not feature.many:
            raise EditError(f"{feature.name} of {copy.label} takes one value")
        if feature.kind is FeatureKind.ATTRIBUTE:
            _put(copy.values, feature.name, canonical(values, feature))
            copy.open.discard(feature.name)
            if not values:
                copy.open |= open_features(copy.table, copy.file) & {feature.name}
        else:
            targets = [self._target(value, feature) for value in values]
            _put(copy.references, feature.name, list(dict.fromkeys(targets)))
        self._note(copy, feature)

    def _note(self, copy: ElementCopy, feature: FeatureTable) -> None:
        self.changed.setdefault(copy, {})[feature.name] = None

    def _target(self, ref: Ref, feature: FeatureTable) -> ElementCopy | Ref:
        target, table = self._find(ref)
        wanted = cast("ClassTable", feature.target)
        if table not in wanted.subtypes:
            what = f"{ref} is a {table.qualified_name}"
            raise EditError(f"{feature.name} refers to a {wanted.qualified_name}, but {what}")
        return target

    def _add(self, command: Add) -> None:
        owner = self._copy(command.owner)
        copy = self._copy_of(owner.file, command)
        self._own(owner, command.feature, copy, command.position)
        self.steps.append(command)
        self.created.append(copy)

    def _copy_of(self, file: str, command: Add | Child) -> ElementCopy:
        table = self._metamodels.classes.get(command.kind)
        if table is None or table.abstract:
            what = "abstract" if table is not None else "unknown"
            hint = suggest(command.kind, self._metamodels.classes)
            raise EditError(f"{command.kind} is an {what} class {f'({hint})' if hint else ''}")
        copy = ElementCopy(table, file)
        copy.open = open_features(table, file)
        for name, values in command.values.items():
            if name == IDENTIFIER:
                copy.identifier = "".join(values)
            else:
                self._give(copy, feature_of(table, name), tuple(values))
        for child in command.children:
            self._own(copy, child.feature, self._copy_of(file, child), None)
        # What is new is written as a whole, not as a change.
        self.changed.pop(copy, None)
        return copy

    def _own(self, owner: ElementCopy, name: str, copy: ElementCopy, position: int | None) -> None:
        feature = feature_of(owner.table, name)
        wanted = feature.target
        if feature.kind is not FeatureKind.CONTAINMENT or wanted is None:
            raise EditError(f"{name} of {owner.label} owns no elements")
        if copy.table not in wanted.subtypes:
            what = f"{name} of {owner.label} takes a {wanted.qualified_name}"
            raise EditError(f"{what}, and {copy.label} is none")
        siblings = owner.owned.setdefault(name, [])
        if not feature.many and (siblings or owner.references.get(name)):
            raise EditError(f"{owner.label} has its {name} already: change or remove it first")
        siblings.insert(len(siblings) if position is None else position, copy)
        copy.owner, copy.feature = owner, name

    def _move(self, command: Move) -> None:
        copy = self._copy(command.element)
        owner = self._copy(command.owner)
        if any(descendant is owner for descendant in copy.everything()):
            raise EditError(f"{copy.label} cannot be moved into itself")
        if copy.owner is None:
            raise EditError(f"{copy.label} is the root of its file, which cannot be moved")
        self._drop(copy)
        self._own(owner, command.feature, copy, command.position)
        self.steps.append(command)

    def _drop(self, copy: ElementCopy) -> None:
        """Takes a copy from its owner or its file."""
        if copy.owner is None:
            self._working_copy.roots[copy.file].remove(copy)
            return
        siblings = copy.owner.owned[copy.feature]
        siblings.remove(copy)
        if not siblings:
            del copy.owner.owned[copy.feature]

    def _remove(self, copy: ElementCopy) -> None:
        if copy.owner is None and len(self._working_copy.roots[copy.file]) == 1:
            raise EditError(f"{copy.label} is all of {copy.file}: delete the file")
        owners, going = leaving([copy], self._working_copy)
        for referrer, name in list(left_by(going, self._working_copy)):
            left = [target for target in referrer.references[name] if target not in going]
            _put(referrer.references, name, left)
            self._note(referrer, referrer.table.features[name])
        # Refs are those before the command, so all are taken before anything is dropped.
        fragments = self._working_copy.fragments()
        # What stands in something else that goes needs no mention.
        for element in owners:
            self.steps.append(Remove(self._working_copy.ref(element, fragments)))
        for element, names in self.changed.items():
            for name in names:
                values = [
                    self._as_ref(value, fragments) for value in element.references.get(name, ())
                ]
                self.steps.append(
                    Set(self._working_copy.ref(element, fragments), name, tuple(values))
                )
        for element in owners:
            self._drop(element)

    def _as_ref(self, target: ElementCopy | Ref, fragments: Mapping[ElementCopy, str]) -> Ref:
        return target if isinstance(target, str) else self._working_copy.ref(target, fragments)


def leaving(
    copies: Iterable[ElementCopy], working_copy: WorkingCopy
) -> tuple[list[ElementCopy], set[ElementCopy]]:
    """Returns what goes when some elements do, the owners alone, and all of it with its parts.

    What cannot be without something that goes, goes too, and so on.
    """
    going: set[ElementCopy] = set()
    removed: list[ElementCopy] = []
    pending = [*copies]
    while pending:
        element = pending.pop()
        if element in going:
            continue
        gone = set(element.everything())
        going |= gone
        removed.append(element)
        pending += _orphaned(gone, going, working_copy)
    inner = {part for copy in removed for part in copy.everything() if part is not copy}
    return [copy for copy in removed if copy not in inner], going


def left_by(
    going: set[ElementCopy], working_copy: WorkingCopy
) -> Iterator[tuple[ElementCopy, str]]:
    """Yields the elements that stay and refer to some that go, with the name of the feature."""
    return (pair for pair in working_copy.referrers(going) if pair[0] not in going)


def _orphaned(
    gone: set[ElementCopy], going: set[ElementCopy], working_copy: WorkingCopy
) -> Sequence[ElementCopy]:
    """Returns the elements that need another one which goes."""
    orphans = []
    for copy, name in working_copy.referrers(gone):
        feature = copy.table.features[name]
        is_needed = feature.lower > 0 and not feature.many
        if copy not in going and is_needed and copy.owner is not None:
            orphans.append(_whole(copy))
    lost = orphaned_transitions(going, working_copy)
    return [*orphans, *(transition for transition in lost if transition not in going)]


def _whole(copy: ElementCopy) -> ElementCopy:
    """Returns the outermost owner that cannot be without a copy, which may be itself."""
    while copy.owner is not None and copy.owner.owner is not None:
        feature = copy.owner.table.features[copy.feature]
        if feature.many or feature.lower == 0:
            break
        copy = copy.owner
    return copy


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


def converted(texts: Values, feature: FeatureTable) -> list[Any]:
    """Returns the values of an attribute that texts stand for."""
    if len(texts) > 1 and not feature.many:
        raise EditError(f"{feature.name} takes one value")
    values = []
    for text in texts:
        value, fault = convert(text, cast("DataTypeTable", feature.data_type))
        if fault is not None:
            hint = f"; {fault.hint}" if fault.hint else ""
            raise EditError(f"{feature.name}: {fault.message}{hint}")
        values.append(value)
    return values


def canonical(values: Values, feature: FeatureTable) -> tuple[str, ...]:
    """Returns values of an attribute as EMF writes them; none where the default need not stand."""
    texts = [lexical(value, feature) for value in converted(values, feature)]
    if feature.many or feature.unsettable or texts != [default_text(feature)]:
        return tuple(dict.fromkeys(texts)) if feature.unique else tuple(texts)
    return ()

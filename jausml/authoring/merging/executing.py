"""Execution of the plan of a merge, by commands of editing, each checked by reading again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from jausml.authoring.differences.changes import words
from jausml.authoring.editing import commands
from jausml.authoring.editing.drafts import Draft
from jausml.authoring.editing.executing import execute, referrers
from jausml.authoring.editing.reading import Reader
from jausml.authoring.editing.records import Stored
from jausml.authoring.editing.working_copy import WorkingCopy
from jausml.authoring.merging import planning
from jausml.authoring.merging.sides import Sides, Value
from jausml.language.metamodel import FeatureKind, FeatureTable
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import contents
from jausml.language.model.model import Model
from jausml.language.model.refs import Ref


class Execution:
    """Execution of a plan on our side.

    `sides`: the three states; our side is that which the reader has read of the files. `where`: the
    refs of the elements of our side, and of what was added, as they stand now.
    """

    def __init__(
        self, file: str, root: Path, files: Mapping[str, Stored], reader: Reader, sides: Sides
    ) -> None:
        self._file = file
        self._reader = reader
        self._sides = sides
        self.root = root
        self.files = dict(files)
        self.conflicts: list[planning.Conflict] = []
        working_copy = WorkingCopy.of({file: sides.ours.model}, root)
        fragments = working_copy.fragments()
        self.where: dict[EObject, Ref] = {
            obj: f"{file}#{fragments[copy]}" for obj, copy in working_copy.copies.items()
        }
        self._working_copy: WorkingCopy | None = None
        self._moved: set[EObject] = set()
        self._later: list[tuple[EObject, FeatureTable, EObject]] = []

    def run(self, plan: planning.Plan) -> None:
        """Carries a plan out."""
        going = {
            part
            for element in (*plan.removed, *plan.replaced)
            for part in self._sides.all_of(element)
        }
        self._moved = plan.moved
        # Where there is room for one element alone, the old one must go first.
        for replaced_element in plan.replaced:
            self._remove(replaced_element, going)
        for addition in plan.additions:
            if addition.element not in plan.moved:
                self._add(addition)
        for setting in plan.settings:
            self._set(setting.element, setting.feature, setting.values, setting.element)
        # References among additions wait until all of these are there.
        for element, feature, owner in self._later:
            tokens = self._sides.values(element, feature, self._sides.theirs)
            self._set(element, feature, tokens, owner)
        for order in plan.orders:
            self._reorder(order)
        # Last: until here something that stays may have referred to it.
        for removed_element in plan.removed:
            self._remove(removed_element, going)

    def model(self) -> Model:
        """Returns the model of the file as it is now."""
        return self._reader.read(self._file, self.files).model

    def _do(self, command: commands.Command) -> tuple[Ref, ...]:
        draft = self._draft()
        outcome = execute([command], draft, self._working_copy)
        self.files, self._working_copy = draft.files, outcome.working_copy
        for shift in outcome.shifts:
            self.where = {obj: shift.get(ref, ref) for obj, ref in self.where.items()}
        return outcome.created

    def _draft(self) -> Draft:
        return Draft(self.root, self.files, self._reader, 1)

    # -- Adding ----------------------------------------------------------------------------------

    def _add(self, addition: planning.Addition) -> None:
        feature = addition.feature
        description = self._described(addition.element, feature.name, addition.owner)
        owner = self.where[addition.owner]
        before = addition.before
        position = self._position(before) if before is not None else None
        add = commands.Add(
            owner,
            feature.name,
            description.kind,
            description.values,
            description.children,
            position,
        )
        try:
            (created,) = self._do(add)
        except commands.EditError:
            if position is None:
                raise
            # What an arrow of text cannot say stands behind all that arrows say.
            (created,) = self._do(replace(add, position=None))
        self._locate(addition.element, created)

    def _position(self, element: EObject) -> int:
        """Returns where an element stands among its siblings now."""
        obj, model = self._draft().element(self.where[element])
        step = model.path_of(obj).rpartition(".")[2]
        if not step.isdecimal():
            raise commands.EditError(f"{self.where[element]} has no place among others")
        return int(step)

    def _described(self, obj: EObject, feature: str, owner: EObject) -> commands.Child:
        """Returns a description of an element of theirs; what cannot be said yet comes later."""
        values: dict[str, commands.Values] = {}
        children: list[commands.Child] = []
        identifier = self._sides.theirs.model.identifier(obj)
        if identifier:
            values[commands.IDENTIFIER] = (identifier,)
        for own_feature in self._sides.features(obj):
            tokens = self._sides.values(obj, own_feature, self._sides.theirs)
            if own_feature.kind is FeatureKind.ATTRIBUTE:
                texts = tuple(text for text in tokens if isinstance(text, str))
            elif own_feature.kind is FeatureKind.CROSS_REFERENCE:
                targets = [self._ref(token) for token in tokens]
                if None in targets:
                    self._later.append((obj, own_feature, owner))
                    continue
                texts = tuple(filter(None, targets))
            else:
                owned = self._added(obj, own_feature)
                children += [self._described(element, own_feature.name, owner) for element in owned]
                continue
            if texts:
                values[own_feature.name] = texts
        kind = self._sides.table(obj).qualified_name
        return commands.Child(feature, kind, values, tuple(children))

    def _added(self, obj: EObject, feature: FeatureTable) -> list[EObject]:
        """Returns the parts of an element of theirs that our side has in no other place."""
        return [content for content in contents(obj, feature) if content not in self._moved]

    def _locate(self, obj: EObject, ref: Ref) -> None:
        """Notes the present ref of an element of theirs, and those of its parts."""
        self.where[obj] = ref
        file, _, _ = ref.partition("#")
        path = self._path(ref)
        for feature in self._sides.table(obj).contained:
            for index, element in enumerate(self._added(obj, feature)):
                identifier = self._sides.theirs.model.identifier(element)
                step = f"@{feature.name}{f'.{index}' if feature.many else ''}"
                self._locate(element, f"{file}#{identifier or f'{path}/{step}'}")

    def _path(self, ref: Ref) -> str:
        """Returns the path of an element by features, whether it has an id or not."""
        obj, model = self._draft().element(ref)
        return model.path_of(obj)

    # -- Changing --------------------------------------------------------------------------------

    def _set(
        self, element: EObject, feature: FeatureTable, values: tuple[Value, ...], place: EObject
    ) -> None:
        if feature.kind is FeatureKind.ATTRIBUTE:
            texts = tuple(text for text in values if isinstance(text, str))
            self._do(commands.Set(self.where[element], feature.name, texts))
            return
        targets = [self._ref(value) for value in values]
        if None in targets:
            what = f"{words(feature.name)} is to refer to an element that we removed"
            name = feature.name if place is element else ""
            self.conflicts.append(planning.Conflict(planning.LOST_TARGET, place, what, name))
        texts = tuple(ref for ref in targets if ref is not None)
        # With no target left the feature keeps its value, as the conflict says.
        if texts or None not in targets:
            self._do(commands.Set(self.where[element], feature.name, texts))

    def _ref(self, value: Value) -> Ref | None:
        """Returns the present ref of an element on our side, None when it is not there."""
        if value is None or isinstance(value, str):
            return value
        # An empty ref stands for what is gone.
        return self.where.get(self._sides.ours.matching.news.get(value, value)) or None

    def _reorder(self, order: planning.Order) -> None:
        """Moves elements of one owner to each other's places."""
        # They share the places that they have now; what stands between them stays.
        places = sorted(map(self._position, order.elements))
        for place, element in zip(places, order.elements, strict=True):
            if self._position(element) != place:
                owner_ref = self.where[order.owner]
                self._do(commands.Move(self.where[element], owner_ref, order.feature.name, place))

    def _remove(self, element: EObject, going: set[EObject]) -> None:
        """Removes an element, unless one that stays refers to it."""
        leaving = {
            self.where[going_element] for going_element in going if going_element in self.where
        }
        ref = self.where[element]
        if not ref:
            return  # it went with something else
        for referrer in referrers(ref, self._draft()):
            if referrer.element not in leaving:
                label = self._sides.label(element)
                what = f"{label} was removed by them, and {referrer.label} refers to it"
                self.conflicts.append(planning.Conflict(planning.GONE_HERE, element, what))
                return
        self._do(commands.Remove(ref))

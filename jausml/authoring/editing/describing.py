"""Descriptions of elements: commands that would add copies of them, in any notation."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple, TypeAlias

from jausml.authoring.editing.commands import NEW, Add, Child, EditError, Set, Values
from jausml.authoring.editing.working_copy import attribute_values
from jausml.language.metamodel import FeatureKind, FeatureTable
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import contents
from jausml.language.model.model import Model
from jausml.language.model.names import name_of, with_owners
from jausml.language.model.refs import Ref

_NAME = "name"
_NUMBERED = re.compile(r"(.*?)_?(\d+)")


def described(
    elements: Sequence[tuple[EObject, Model]], ref_of: Callable[[EObject, Model], Ref]
) -> tuple[Add | Set, ...]:
    """Returns commands that would add copies of elements with all their parts.

    The owner of each is empty, its feature the present one. A reference among the copied elements
    becomes a ref to the copy, such as `new:0/@maps.1`: connections in the copy of a bridge use the
    copied maps. The target of such a reference is added first.
    """
    return _Describing(elements, ref_of).commands()


class _Describing:
    """Descriptions of some elements, part by part."""

    def __init__(
        self, elements: Sequence[tuple[EObject, Model]], ref_of: Callable[[EObject, Model], Ref]
    ) -> None:
        self._ref_of = ref_of
        self._elements: dict[_Path, tuple[EObject, Model]] = {}
        self._paths: dict[Ref, _Path] = {}
        for number, (obj, model) in enumerate(elements):
            self._note((_Step(str(number)),), obj, model)
        roots = [path for path in self._elements if len(path) == 1]
        parts = {
            part
            for path in self._elements
            for target in self._inner_targets(path)
            if (part := _part(path, target))
        }
        self._waiting = dict.fromkeys([*roots, *(path for path in self._elements if path in parts)])
        self._numbers: dict[_Path, int] = {}
        self._commands: list[Add | Set] = []
        self._later: list[tuple[_Path, FeatureTable]] = []

    def commands(self) -> tuple[Add | Set, ...]:
        """Returns the commands; to be called once."""
        while self._waiting:
            self._add(self._next())
        for path, feature in self._later:
            values = tuple(self._value(path, target) for target in self._targets(path, feature))
            self._commands.append(Set(self._address(path), feature.name, values))
        return tuple(self._commands)

    def _note(self, path: _Path, obj: EObject, model: Model) -> None:
        self._elements[path] = obj, model
        self._paths[self._ref_of(obj, model)] = path
        for feature in model.metamodels.class_of(obj).contained:
            if feature.settable:
                for index, child in enumerate(contents(obj, feature)):
                    step = _Step(feature.name, index, is_many=feature.many)
                    self._note((*path, step), child, model)

    def _targets(self, path: _Path, feature: FeatureTable) -> Sequence[EObject]:
        return contents(self._elements[path][0], feature)

    def _inner_targets(self, path: _Path) -> Iterator[_Path]:
        """Yields the targets of the references of an element that are copied along with it."""
        obj, model = self._elements[path]
        for feature in model.metamodels.class_of(obj).features.values():
            if feature.settable and feature.kind is FeatureKind.CROSS_REFERENCE:
                for content in contents(obj, feature):
                    target = self._paths.get(self._ref_of(content, model))
                    if target is not None:
                        yield target

    def _next(self) -> _Path:
        """Returns the next part: one that needs no other, if there is one."""
        ready = [path for path in self._waiting if self._is_there(path[:-1])]
        for part in ready:
            inner = (element for element in self._elements if element[: len(part)] == part)
            targets = (inner_target for path in inner for inner_target in self._inner_targets(path))
            if len(part) == 1 or all(
                target[: len(part)] == part or self._is_there(target) for target in targets
            ):
                return part
        return ready[0]

    def _is_there(self, path: _Path) -> bool:
        return not any(path[:length] in self._waiting for length in range(1, len(path) + 1))

    def _add(self, part: _Path) -> None:
        del self._waiting[part]
        obj, _ = self._elements[part]
        child = self._child(part, part)
        owner, feature, position = "", obj.eContainmentFeature(), None
        if len(part) > 1:
            owner, position = self._address(part[:-1]), self._position(part)
        name = feature.name if feature is not None else ""
        self._numbers[part] = len(self._numbers)
        self._commands.append(Add(owner, name, child.kind, child.values, child.children, position))

    def _child(self, path: _Path, part: _Path) -> Child:
        """Returns an element of a part, without parts and references that are added later."""
        obj, model = self._elements[path]
        table = model.metamodels.class_of(obj)
        values: dict[str, Values] = {}
        children: list[Child] = []
        for feature in table.features.values():
            if not feature.settable:
                continue
            if feature.kind is FeatureKind.ATTRIBUTE:
                texts = tuple(text for text in attribute_values(obj, feature) if text is not None)
            elif feature.kind is FeatureKind.CROSS_REFERENCE:
                texts = self._references(path, feature, part)
            else:
                if feature.kind is FeatureKind.CONTAINMENT:
                    children += self._owned(path, feature, part)
                continue
            if texts:
                values[feature.name] = texts
        return Child(path[-1].feature, table.qualified_name, values, tuple(children))

    def _owned(self, path: _Path, feature: FeatureTable, part: _Path) -> Iterator[Child]:
        for index in range(len(self._targets(path, feature))):
            inner = (*path, _Step(feature.name, index, is_many=feature.many))
            if inner not in self._waiting:
                yield self._child(inner, part)

    def _references(self, path: _Path, feature: FeatureTable, part: _Path) -> Values:
        """Returns the refs of a reference; none where a target is not added before it."""
        targets = self._targets(path, feature)
        model = self._elements[path][1]
        inner = [self._paths.get(self._ref_of(target, model)) for target in targets]
        if any(
            inner_path is not None
            and (inner_path[: len(part)] == part or not self._is_there(inner_path))
            for inner_path in inner
        ):
            self._later.append((path, feature))
            return ()
        return tuple(self._value(path, target) for target in targets)

    def _value(self, path: _Path, target: EObject) -> Ref:
        ref = self._ref_of(target, self._elements[path][1])
        inner = self._paths.get(ref)
        return ref if inner is None else self._address(inner)

    def _address(self, path: _Path) -> Ref:
        """Returns the ref of a copy, by the part with which it was added."""
        length = next(size for size in range(len(path), 0, -1) if path[:size] in self._numbers)
        ref = f"{NEW}{self._numbers[path[:length]]}"
        for end in range(length + 1, len(path) + 1):
            step = path[end - 1]
            ref += (
                f"/@{step.feature}.{self._index(path[:end])}"
                if step.is_many
                else f"/@{step.feature}"
            )
        return ref

    def _index(self, path: _Path) -> int:
        """Returns the index of a copy among its siblings that were added."""
        step = path[-1]
        return step.at - sum(
            sibling[:-1] == path[:-1]
            and sibling[-1].feature == step.feature
            and sibling[-1].at < step.at
            for sibling in self._waiting
        )

    def _position(self, path: _Path) -> int | None:
        """Returns the position of a new copy, None for the last one."""
        feature = path[-1].feature
        behind = (element for element in self._elements if element[:-1] == path[:-1])
        last = max(
            sibling[-1].at
            for sibling in behind
            if sibling[-1].feature == feature and self._is_there(sibling)
        )
        return self._index(path) if path[-1].at < last else None


class _Step(NamedTuple):
    """A step from an owner to a part, or the number of an element that is copied."""

    feature: str
    at: int = 0
    is_many: bool = True


_Path: TypeAlias = "tuple[_Step, ...]"


def _part(path: _Path, target: _Path) -> _Path | None:
    """Returns the part around an element that can be added once the target of a reference is there.

    There is none where the element refers to a part of its own, or is copied as a whole.
    """
    common = 0
    while common < min(len(path), len(target)) and path[common] == target[common]:
        common += 1
    end = max(common, 1) + 1
    return path[:end] if end <= len(path) else None


def pasted(
    commands: Sequence[Add | Set],
    chosen: EObject,
    model: Model,
    ref_of: Callable[[EObject, Model], Ref],
) -> tuple[Add | Set, ...]:
    """Returns descriptions as commands that add to an owner, with names that are free in it."""
    taken: dict[EObject, set[str]] = {}
    pasted_commands: list[Add | Set] = []
    for command in commands:
        if isinstance(command, Set) or command.owner.startswith(NEW):
            pasted_commands.append(command)
            continue
        owner, feature = _place(command, chosen, model)
        if owner not in taken:
            taken[owner] = {name_of(sibling) for sibling in model.owned(owner)}
        values = dict(command.values)
        if values.get(_NAME):
            name = numbered_name(values[_NAME][0], taken[owner])
            values[_NAME] = (name,)
            taken[owner].add(name)
        ref = ref_of(owner, model)
        pasted_commands.append(
            replace(command, owner=ref, feature=feature, values=values, position=None)
        )
    return tuple(pasted_commands)


def _place(command: Add, chosen: EObject, model: Model) -> tuple[EObject, str]:
    """Returns the nearest owner that can have the described element, and the feature."""
    table = model.metamodels.classes.get(command.kind)
    supertypes = table.supertypes if table is not None else ()
    for owner in with_owners(chosen):
        features = [
            feature
            for feature in model.metamodels.class_of(owner).contained
            if feature.target in supertypes and (feature.many or not contents(owner, feature))
        ]
        names = [
            feature.name
            for feature in sorted(features, key=lambda candidate: candidate.target is not table)
        ]
        if names:
            return owner, command.feature if command.feature in names else names[0]
    what = table.name if table is not None else command.kind
    raise EditError(f"a {what} has no place in {name_of(chosen) or chosen.eClass.name}")


def numbered_name(name: str, taken: set[str]) -> str:
    """Returns a free name: the name itself, else with the next number behind it."""
    match = _NUMBERED.fullmatch(name)
    stem, number = (match[1], int(match[2])) if match and len(match[2]) < 9 else (name, 1)
    candidate = name
    while candidate in taken:
        number += 1
        candidate = f"{stem}_{number}"
    return candidate

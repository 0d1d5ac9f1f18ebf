"""Descriptions of elements: commands that would add the same once more, in any notation."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from jausml.editing.commands import NEW, Add, Child, EditError
from jausml.editing.forest import attribute_values
from jausml.metamodel import FeatureKind
from jausml.metamodel.filling import contents
from jausml.model.names import name_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from jausml.editing.commands import Values
    from jausml.metamodel.classes.ecore import EObject
    from jausml.model.model import Model
    from jausml.model.refs import Ref

_NAME = "name"
_NUMBERED = re.compile(r"(.*?)_?(\d+)")


def described(
    elements: Sequence[tuple[EObject, Model]], ref_of: Callable[[EObject, Model], Ref]
) -> tuple[Add, ...]:
    """Returns commands that would add elements with all that they own.

    Their owner is empty, their feature the one that owns them now. What they refer to of each
    other becomes `new:0` and so on, if they are added in this order.

    Args:
        elements: The elements, each with a model that has it.
        ref_of: Returns the ref of an element of a model.
    """
    numbers: dict[Ref, str] = {}
    found = []
    for number, (obj, model) in enumerate(elements):
        feature = obj.eContainmentFeature()
        made = _child(obj, model, feature.name if feature is not None else "", ref_of, numbers)
        numbers[ref_of(obj, model)] = f"{NEW}{number}"
        found.append(Add("", made.feature, made.kind, made.values, made.children))
    return tuple(found)


def _child(
    obj: EObject,
    model: Model,
    feature: str,
    ref_of: Callable[[EObject, Model], Ref],
    numbers: Mapping[Ref, str],
) -> Child:
    table = model.metamodels.class_of(obj)
    values: dict[str, Values] = {}
    children: list[Child] = []
    for each in table.features.values():
        if not each.settable:
            continue
        if each.kind is FeatureKind.ATTRIBUTE:
            texts = tuple(text for text in attribute_values(obj, each) if text is not None)
        elif each.kind is FeatureKind.CROSS_REFERENCE:
            refs = (ref_of(target, model) for target in contents(obj, each))
            texts = tuple(numbers.get(ref, ref) for ref in refs)
        else:
            owned = contents(obj, each) if each.kind is FeatureKind.CONTAINMENT else ()
            children += [_child(one, model, each.name, ref_of, numbers) for one in owned]
            continue
        if texts:
            values[each.name] = texts
    return Child(feature, table.qualified_name, values, tuple(children))


def pasted(
    commands: Sequence[Add], chosen: EObject, model: Model, ref_of: Callable[[EObject, Model], Ref]
) -> tuple[Add, ...]:
    """Returns descriptions as commands that add to an owner, with names that are free there.

    Args:
        commands: The descriptions.
        chosen: The owner, or what stands in it.
        model: The model of it.
        ref_of: Returns the ref of an element of a model.

    Raises:
        EditError: Neither the element nor one around it can own what is described.
    """
    taken: dict[EObject, set[str]] = {}
    found = []
    for each in commands:
        owner, feature = _place(each, chosen, model)
        if owner not in taken:
            taken[owner] = {name_of(one) for one in model.owned(owner)}
        values = dict(each.values)
        if values.get(_NAME):
            name = free_name(values[_NAME][0], taken[owner])
            values[_NAME] = (name,)
            taken[owner].add(name)
        ref = ref_of(owner, model)
        found.append(replace(each, owner=ref, feature=feature, values=values, position=None))
    return tuple(found)


def _place(command: Add, chosen: EObject, model: Model) -> tuple[EObject, str]:
    """Returns the nearest owner that can own what is described, and the feature."""
    table = model.metamodels.classes.get(command.kind)
    owner: EObject | None = chosen
    while owner is not None and table is not None:
        names = [
            each.name
            for each in model.metamodels.class_of(owner).contained
            if each.target in table.supertypes and (each.many or not contents(owner, each))
        ]
        if names:
            return owner, command.feature if command.feature in names else names[0]
        owner = owner.eContainer()
    what = table.name if table is not None else command.kind
    raise EditError(f"a {what} has no place in {name_of(chosen) or chosen.eClass.name}")


def free_name(name: str, taken: set[str]) -> str:
    """Returns a name that is not taken: itself, else with the next number behind it."""
    match = _NUMBERED.fullmatch(name)
    stem, number = (match[1], int(match[2])) if match and len(match[2]) < 9 else (name, 1)
    found = name
    while found in taken:
        number += 1
        found = f"{stem}_{number}"
    return found

"""Ids for elements that have none: the names by which people would call them.

Text has no ids. An XMI file made of it is readable, and keeps its references when elements move,
if those that are referred to have ids.
"""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING

from jausml.language.metamodel import FeatureKind
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.metamodel.filling import count
from jausml.language.model.names import name_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.model import Model

_LEGAL = re.compile(r"[A-Za-z_][A-Za-z0-9_.\-]*")


def name_identifiers(roots: Sequence[EObject], model: Model) -> None:
    """Gives ids to the elements that are referred to, or are likely to be from other files.

    An id is the name of the element; for messages with their service (`Winch.LockBrake`), and for
    names that occur twice with all owners but the root. Elements that have an id keep it, and so do
    elements for which there is none: they are referred to by position.
    """
    elements = list(_elements(roots, model))
    referred = {target for obj in elements for target in _targets(obj, model)}
    named = [each for each in elements if name_of(each) and (each in referred or _is_public(each))]
    names = Counter(map(name_of, named))
    taken = {model.identifier(each) for each in elements}
    for each in named:
        is_message = isinstance(each, jaus.MessageDef)
        identifier = _path(each) if is_message or names[name_of(each)] > 1 else name_of(each)
        if _LEGAL.fullmatch(identifier) and identifier not in taken:
            model.name_by_id(each, identifier)
            taken.add(identifier)


def _elements(roots: Sequence[EObject], model: Model) -> Iterator[EObject]:
    pending = list(reversed(roots))
    while pending:
        obj = pending.pop()
        yield obj
        pending += reversed(model.owned(obj))


def _targets(obj: EObject, model: Model) -> Iterator[EObject]:
    for feature in model.metamodels.class_of(obj).features.values():
        if feature.kind is FeatureKind.CROSS_REFERENCE and count(obj, feature):
            value = getattr(obj, feature.name)
            yield from value if feature.many else [value]


def _is_public(obj: EObject) -> bool:
    """Tells whether an element is of a class that other files refer to."""
    kinds = (
        *(jaus.Service, jaus.MessageDef, jaus.Component),
        *(ros.MessageType, ros.ServiceType, bridge.AttributeMap),
    )
    return isinstance(obj, kinds)


def _path(obj: EObject) -> str:
    """Returns the names that lead to an element from its root, which is left out."""
    steps: list[str] = []
    while (owner := obj.eContainer()) is not None:
        steps.append(name_of(obj))
        obj = owner
    return ".".join(reversed([each for each in steps if each]))

"""Hosting: where components and nodes run, as what is dragged into the frame of a host says."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from jausml.authoring.editing.commands import Add, Remove, Set
from jausml.authoring.proposals.elements import AnswerError, Option
from jausml.language.metamodel.classes import jaus, ros, system
from jausml.language.model.names import name_of
from jausml.language.semantics.hosts import host_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.authoring.editing.commands import Command
    from jausml.authoring.proposals.elements import Scope
    from jausml.language.metamodel.classes.ecore import EObject

_FEATURES = ("components", "nodes")


def hosted(scope: Scope, elements: Sequence[EObject], host: system.Host | None) -> Option:
    """Returns what lets elements run on a host; without commands where they do already.

    Args:
        host: The host; None for the frame of none, where external components alone can be.
    """
    moved: dict[system.System, list[EObject]] = {}
    for each in elements:
        whole = _system_of(each, host)
        if whole is not None and host_of(whole, cast("jaus.Component", each)) is not host:
            moved.setdefault(whole, []).append(each)
    what = name_of(elements[0]) if len(elements) == 1 else f"{len(elements)} elements"
    where = f"on {name_of(host)}" if host is not None else "on no host of the system"
    commands = [
        command for whole, some in moved.items() for command in _placed(scope, whole, some, host)
    ]
    return Option(f"Run {what} {where}", "", "", commands)


def _system_of(element: EObject, host: system.Host | None) -> system.System | None:
    """Returns the system of an element whose host is to change, None if there is nothing to do."""
    whole = element.eContainer()
    name = name_of(element) or element.eClass.name
    if not isinstance(element, jaus.Component | ros.Node) or not isinstance(whole, system.System):
        raise AnswerError(f"{name} is no component or node of a system, which could run on a host")
    if host is None:
        # Any other is somewhere in the system, wherever its box stands.
        is_external = isinstance(element, jaus.Component) and bool(element.external)
        return whole if is_external else None
    if host.eContainer() is not whole:
        raise AnswerError(f"{name} and {name_of(host)} are of different systems")
    return whole


def _placed(
    scope: Scope, whole: system.System, elements: Sequence[EObject], host: system.Host | None
) -> Iterator[Command]:
    """Yields what changes the placements of a system."""
    own = next((each for each in whole.placements if each.host is host), None)
    emptied = []
    for placement in whole.placements:
        left = {name: _without(getattr(placement, name), elements) for name in _FEATURES}
        if placement is own:
            for name in _FEATURES:
                left[name] += [each for each in elements if _feature(each) == name]
        if not any(left.values()):
            emptied.append(placement)
            continue
        for name, values in left.items():
            if values != list(getattr(placement, name)):
                refs = tuple(scope.ref(each) for each in values)
                yield Set(scope.ref(placement), name, refs)
    if own is None and host is not None and not _follows(whole, elements, host):
        placed = {
            name: refs
            for name in _FEATURES
            if (refs := tuple(scope.ref(e) for e in elements if _feature(e) == name))
        }
        given = {"host": (scope.ref(host),), **placed}
        yield Add(scope.ref(whole), "placements", "system.Placement", given)
    # The last one first: those behind one that goes have other positions.
    for each in reversed(emptied):
        yield Remove(scope.ref(each))


def _feature(element: EObject) -> str:
    return "nodes" if isinstance(element, ros.Node) else "components"


def _without(values: Sequence[EObject], others: Sequence[EObject]) -> list[EObject]:
    return [each for each in values if each not in others]


def _follows(whole: system.System, elements: Sequence[EObject], host: system.Host) -> bool:
    """Tells whether elements run on a host without being placed there."""
    is_external = any(isinstance(each, jaus.Component) and each.external for each in elements)
    return next(iter(whole.hosts), None) is host and not is_external

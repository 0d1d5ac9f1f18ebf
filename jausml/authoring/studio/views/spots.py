"""What the ids of boxes and rows of a diagram stand for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.proposals.mapping.members import member
from jausml.language.metamodel.classes import bridge, jaus, ros

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.authoring.proposals.elements import Scope
    from jausml.authoring.proposals.mapping.members import Member
    from jausml.language.metamodel.classes.ecore import EObject


_MARK = "!"

JAUS_END, ROS_END = "!jaus", "!ros"


@dataclass(frozen=True)
class Spot:
    """An end of the system view, as its ids tell.

    Attributes:
        element: What the row stands for: an endpoint or a connection; None for the whole box and
            for the row of a message.
        message: Name of the message of such a row, empty for others.
    """

    owner: EObject
    element: EObject | None = None
    message: str = ""


def spot(scope: Scope, node: str, port: str) -> Spot:
    """Returns the end that ids of the system view name.

    Args:
        port: Id of a row of it, empty for the box.
    """
    if _MARK in node:
        raise AnswerError("that end is not in the model; add it first")
    owner = element_of(scope, node)
    if port.startswith(f"{node}{_MARK}"):
        return Spot(owner, message=port.rpartition(_MARK)[2])
    return Spot(owner, element_of(scope, port) if port else None)


def element_of(scope: Scope, identifier: str) -> EObject:
    """Returns the element of an id in a graph: a fragment, behind its file unless the first."""
    name, mark, fragment = identifier.rpartition("#")
    for document in scope.model.documents:
        if not mark or document.path.name == name:
            return scope.find_in(document, fragment)
    raise AnswerError(f"there is no element {identifier!a} any more")


def all_spots(scope: Scope) -> Iterator[Spot]:
    """Yields the boxes and rows of a model, those of messages left out."""
    model = scope.model
    for component in model.instances(jaus.Component, library=False):
        yield Spot(component)
        if isinstance(component, bridge.Bridge):
            for each in component.bridgeConnections:
                yield Spot(component, each)
    for node in model.instances(ros.Node, library=False):
        yield Spot(node)
        for feature in ("publishers", "subscriptions", "serviceServers", "serviceClients"):
            for end in getattr(node, feature):
                yield Spot(node, end)


def map_of(scope: Scope, view: str) -> bridge.AttributeMap | None:
    """Returns the map that a view shows, None for a view of something else."""
    kind, _, name = view.partition(":")
    return map_named(scope, name) if kind == "map" else None


def map_shown(scope: Scope, view: str) -> bridge.AttributeMap:
    """Returns the map that a view shows, which must be one of a map."""
    used = map_of(scope, view)
    if used is None:
        raise AnswerError(f"{view} is no view of a map")
    return used


def map_named(scope: Scope, name: str) -> bridge.AttributeMap:
    """Returns the map of a name."""
    for each in scope.model.instances(bridge.AttributeMap):
        if each.name == name:
            return each
    raise AnswerError(f"there is no map {name!a} any more")


def end_of(scope: Scope, used: bridge.AttributeMap, node: str, port: str) -> Member:
    """Returns the member that ids of the map view name."""
    if not port:
        raise AnswerError("draw from a member to a member")
    if node.endswith(JAUS_END):
        return member(used, port, is_jaus=True)
    if node.endswith(ROS_END):
        return member(used, port, is_jaus=False)
    for join in (*used.joins, *used.reportJoins):
        if scope.model.fragment(join) == node.rpartition("#")[2]:
            is_jaus = isinstance(join, bridge.ReportJoin)
            return member(used, f"{join.name}.{port}", is_jaus=is_jaus)
    raise AnswerError("that box is no end of the map")

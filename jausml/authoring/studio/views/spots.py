"""The elements behind boxes and rows of a diagram or places of a text, and where they stand."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from jausml.authoring.proposals.elements import AnswerError, Scope
from jausml.authoring.proposals.mapping.members import Member, member
from jausml.authoring.studio.views.places import (
    TextPlaces,
    XmlPlaces,
    index_of_utf16,
    utf16_length,
    with_newlines,
)
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model import Document, Model, refs
from jausml.language.model.names import with_owners
from jausml.language.model.xmi.parsing import Node
from jausml.language.text.reading.document import TextDocument
from jausml.views.diagrams.views import graph_of
from jausml.views.diagrams.views.connections import PROVIDES, USES
from jausml.views.diagrams.views.maps import names_of

_MARK = "!"

JAUS_END, ROS_END = "!jaus", "!ros"


@dataclass(frozen=True)
class Spot:
    """An end of the system view, as its ids tell.

    `element`: what the row stands for: an endpoint or a connection; None for the whole box and for
    the row of a message. `message`: name of the message of such a row, empty for others.
    """

    owner: EObject
    element: EObject | None = None
    message: str = ""


def spot(scope: Scope, node: str, port: str) -> Spot:
    """Returns the end that ids of the system view name.

    `port`: id of a row of it, empty for the box.
    """
    if _MARK in node:
        raise AnswerError("that end is not in the model; add it first")
    owner = element_of(scope, node)
    if port.startswith(f"{node}{_MARK}"):
        way, _, name = port.removeprefix(f"{node}{_MARK}").partition(_MARK)
        # From the row of a service one draws as from the box.
        return Spot(owner) if way in (PROVIDES, USES) else Spot(owner, message=name)
    return Spot(owner, element_of(scope, port) if port else None)


def element_of(scope: Scope, identifier: str) -> EObject:
    """Returns the element of an id in a graph: a fragment, behind its file unless the first."""
    file, mark, fragment = identifier.rpartition("#")
    for document in scope.model.documents:
        if refs.file_mark(document, scope.model) == file + mark:
            return scope.find_in(document, fragment)
    raise AnswerError(f"there is no element {identifier!r} any more")


def all_spots(scope: Scope) -> Iterator[Spot]:
    """Yields the boxes and rows of a model, those of messages left out."""
    model = scope.model
    for component in model.instances(jaus.Component, library=False):
        yield Spot(component)
        if isinstance(component, bridge.Bridge):
            for bridge_connection in component.bridgeConnections:
                yield Spot(component, bridge_connection)
    for node in model.instances(ros.Node, library=False):
        yield Spot(node)
        for feature in ("publishers", "subscriptions", "serviceServers", "serviceClients"):
            for end in getattr(node, feature):
                yield Spot(node, end)


def map_of(scope: Scope, view: str) -> bridge.AttributeMap | None:
    """Returns the map of a view, None for another kind of view."""
    kind, _, name = view.partition(":")
    return map_named(scope, name) if kind == "map" else None


def map_shown(scope: Scope, view: str) -> bridge.AttributeMap:
    """Returns the map that a view shows, which must be one of a map."""
    map_ = map_of(scope, view)
    if map_ is None:
        raise AnswerError(f"{view} is no view of a map")
    return map_


def element_shown(scope: Scope, view: str) -> EObject | None:
    """Returns the service or machine that a view shows, None for another view."""
    if view.partition(":")[0] not in ("service", "machine"):
        return None
    return scope.find(graph_of(scope.model, view, root=scope.root).element)


def map_named(scope: Scope, name: str) -> bridge.AttributeMap:
    """Returns the map of a name, as its view has it."""
    for attribute_map in scope.model.instances(bridge.AttributeMap):
        if name in names_of(attribute_map):
            return attribute_map
    raise AnswerError(f"there is no map {name!r} any more")


def end_of(scope: Scope, map_: bridge.AttributeMap, node: str, port: str) -> Member:
    """Returns the member that ids of the map view name."""
    if not port:
        raise AnswerError("draw from a member to a member")
    if node.endswith(JAUS_END):
        return member(map_, port, is_jaus=True)
    if node.endswith(ROS_END):
        return member(map_, port, is_jaus=False)
    for join in (*map_.joins, *map_.reportJoins):
        if scope.model.fragment(join) == node.rpartition("#")[2]:
            is_jaus = isinstance(join, bridge.ReportJoin)
            return member(map_, f"{join.name}.{port}", is_jaus=is_jaus)
    raise AnswerError("that box is no end of the map")


XMI, TEXT = "xmi", "text"


@dataclass(frozen=True, slots=True)
class Located:
    """The text of a file, and where in it an element stands.

    Attributes:
        notation: `xmi` or `text`.
        start: Where the element begins, in units of UTF-16 as browsers count them.
    """

    file: str
    notation: str
    text: str
    start: int
    end: int


def source(scope: Scope, ref: str) -> Located:
    """Returns the place of an element; that of its owner for one that the text implies."""
    element = scope.find(ref)
    file, _ = refs.split(ref)
    model = scope.model_of(element)
    document = model.document_of(element)
    if document is None:
        return Located(file, XMI, "", 0, 0)
    places = _places(document)
    spans = (places.element(node) for node in _nodes(model, element))
    start, end = next(filter(None, spans), (0, 0))
    text, notation = places.text, TEXT if isinstance(places, TextPlaces) else XMI
    return Located(
        file, notation, with_newlines(text), utf16_length(text[:start]), utf16_length(text[:end])
    )


def _places(document: Document) -> TextPlaces | XmlPlaces:
    written = document.written
    return (
        TextPlaces(document, written) if isinstance(written, TextDocument) else XmlPlaces(document)
    )


def _nodes(model: Model, element: EObject) -> Iterator[Node]:
    """Yields the nodes that were read for an element, and then for its owners."""
    nodes = map(model.node_of, with_owners(element))
    yield from (node for node in nodes if node is not None)


def element_at(model: Model, offset: int) -> EObject | None:
    """Returns the innermost element that is written at a place, None where there is none.

    `offset`: the place, as a page counts.
    """
    document = model.documents[0]
    if not document.readable:
        return None
    places = _places(document)
    at = index_of_utf16(places.text, offset)
    around: list[tuple[int, EObject]] = []
    waiting = list(reversed(document.root_nodes))
    while waiting:
        node = waiting.pop()
        start, end = places.element(node) or (at + 1, at)
        # In text, what an element owns may stand anywhere.
        if start <= at <= end or isinstance(places, TextPlaces):
            waiting += reversed(node.children)
        if start <= at <= end and node.obj is not None:
            around.append((start, node.obj))
    # Of two that touch, the one that begins last; of two that begin together, the inner one.
    latest = max((start for start, _ in around), default=None)
    return next((obj for start, obj in reversed(around) if start == latest), None)

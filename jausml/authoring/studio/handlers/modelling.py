"""Requests that need thought: forms, the palette, what can be connected."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.authoring.proposals.elements import AnswerError, Options, Scope, label_of
from jausml.authoring.proposals.mapping.assigning import assign, partners
from jausml.authoring.studio.rpc import Method
from jausml.authoring.studio.views.connecting import connect, ends, hosted
from jausml.authoring.studio.views.forms import form
from jausml.authoring.studio.views.inheriting import cut, heritage, join
from jausml.authoring.studio.views.moving import lead
from jausml.authoring.studio.views.palette import MOST, palette
from jausml.authoring.studio.views.spots import JAUS_END, ROS_END, element_of, end_of, spot
from jausml.language.metamodel.classes import bridge, jaus, system
from jausml.language.model import refs
from jausml.views.diagrams.views import graph_of
from jausml.views.diagrams.views.context import Context

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from jausml.authoring.studio.context import StudioContext
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.model import Model


@dataclass(frozen=True)
class OfElement:
    """An element."""

    element: str


@dataclass(frozen=True)
class Search:
    """What shall be added.

    Attributes:
        kinds: The groups of the palette that are meant; None for all.
        limit: How many at most; None for as many as are usual.
        onto: The element that it is dropped on; empty for the system.
    """

    file: str
    query: str = ""
    kinds: tuple[str, ...] | None = None
    limit: int | None = None
    onto: str = ""


@dataclass(frozen=True)
class Port:
    """An end in the system view: ids of a box and of a row of it, empty for the box."""

    node: str
    port: str = ""


@dataclass(frozen=True)
class Line:
    """A line that was drawn in a view."""

    file: str
    view: str
    source: Port
    target: Port


@dataclass(frozen=True)
class Start:
    """Where a line starts in a view."""

    file: str
    view: str
    node: str
    port: str = ""


@dataclass(frozen=True)
class Drawn:
    """A line that a view shows, by its id."""

    file: str
    view: str
    line: str


@dataclass(frozen=True)
class Hosting:
    """Boxes that were dragged into the frame of a host."""

    file: str
    nodes: tuple[str, ...]
    host: str = ""


def methods(context: StudioContext) -> Mapping[str, Method[Any]]:
    """Returns the methods by name."""
    return {
        "form": Method(OfElement, lambda request: _form(context, request)),
        "palette": Method(Search, lambda request: _palette(context, request)),
        "connect": Method(Line, lambda request: _connect(context, request)),
        "ends": Method(Start, lambda request: _ends(context, request)),
        "unlink": Method(Drawn, lambda request: _unlink(context, request)),
        "host": Method(Hosting, lambda request: _host(context, request)),
    }


def scope_of(context: StudioContext, file: str) -> Scope:
    """Returns the model of a file as answers see it."""
    return scope_around(context, file, context.project.model(file).model)


def scope_around(context: StudioContext, file: str, model: Model) -> Scope:
    """Returns a model of a file as answers see it, with the rest of the project."""
    return Scope(model, context.project.root, lambda: context.project.beside(file))


def _form(context: StudioContext, request: OfElement) -> object:
    file, _ = refs.split(request.element)
    if not file.startswith(refs.LIBRARY):
        verdict = context.verdicts.of(file)
        scope = scope_around(context, file, verdict.report.model)
        return form(scope, request.element, verdict.report.diagnostics)
    _, model = context.project.find(request.element)
    return form(Scope(model, context.project.root), request.element)


def _palette(context: StudioContext, request: Search) -> object:
    scope = scope_of(context, request.file)
    limit = MOST if request.limit is None else max(0, request.limit)
    return {"items": palette(scope, request.query, request.kinds, limit, request.onto)}


def _connect(context: StudioContext, request: Line) -> object:
    scope = scope_of(context, request.file)
    used = map_of(scope, request.view)
    if used is not None:
        first = end_of(scope, used, request.source.node, request.source.port)
        return assign(
            scope, used, first, end_of(scope, used, request.target.node, request.target.port)
        )
    shown = _shown(scope, request.view)
    if isinstance(shown, jaus.StateMachine):
        return lead(scope, shown, request.source.node, request.target.node)
    if isinstance(shown, jaus.Service):
        ends_ = ((each.node, each.port) for each in (request.source, request.target))
        return join(scope, *ends_)
    source = spot(scope, request.source.node, request.source.port)
    return connect(scope, source, spot(scope, request.target.node, request.target.port))


def map_of(scope: Scope, view: str) -> bridge.AttributeMap | None:
    """Returns the map that a view shows, None for a view of something else."""
    kind, _, name = view.partition(":")
    return map_named(scope, name) if kind == "map" else None


def map_named(scope: Scope, name: str) -> bridge.AttributeMap:
    """Returns the map of a name."""
    for each in scope.model.instances(bridge.AttributeMap):
        if each.name == name:
            return each
    raise AnswerError(f"there is no map {name!a} any more")


def _ends(context: StudioContext, request: Start) -> object:
    scope = scope_of(context, request.file)
    ids = Context(scope.model, request.view, ())
    used = map_of(scope, request.view)
    if used is not None:
        return {"ends": list(_members_beside(scope, ids, used, request))}
    shown = _shown(scope, request.view)
    if isinstance(shown, jaus.StateMachine):
        return {"ends": list(_states(scope, request))}
    if isinstance(shown, jaus.Service):
        choices = heritage(scope, request.port or request.node)
        return {"ends": [_end(each.value, each.label, each.documentation) for each in choices]}
    found = []
    for end, why in ends(scope, spot(scope, request.node, request.port)):
        port = ids.id_of(end.element) if end.element is not None else ""
        label = " ".join(label_of(each) for each in (end.owner, end.element) if each is not None)
        found.append(_end(ids.id_of(end.owner), label, why, port))
    return {"ends": found}


def _end(node: str, label: str, why: str, port: str = "") -> dict[str, str]:
    return {"node": node, "port": port, "label": label, "why": why}


def _states(scope: Scope, request: Start) -> Iterator[dict[str, str]]:
    """Yields the states of a machine, with that where a line starts."""
    for each in graph_of(scope.model, request.view, root=scope.root).nodes:
        again = "left and entered again" if each.id == request.node else each.subtitle
        yield _end(each.id, each.title, again)


def _shown(scope: Scope, view: str) -> EObject | None:
    """Returns the service or machine that a view shows, None for another view."""
    if view.partition(":")[0] not in ("service", "machine"):
        return None
    return scope.find(graph_of(scope.model, view, root=scope.root).element)


def _unlink(context: StudioContext, request: Drawn) -> Options:
    scope = scope_of(context, request.file)
    if isinstance(_shown(scope, request.view), jaus.Service):
        return cut(scope, request.line)
    return Options(refusal="this line follows from what it joins: delete one of its ends")


def _host(context: StudioContext, request: Hosting) -> object:
    scope = scope_of(context, request.file)
    boxes = [spot(scope, each, "").owner for each in request.nodes]
    host = element_of(scope, request.host) if request.host else None
    if not boxes or (host is not None and not isinstance(host, system.Host)):
        raise AnswerError("components and nodes run on hosts; drag some into the frame of one")
    return hosted(scope, boxes, host)


def _members_beside(
    scope: Scope, ids: Context, used: bridge.AttributeMap, request: Start
) -> Iterator[dict[str, str]]:
    """Yields the members of the other end of a map that a member may become."""
    start = end_of(scope, used, request.node, request.port)
    box = f"{ids.id_of(used)}{ROS_END if start.is_jaus else JAUS_END}"
    for each, why in partners(scope, used, start):
        yield _end(box, each.path, why, each.path)

"""Answers about a model that is edited: forms, the palette, what can be connected, values tried."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from jausml.authoring.proposals.elements import AnswerError, Options, Scope, label_of
from jausml.authoring.proposals.mapping.assigning import assign, partners
from jausml.authoring.proposals.mapping.assignments import clock, constant, ignore
from jausml.authoring.proposals.mapping.filling import fill_map
from jausml.authoring.studio.context import StudioContext
from jausml.authoring.studio.views.connecting import connect, ends, hosted
from jausml.authoring.studio.views.forms import choices, form_of
from jausml.authoring.studio.views.palette import MOST, palette
from jausml.authoring.studio.views.service_lines import cut, heritage, join, lead
from jausml.authoring.studio.views.spots import (
    JAUS_END,
    ROS_END,
    element_of,
    element_shown,
    end_of,
    map_named,
    map_of,
    map_shown,
    spot,
)
from jausml.authoring.studio.views.trying import inputs
from jausml.language.metamodel.classes import jaus, system
from jausml.language.model import refs
from jausml.views.diagrams.views import graph_of
from jausml.views.diagrams.views.context import Context

Direction = Literal["to_ros", "to_jaus"]


@dataclass(frozen=True)
class Port:
    """An end in the system view: ids of a box and of a row of it, empty for the box."""

    node: str
    port: str = ""


def _form(context: StudioContext, element: str) -> object:
    file, _ = refs.split(element)
    if file.startswith(refs.LIBRARY):
        scope = context.scope_of_library(element)
        return form_of(scope, scope.find(element))
    report = context.verdicts.of(file).report
    scope = context.scope_of(file, report.model)
    return form_of(scope, scope.find(element), report.diagnostics)


def _choices(context: StudioContext, element: str, feature: str, query: str = "") -> object:
    """Returns the elements that a reference may lead to, searched by a query."""
    file, _ = refs.split(element)
    is_library = file.startswith(refs.LIBRARY)
    scope = context.scope_of_library(element) if is_library else context.scope_of(file)
    return choices(scope, element, feature, query)


def _palette(
    context: StudioContext,
    file: str,
    query: str = "",
    kinds: tuple[str, ...] | None = None,
    limit: int | None = None,
    onto: str = "",
) -> object:
    """Returns the elements that can be added to `onto`, or to the system; of all kinds, or some."""
    limit = MOST if limit is None else max(0, limit)
    return {"items": palette(context.scope_of(file), query, kinds, limit, onto)}


def _connect(context: StudioContext, file: str, view: str, source: Port, target: Port) -> object:
    scope = context.scope_of(file)
    map_ = map_of(scope, view)
    if map_ is not None:
        first = end_of(scope, map_, source.node, source.port)
        return assign(scope, map_, first, end_of(scope, map_, target.node, target.port))
    shown = element_shown(scope, view)
    if isinstance(shown, jaus.StateMachine):
        return lead(scope, shown, source.node, target.node)
    if isinstance(shown, jaus.Service):
        return join(scope, (source.node, source.port), (target.node, target.port))
    start = spot(scope, source.node, source.port)
    return connect(scope, start, spot(scope, target.node, target.port))


def _ends(context: StudioContext, file: str, view: str, node: str, port: str = "") -> object:
    """Returns where a line may end that starts at an end of a view."""
    scope = context.scope_of(file)
    ids = Context(scope.model, view, ())
    map_ = map_of(scope, view)
    if map_ is not None:
        start = end_of(scope, map_, node, port)
        box = f"{ids.id_of(map_)}{ROS_END if start.is_jaus else JAUS_END}"
        members = partners(scope, map_, start)
        return {"ends": [_end(box, member.path, why, member.path) for member, why in members]}
    shown = element_shown(scope, view)
    if isinstance(shown, jaus.StateMachine):
        return {"ends": list(_states(scope, view, node))}
    if isinstance(shown, jaus.Service):
        choices = heritage(scope, port or node)
        return {
            "ends": [_end(choice.value, choice.label, choice.documentation) for choice in choices]
        }
    line_ends = []
    for end, why in ends(scope, spot(scope, node, port)):
        row = ids.id_of(end.element) if end.element is not None else ""
        label = " ".join(
            label_of(element) for element in (end.owner, end.element) if element is not None
        )
        line_ends.append(_end(ids.id_of(end.owner), label, why, row))
    return {"ends": line_ends}


def _end(node: str, label: str, why: str, port: str = "") -> dict[str, str]:
    return {"node": node, "port": port, "label": label, "why": why}


def _states(scope: Scope, view: str, start: str) -> Iterator[dict[str, str]]:
    """Yields the states of a machine, with that where a line starts."""
    for node in graph_of(scope.model, view, root=scope.root).nodes:
        again = "left and entered again" if node.id == start else node.subtitle
        yield _end(node.id, node.title, again)


def _unlink(context: StudioContext, file: str, line: str) -> Options:
    return cut(context.scope_of(file), line)


def _host(context: StudioContext, file: str, nodes: tuple[str, ...], host: str = "") -> object:
    """Returns how boxes come to run on a host, into whose frame they were dragged."""
    scope = context.scope_of(file)
    boxes = [spot(scope, node, "").owner for node in nodes]
    frame = element_of(scope, host) if host else None
    if not boxes or (frame is not None and not isinstance(frame, system.Host)):
        raise AnswerError("components and nodes run on hosts; drag some into the frame of one")
    return hosted(scope, boxes, frame)


def _inputs(context: StudioContext, file: str, map: str, direction: Direction) -> object:  # noqa: A002
    map_ = map_named(context.scope_of(file), map)
    return {"inputs": inputs(map_, to_ros=direction == "to_ros")}


def _fill(
    context: StudioContext, file: str, view: str, target: Port, value: str = ""
) -> dict[str, Any]:
    """Returns how a member is filled that has no source."""
    scope = context.scope_of(file)
    map_ = map_shown(scope, view)
    member = end_of(scope, map_, target.node, target.port)
    return {
        "constant": constant(scope, map_, member, value),
        "clock": clock(scope, map_, member),
        "ignore": ignore(scope, map_, member),
    }


def _fill_map(context: StudioContext, file: str, view: str) -> object:
    scope = context.scope_of(file)
    return fill_map(scope, map_shown(scope, view))


def _try(
    context: StudioContext,
    file: str,
    map: str,  # noqa: A002
    direction: Direction,
    values: Mapping[str, str],
) -> object:
    """Returns the translation of values, which are texts by path."""
    scope = context.scope_of(file)
    to_ros = direction == "to_ros"
    return context.trials.run(scope, map_named(scope, map), values, to_ros=to_ros)


METHODS: Mapping[str, Callable[..., object]] = {
    "form": _form,
    "choices": _choices,
    "palette": _palette,
    "connect": _connect,
    "ends": _ends,
    "unlink": _unlink,
    "host": _host,
    "tried": _inputs,
    "fill": _fill,
    "fill_map": _fill_map,
    "try": _try,
}
"""The functions that answer questions, by name."""

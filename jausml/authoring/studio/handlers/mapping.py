"""Questions about attribute maps: what values of one side become on the other."""

from __future__ import annotations

from collections.abc import Mapping  # noqa: TC003 - parameters are typed at run time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.proposals.mapping.assignments import clock, constant, ignore
from jausml.authoring.proposals.mapping.filling import fill_map
from jausml.authoring.studio.handlers.answering import Port, map_named, map_of, scope_of
from jausml.authoring.studio.handlers.showing import OfView
from jausml.authoring.studio.rpc import Method
from jausml.authoring.studio.views.spots import end_of
from jausml.authoring.studio.views.trying import inputs

if TYPE_CHECKING:
    from jausml.authoring.proposals.elements import Scope
    from jausml.authoring.studio.context import StudioContext
    from jausml.language.metamodel.classes import bridge

Direction = Literal["to_ros", "to_jaus"]


@dataclass(frozen=True)
class Asked:
    """A direction of a map, by the name of the map."""

    file: str
    map: str
    direction: Direction


@dataclass(frozen=True)
class Trial:
    """Values that are tried: texts by path."""

    file: str
    map: str
    direction: Direction
    values: Mapping[str, str]


@dataclass(frozen=True)
class Filling:
    """A member that is filled without a source."""

    file: str
    view: str
    target: Port
    value: str = ""


def methods(context: StudioContext) -> Mapping[str, Method[Any]]:
    """Returns the methods by name."""
    return {
        "tried": Method(Asked, lambda asked: _inputs(context, asked)),
        "fill": Method(Filling, lambda asked: _fill(context, asked)),
        "fill_map": Method(OfView, lambda asked: _fill_map(context, asked)),
        "try": Method(Trial, lambda asked: _try(context, asked)),
    }


def _inputs(context: StudioContext, asked: Asked) -> object:
    used = map_named(scope_of(context, asked.file), asked.map)
    return {"inputs": inputs(used, to_ros=asked.direction == "to_ros")}


def _fill(context: StudioContext, asked: Filling) -> object:
    scope = scope_of(context, asked.file)
    used = _map_of(scope, asked.view)
    target = end_of(scope, used, asked.target.node, asked.target.port)
    return {
        "constant": constant(scope, used, target, asked.value),
        "clock": clock(scope, used, target),
        "ignore": ignore(scope, used, target),
    }


def _fill_map(context: StudioContext, asked: OfView) -> object:
    scope = scope_of(context, asked.file)
    return fill_map(scope, _map_of(scope, asked.view))


def _map_of(scope: Scope, view: str) -> bridge.AttributeMap:
    used = map_of(scope, view)
    if used is None:
        raise AnswerError(f"{view} is no view of a map")
    return used


def _try(context: StudioContext, asked: Trial) -> object:
    scope = scope_of(context, asked.file)
    to_ros = asked.direction == "to_ros"
    return context.trials.run(scope, map_named(scope, asked.map), asked.values, to_ros=to_ros)

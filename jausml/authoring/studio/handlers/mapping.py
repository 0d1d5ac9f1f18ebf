"""Requests about attribute maps: what values of one side become on the other."""

from __future__ import annotations

from collections.abc import Mapping  # noqa: TC003 - parameters are typed at run time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.proposals.mapping.assignments import clock, constant, ignore
from jausml.authoring.proposals.mapping.filling import fill_map
from jausml.authoring.studio.handlers.modelling import Port, map_named, map_of, scope_of
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
class InputsRequest:
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
        "tried": Method(InputsRequest, lambda request: _inputs(context, request)),
        "fill": Method(Filling, lambda request: _fill(context, request)),
        "fill_map": Method(OfView, lambda request: _fill_map(context, request)),
        "try": Method(Trial, lambda request: _try(context, request)),
    }


def _inputs(context: StudioContext, request: InputsRequest) -> object:
    used = map_named(scope_of(context, request.file), request.map)
    return {"inputs": inputs(used, to_ros=request.direction == "to_ros")}


def _fill(context: StudioContext, request: Filling) -> object:
    scope = scope_of(context, request.file)
    used = _map_of(scope, request.view)
    target = end_of(scope, used, request.target.node, request.target.port)
    return {
        "constant": constant(scope, used, target, request.value),
        "clock": clock(scope, used, target),
        "ignore": ignore(scope, used, target),
    }


def _fill_map(context: StudioContext, request: OfView) -> object:
    scope = scope_of(context, request.file)
    return fill_map(scope, _map_of(scope, request.view))


def _map_of(scope: Scope, view: str) -> bridge.AttributeMap:
    used = map_of(scope, view)
    if used is None:
        raise AnswerError(f"{view} is no view of a map")
    return used


def _try(context: StudioContext, request: Trial) -> object:
    scope = scope_of(context, request.file)
    to_ros = request.direction == "to_ros"
    return context.trials.run(scope, map_named(scope, request.map), request.values, to_ros=to_ros)

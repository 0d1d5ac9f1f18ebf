"""Requests about which bridge carries which connections, and what that costs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from jausml.authoring.projects.adding import check_name
from jausml.authoring.projects.errors import ProjectError
from jausml.authoring.proposals.bridging import system_of
from jausml.authoring.proposals.elements import AnswerError, Scope
from jausml.authoring.proposals.partition import commands_of, taken_over
from jausml.authoring.studio.context import StudioContext
from jausml.language.model.names import name_of
from jausml.views.analysis.formats.plan import named, plain
from jausml.views.analysis.formats.text import number
from jausml.views.analysis.partition.plans import Planner
from jausml.views.analysis.partition.weighing import Limits
from jausml.views.analysis.sizes import Assumptions
from jausml.views.diagrams.views.context import Context

_MOST_WEIGHED = 400
"""Connections that are weighed after each edit: each takes a thousandth of a second."""


def _partition(
    context: StudioContext,
    file: str,
    most: int = 0,
    load: float = 50,
    names: Mapping[str, str] | None = None,
) -> dict[str, Any]:
    """Returns bridges before and after, with the commands: as is proposed, or as `names` say it.

    `most`: connections of a bridge, 0 for any. `load`: percent of a processor. `names`: the bridge
    of connections, by their names behind those of their bridges now.
    """
    scope, planner = _planner(context, file)
    if names is None:
        plan = planner.propose(Limits(max(0, most), max(load, 0.001) / 100))
    else:
        homes = {planned.name for planned in planner.before}
        for name in set(names.values()) - homes:
            _check_new(name, scope)
        known = {
            named(carrier): carrier for planned in planner.before for carrier in planned.carriers
        }
        if unknown := names.keys() - known.keys():
            raise AnswerError(f"there is no connection {min(unknown)} any more")
        plan = planner.assigned({known[name]: home for name, home in names.items()})
    return {**plain(plan), "commands": () if plan.faults else commands_of(scope, plan)}


def _check_new(name: str, scope: Scope) -> None:
    whole = system_of(scope)
    try:
        if whole is not None:
            check_name(name, whole)
    except ProjectError as error:
        raise AnswerError(str(error)) from error


def _carry(
    context: StudioContext, file: str, elements: tuple[str, ...], bridge: str = ""
) -> object:
    """Returns the option that moves connections to a bridge, by default to a new one."""
    scope, planner = _planner(context, file)
    known = {id(carrier): carrier for planned in planner.before for carrier in planned.carriers}
    carriers = [known[id(element)] for element in map(scope.find, elements) if id(element) in known]
    if len(carriers) < len(elements) or not carriers:
        raise AnswerError("connections of bridges go to other bridges; choose some")
    return taken_over(scope, planner, carriers, name_of(scope.find(bridge)) if bridge else "")


def _loads(context: StudioContext, file: str) -> dict[str, Any]:
    """Returns the costs of the bridges of a system, by the ids of their boxes."""
    scope = context.scope_of(file)
    whole = system_of(scope)
    count = sum(len(bridge.bridgeConnections) for bridge in whole.bridges) if whole else 0
    if not 0 < count <= _MOST_WEIGHED or context.verdicts.of(file).report.has_errors:
        return {"loads": {}}
    ids = Context(scope.model, "system", ())
    loads = {
        ids.id_of(
            planned.origin
        ): f"{number(planned.share * 100)} % CPU, {planned.datagrams:.0f} datagrams/s, "
        f"waits {planned.wait * 1000:.2g} ms"
        for planned in _planner(context, file)[1].before
    }
    return {"loads": loads}


def _planner(context: StudioContext, file: str) -> tuple[Scope, Planner]:
    scope = context.scope_of(file)
    whole = system_of(scope)
    if whole is None or not whole.bridges:
        raise AnswerError("the file has no system with bridges")
    if context.verdicts.of(file).report.has_errors:
        raise AnswerError("the model has errors, so nobody knows what its bridges cost")
    return scope, Planner(whole, Assumptions())


METHODS: Mapping[str, Callable[..., object]] = {
    "partition": _partition,
    "carry": _carry,
    "loads": _loads,
}
"""The functions that answer questions, by name."""

"""The views of a model: which there are, and the graph of each."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.diagrams.views import machines, maps, services, system
from jausml.diagrams.views.context import Context
from jausml.metamodel.classes.system import System
from jausml.model.values import nearest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path

    from jausml.diagrams.graph import Graph
    from jausml.model.diagnostics import Diagnostic
    from jausml.model.model import Model

SYSTEM = "system"


class UnknownViewError(Exception):
    """A model has no such view.

    Args:
        view: What was asked for.
        known: The views that the model has.
    """

    def __init__(self, view: str, known: Iterable[str]) -> None:
        names = list(known)
        kind = view.partition(":")[0]
        same = [each for each in names if each.partition(":")[0] == kind]
        near = nearest(view, names)
        if near:
            hint = f"did you mean {near}?"
        else:
            shown = ", ".join((same or names)[:_MOST_SHOWN])
            hint = f"there are: {shown}" if shown else "the model has none"
        super().__init__(f"no view {view!a}; {hint}")


_MOST_SHOWN = 12


def view_names(model: Model, *, library: bool = True) -> list[str]:
    """Returns the views of a model: the system, maps, services and machines.

    Args:
        model: The model.
        library: Whether those of the shipped library that it uses are among them.
    """
    return list(_views(model, library=library))


def graph_of(
    model: Model, view: str, diagnostics: Iterable[Diagnostic] = (), root: Path | None = None
) -> Graph:
    """Returns the graph of a view.

    Args:
        model: The model; it may have errors.
        view: Name of the view, such as `system` or `map:odometry`.
        diagnostics: What was found about the model.
        root: The folder to which references are relative; None for that of the first file.

    Raises:
        UnknownViewError: The model has no such view.
    """
    views = _views(model, library=True)
    if view not in views:
        raise UnknownViewError(view, views)
    return views[view](Context(model, view, diagnostics, root))


def _views(model: Model, *, library: bool) -> dict[str, Callable[[Context], Graph]]:
    found: dict[str, Callable[[Context], Graph]] = {}
    # A system begins with nothing, and a text of nothing may become one.
    first = model.documents[0].roots if model.documents else []
    if not first or isinstance(first[0], System) or system.participants(model):
        found[SYSTEM] = system.graph
    for module in (maps, services, machines):
        for name, make in module.offered(model, library=library):
            found.setdefault(name, make)
    return found

"""The views of a model: which there are, and the graph of each."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from jausml.language.metamodel.classes.system import System
from jausml.language.model.diagnostics import Diagnostic
from jausml.language.model.model import Model
from jausml.language.model.values import nearest
from jausml.language.semantics.subject import remembering
from jausml.views.diagrams.graph import Graph
from jausml.views.diagrams.views import maps, services, system
from jausml.views.diagrams.views.context import Context

SYSTEM = "system"


class UnknownViewError(Exception):
    """A model has no such view."""

    def __init__(self, view: str, known: Iterable[str]) -> None:
        names = list(known)
        kind = view.partition(":")[0]
        same = [name for name in names if name.partition(":")[0] == kind]
        near = nearest(view, names)
        if near:
            hint = f"did you mean {near}?"
        else:
            shown = ", ".join((same or names)[:_MOST_SHOWN])
            hint = f"there are: {shown}" if shown else "the model has none"
        super().__init__(f"no view {view!r}; {hint}")


_MOST_SHOWN = 12


def view_names(model: Model, *, library: bool = True) -> list[str]:
    """Returns the views of a model, each once: the system, maps, services and machines.

    A view has the first of its names that no view before it has.
    """
    chosen_names: list[str] = []
    taken: set[str] = set()
    for names, _ in _offered(model, library=library):
        chosen_names += [name for name in names if name not in taken][:1]
        taken.update(names)
    return chosen_names


def graph_of(
    model: Model, view: str, diagnostics: Iterable[Diagnostic] = (), root: Path | None = None
) -> Graph:
    """Returns the graph of a view.

    Args:
        view: Name of the view, such as `system` or `map:odometry`; a service that has one has
            `bodies:NAME` too, with the members of its messages.
        root: The folder to which references are relative; None for that of the first file.

    Raises:
        UnknownViewError: The model has no such view.
    """
    views: dict[str, Callable[[Context], Graph]] = {}
    for names, make in _offered(model, library=True):
        for name in names:
            views.setdefault(name, make)
    shown = (
        view.replace(services.BODIES, services.SERVICE)
        if view.startswith(services.BODIES)
        else view
    )
    if shown not in views:
        raise UnknownViewError(shown, views)
    with remembering():
        return views[shown](Context(model, view, diagnostics, root))


def _offered(
    model: Model, *, library: bool
) -> Iterator[tuple[tuple[str, ...], Callable[[Context], Graph]]]:
    """Yields all names of each view, and the function that makes its graph."""
    # A system begins with nothing, and a text of nothing may become one.
    first = model.documents[0].roots if model.documents else []
    if not first or isinstance(first[0], System) or system.participants(model):
        yield (SYSTEM,), system.graph
    for offered in (maps.offered, services.offered, services.offered_machines):
        yield from offered(model, library=library)

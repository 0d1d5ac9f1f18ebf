"""Projects that begin with what is there: topics of ROS, or services in JSIDL."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import Add
from jausml.authoring.projects.adding import add, add_bridge
from jausml.authoring.projects.creating import create
from jausml.authoring.projects.eclipse import localized
from jausml.authoring.projects.errors import ProjectError
from jausml.authoring.projects.places import place_of
from jausml.authoring.proposals.elements import Scope
from jausml.authoring.proposals.fresh import free_address
from jausml.language.model.reading.reader import read_models
from jausml.language.model.xmi.writer import replace_file, to_xmi

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from jausml.authoring.editing.commands import Command
    from jausml.authoring.projects.creating import Wish
    from jausml.authoring.projects.places import Opened
    from jausml.authoring.proposals.topics import Crossing, TopicEnd
    from jausml.language.importers.jsidl import ImportResult
    from jausml.language.metamodel.classes import jaus


def start_from_topics(
    folder: Path, wish: Wish, chosen: Sequence[Crossing], topics: Sequence[TopicEnd]
) -> list[str]:
    """Makes a project whose system has a bridge of topics.

    Returns:
        The paths of what was written, relative to the folder.

    Raises:
        OSError: A file cannot be written.
    """
    written = _begin(folder, wish)
    place = place_of(folder / wish.model)
    files = add_bridge(place, f"{wish.name}_bridge", chosen, topics)
    return list(dict.fromkeys((*written, *files)))


def start_from_services(folder: Path, wish: Wish, imported: ImportResult) -> list[str]:
    """Makes a project whose system has a component that provides services that were imported.

    Returns:
        The paths of what was written, relative to the folder.

    Raises:
        OSError: A file cannot be written.
    """
    services = folder / "models" / f"{wish.name}_services.xmi"
    if services.exists():
        raise ProjectError(f"{services} is there already; nothing was written")
    written = _begin(folder, wish)
    place = place_of(folder / wish.model)
    xmi = to_xmi(imported.sets, imported.model, services)
    replace_file(services, localized(xmi, services.resolve(), place.root).encode())

    def commands(at: Opened) -> Sequence[Command]:
        model = read_models([services], project_root=place.root).model
        scope = Scope(at.scope.model, place.root, (model,))
        provided = tuple(map(scope.ref, _outermost(model.documents[0].roots)))  # type: ignore[arg-type]
        values = {
            "name": (f"{wish.name}_component",),
            "address": (free_address(scope.model),),
            "provides": provided,
        }
        return [Add(scope.ref(at.system), "components", "jaus.Component", values)]

    files = add(place, "Add a component", commands)
    found = services.relative_to(folder).as_posix()
    return list(dict.fromkeys((*written, found, *files)))


def _begin(folder: Path, wish: Wish) -> list[str]:
    """Makes an empty project in which its model is new."""
    if (folder / wish.model).exists():
        raise ProjectError(f"{folder / wish.model} is there already; nothing was written")
    return create(folder, replace(wish, is_empty=True))


def _outermost(sets: Sequence[jaus.ServiceSet]) -> list[jaus.Service]:
    """Returns the services that no other one of the sets inherits."""
    services = [each for one in sets for each in one.services]
    inherited = [each.inherits for each in services]
    return [each for each in services if each not in inherited]

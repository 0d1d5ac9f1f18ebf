"""New elements of a project, written into the model that stands there."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from jausml.authoring.editing.commands import Add, Command, EditError
from jausml.authoring.projects.creating import Wish, create
from jausml.authoring.projects.eclipse_xmi import MAPPINGS, as_xmi_beside, localized
from jausml.authoring.projects.errors import ProjectError
from jausml.authoring.projects.places import Opened, Place, opened, place_of
from jausml.authoring.projects.starting import EMPTY
from jausml.authoring.proposals.bridging import bridges_of, offer_of
from jausml.authoring.proposals.elements import AnswerError, Scope
from jausml.authoring.proposals.new_elements import free_address, participant_name
from jausml.authoring.proposals.system_parts import new_bridge, new_connections
from jausml.authoring.proposals.topics import Crossing, TopicEnd
from jausml.language.importers.jsidl import ImportResult
from jausml.language.metamodel.classes import bridge, jaus, system
from jausml.language.model.files import replace_file
from jausml.language.model.names import name_of
from jausml.language.model.xmi.writer import to_xmi
from jausml.language.project import Index, library
from jausml.language.semantics.names import is_identifier, snake_case, taken


class Written(NamedTuple):
    """The files that an addition has written, relative to the folder of the project.

    `formatted`: those of them whose layout was another one.
    """

    files: tuple[str, ...]
    formatted: tuple[str, ...]


def add(
    place: Place,
    label: str,
    commands: Callable[[Opened], Sequence[Command]],
    *,
    is_of_services: bool = False,
) -> Written:
    """Adds elements to a model, all or none; returns the files that were written.

    `ProjectError`: it cannot be added; nothing was written. `OSError`: a file cannot be read or
    written.
    """
    at = opened(place, is_of_services=is_of_services)
    try:
        entry = at.project.do(commands(at), label)
    except (EditError, AnswerError) as error:
        at.forget()
        raise ProjectError(str(error)) from error
    except BaseException:
        at.forget()
        raise
    new_files = [path.relative_to(place.root).as_posix() for path in at.created]
    formatted = tuple(file for file in entry.formatted if file not in new_files)
    return Written(tuple(dict.fromkeys((*new_files, *entry.files))), formatted)


def add_bridge(
    place: Place,
    name: str,
    chosen: Sequence[Crossing],
    topics: Sequence[TopicEnd],
    address: str = "",
    namespace: str = "",
) -> Written:
    """Adds a bridge with a connection for each way that was chosen.

    `address`: its JAUS id; empty for one that is free. `namespace`: that of its topics. Returns the
    files that were written, relative to the folder of the project.
    """

    def new_commands(at: Opened, scope: Scope, crossings: Sequence[Crossing]) -> Sequence[Command]:
        whole = at.system
        if name in [name_of(system_bridge) for system_bridge in whole.bridges]:
            raise ProjectError(
                f"{name_of(whole)} has something of the name {name} already; "
                f"jausml new connection --bridge {name} adds topics to it"
            )
        check_name(name, whole)
        space = namespace.strip("/")
        return new_bridge(
            scope, whole, name, crossings, topics=topics, address=address, namespace=space
        )

    return _carry(place, f"Add bridge {name}", chosen, new_commands)


def add_connections(
    place: Place, name: str, chosen: Sequence[Crossing], topics: Sequence[TopicEnd]
) -> Written:
    """Adds a connection for each way that was chosen to a bridge, with the services of them.

    `name`: name of the bridge; empty for the only one. Returns the files that were written,
    relative to the folder of the project.
    """

    def new_commands(at: Opened, scope: Scope, crossings: Sequence[Crossing]) -> Sequence[Command]:
        owner = bridge_in(at, name)
        for crossing in crossings:
            if _carries(owner, crossing):
                map_name = name_of(crossing.map)
                raise ProjectError(
                    f"{name_of(owner)} carries {crossing.topic.name} by {map_name} already"
                )
        return new_connections(scope, owner, crossings, topics)

    return _carry(place, "Add connections", chosen, new_commands)


def _carries(owner: bridge.Bridge, crossing: Crossing) -> bool:
    return any(
        name_of(connection.map) == name_of(crossing.map)
        and crossing.topic.name in [topic.name for topic in connection.topics]
        for connection in owner.bridgeConnections
        if connection.map is not None
    )


def _carry(
    place: Place,
    label: str,
    chosen: Sequence[Crossing],
    command_factory: Callable[[Opened, Scope, Sequence[Crossing]], Sequence[Command]],
) -> Written:
    """Adds the connections that carry topics by ready maps; returns the files that were written.

    Text imports the ready maps. Eclipse reads no text, so XMI gets copies of them beside it.
    """
    copies = {} if place.is_text else _copies(place, chosen)
    new = [path for path in copies if not path.exists()]
    for path in new:
        path.parent.mkdir(parents=True, exist_ok=True)
        replace_file(path, as_xmi_beside(copies[path], path, place.root).encode())

    def commands(at: Opened) -> Sequence[Command]:
        scope = at.scope
        return command_factory(
            at, scope, [_present(crossing, scope, copies) for crossing in chosen]
        )

    try:
        written = add(place, label, commands)
    except BaseException:
        for path in new:
            path.unlink(missing_ok=True)
        raise
    copied = (path.relative_to(place.root).as_posix() for path in new)
    return written._replace(files=(*written.files, *copied))


def check_name(name: str, whole: system.System) -> None:
    """Raises ProjectError where a component, bridge or node cannot have a name."""
    if not is_identifier(name):
        raise ProjectError(f"{name!r} is no name: letters, digits and single _ after a letter")
    if reason := taken(name.lower()):
        raise ProjectError(f"{name} {reason}; choose another name")
    if participant_name(name, whole) != snake_case(name):
        raise ProjectError(f"{name_of(whole)} has something of the name {name} already")


def scope_of(place: Place) -> Scope:
    """Returns the scope of a model and its project; the model may be missing."""
    if place.path.exists():
        return opened(place).scope
    return Scope(Index(place.root).whole(), place.root)


def ready_maps(scope: Scope) -> list[bridge.AttributeMap]:
    """Returns the maps of a project, and those of the library that it has no copies of."""
    ready = library().instances(bridge.AttributeMap)
    own = {_identity(map_): map_ for map_ in reversed(scope.own(bridge.AttributeMap))}
    return [
        *reversed(own.values()),
        *(attribute_map for attribute_map in ready if _identity(attribute_map) not in own),
    ]


def _identity(map_: bridge.AttributeMap) -> tuple[str, str, str]:
    """Returns the key that a map and a copy of it have in common."""
    message, kind = map_.message, map_.type
    return name_of(map_), name_of(message) if message else "", name_of(kind) if kind else ""


def _present(crossing: Crossing, scope: Scope, copies: Collection[Path]) -> Crossing:
    """Returns a way with its present map; a copy replaces that of the library."""
    if crossing.has_own_map:
        return crossing
    shipped = library().document_of(crossing.map)
    is_copied = shipped is not None and any(copy.stem == shipped.path.stem for copy in copies)
    for map_ in scope.instances(bridge.AttributeMap):
        if is_copied and library().document_of(map_) is not None:
            break
        offer = offer_of(map_.message, to_ros=crossing.offer.to_ros) if map_.message else None
        if _identity(map_) == _identity(crossing.map) and offer is not None:
            return replace(crossing, map=map_, offer=offer)
    files = ", ".join(str(copy) for copy in copies)
    place = f"{files}: " if is_copied else ""
    raise ProjectError(f"{place}there is no map {name_of(crossing.map)}")


def _copies(place: Place, chosen: Sequence[Crossing]) -> dict[Path, Path]:
    """Returns the texts of the library that ways use, by the files that hold them as XMI."""
    texts_by_file: dict[Path, Path] = {}
    for crossing in chosen:
        document = library().document_of(crossing.map)
        if document is None or document.is_xml or crossing.has_own_map:
            continue
        texts_by_file[place.path.parent / MAPPINGS / f"{document.path.stem}.xmi"] = document.path
    return texts_by_file


def check_map_name(name: str, owner: bridge.Bridge) -> None:
    """Raises ProjectError where a bridge cannot have a map of a name."""
    if not is_identifier(name):
        raise ProjectError(f"{name!r} is no name: letters, digits and single _ after a letter")
    if any(name_of(attribute_map) == name for attribute_map in owner.maps):
        raise ProjectError(f"{name_of(owner)} has a map {name} already")


def bridge_in(at: Opened, name: str) -> bridge.Bridge:
    """Returns the bridge of a model that gets something, in whichever file it stands.

    `name`: its name; empty for the only one.
    """
    roots = at.scope.model.documents[0].roots
    # Eclipse's Control... puts what a system owns into a file of its own.
    apart = (
        system_bridge
        for root in roots
        if isinstance(root, system.System)
        for system_bridge in root.bridges
    )
    bridges = list(dict.fromkeys((*bridges_of(at.scope), *apart)))
    chosen = [candidate for candidate in bridges if name in ("", name_of(candidate))]
    if len(chosen) == 1:
        return chosen[0]
    if not bridges:
        raise ProjectError(f"{at.place.file} has no bridge; `jausml new bridge` makes one")
    which = f"no bridge {name!r}" if name else "not one bridge"
    raise ProjectError(
        f"{at.place.file} has {which}; there are: {', '.join(map(name_of, bridges))}"
    )


def namespace_of(place: Place, name: str) -> str:
    """Returns the ROS namespace of a bridge of a model, empty for the root."""
    if not place.path.exists():
        raise ProjectError(f"{place.path} does not exist, so it has no bridge")
    return str(bridge_in(opened(place), name).namespace or "")


def start_from_topics(
    folder: Path, wish: Wish, chosen: Sequence[Crossing], topics: Sequence[TopicEnd]
) -> list[str]:
    """Makes a project whose system has a bridge of topics.

    Returns the paths of what was written, relative to the folder. `OSError`: a file cannot be
    written.
    """
    written = _begin(folder, wish)
    place = place_of(folder / wish.model)
    bridge_written = add_bridge(place, f"{wish.name}_bridge", chosen, topics)
    return list(dict.fromkeys((*written, *bridge_written.files)))


def start_from_services(folder: Path, wish: Wish, imported: ImportResult) -> list[str]:
    """Makes a project whose system has a component that provides services that were imported.

    Returns the paths of what was written, relative to the folder. `OSError`: a file cannot be
    written.
    """
    services = folder / "models" / f"{wish.name}_services.xmi"
    if services.exists():
        raise ProjectError(f"{services} is there already; nothing was written")
    written = _begin(folder, wish)
    place = place_of(folder / wish.model)
    xmi = to_xmi(imported.sets, imported.model, services)
    replace_file(services, localized(xmi, services.resolve(), place.root).encode())

    def commands(at: Opened) -> Sequence[Command]:
        scope = at.scope
        model = at.project.model(services.relative_to(folder).as_posix()).model
        services_made = _outermost(model.documents[0].roots)  # type: ignore[arg-type]
        provided = tuple(at.project.ref(service, model) for service in services_made)
        values = {
            "name": (f"{wish.name}_component",),
            "address": (free_address(scope.model),),
            "provides": provided,
        }
        return [Add(scope.ref(at.system), "components", "jaus.Component", values)]

    files = add(place, "Add a component", commands).files
    services_path = services.relative_to(folder).as_posix()
    return list(dict.fromkeys((*written, services_path, *files)))


def _begin(folder: Path, wish: Wish) -> list[str]:
    """Makes an empty project in which its model is new."""
    if (folder / wish.model).exists():
        raise ProjectError(f"{folder / wish.model} is there already; nothing was written")
    return create(folder, replace(wish, origin=EMPTY))


def _outermost(sets: Sequence[jaus.ServiceSet]) -> list[jaus.Service]:
    """Returns the services that no other one of the sets inherits."""
    services = [service for service_set in sets for service in service_set.services]
    inherited = [service.inherits for service in services]
    return [service for service in services if service not in inherited]

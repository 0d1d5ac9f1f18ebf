"""The child process that reads the models of a system, again whenever they change.

Usage: python -m jausml.live.operating.reading FILE|FOLDER. It writes `Knowledge`, pickled, to its
standard output, and ends at the end of its input.
"""

from __future__ import annotations

import os
import pickle
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from threading import Thread
from typing import Any

from watchfiles import watch

from jausml.language.metamodel.classes import bridge, system
from jausml.language.model import Model
from jausml.language.model.diagnostics import Severity
from jausml.language.model.project import is_model_file
from jausml.language.model.reading.reader import read_models
from jausml.language.project import Index
from jausml.language.semantics.connections import calls, stops
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.paths.scopes import target_paths
from jausml.language.text.notation import NOTATIONS
from jausml.live.messages import CatalogueError, load_catalogue
from jausml.live.messages.frozen import FrozenMessages, frozen
from jausml.live.messages.of_project import sound_files
from jausml.live.operating.knowledge import Declarations, DeclaredStop, Knowledge
from jausml.live.systems.declarations import components_of, declarations_of

_DEBOUNCE_MS, _STEP_MS = 100, 20
_NICE = 10  # added to the niceness of this process, so that the unit goes first


def read(path: Path) -> Knowledge:
    """Returns the knowledge of a file, or of the first file below a folder that has a system."""
    index = None if path.is_file() else Index(path)
    beside = () if index is None else index.files_with_messages
    for file in (path,) if index is None else index.files_with_systems:
        result = read_models([file], notations=NOTATIONS)
        fault = next(
            (
                diagnostic
                for diagnostic in result.diagnostics
                if diagnostic.severity is Severity.ERROR
            ),
            None,
        )
        if fault is not None:
            messages, _ = _messages(())
            return Knowledge(messages, fault=f"{fault.location}: {fault.message}")
        model = result.model
        if index is None or model.instances(system.System, library=False):
            declared = tuple(declarations_of(model))
            messages, without = _messages(dict.fromkeys([file, *beside]))
            named, stops = components_of(model), stops_of(model)
            untaken = untaken_of(model)
            return Knowledge(messages, declared, named, stops, untaken, left_out=without)
    messages, without = _messages(beside)
    return Knowledge(messages, left_out=without)


def _messages(files: Iterable[Path]) -> tuple[FrozenMessages, str]:
    """Returns the messages of files and the library, and the reasons for files left out."""
    paths, reasons = list(files), list[str]()
    try:
        catalogue = load_catalogue(paths, notations=NOTATIONS)
    except CatalogueError:
        sound = sound_files(paths, "messages", reasons.append)
        catalogue = load_catalogue(sound, notations=NOTATIONS)
    return frozen(catalogue), "; ".join(reasons)


def stops_of(model: Model) -> dict[tuple[str, str], Declarations]:
    """Returns the declared stops, or the reasons for none, by JAUS id and message name."""
    stops_by_command: dict[tuple[str, str], Declarations] = {}
    for owner in model.instances(bridge.Bridge, library=False):
        for connection in owner.bridgeConnections:
            for target in _receivers(owner, connection):
                key = target, str(connection.map.message.name)
                declared = _declared(connection, f"{owner.name}.{connection.name}")
                stops_by_command[key] = (*stops_by_command.get(key, ()), declared)
    return stops_by_command


def untaken_of(model: Model) -> dict[str, frozenset[str]]:
    """Returns the commands of their services that bridges do not take, by JAUS id."""
    return {
        str(owner.address): frozenset(str(message.name) for message in calls.untaken(owner))
        for owner in model.instances(bridge.Bridge, library=False)
        if owner.address
    }


def _receivers(owner: bridge.Bridge, connection: bridge.Connection) -> Iterator[str]:
    """Yields the JAUS ids of the receivers of the commands of a connection."""
    if connection.map is None or connection.map.message is None:
        return
    if not stops.carries_commands(connection):
        return
    takers = [owner] if is_to_ros(connection) else connection.peers
    yield from (str(taker.address) for taker in takers if taker.address)


def _declared(connection: bridge.Connection, name: str) -> DeclaredStop | str:
    """Returns the stop of the JAUS message of a connection, or why there is none."""
    is_sent = not is_to_ros(connection)
    if connection.onSilence.name == "hold":
        return f"{name} holds the last command"
    values: Iterable[bridge.ConstantAssignment] = connection.safeValue if is_sent else ()
    if not values:
        if connection.map.stopJaus is None:
            return f"{name} has no JAUS stop"
        values = connection.map.stopJaus.values
    if connection.silenceTimeout is None or not connection.silenceTimeout > 0:
        return f"{name} declares no silenceTimeout"
    assignments = stops.with_constants(connection.map, values, to_ros=False)
    fields: dict[str, Any] = {}
    for assignment in assignments:
        if not isinstance(assignment, bridge.ConstantAssignment):
            return f"the stop of {name} needs the clock"
        fields |= dict.fromkeys(target_paths(assignment), _value(str(assignment.value)))
    return DeclaredStop("", fields, float(connection.silenceTimeout), f"connection {name}")


def _value(text: str) -> Any:
    try:
        return float(text) if "." in text or "e" in text.lower() else int(text)
    except ValueError:
        return text


def main(path: Path) -> None:
    """Writes the knowledge of a file or folder, and again after each change."""
    os.nice(_NICE)
    # Output of imported modules must not come between the values.
    pipe = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    Thread(target=_end_with_input, daemon=True).start()
    root = path.parent if path.is_file() else path

    def is_model(_: object, changed: str) -> bool:
        return is_model_file(os.path.relpath(changed, root).replace(os.sep, "/"), root)

    _say(pipe, read(path))
    changes = watch(root, watch_filter=is_model, debounce=_DEBOUNCE_MS, step=_STEP_MS)
    for _ in changes:
        if path.exists():
            _say(pipe, read(path))


def _say(pipe: Any, knowledge: Knowledge) -> None:
    pickle.dump(knowledge, pipe)
    pipe.flush()


def _end_with_input() -> None:
    sys.stdin.read()
    os._exit(0)


if __name__ == "__main__":
    main(Path(os.path.realpath(sys.argv[1])))

"""Names of what is known, as JSON, which complete words: of the library and of a project.

What the library and the rules have stands in the folder `known`, a list a file, one JSON object a
line, as `--format json` prints it. `tools/build_known.py` writes them and a test compares them, so
that lists are printed, and words completed, without reading either, which takes several times as
long.

To read a project takes longer than a person waits for a completion: its names are kept in the cache
of the user until one of its models changes.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterable, Sequence
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from jausml.live.messages import Catalogue, ServiceEntry

    Completing = Callable[[click.Context, click.Parameter, str], list[str]]

KNOWN = ("rules", "services", "messages", "fields", "maps")
"""The lists of what is known without a model of the user."""

FOLDER = Path(__file__).parent / "known"

Names = dict[str, list[dict[str, Any]]]
"""Services as `list services` has them, and the paths of the fields of messages."""


def known(name: str) -> list[dict[str, Any]]:
    """Returns a list; the files of the maps are relative to the library."""
    lines = (FOLDER / f"{name}.jsonl").read_text(encoding="utf-8").splitlines()
    return [json.loads(line) for line in lines]


def library_file(name: str) -> str:
    """Returns the path of a file of the library."""
    return str(files("jausml.models") / "library" / name)


def completing(names: Callable[[Sequence[str]], Iterable[str]]) -> Completing:
    """Returns what completes a word by names, of which some come from the models of `--model`."""

    def fitting(context: click.Context, _parameter: click.Parameter, begun: str) -> list[str]:
        return beginning(begun, names(context.params.get("models") or ()))

    return fitting


def beginning(begun: str, names: Iterable[str]) -> list[str]:
    """Returns the names that begin as a word does, in order."""
    return sorted(each for each in set(names) if each.lower().startswith(begun.lower()))


def rule_names(_models: Sequence[str] = ()) -> Iterable[str]:
    """Returns the rules."""
    return (each["rule"] for each in known("rules"))


def map_names(_models: Sequence[str] = ()) -> Iterable[str]:
    """Returns the maps of the library."""
    return (each["map"] for each in known("maps"))


def service_names(models: Sequence[str] = ()) -> Iterable[str]:
    """Returns the services."""
    return (each["name"] for each in _all("services", models))


def message_names(models: Sequence[str] = ()) -> Iterable[str]:
    """Returns the messages."""
    services = _all("services", models)
    return (name for each in services for name in (*each["inputs"], *each["outputs"]))


def input_names(models: Sequence[str] = (), labels: Collection[str] = ()) -> Iterable[str]:
    """Yields the messages that services take, those that they inherit too.

    `labels`: URN and version of each service, e.g. `urn:jaus:jss:core:Management/1.1`; all services
    without any.
    """
    services = {f"{each['service']}/{each['version']}": each for each in _all("services", models)}
    waiting, seen = list(labels or services), set()
    for label in waiting:
        if label in services and label not in seen:
            seen.add(label)
            yield from services[label]["inputs"]
            waiting.append(services[label]["inherits"])


def field_paths(message: str, models: Sequence[str] = ()) -> Iterable[str]:
    """Yields the paths of the fields of the messages of a name."""
    found = (each for each in _all("fields", models) if each["message"] == message)
    return (path for each in found for path in each["paths"])


def _all(kind: str, models: Sequence[str]) -> list[dict[str, Any]]:
    try:
        own = _named(models) if models else _of_project()
    except click.ClickException:
        own = {}  # a completion has nobody to tell it
    return [*known(kind), *own.get(kind, ())]


def _named(models: Sequence[str]) -> Names:
    from jausml.cli.shared.models import open_catalogue

    return names_of(open_catalogue(models))


def _of_project() -> Names:
    """Returns the names that the models of the project of the current folder add."""
    from jausml.language.model.answers import Question
    from jausml.language.model.looking import noting
    from jausml.language.model.project import made_project

    if made_project(Path.cwd()) is None:
        return {}
    question = Question(("names",))
    names: Names | None = question.answer()
    if names is None:
        from jausml.live.messages.of_project import project_catalogue

        with noting() as seen:
            names = names_of(project_catalogue(lambda _: None))
        question.keep(names, seen)
    return names


def names_of(found: Catalogue) -> dict[str, list[dict[str, Any]]]:
    """Returns the services of a catalogue that are not the library's, and their fields."""
    own = [s for s in found.services.values() if not found.model.is_library(s.definition)]
    return {"services": [listed_service(each) for each in own], "fields": listed_fields(own)}


def listed_service(service: ServiceEntry) -> dict[str, Any]:
    """Returns a service."""
    return {
        "service": service.urn,
        "version": service.version,
        "name": service.name,
        "set": service.set_name,
        "inherits": service.inherits.label if service.inherits else None,
        "inputs": [entry.name for entry in service.inputs],
        "outputs": [entry.name for entry in service.outputs],
    }


def listed_fields(services: Iterable[ServiceEntry]) -> list[dict[str, Any]]:
    """Returns the messages of services with the paths of their fields, by name."""
    from jausml.live.messages import MessageError
    from jausml.live.messages.text import paths_of

    found: dict[str, dict[str, None]] = {}
    for entry in (each for service in services for each in service.messages):
        try:
            paths = paths_of(entry)
        except MessageError:
            continue  # Whoever uses it is told what is wrong.
        found.setdefault(entry.name, {}).update(dict.fromkeys(paths))
    return [{"message": name, "paths": list(found[name])} for name in sorted(found) if found[name]]

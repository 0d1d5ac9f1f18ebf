"""Lists as JSON objects, made of what is read: all rules, messages and services, attribute maps."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jausml.authoring.merging.planning import MERGE_RULES
from jausml.cli.shared.models import open_catalogue, readable_model
from jausml.cli.shared.names import listed_fields, listed_service
from jausml.generation.contract.finding import CODE_RULES
from jausml.language.exporters.jsidl import JSIDL_EXPORT_RULES
from jausml.language.importers.jsidl.rules import JSIDL_RULES
from jausml.language.importers.ros.rules import ROS_RULES
from jausml.language.metamodel.classes import bridge
from jausml.language.model.library import library_paths, module_of
from jausml.language.semantics.connections.map_overview import MapOverview, overview
from jausml.language.text.rules import TEXT_RULES
from jausml.language.validation.catalogue import catalogue
from jausml.language.validation.product_rules import PRODUCT_RULES
from jausml.live.messages import UnknownServiceError
from jausml.proving.results import PROOF_RULES
from jausml.safety_case.comparing import CASE_RULES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.live.messages import Catalogue, MessageEntry


def rules() -> list[dict[str, Any]]:
    """Returns all rules, ordered by id."""
    return [
        {
            "rule": entry.id,
            "severity": entry.severity.value,
            "title": entry.title,
            "documentation": entry.documentation,
        }
        for entry in catalogue(
            JSIDL_RULES,
            JSIDL_EXPORT_RULES,
            ROS_RULES,
            TEXT_RULES,
            MERGE_RULES,
            CODE_RULES,
            PROOF_RULES,
            PRODUCT_RULES,
            CASE_RULES,
        )
    ]


def services(models: Sequence[str]) -> list[dict[str, Any]]:
    """Returns the services of models and of the library."""
    return [listed_service(entry) for entry in open_catalogue(models).services.values()]


def fields(models: Sequence[str]) -> list[dict[str, Any]]:
    """Returns the messages of models and of the library with the paths of their fields."""
    return listed_fields(open_catalogue(models).services.values())


def messages(models: Sequence[str], service: str | None = None) -> list[dict[str, Any]]:
    """Returns the messages of models and of the library."""
    found = open_catalogue(models)
    entries = found.messages if service is None else _messages_of(found, service)
    return [_message(entry) for entry in entries]


def maps(models: Sequence[str]) -> list[dict[str, Any]]:
    """Returns the attribute maps of the library and of models."""
    return [each.to_json() for each in open_maps(models)]


def _messages_of(found: Catalogue, service: str) -> Sequence[MessageEntry]:
    try:
        meant = found.find_services(service)
    except UnknownServiceError as error:
        raise click.UsageError(str(error)) from error
    every = (entry for each in meant for owner in each.lineage for entry in owner.messages)
    return sorted(dict.fromkeys(every), key=lambda entry: (entry.code, entry.name))


def _message(entry: MessageEntry) -> dict[str, Any]:
    return {
        "message": entry.name,
        "code": entry.code_text,
        "command": entry.is_command,
        "services": [service.label for service in entry.services],
    }


@dataclass(frozen=True)
class FoundMap:
    """An attribute map and its file.

    `module`: what imports it in text, e.g. `mappings.range_sensor`; empty for a user's file.
    """

    overview: MapOverview
    path: str
    line: int
    module: str

    def to_json(self) -> dict[str, Any]:
        """Returns what the map is, and where."""
        place = {"file": self.path, "line": self.line, "module": self.module or None}
        return {**self.overview.to_json(), **place}


def open_maps(models: Sequence[str], word: str = "") -> list[FoundMap]:
    """Returns the attribute maps of the library and of models, in the order of their files.

    `word`: text that stands in the files of the library that are meant; all when empty.
    """
    ready = [path for path in library_paths("mappings") if word in path.read_text(encoding="utf-8")]
    paths = [*map(str, ready), *models]
    if not paths:
        return []
    model = readable_model(paths)
    found = []
    for each in model.instances(bridge.AttributeMap):
        place = model.location(each)
        path = Path(place.path)
        module = module_of(path) if path in ready else ""
        found.append(FoundMap(overview(each), str(place.path), place.line, module))
    return found

"""Lists as JSON objects, of what is read: rules, services, messages, attribute maps at a glance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from jausml.authoring.merging.planning import MERGE_RULES
from jausml.cli.shared.models import open_catalogue, readable_model
from jausml.cli.shared.names import listed_fields, listed_service
from jausml.generation.contract.finding import CODE_RULES
from jausml.language.exporters.jsidl import JSIDL_EXPORT_RULES
from jausml.language.importers.jsidl.building import JSIDL_RULES
from jausml.language.importers.ros.definitions import ROS_RULES
from jausml.language.metamodel.classes import bridge
from jausml.language.model.library import library_paths, module_of
from jausml.language.semantics.paths.ros_paths import ros_name
from jausml.language.text.notation import TEXT_RULES
from jausml.language.validation.rules import PRODUCT_RULES, catalogue
from jausml.live.messages import Catalogue, MessageEntry, UnknownServiceError
from jausml.proving.results import PROOF_RULES
from jausml.safety_case.comparing import CASE_RULES

TO_ROS, TO_JAUS = "JAUS->ROS", "ROS->JAUS"


@dataclass(frozen=True)
class MapOverview:
    """An attribute map at a glance."""

    name: str
    documentation: str
    message: str
    code: str
    service: str
    type: str
    directions: tuple[str, ...]
    quantities: tuple[tuple[str, float, str], ...]
    joins: tuple[tuple[str, str, float, str], ...]
    report_joins: tuple[tuple[str, str, float, str], ...]
    vectors: int

    @property
    def types(self) -> list[str]:
        """The ROS type and those of joined topics."""
        return [self.type, *(kind for _, kind, _, _ in self.joins)]

    def to_json(self) -> dict[str, Any]:
        """Returns what is known as objects and lists."""
        return {
            "map": self.name,
            "message": self.message,
            "code": self.code,
            "service": self.service,
            "type": self.type,
            "directions": list(self.directions),
            "quantities": [
                {"name": name, "value": value, "units": units}
                for name, value, units in self.quantities
            ],
            "joins": [
                {"name": name, "type": kind, "freshness": freshness, "whenStale": stale}
                for name, kind, freshness, stale in self.joins
            ],
            "reportJoins": [
                {"name": name, "message": message, "freshness": freshness, "whenStale": stale}
                for name, message, freshness, stale in self.report_joins
            ],
            "vectors": self.vectors,
            "documentation": self.documentation,
        }


def overview(attribute_map: bridge.AttributeMap) -> MapOverview:
    """Returns a map at a glance."""
    message = attribute_map.message
    owner = message.eContainer()
    ways = ((TO_ROS, attribute_map.toRos), (TO_JAUS, attribute_map.toJaus))
    return MapOverview(
        name=str(attribute_map.name),
        documentation=str(attribute_map.documentation or ""),
        message=str(message.name),
        code=str(message.code),
        service=str(owner.name) if owner is not None else "",
        type=ros_name(attribute_map.type),
        directions=tuple(way for way, assignments in ways if assignments),
        quantities=tuple(
            (str(each.name), float(each.value), str(each.units or ""))
            for each in attribute_map.quantities
        ),
        joins=tuple(
            (str(each.name), ros_name(each.type), float(each.freshness), str(each.whenStale))
            for each in attribute_map.joins
        ),
        report_joins=tuple(
            (str(each.name), str(each.message.name), float(each.freshness), str(each.whenStale))
            for each in attribute_map.reportJoins
        ),
        vectors=len(attribute_map.vectors),
    )


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

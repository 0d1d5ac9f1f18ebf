"""Services, messages, attribute maps and rules at a glance, as JSON objects."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from jausml.authoring.merging.planning import MERGE_RULES
from jausml.cli.shared.files import ending_at
from jausml.cli.shared.models import beside_library, open_catalogue
from jausml.generation.contract.finding import CODE_RULES
from jausml.language.exporters.jsidl import JSIDL_EXPORT_RULES
from jausml.language.importers.jsidl.building import JSIDL_RULES
from jausml.language.importers.ros.definitions import ROS_RULES
from jausml.language.metamodel.classes import bridge
from jausml.language.model.library import library_paths, module_of
from jausml.language.text.notation import TEXT_RULES
from jausml.language.validation.rules import PRODUCT_RULES, catalogue
from jausml.live.messages import Catalogue, MessageEntry, UnknownServiceError
from jausml.proving.results import PROOF_RULES
from jausml.safety_case.rules import CASE_RULES

TO_ROS, TO_JAUS = "JAUS->ROS", "ROS->JAUS"


def overview(attribute_map: bridge.AttributeMap) -> dict[str, Any]:
    """Returns a map at a glance."""
    from jausml.language.semantics.paths.ros_paths import ros_name

    message = attribute_map.message
    owner = message.eContainer()
    directions = ((TO_ROS, attribute_map.toRos), (TO_JAUS, attribute_map.toJaus))
    return {
        "map": str(attribute_map.name),
        "message": str(message.name),
        "code": str(message.code),
        "service": str(owner.name) if owner is not None else "",
        "type": ros_name(attribute_map.type),
        "directions": [way for way, assignments in directions if assignments],
        "quantities": [
            {
                "name": str(quantity.name),
                "value": float(quantity.value),
                "units": str(quantity.units or ""),
            }
            for quantity in attribute_map.quantities
        ],
        "joins": [
            {"name": str(join.name), "type": ros_name(join.type), **_freshness(join)}
            for join in attribute_map.joins
        ],
        "reportJoins": [
            {
                "name": str(report_join.name),
                "message": str(report_join.message.name),
                **_freshness(report_join),
            }
            for report_join in attribute_map.reportJoins
        ],
        "vectors": len(attribute_map.vectors),
        "documentation": str(attribute_map.documentation or ""),
    }


def _freshness(join: bridge.Join | bridge.ReportJoin) -> dict[str, Any]:
    return {"freshness": float(join.freshness), "whenStale": str(join.whenStale)}


def services(models: Sequence[str]) -> list[dict[str, Any]]:
    """Returns the services of models and of the library."""
    return [
        {
            "service": entry.urn,
            "version": entry.version,
            "name": entry.name,
            "set": entry.set_name,
            "inherits": entry.inherits.label if entry.inherits else None,
            "inputs": list(entry.input_names),
            "outputs": list(entry.output_names),
        }
        for entry in open_catalogue(models).services.values()
    ]


def messages(models: Sequence[str], service: str | None = None) -> list[dict[str, Any]]:
    """Returns the messages of models and of the library."""
    catalogue = open_catalogue(models)
    entries = catalogue.messages if service is None else _messages_of(catalogue, service)
    return [
        {
            "message": entry.name,
            "code": entry.code_text,
            "command": entry.is_command,
            "services": [service.label for service in entry.services],
        }
        for entry in entries
    ]


def _messages_of(catalogue: Catalogue, service: str) -> Sequence[MessageEntry]:
    with ending_at(UnknownServiceError, kind=click.UsageError):
        meant = catalogue.find_services(service)
    every = (
        entry
        for named_service in meant
        for owner in named_service.lineage
        for entry in owner.messages
    )
    return sorted(dict.fromkeys(every), key=lambda entry: (entry.code, entry.name))


def maps(models: Sequence[str], word: str = "") -> list[dict[str, Any]]:
    """Returns the attribute maps of the library and of models, in the order of their files.

    `models`: by default those of the project of the current folder, but those with errors.
    `module`: what imports it in text, e.g. `mappings.range_sensor`; None for a user's file.
    `word`: text that stands in the files of the library that are meant; all when empty.
    """
    ready = [path for path in library_paths("mappings") if word in path.read_text(encoding="utf-8")]
    model = beside_library(ready, models, "maps")
    entries = []
    for attribute_map in model.instances(bridge.AttributeMap):
        place = model.location(attribute_map)
        path = Path(place.path)
        module = module_of(path) if path in ready else None
        entries.append(
            {
                **overview(attribute_map),
                "file": str(place.path),
                "line": place.line,
                "module": module,
            }
        )
    return entries


def rules() -> list[dict[str, Any]]:
    """Returns all rules of the product, ordered by id."""
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

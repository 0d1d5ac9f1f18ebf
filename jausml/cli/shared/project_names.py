"""Names of what a catalogue has, as lists of JSON objects."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from jausml.live.messages import MessageError
from jausml.live.messages.definitions import paths_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.live.messages import Catalogue, ServiceEntry


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
    found: dict[str, dict[str, None]] = {}
    for entry in (each for service in services for each in service.messages):
        try:
            paths = paths_of(entry)
        except MessageError:
            continue  # Whoever uses it is told what is wrong.
        found.setdefault(entry.name, {}).update(dict.fromkeys(paths))
    return [{"message": name, "paths": list(found[name])} for name in sorted(found) if found[name]]

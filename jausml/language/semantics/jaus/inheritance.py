"""Inheritance of JAUS services."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from jausml.language.metamodel.classes import jaus


def lineage(service: jaus.Service | None) -> list[jaus.Service]:
    """Returns a service and those that it inherits, nearest first; a cycle ends the list."""
    services: dict[jaus.Service, None] = {}
    while service is not None and service not in services:
        services[service] = None
        service = service.inherits
    return list(services)


def with_inherited(services: Iterable[jaus.Service]) -> list[jaus.Service]:
    """Returns services and those that they inherit, each once."""
    all_services: dict[jaus.Service, None] = {}
    for start in services:
        service: jaus.Service | None = start
        # What a service that was found inherits was found with it.
        while service is not None and service not in all_services:
            all_services[service] = None
            service = service.inherits
    return list(all_services)


def along_inheritance(services: Iterable[jaus.Service]) -> Iterator[tuple[jaus.Service, bool]]:
    """Yields services with their inherited ones, in one walk down the trees of inheritance.

    Every service is visited once, so that a walk costs no more than there are services, however
    deep they inherit. Services on a cycle, and their heirs, are left out.

    Yields:
        A service and True before its heirs, the service and False after them.
    """
    heirs: dict[jaus.Service, list[jaus.Service]] = {}
    roots = []
    for start in services:
        service = start
        while service not in heirs:
            heirs[service] = []
            parent = service.inherits
            if parent is None:
                roots.append(service)
                break
            service = parent
    for service in heirs:
        if service.inherits is not None:
            heirs[service.inherits].append(service)
    visits = [(root, True) for root in reversed(roots)]
    while visits:
        service, entering = visits.pop()
        yield service, entering
        if entering:
            visits.append((service, False))
            visits += [(heir, True) for heir in reversed(heirs[service])]

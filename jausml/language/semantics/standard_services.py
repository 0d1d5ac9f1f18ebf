"""Core services that a component provides though its model does not name them (AS5710)."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import jaus
from jausml.language.model import library_root, read_models
from jausml.language.semantics.core_services import CORE
from jausml.language.semantics.memory import remembered

if TYPE_CHECKING:
    from collections.abc import Iterable

NEWEST_SET = "core-1.1.xmi"
"""The service set of the library that has the newest core services (AS5710A)."""

STANDARD = ("Discovery", "Liveness", "Management")
"""Services that are added; Events, AccessControl and Transport come along by inheritance."""

_OTHER_NAMES = {f"{CORE}Liveliness": f"{CORE}Liveness"}
"""URNs under which service sets know a core service too."""


@remembered
def with_standard(component: jaus.Component) -> list[jaus.Service]:
    """Returns the services that a component provides itself: named ones, then standard ones.

    A service that the model names, or that a named one inherits, is not added in another version.
    """
    named = list(component.provides)
    if component.external or component.coreServices.name == "none":
        return named
    urns = {_OTHER_NAMES.get(str(each.urn), str(each.urn)) for each in _closure(named)}
    return [*named, *(each for each in standard_services() if str(each.urn) not in urns)]


def is_discovered(component: jaus.Component) -> bool:
    """Tells whether a component answers those who look for others (AS5710, Discovery)."""
    return any(each.urn == f"{CORE}Discovery" for each in _closure(with_standard(component)))


def answers_for_subsystem(component: jaus.Component, system: Iterable[jaus.Component]) -> bool:
    """Tells whether Discovery of a component answers for its subsystem.

    It is component 1 of node 1 by convention, else the one with the lowest address. In a subsystem
    with external components somebody else answers, unless the component is 1.1.
    """
    subsystem, *rest = _numbers(component)
    if not is_discovered(component):
        return False
    if rest == [1, 1]:
        return True
    others = [each for each in system if each.address and _numbers(each)[0] == subsystem]
    if any(each.external for each in others):
        return False
    return all(_numbers(component) <= _numbers(each) for each in others if is_discovered(each))


def _numbers(component: jaus.Component) -> list[int]:
    return [int(part) for part in str(component.address).split(".")]


def _closure(services: Iterable[jaus.Service]) -> set[jaus.Service]:
    found: set[jaus.Service] = set()
    for start in services:
        service: jaus.Service | None = start
        while service is not None and service not in found:
            found.add(service)
            service = service.inherits
    return found


@cache
def standard_services() -> tuple[jaus.Service, ...]:
    """Returns the standard services as the library has them, read at the first call.

    Models that refer to the same file have elements of their own; what counts is the URN.
    """
    model = read_models([library_root() / "jaus" / NEWEST_SET]).model
    by_name = {str(each.name): each for each in model.instances(jaus.Service)}
    return tuple(by_name[name] for name in STANDARD)

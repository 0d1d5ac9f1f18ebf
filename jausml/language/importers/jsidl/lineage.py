"""Lineage of a service: what it may name, its own and what it inherits."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.semantics.jaus.core_services import SERVED_BY_RUNTIME
from jausml.language.semantics.jaus.inherited_machines import CORE_EVENTS

if TYPE_CHECKING:
    from collections.abc import Container, Iterable

    from jausml.language.metamodel.classes import jaus


def lineage(service: jaus.Service | None) -> list[jaus.Service]:
    """Returns a service and those that it inherits, nearest first; a cycle ends the list."""
    found: dict[jaus.Service, None] = {}
    while service is not None and service not in found:
        found[service] = None
        service = service.inherits
    return list(found)


def bases_first(services: Iterable[jaus.Service]) -> list[jaus.Service]:
    """Returns services in an order in which each follows those that it inherits."""
    return sorted(services, key=lambda service: len(lineage(service)))


class KnownNames:
    """The names that the protocol behaviour of a service may use.

    Attributes:
        served: Inherited messages that the runtime takes, with the names of their services.
    """

    def __init__(self, service: jaus.Service, declared: Container[str]) -> None:
        self.inputs: dict[str, jaus.MessageDef] = {}
        self.outputs: dict[str, jaus.MessageDef] = {}
        self.events: set[str] = set(CORE_EVENTS)
        self.served: dict[jaus.MessageDef, str] = {}
        self._declared = declared
        is_core = service.urn in SERVED_BY_RUNTIME
        for each in lineage(service):
            if each.urn in SERVED_BY_RUNTIME and not is_core:
                self.served |= dict.fromkeys(each.inputs, each.name)
            for message in each.inputs:
                self.inputs.setdefault(message.name, message)
            for message in each.outputs:
                self.outputs.setdefault(message.name, message)
            self.events |= {event.name for event in each.events}

    def is_declared(self, name: str) -> bool:
        """Tells whether the files declare a message or event, if only with errors."""
        return name in self._declared

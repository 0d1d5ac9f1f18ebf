"""Names of JSIDL: what is inherited has the names of the references to it before its own."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.semantics.jaus.services import lineage

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.language.metamodel.classes import jaus


def reference_name(service: jaus.Service) -> str:
    """Returns the name under which heirs refer to a service, e.g. `accessControl`."""
    name = str(service.name)
    return name[:1].lower() + name[1:]


def qualified(name: str, service: jaus.Service, is_owner: Callable[[jaus.Service], bool]) -> str:
    """Returns a name as a service writes it: `management.accessControl.Timedout`.

    Args:
        is_owner: Tells the service that declares it; of several the farthest is meant, and without
            one the name is that of the service itself.
    """
    chain = lineage(service)
    owners = [place for place, each in enumerate(chain) if is_owner(each)]
    inherited = chain[1 : owners[-1] + 1] if owners else []
    return ".".join([*map(reference_name, inherited), name])

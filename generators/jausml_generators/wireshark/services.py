"""Services that a dissector knows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.generation.system import system_of
from jausml.language.metamodel.classes import jaus
from jausml.language.model import library_root, read_models
from jausml.language.semantics.jaus.core_services import CORE, NEWEST_SET
from jausml_generators.common.components import services_of, with_inherited

if TYPE_CHECKING:
    from jausml.language.model.model import Model


def used_services(model: Model) -> list[jaus.Service]:
    """Returns the services whose messages the components of a system send or receive.

    The core services come last; every component has some of them from the runtime.

    Args:
        model: A valid model.
    """
    system = system_of(model)
    found = list(dict.fromkeys(services_of((*system.components, *system.bridges), system.bridges)))
    own = [service for service in with_inherited(found) if not _is_core(service)]
    old = [service for service in with_inherited(found) if _is_core(service)]
    return [*own, *library_services(NEWEST_SET), *old]


def library_services(pattern: str = "*.xmi") -> list[jaus.Service]:
    """Returns the services of the shipped library, by file and place in it.

    Args:
        pattern: Which of its JAUS models.
    """
    paths = sorted((library_root() / "jaus").glob(pattern))
    return list(read_models(paths).model.instances(jaus.Service))


def _is_core(service: jaus.Service) -> bool:
    return str(service.urn).startswith(CORE)

"""The services whose messages something outside of the workspace has to know."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.generation.system import system_of
from jausml.language.metamodel.classes import jaus
from jausml.language.project import library
from jausml.language.semantics.jaus.core_services import CORE, NEWEST_SET
from jausml_generators.common.components import services_of, with_inherited

if TYPE_CHECKING:
    from jausml.language.model.model import Model


def used_services(model: Model) -> list[jaus.Service]:
    """Returns the services whose messages the components of a system send or receive.

    The core services come last; every component has some of them from the runtime.
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
    model = library("jaus")
    meant = [each for each in model.documents if each.path.match(pattern)]
    return [each for each in model.instances(jaus.Service) if model.document_of(each) in meant]


def _is_core(service: jaus.Service) -> bool:
    return str(service.urn).startswith(CORE)

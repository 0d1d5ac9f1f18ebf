"""Target `wireshark`: one Lua file that makes Wireshark show JAUS messages."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.generation.system import source_of, system_of
from jausml.generation.target import Target, WholeLibrary
from jausml.generation.tasks import FileTask, Task, templates_beside
from jausml.language.metamodel.classes import jaus
from jausml.language.project.library import library
from jausml.language.semantics.jaus.core_services import CORE, NEWEST_SET
from jausml_generators.common.components import services_of, with_inherited
from jausml_generators.wireshark.views import DissectorView

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.language.model.model import Model


def tasks(model: Model) -> list[Task]:
    """Returns the one file, for the messages that the system can send or receive."""
    return _dissector(model, used_services(model))


def whole_library_tasks(model: Model) -> list[Task]:
    """Returns the one file, for every message of the shipped library and of the system."""
    return _dissector(model, [*used_services(model), *library_services()])


def _dissector(model: Model, services: Sequence[jaus.Service]) -> list[Task]:
    view = DissectorView(system_of(model), source_of(model), services)
    return [FileTask("dissector.lua.j2", [view], lambda view: view.path)]


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


TARGET = Target(
    name="wireshark",
    description="A Wireshark dissector in Lua for the messages of the system.",
    tasks=tasks,
    template_folders=(templates_beside(__file__),),
    is_on_request=True,
    whole_library=WholeLibrary(
        help="every message of the library, not only those of the system",
        tasks=whole_library_tasks,
    ),
)
"""A dissector for JAUS over UDP and TCP (AS5669A) and the bodies of messages (AS5684)."""

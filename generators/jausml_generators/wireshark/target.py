"""Target `wireshark`: one Lua file that makes Wireshark show JAUS messages."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.generation.system import source_of, system_of
from jausml.generation.target import FileTask, Target, Task, WholeLibrary, templates_beside
from jausml_generators.common.services import library_services, used_services
from jausml_generators.wireshark.views import DissectorView

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.language.metamodel.classes import jaus
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

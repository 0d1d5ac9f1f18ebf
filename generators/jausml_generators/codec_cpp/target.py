"""Target `codec_cpp`: headers with the JAUS messages of a system, for programs without Python."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.generation.system import source_of, system_of
from jausml.generation.target import (
    FileTask,
    Target,
    Task,
    TextFile,
    TextTask,
    WholeLibrary,
    templates_beside,
)
from jausml_generators.codec_cpp.views import HeaderView
from jausml_generators.common.services import library_services, used_services
from jausml_generators.cpp.support import JAUS, support

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.language.metamodel.classes import jaus
    from jausml.language.model.model import Model


def tasks(model: Model) -> list[Task]:
    """Returns the files for the messages that the system can send or receive."""
    return _headers(model, used_services(model))


def whole_library_tasks(model: Model) -> list[Task]:
    """Returns the files for every message of the shipped library and of the system."""
    return _headers(model, [*used_services(model), *library_services()])


def _headers(model: Model, services: Sequence[jaus.Service]) -> list[Task]:
    view = HeaderView(system_of(model).name, source_of(model), services)
    copy = TextFile(f"codec_cpp/{JAUS}", support(JAUS), view.element_id, "jausml")
    return [FileTask("messages.hpp.j2", [view], lambda view: view.path), TextTask([copy])]


TARGET = Target(
    name="codec_cpp",
    description="C++ headers with the JAUS messages of the system, for programs without Python.",
    tasks=tasks,
    template_folders=(templates_beside(__file__),),
    is_on_request=True,
    whole_library=WholeLibrary(
        help="every message of the library, not only those of the system",
        tasks=whole_library_tasks,
    ),
)
"""Structs that read and write themselves (AS5684), of fixed capacity where it is bounded."""

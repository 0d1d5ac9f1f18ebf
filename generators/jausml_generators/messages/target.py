"""One package with the classes of all JAUS messages of a system."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.generation.system import source_of, system_of
from jausml.generation.target import FileTask, Target, Task
from jausml_generators.common.runtime import FACE
from jausml_generators.messages.views import SystemMessages
from jausml_generators.python.package import PACKAGE_TEMPLATES, package_tasks, package_view

if TYPE_CHECKING:
    from jausml.language.model.model import Model


def tasks(model: Model) -> list[Task]:
    """Returns the files of the package `<system>_messages`; none without messages."""
    system = system_of(model)
    messages = SystemMessages(system, source_of(model))
    if not messages.modules:
        return []
    package = package_view(
        system,
        messages.name,
        element_id=messages.element_id,
        source=messages.source,
        description=messages.description,
        dependencies=(FACE,),
        test_dependencies=(),
    )
    return [
        *package_tasks([package]),
        FileTask(
            "messages.py.j2",
            messages.modules,
            messages.path,
            imports=lambda module: module.imports,
        ),
    ]


TARGET = Target(
    name="messages",
    description="The JAUS messages of the system, each once, as an ament_python package.",
    tasks=tasks,
    template_folders=(PACKAGE_TEMPLATES,),
)
"""The package `<system>_messages`: a module with dataclasses and codecs for each service."""

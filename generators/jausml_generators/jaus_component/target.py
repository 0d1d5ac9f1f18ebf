"""Target `jaus_component`: one package for each modelled component that is no bridge."""

from __future__ import annotations

from jausml.generation.target import FileTask, Target, Task, system_of, templates_beside
from jausml.language.model.model import Model
from jausml_generators.jaus_component.views import component_views
from jausml_generators.messages.target import SystemMessages
from jausml_generators.python.package import FACE, PACKAGE_TEMPLATES, package_tasks, program_tasks


def tasks(model: Model) -> list[Task]:
    """Returns the files of every component."""
    system, messages = system_of(model), model.derived(SystemMessages)
    views = model.derived(component_views)
    packages = [
        view.package_view(
            system, view.documentation, dependencies=(FACE, *messages.needed_by(view))
        )
        for view in views
    ]
    return [
        *package_tasks(packages),
        FileTask(
            "used_messages.py.j2",
            [messages.used_by(view) for view in views],
            lambda used: used.path,
        ),
        *program_tasks(views, base="component_base.py.j2", skeleton="component.py.j2"),
        FileTask(
            "test_component.py.j2",
            views,
            lambda view: f"{view.package}/test/test_{view.package}.py",
            imports=lambda view: view.test_imports,
        ),
        FileTask(
            "states.md.j2",
            [view for view in views if view.state_machines],
            lambda view: f"{view.package}/states.md",
        ),
    ]


TARGET = Target(
    name="jaus_component",
    description="JAUS components with skeletons, one ament_python package each.",
    tasks=tasks,
    template_folders=(templates_beside(__file__), PACKAGE_TEMPLATES),
)
"""Base, skeleton, entry point and tests of each component."""

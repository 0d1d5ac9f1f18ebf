"""Target `jaus_component`: one package for each modelled component that is no bridge."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.generation.system import source_of, system_of
from jausml.generation.target import Target
from jausml.generation.tasks import FileTask, Task, templates_beside
from jausml.generators.common import runtime
from jausml.generators.jaus_component.views import ComponentView
from jausml.generators.python.codec.messages import MessagesModule
from jausml.generators.python.package import (
    PACKAGE_TEMPLATES,
    module_path,
    package_tasks,
    package_view,
    program_tasks,
)
from jausml.metamodel.classes import bridge

if TYPE_CHECKING:
    from jausml.model.model import Model


def tasks(model: Model) -> list[Task]:
    """Returns the files of every component."""
    system, source = system_of(model), source_of(model)
    plain = [c for c in system.components if not isinstance(c, bridge.Bridge)]
    views = [ComponentView(component, system, source) for component in plain]
    packages = [
        package_view(
            system,
            view.package,
            element_id=view.element_id,
            source=source,
            description=view.documentation,
            element=view.component,
            dependencies=(runtime.FACE,),
            executables=((view.package, f"{view.package}.main"),),
        )
        for view in views
    ]
    by_id = {view.element_id: view for view in views}
    return [
        *package_tasks(packages),
        FileTask(
            "messages.py.j2",
            [_messages(view) for view in views],
            lambda module: module_path(by_id[module.element_id], "messages"),
        ),
        *program_tasks(
            views,
            base="component_base.py.j2",
            skeleton="component.py.j2",
            main="component_main.py.j2",
        ),
        FileTask(
            "test_component.py.j2",
            views,
            lambda view: f"{view.package}/test/test_{view.package}.py",
        ),
        FileTask(
            "states.md.j2",
            [view for view in views if view.state_machines],
            lambda view: f"{view.package}/states.md",
        ),
    ]


def _messages(view: ComponentView) -> MessagesModule:
    return MessagesModule(
        summary=f"The JAUS messages of the component {view.name} and their codecs.",
        runtime=runtime.FACE,
        messages=view.messages,
        source=view.source,
        element_id=view.element_id,
    )


TARGET = Target(
    name="jaus_component",
    description="JAUS components with skeletons, one ament_python package each.",
    tasks=tasks,
    template_folders=(templates_beside(__file__), PACKAGE_TEMPLATES),
)
"""Messages, base, skeleton, entry point and tests of each component."""

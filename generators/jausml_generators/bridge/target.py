"""Target `bridge`: one package for each modelled bridge."""

from __future__ import annotations

from jausml.generation import native
from jausml.generation.target import (
    FileTask,
    Target,
    Task,
    TextFile,
    TextTask,
    system_of,
    templates_beside,
)
from jausml.language.model.model import Model
from jausml_generators.bridge.checks.module import TestModule
from jausml_generators.bridge.views import BridgeView, bridge_views
from jausml_generators.cpp.types import CORE, support
from jausml_generators.messages.target import SystemMessages
from jausml_generators.python.package import (
    PACKAGE_TEMPLATES,
    module_path,
    package_tasks,
    program_tasks,
)


def tasks(model: Model) -> list[Task]:
    """Returns the files of every bridge."""
    system, messages = system_of(model), model.derived(SystemMessages)
    bridges = model.derived(bridge_views)
    tests = [TestModule(bridge) for bridge in bridges]
    with_core = [bridge for bridge in bridges if bridge.has_core]
    packages = [
        bridge.package_view(
            system,
            bridge.documentation,
            dependencies=(*bridge.dependencies, *messages.needed_by(bridge)),
            test_dependencies=test.dependencies,
            core=native.SOURCE.as_posix() if bridge.has_core else "",
        )
        for bridge, test in zip(bridges, tests, strict=True)
    ]
    return [
        *package_tasks(packages),
        FileTask(
            "used_messages.py.j2",
            [messages.used_by(bridge) for bridge in bridges],
            lambda used: used.path,
        ),
        FileTask(
            "ros_types.py.j2",
            bridges,
            lambda bridge: module_path(bridge, "ros_types"),
            imports=lambda bridge: bridge.light.imports,
        ),
        *program_tasks(
            bridges, base="base.py.j2", skeleton="skeleton.py.j2", words=lambda view: view.words
        ),
        FileTask("core.cpp.j2", with_core, _source),
        TextTask(
            [
                TextFile(
                    f"{bridge.package}/core/{name}", support(name), bridge.element_id, "jausml"
                )
                for bridge in with_core
                for name in CORE
            ]
        ),
        FileTask(
            "test_translations.py.j2",
            tests,
            lambda view: f"{view.bridge.package}/test/test_{view.bridge.package}_translations.py",
            imports=lambda view: view.imports,
            words=lambda view: view.bridge.words,
        ),
    ]


def _source(bridge: BridgeView) -> str:
    return f"{bridge.package}/{native.SOURCE.as_posix()}"


TARGET = Target(
    name="bridge",
    description="ROS 2 <-> JAUS bridges with skeletons, one ament_python package each.",
    tasks=tasks,
    template_folders=(templates_beside(__file__), PACKAGE_TEMPLATES),
)
"""Base, skeleton, entry point and tests of each bridge."""

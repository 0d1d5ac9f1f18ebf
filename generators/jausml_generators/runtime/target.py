"""Target `runtime`: copies the runtime, so that a robot needs nothing but ROS 2 and Python."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import jausml
from jausml.generation.target import Target, Task, TextFile, TextTask, system_of
from jausml_generators.python.package import PACKAGE_TEMPLATES, package_tasks, package_view

if TYPE_CHECKING:
    from jausml.language.model.model import Model

NAME = "jausml_runtime"
DEPENDENCIES = (
    *("action_msgs", "diagnostic_msgs", "rcl_interfaces"),
    *("rclpy", "rosgraph_msgs", "rosidl_parser"),
)


def tasks(model: Model) -> list[Task]:
    """Returns the package files and a copy of each module of the runtime."""
    package = package_view(
        system_of(model),
        NAME,
        version=jausml.__version__,
        license="Apache-2.0",
        maintainer="jausml",
        maintainer_email="jausml@example.com",
        element_id="runtime",
        source="jausml",
        description="JAUS over UDP, the core services, and what bridges run on.",
        dependencies=DEPENDENCIES,
        test_dependencies=(),
        has_own_init=True,
    )
    return [*package_tasks([package]), TextTask(_modules(), is_copied=True)]


def _modules() -> list[TextFile]:
    folder = Path(jausml.__file__).parent / "runtime"
    names = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*.py"))
    return [
        TextFile(
            path=f"{NAME}/{NAME}/{name}",
            content=(folder / name).read_text(encoding="utf-8"),
            element_id=f"runtime:{name}",
            source=f"jausml/runtime/{name}",
        )
        for name in names
    ]


TARGET = Target(
    name="runtime",
    description="The runtime as the package jausml_runtime.",
    tasks=tasks,
    template_folders=(PACKAGE_TEMPLATES,),
    is_shared=True,
)
"""The package `jausml_runtime`: JUDP, the core services and the bridge's engine."""

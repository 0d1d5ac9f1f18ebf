"""Copies the runtime, so that a robot needs nothing but ROS 2 and Python."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import jausml
from jausml.generation.engine import ArtifactTask, TextFile, TextTask
from jausml.generators.common.package import PACKAGE_TEMPLATES, PackageView, package_tasks
from jausml.generators.common.system import system_of
from jausml.model.model import Model

NAME = "jausml_runtime"
DEPENDENCIES = ("diagnostic_msgs", "rcl_interfaces", "rclpy")


class RuntimeTarget:
    """The package `jausml_runtime`: JUDP, the core services and the bridge's engine."""

    name = "runtime"
    description = "The runtime as the package jausml_runtime."
    template_folders = (PACKAGE_TEMPLATES,)

    def tasks(self, model: Model) -> Sequence[ArtifactTask[Any]]:
        """Returns the package files and a copy of each module of the runtime."""
        system = system_of(model)
        package = PackageView(
            name=NAME,
            element_id="runtime",
            source="jausml",
            description="JAUS over UDP, the core services, and what bridges run on.",
            version=jausml.__version__,
            maintainer=system.maintainer,
            maintainer_email=system.maintainerEmail,
            license="Apache-2.0",
            dependencies=DEPENDENCIES,
            test_dependencies=(),
        )
        return [*_without_init(package), TextTask(_modules())]


def _without_init(package: PackageView) -> list[ArtifactTask[Any]]:
    # The runtime brings its own __init__.py.
    return [task for task in package_tasks([package]) if getattr(task, "template_name", "") != "init.py.j2"]


def _modules() -> list[TextFile]:
    folder = Path(jausml.__file__).parent / "runtime"
    files = sorted(path.relative_to(folder) for path in folder.rglob("*.py"))
    return [
        TextFile(
            path=f"{NAME}/{NAME}/{path.as_posix()}",
            content=(folder / path).read_text(encoding="utf-8"),
            element_id=f"runtime:{path.as_posix()}",
            source=f"jausml/runtime/{path.as_posix()}",
        )
        for path in files
    ]


TARGET = RuntimeTarget()

"""Target `runtime`: copies the runtime, so that a robot needs nothing but ROS 2 and Python."""

from __future__ import annotations

import sys
from collections.abc import Iterable

import jausml
from jausml.generation.target import Target, Task, TextFile, TextTask, WholeLibrary
from jausml.language.model.model import Model
from jausml_generators.python.package import FACE, PACKAGE_TEMPLATES, PackageView, package_tasks
from jausml_generators.runtime.modules import copied, needed, runtime_modules


def tasks_for(code: Iterable[tuple[str, str]]) -> list[Task]:
    """Returns the package files, and a copy of each module that code needs; of all without any."""
    known = runtime_modules()
    reasons = needed(code) or dict.fromkeys(known, "any code")
    modules = [known[name] for name in sorted(reasons)]
    foreign = {package for module in modules for package in module.foreign}
    package = PackageView(
        name=FACE,
        element_id="runtime",
        source="jausml",
        description="JAUS over UDP, the core services, and what bridges run on.",
        version=jausml.__version__,
        maintainer="jausml",
        maintainer_email="jausml@example.com",
        license="Apache-2.0",
        dependencies=tuple(sorted(foreign - sys.stdlib_module_names)),
        test_dependencies=(),
        has_own_init=True,
    )
    files = [
        TextFile(
            path=f"{FACE}/{FACE}/{module.path}",
            content=copied(module, reasons),
            element_id=f"runtime:{module.path} for {reasons[module.name]}",
            source=f"jausml/runtime/{module.path}",
        )
        for module in modules
    ]
    return [*package_tasks([package]), TextTask(files, is_copied=True)]


def _whole(_: Model) -> list[Task]:
    return tasks_for(())


TARGET = Target(
    name="runtime",
    description="The runtime as the package jausml_runtime, as far as the workspace uses it.",
    tasks=lambda _: [],
    template_folders=(PACKAGE_TEMPLATES,),
    is_shared=True,
    for_code=tasks_for,
    whole_library=WholeLibrary(help="all of the runtime", tasks=_whole),
)
"""The package `jausml_runtime`: JUDP, the core services and the bridge's engine."""

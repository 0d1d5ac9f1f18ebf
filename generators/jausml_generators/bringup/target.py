"""Target `bringup`: launch files, parameters, SROS 2 policies and processes of a system."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from jausml.generation.target import FileTask, Target, Task, source_of, system_of, templates_beside
from jausml.language.model.model import Model
from jausml_generators.bridge.views import bridge_views
from jausml_generators.bringup.processes import ProcessView
from jausml_generators.bringup.views import LAUNCH_IMPORTS, BringupView
from jausml_generators.python.package import PACKAGE_TEMPLATES, package_tasks, package_view


def tasks(model: Model) -> list[Task]:
    """Returns the files of the package `<system>_bringup`."""
    system, bringup = system_of(model), bringup_view(model)
    package = package_view(
        system,
        bringup.name,
        element_id=bringup.element_id,
        source=bringup.source,
        description=f"Starts the system {system.name}.",
        dependencies=bringup.dependencies,
        test_dependencies=(),
        data=(
            ("launch", "launch/*.launch.py"),
            ("config", "config/*.yaml"),
            *([("security", "security/*.policy.xml")] if bringup.policies else []),
        ),
        python=False,
    )
    return [
        *package_tasks([package]),
        FileTask(
            "system.launch.py.j2",
            bringup.launches,
            lambda launch: f"{bringup.name}/launch/{launch.name}.launch.py",
            imports=lambda _: LAUNCH_IMPORTS,
        ),
        FileTask(
            "config.yaml.j2",
            bringup.configs,
            lambda config: f"{bringup.name}/config/{config.process.name}.yaml",
        ),
        FileTask(
            "policy.xml.j2",
            bringup.policies,
            lambda policy: f"{bringup.name}/security/{policy.name}.policy.xml",
        ),
    ]


def processes(model: Model) -> list[Mapping[str, Any]]:
    """Returns the processes that `jausml run` starts, as the manifest records them."""
    bringup = bringup_view(model)
    return [_entry(bringup, process) for process in bringup.processes]


def bringup_view(model: Model) -> BringupView:
    """Returns the view of the bring-up package of a valid model."""
    return BringupView(system_of(model), source_of(model), model.derived(bridge_views))


def _entry(bringup: BringupView, process: ProcessView) -> Mapping[str, Any]:
    entry: dict[str, Any] = {
        "name": process.name,
        "kind": process.kind,
        "package": process.package,
        "module": process.module,
        "arguments": [],
    }
    if process.needs_file:
        entry["parameters"] = f"{bringup.name}/config/{process.name}.yaml"
    if process.speaks_ros:
        entry["domain"] = bringup.system.rosDomain
    return entry


TARGET = Target(
    name="bringup",
    description="Launch files, parameters and SROS 2 policies of the system.",
    tasks=tasks,
    template_folders=(templates_beside(__file__), PACKAGE_TEMPLATES),
    processes=processes,
)
"""The package `<system>_bringup`."""

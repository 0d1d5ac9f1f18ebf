"""Target `ros_node`: one package for each modelled ROS 2 node."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.generation.system import source_of, system_of
from jausml.generation.target import FileTask, Target, Task, templates_beside
from jausml_generators.python.package import (
    PACKAGE_TEMPLATES,
    package_tasks,
    package_view,
    program_tasks,
)
from jausml_generators.ros_node.views import NodeView

if TYPE_CHECKING:
    from jausml.language.model.model import Model


def tasks(model: Model) -> list[Task]:
    """Returns the files of every node."""
    system, source = system_of(model), source_of(model)
    nodes = [NodeView(node, system.name, source) for node in system.nodes]
    packages = [
        package_view(
            system,
            node.package,
            element_id=node.element_id,
            source=source,
            description=node.description,
            element=node.node,
            dependencies=node.dependencies,
            executables=((node.package, f"{node.package}.main"),),
        )
        for node in nodes
    ]
    return [
        *package_tasks(packages),
        *program_tasks(nodes, base="base.py.j2", skeleton="skeleton.py.j2"),
        FileTask(
            "test_node.py.j2",
            nodes,
            lambda node: f"{node.package}/test/test_{node.package}.py",
            imports=lambda node: node.test_imports,
        ),
    ]


TARGET = Target(
    name="ros_node",
    description="ROS 2 nodes with skeletons, one ament_python package each.",
    tasks=tasks,
    template_folders=(templates_beside(__file__), PACKAGE_TEMPLATES),
)
"""Base, skeleton, entry point and tests of each node."""

"""Interface packages, which colcon builds like any other."""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from jausml.generation.engine import ArtifactTask, FileTask, templates_beside
from jausml.generators.common.system import source_of, system_of
from jausml.generators.python.names import package_name
from jausml.generators.ros_interfaces.jaus_types import MessagesPackage
from jausml.generators.ros_interfaces.ros_types import package_files
from jausml.generators.ros_interfaces.selection import (
    all_messages,
    declared_packages,
    unmapped_messages,
)
from jausml.generators.ros_interfaces.views import InterfacesView
from jausml.metamodel.classes import ros
from jausml.metamodel.filling import new_object

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.model.model import Model


class DeclaredInterfacesTarget:
    """The interface packages that a model declares in its own file.

    Those of files that it refers to are elsewhere: they were imported from what is installed.
    """

    name = "declared_interfaces"
    description = "The packages of ROS interfaces that the model declares."
    template_folders = (templates_beside(__file__),)
    needs_system = False

    def tasks(self, model: Model) -> Sequence[ArtifactTask[Any]]:
        """Returns the files of the packages; none for a package without interfaces.

        Args:
            model: A valid model.
        """
        system, source = _system(model)
        packages = []
        for package in declared_packages(model):
            description = str(package.documentation or f"Interfaces of {system.name}.")
            files = list(package_files(package, source))
            packages.append(InterfacesView(system, str(package.name), description, files, source))
        return _tasks(packages)


class RosInterfacesTarget:
    """JAUS messages as ROS messages, in one interface package.

    It is `<system>_jaus_msgs`, without a system `<model file>_jaus_msgs`, and has the messages that
    no attribute map turns into a ROS type.

    Args:
        every_message: Whether it has all messages of the model's services, mapped ones too.
    """

    name = "ros_interfaces"
    description = "A package of ROS messages for the JAUS messages without a map."
    template_folders = (templates_beside(__file__),)
    is_on_request = True
    needs_system = False

    def __init__(self, *, every_message: bool = False) -> None:
        self._every_message = every_message

    def for_whole_library(self) -> RosInterfacesTarget:
        """Returns the target for every message of the model's services (`--all`)."""
        return RosInterfacesTarget(every_message=True)

    def tasks(self, model: Model) -> Sequence[ArtifactTask[Any]]:
        """Returns the files of the package; none without such messages.

        Args:
            model: A valid model.
        """
        system, source = _system(model)
        taken = {str(package.name) for package in model.instances(ros.InterfacePackage)}
        name = package_name(f"{system.name}_jaus_msgs")
        while name in taken:
            name += "_2"
        messages = MessagesPackage(name, source)
        for message in (all_messages if self._every_message else unmapped_messages)(model):
            messages.add(message)
        description = f"JAUS messages of {system.name} as ROS messages."
        return _tasks([InterfacesView(system, name, description, messages.files, source)])


def _tasks(packages: Sequence[InterfacesView]) -> list[ArtifactTask[Any]]:
    packages = [package for package in packages if package.files]
    files = [file for package in packages for file in package.files]
    return [
        FileTask("package.xml.j2", packages, lambda view: f"{view.name}/package.xml"),
        FileTask("CMakeLists.txt.j2", packages, lambda view: f"{view.name}/CMakeLists.txt"),
        FileTask("definition.j2", files, lambda file: file.path),
    ]


def _system(model: Model) -> tuple[Any, str]:
    """Returns the system and the name of its file; without one, a system named after the file."""
    if any(root.eClass.name == "System" for root in model.documents[0].roots):
        return system_of(model), source_of(model)
    path = PurePath(model.documents[0].display)
    system = new_object(model.metamodels.classes["system.System"])
    system.name = path.stem
    return system, path.name


TARGET = RosInterfacesTarget()
DECLARED = DeclaredInterfacesTarget()

"""Interface packages, which colcon builds like any other."""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from jausml.generation.engine import ArtifactTask, FileTask, templates_beside
from jausml.generators.common.names import package_name
from jausml.generators.common.system import source_of, system_of
from jausml.generators.ros_interfaces.jaus_types import MessagesPackage
from jausml.generators.ros_interfaces.ros_types import package_files
from jausml.generators.ros_interfaces.selection import all_messages, unmapped_messages
from jausml.generators.ros_interfaces.views import InterfacesView
from jausml.metamodel.filling import new_object

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.model.model import Model


class RosInterfacesTarget:
    """The interface packages that a model declares, and one of JAUS messages as ROS messages.

    The latter is `<system>_jaus_msgs`, without a system `<model file>_jaus_msgs`. It has the
    messages that no attribute map turns into a ROS type.

    Args:
        every_message: Whether it has all messages of the model's services, mapped ones too.
    """

    name = "ros_interfaces"
    description = "Packages of ROS interfaces: declared ones, and JAUS messages without a map."
    template_folders = (templates_beside(__file__),)
    is_on_request = True
    needs_system = False

    def __init__(self, *, every_message: bool = False) -> None:
        self._every_message = every_message

    def for_whole_library(self) -> RosInterfacesTarget:
        """Returns the target for every message of the model's services (`--all`)."""
        return RosInterfacesTarget(every_message=True)

    def tasks(self, model: Model) -> Sequence[ArtifactTask[Any]]:
        """Returns the files of the packages; none for a package without interfaces.

        Args:
            model: A valid model.
        """
        packages = [view for view in self._packages(model) if view.files]
        files = [file for package in packages for file in package.files]
        return [
            FileTask("package.xml.j2", packages, lambda view: f"{view.name}/package.xml"),
            FileTask("CMakeLists.txt.j2", packages, lambda view: f"{view.name}/CMakeLists.txt"),
            FileTask("definition.j2", files, lambda file: file.path),
        ]

    def _packages(self, model: Model) -> list[InterfacesView]:
        system, source = _system(model)
        declared = model.instances("ros.InterfacePackage", library=False)
        views = [
            InterfacesView(
                system,
                str(package.name),
                str(package.documentation or f"Interfaces of {system.name}."),
                list(package_files(package, source)),
                source,
            )
            for package in declared
        ]
        name = package_name(f"{system.name}_jaus_msgs")
        while any(view.name == name for view in views):
            name += "_2"
        messages = MessagesPackage(name, source)
        for message in (all_messages if self._every_message else unmapped_messages)(model):
            messages.add(message)
        description = f"JAUS messages of {system.name} as ROS messages."
        return [*views, InterfacesView(system, name, description, messages.files, source)]


def _system(model: Model) -> tuple[Any, str]:
    """Returns the system and the name of its file; without one, a system named after the file."""
    if model.instances("system.System"):
        return system_of(model), source_of(model)
    path = PurePath(model.documents[0].display)
    system = new_object(model.metamodels.classes["system.System"])
    system.name = path.stem
    return system, path.name


TARGET = RosInterfacesTarget()

"""Target `ros_interfaces`: interface packages, which colcon builds like any other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import PurePath

from jausml.generation.target import (
    FileTask,
    Target,
    Task,
    WholeLibrary,
    source_of,
    system_of,
    templates_beside,
)
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.metamodel.classes import system as system_language
from jausml.language.metamodel.classes.system import System
from jausml.language.metamodel.filling import new_object
from jausml.language.model.model import Model
from jausml.language.semantics.jaus.core_services import CORE
from jausml_generators.common.components import services_of, with_inherited
from jausml_generators.python.names import package_name
from jausml_generators.ros_interfaces.definitions import DefinitionFile, package_files
from jausml_generators.ros_interfaces.jaus_types import MessagesPackage


def declared_tasks(model: Model) -> list[Task]:
    """Returns the files of the declared packages; none for a package without interfaces."""
    system, source = _system(model), source_of(model)
    packages = []
    for package in declared_packages(model):
        description = str(package.documentation or f"Interfaces of {system.name}.")
        files = list(package_files(package, source))
        packages.append(InterfacesView(system, str(package.name), description, files, source))
    return _tasks(packages)


def tasks(model: Model) -> list[Task]:
    """Returns the files of the package of messages that no map turns into a ROS type."""
    return _messages_tasks(model, unmapped_messages(model))


def whole_library_tasks(model: Model) -> list[Task]:
    """Returns the files of the package of all messages of the model's services."""
    own = model.instances(jaus.Service, library=False)
    services = [*own, *with_inherited(_used_services(model))]
    return _messages_tasks(model, _messages(services))


def _messages_tasks(model: Model, chosen: Iterable[jaus.MessageDef]) -> list[Task]:
    system, source = _system(model), source_of(model)
    taken = {str(package.name) for package in model.instances(ros.InterfacePackage)}
    name = package_name(f"{system.name}_jaus_msgs")
    while name in taken:
        name += "_2"
    messages = MessagesPackage(name, source)
    for message in chosen:
        messages.add(message)
    description = f"JAUS messages of {system.name} as ROS messages."
    return _tasks([InterfacesView(system, name, description, messages.files, source)])


def _tasks(packages: Sequence[InterfacesView]) -> list[Task]:
    packages = [package for package in packages if package.files]
    files = [file for package in packages for file in package.files]
    return [
        FileTask("package.xml.j2", packages, lambda view: f"{view.name}/package.xml"),
        FileTask("CMakeLists.txt.j2", packages, lambda view: f"{view.name}/CMakeLists.txt"),
        FileTask("definition.j2", files, lambda file: file.path),
    ]


def _system(model: Model) -> system_language.System:
    """Returns the system; without one, a system named after the file."""
    document = model.documents[0]
    if any(isinstance(root, system_language.System) for root in document.roots):
        return system_of(model)
    system: system_language.System = new_object(model.metamodels.classes["system.System"])
    system.name = PurePath(document.display).stem
    return system


TARGET = Target(
    name="ros_interfaces",
    description="A package of ROS messages for the JAUS messages without a map.",
    tasks=tasks,
    template_folders=(templates_beside(__file__),),
    is_on_request=True,
    needs_system=False,
    whole_library=WholeLibrary(
        help="every message of the services that the system uses", tasks=whole_library_tasks
    ),
)
"""JAUS messages as ROS messages, in the package `<system or model file>_jaus_msgs`."""

DECLARED = Target(
    name="declared_interfaces",
    description="The packages of ROS interfaces that the model declares.",
    tasks=declared_tasks,
    template_folders=(templates_beside(__file__),),
    needs_system=False,
)
"""The interface packages that a model declares in its own file.

Those of files that it refers to are elsewhere: they were imported from what is installed.
"""


class InterfacesView:
    """An ament_cmake package of interfaces."""

    def __init__(
        self,
        system: System,
        name: str,
        description: str,
        files: Sequence[DefinitionFile],
        source: str,
    ) -> None:
        self.name = name
        self.description = description
        self.files = sorted(files, key=lambda file: file.place)
        self.source = source
        self.element_id = f"interfaces:{name}"
        self.version = system.version
        self.maintainer = system.maintainer
        self.maintainer_email = system.maintainerEmail
        self.license = system.license

    @property
    def dependencies(self) -> list[str]:
        """The packages whose types its definitions use, sorted."""
        package_names = {name for file in self.files for name in file.packages}
        if any(file.kind == "action" for file in self.files):
            package_names.add("action_msgs")
        return sorted(package_names)


def declared_packages(model: Model) -> list[ros.InterfacePackage]:
    """Returns the interface packages that stand in the files that the user named."""
    packages = model.instances(ros.InterfacePackage, library=False)
    documents = [(package, model.document_of(package)) for package in packages]
    return [package for package, place in documents if place is not None and place.is_input]


def unmapped_messages(model: Model) -> list[jaus.MessageDef]:
    """Returns messages that no attribute map of the model is about.

    They are those of services that the model declares, and of the library's services that a
    component, a bridge or a connection uses, core services apart: the runtime speaks
    these.
    """
    mapped = {attribute_map.message for attribute_map in model.instances(bridge.AttributeMap)}
    own = model.instances(jaus.Service, library=False)
    used = [service for service in _used_services(model) if not str(service.urn).startswith(CORE)]
    return [message for message in _messages([*own, *used]) if message not in mapped]


def _messages(services: Iterable[jaus.Service]) -> list[jaus.MessageDef]:
    """Returns the messages of services, each once; of one name and code the first."""
    messages: dict[tuple[str, str], jaus.MessageDef] = {}
    for service in dict.fromkeys(services):
        for message in (*service.inputs, *service.outputs):
            messages.setdefault((str(message.name), str(message.code)), message)
    return list(messages.values())


def _used_services(model: Model) -> Iterator[jaus.Service]:
    return services_of(model.instances(jaus.Component), model.instances(bridge.Bridge))

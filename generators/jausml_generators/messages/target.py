"""One package with the classes of all JAUS messages of a system."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from operator import itemgetter

from jausml.generation.literals import clean
from jausml.generation.python import Origin, statements
from jausml.generation.target import FileTask, Target, Task, source_of, system_of
from jausml.language.metamodel.classes import jaus
from jausml.language.model.model import Model
from jausml_generators.bridge.views import BridgeView, bridge_views
from jausml_generators.jaus_component.views import ComponentView, component_views
from jausml_generators.python.codec.message_builder import build_message_map
from jausml_generators.python.codec.messages import MessagesModule, MessageView
from jausml_generators.python.names import Scope, package_name, snake_case
from jausml_generators.python.package import FACE, PACKAGE_TEMPLATES, package_tasks, package_view


@dataclass(frozen=True)
class UsedMessages:
    """The module `messages` of a package: class names from the package of messages."""

    user: BridgeView | ComponentView
    names: Mapping[str, Origin]

    @property
    def exports(self) -> tuple[str, ...]:
        """Names of the classes."""
        return tuple(sorted(self.names))

    @property
    def element_id(self) -> str:
        """Identity of the model element."""
        return self.user.element_id

    @property
    def source(self) -> str:
        """Model file."""
        return self.user.source

    @property
    def path(self) -> str:
        """Where the module stands."""
        return f"{self.user.package}/{self.user.package}/messages.py"

    @property
    def import_lines(self) -> tuple[str, ...]:
        """Import statements of the module."""
        return tuple(statements(self.names))


class SystemMessages:
    """The package of the messages of a system.

    A message that several services define in the same way is one class.
    """

    def __init__(self, model: Model) -> None:
        self.system = system_of(model)
        self.source = source_of(model)
        self.name = package_name(f"{self.system.name}_messages")
        self.element_id = f"messages:{self.system.name}"
        self.users: tuple[BridgeView | ComponentView, ...] = (
            *model.derived(component_views),
            *model.derived(bridge_views),
        )
        self._views = build_message_map(
            element for user in self.users for element in user.message_map
        )
        self._owners = _owners(self._views)
        self._modules = _modules(self._owners.values())

    @property
    def description(self) -> str:
        """The purpose of the package."""
        return f"The JAUS messages of the system {clean(self.system.name)}."

    @property
    def modules(self) -> tuple[MessagesModule, ...]:
        """The modules of the package, one for each service that has messages."""
        return tuple(
            MessagesModule(
                summary=f"Messages of the service {clean(service.name)} and their codecs.",
                runtime=FACE,
                messages=tuple(view for view, owner in self._owners.items() if owner is service),
                source=self.source,
                element_id=f"{self.element_id}/{module}",
            )
            for service, module in sorted(self._modules.items(), key=itemgetter(1))
        )

    def path(self, module: MessagesModule) -> str:
        """Returns where a module of the package stands."""
        return f"{self.name}/{self.name}/{module.element_id.partition('/')[2]}.py"

    def used_by(self, user: BridgeView | ComponentView) -> UsedMessages:
        """Returns the messages of a component or bridge."""
        names: dict[str, Origin] = {}
        for element, view in user.message_map.items():
            shared = self._views[element]
            module = self._modules[self._owners[shared]]
            names[view.class_name] = Origin(f"{self.name}.{module}", shared.class_name)
        return UsedMessages(user, names)

    def needed_by(self, user: BridgeView | ComponentView) -> tuple[str, ...]:
        """Returns the packages that the messages of a component or bridge are in."""
        return (self.name,) if user.message_map else ()


def _owners(
    views: Mapping[jaus.MessageDef, MessageView],
) -> dict[MessageView, jaus.Service]:
    """Returns the service in whose module each class stands: the first that defines the message."""
    owners: dict[MessageView, jaus.Service] = {}
    for element, view in views.items():
        service = element.eContainer()
        if service is not None:
            owners.setdefault(view, service)
    return owners


def _modules(services: Iterable[jaus.Service]) -> dict[jaus.Service, str]:
    """Returns the module of each service; of equal names, the first by URN and version keeps it."""
    scope = Scope()
    ordered = sorted(
        dict.fromkeys(services), key=lambda service: (str(service.urn), str(service.version))
    )
    return {service: scope.claim(snake_case(service.name)) for service in ordered}


def tasks(model: Model) -> list[Task]:
    """Returns the files of the package `<system>_messages`; none without messages."""
    messages = model.derived(SystemMessages)
    if not messages.modules:
        return []
    package = package_view(
        messages.system,
        messages.name,
        element_id=messages.element_id,
        source=messages.source,
        description=messages.description,
        dependencies=(FACE,),
        test_dependencies=(),
    )
    return [
        *package_tasks([package]),
        FileTask(
            "messages.py.j2",
            messages.modules,
            messages.path,
            imports=lambda module: module.imports,
            words=lambda module: frozenset(view.class_name for view in module.messages),
        ),
    ]


TARGET = Target(
    name="messages",
    description="The JAUS messages of the system, each once, as an ament_python package.",
    tasks=tasks,
    template_folders=(PACKAGE_TEMPLATES,),
)
"""The package `<system>_messages`: a module with dataclasses and codecs for each service."""

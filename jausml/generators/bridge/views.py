"""View of a bridge package, for its templates."""

from __future__ import annotations

import functools
from contextlib import suppress
from dataclasses import dataclass
from textwrap import indent
from typing import TYPE_CHECKING

from jausml.generation.artifact import MethodContract, SkeletonContract
from jausml.generation.literals import LINE_WIDTH, python_literal, python_string
from jausml.generators.bridge.base_module import VALUE_TYPES, BaseModule, names_of, stub
from jausml.generators.bridge.connections import ConnectionView, argument, query_of
from jausml.generators.bridge.ros_classes import RosClasses
from jausml.generators.bridge.translation import AssignmentError, Surroundings, used_maps
from jausml.generators.bridge.translation.ros_fields import PathError
from jausml.generators.common import runtime
from jausml.generators.common.components import (
    SUBSYSTEM_TYPES,
    address_call,
    service_identities,
    transport_names,
    transport_settings,
)
from jausml.generators.common.ros import import_lines
from jausml.generators.python.codec.message_builder import build_message, build_message_map
from jausml.generators.python.layout import Call, statement
from jausml.generators.python.names import Scope, class_name, names_in, package_name, snake_case
from jausml.metamodel.classes import bridge, jaus
from jausml.semantics.paths import source_paths

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from jausml.generators.python.codec.messages import MessageView
    from jausml.metamodel.classes.bridge import Bridge
    from jausml.metamodel.classes.system import System

_ARGUMENT = 16


# Attributes that the base class has anyway.
_TAKEN_ATTRIBUTES = names_in(
    """
    accept close component connections loop now on_not_ready open publisher rate_parameter report
    ros settings silence_parameter subscribe
    """
)
# Classes of the runtime that generated modules import.
_TAKEN_CLASSES = names_in(
    """
    AbsentFieldError Bridge BridgeSettings ComponentSettings ConversionError EventToTopics Guard
    JausAddress MessageToTopics Priority Qos QueryToTopics ServiceIdentity Topic TopicsToMessage
    TopicsToReport TransportKind TransportSettings
    """
)


@dataclass(frozen=True)
class BridgeView:
    """A modelled bridge.

    Args:
        bridge: The bridge.
        system: The system that owns it.
        source: Model file.
    """

    bridge: Bridge
    system: System
    source: str

    @property
    def element_id(self) -> str:
        """Identity of the model element."""
        return f"bridge:{self.bridge.name}"

    @property
    def name(self) -> str:
        """Name of the bridge, of its node and of its JAUS identification."""
        return str(self.bridge.name)

    @property
    def title(self) -> str:
        """What texts call it, e.g. `bridge turtle`; one that is named `bridge` just that."""
        return "bridge" if self.name.lower() == "bridge" else f"bridge {self.name}"

    @property
    def package(self) -> str:
        """Package, module of the skeleton and executable."""
        return package_name(self.name)

    @property
    def class_name(self) -> str:
        """Class of the user's skeleton."""
        return class_name("".join(word.capitalize() for word in self.package.split("_")))

    @property
    def base_name(self) -> str:
        """Class that is generated anew each time."""
        return f"{self.class_name}Base"

    @property
    def documentation(self) -> str:
        """What the model says that the bridge is for."""
        return self.bridge.documentation or f"The {self.title} of the system {self.system.name}."

    @functools.cached_property
    def connections(self) -> tuple[ConnectionView, ...]:
        """The connections in model order, under names that are unique in Python."""
        scope = self._around.attributes
        return tuple(
            ConnectionView(
                connection,
                scope.claim(snake_case(connection.name)),
                self.ros_classes.name_of(connection.map.type),
                self.message_of,
                self._around,
                self._requested(connection.map.message),
            )
            for connection in self.bridge.bridgeConnections
        )

    @functools.cached_property
    def message_map(self) -> dict[jaus.MessageDef, MessageView]:
        """The JAUS messages that the bridge takes, makes and asks for."""
        return build_message_map(
            element
            for connection in self.bridge.bridgeConnections
            for element in (*_messages_of(connection), query_of(connection))
            if element is not None
        )

    @functools.cached_property
    def messages(self) -> tuple[MessageView, ...]:
        """The classes of these messages."""
        return tuple(dict.fromkeys(self.message_map.values()))

    @functools.cached_property
    def ros_classes(self) -> RosClasses:
        """Names of the ROS message classes in the generated modules."""
        taken = {view.class_name for view in self.messages} | _TAKEN_CLASSES
        return RosClasses(taken | {self.class_name, self.base_name})

    @functools.cached_property
    def _around(self) -> Surroundings:
        """What the translations use of the class and the module; complete once all are written."""
        overrides = {str(each.name): each for each in self.bridge.quantities}
        return Surroundings(
            self.message_of, self.ros_classes.name_of, overrides, Scope(_TAKEN_ATTRIBUTES)
        )

    @functools.cached_property
    def around(self) -> Surroundings:
        """What the translations use of the class and the module."""
        for connection in self.connections:
            connection.body  # noqa: B018 - writing a translation collects what it uses
        return self._around

    def message_of(self, element: jaus.MessageDef) -> MessageView:
        """Returns the class of a JAUS message of the bridge."""
        return next(
            view
            for view in self.messages
            if view.jaus_name == element.name and view == build_message(element, view.class_name)
        )

    @property
    def settings(self) -> tuple[tuple[str, str | Call], ...]:
        """Arguments of BridgeSettings, as names and expressions."""
        bridge = self.bridge
        component = Call(
            "ComponentSettings",
            (
                f"default_authority={bridge.defaultAuthority}",
                f"control_timeout={bridge.controlTimeout}",
                f"event_timeout={bridge.eventTimeout}",
            ),
        )
        return (
            ("name", python_string(self.name)),
            ("address", address_call(bridge)),
            ("description", python_string(" ".join(self.documentation.split()))),
            ("namespace", python_string(bridge.namespace or "")),
            ("frequency", python_literal(float(bridge.frequency))),
            ("component_type", str(SUBSYSTEM_TYPES[bridge.type.name])),
            ("authority", str(bridge.authority)),
            ("component", component),
            ("transport", transport_settings(self.system, bridge)),
        )

    @functools.cached_property
    def services(self) -> tuple[Call, ...]:
        """The services that the bridge provides, inherited ones before those that inherit."""
        return service_identities(self.bridge.provides)

    @property
    def settings_lines(self) -> tuple[str, ...]:
        """Arguments of BridgeSettings, laid out."""
        lines = [argument(key, value, _ARGUMENT) for key, value in self.settings]
        if self.services:
            lone = f"services=({self.services[0]},)"
            inner = [indent(f"{statement(each, '', 21)},", "    ") for each in self.services]
            is_short = len(self.services) == 1 and len(lone) + 1 + _ARGUMENT <= LINE_WIDTH
            lines.append(lone if is_short else "\n".join(["services=(", *inner, ")"]))
        return tuple(lines)

    # ------------------------------------------------------------------ imports

    @property
    def base_import_lines(self) -> tuple[str, ...]:
        """Import lines of the base: ROS and the runtime, then the messages."""
        classes = ["JausAddress", "Bridge", "BridgeSettings", "ComponentSettings", "Topic"]
        if self.services:
            classes.append("ServiceIdentity")
        names = {(runtime.FACE, name) for name in classes}
        names |= transport_names(self.system, self.bridge)
        for view in self.connections:
            names |= view.runtime_names
        return self.module.import_lines(names)

    @functools.cached_property
    def module(self) -> BaseModule:
        """What stands in the module of the base besides the connections."""
        return BaseModule(self.around, self.connections, self.ros_classes)

    @property
    def dependencies(self) -> tuple[str, ...]:
        """ROS packages that the package needs at run time, sorted."""
        # A translation that cannot be written is reported by the template that it stands in.
        with suppress(AssignmentError, PathError):
            self.around  # noqa: B018 - writing the translations names the types inside messages
        used = {kind.package for kind in self.ros_classes.names}
        return tuple(sorted(used | {"diagnostic_msgs", runtime.FACE, "rcl_interfaces", "rclpy"}))

    def contract(self) -> SkeletonContract:
        """Returns what the base expects of the user's class."""
        translations = tuple(
            MethodContract(
                f"translate_{view.name}",
                ("source", *(join.name for join in view.joins)),
                "",  # nothing stays when a connection is renamed
                _stub(view),
                optional=True,
            )
            for view in self.connections
        )
        hook = MethodContract("on_not_ready", (), "hook:on_not_ready", "", optional=True)
        conversions = tuple(
            MethodContract(each.name, names_of(each), f"conversion:{each.model_name}", stub(each))
            for each in self.module.methods
        )
        return SkeletonContract(
            self.class_name, self.base_name, (*translations, hook, *conversions)
        )

    @property
    def skeleton_standard_lines(self) -> tuple[str, ...]:
        """Import statements of the standard library that the skeleton needs."""
        names = ["TYPE_CHECKING"] if self.skeleton_typing_lines else []
        names += ["Any"] if "Any" in self.module.method_words else []
        return import_lines(("typing", name) for name in names)

    @property
    def skeleton_typing_lines(self) -> tuple[str, ...]:
        """Import statements of the skeleton that type checkers alone need."""
        names = VALUE_TYPES & self.module.method_words
        return import_lines(((runtime.CONVERSIONS, name) for name in names), 4)

    def _requested(self, message: jaus.MessageDef) -> frozenset[str]:
        """Fields of a report that some connection of the bridge reads."""
        return frozenset(
            path.split(".")[0].partition("[")[0]
            for connection in self.bridge.bridgeConnections
            if connection.direction.name == "jausToRos" and connection.map.message is message
            for path in _read_paths(connection.map.toRos)
        )


def _read_paths(assignments: Iterable[bridge.Assignment]) -> Iterator[str]:
    """Yields the source paths that start at the message, those in lists included."""
    for assignment in assignments:
        yield from source_paths(assignment)
        nested = assignment.assignments if isinstance(assignment, bridge.ListAssignment) else ()
        for inner in _read_paths(nested):
            if inner.startswith("/"):
                yield inner[1:]


def _messages_of(connection: bridge.Connection) -> Iterator[jaus.MessageDef]:
    """Yields the message of a connection and those inside it that have maps of their own."""
    to_ros = connection.direction.name == "jausToRos"
    for attribute_map in used_maps(connection.map, to_ros=to_ros):
        yield attribute_map.message


def _stub(view: ConnectionView) -> str:
    parameters = "".join(f", {join.name}: {join.type_name} | None = None" for join in view.joins)
    arguments = "".join(f", {join.name}" for join in view.joins)
    return (
        f"    def translate_{view.name}(self, source: {view.source_name}{parameters})"
        f" -> {view.target_name} | None:\n"
        f"        return super().translate_{view.name}(source{arguments})\n"
    )

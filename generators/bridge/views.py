"""What the templates of a bridge package may ask."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from textwrap import indent
from typing import TYPE_CHECKING, Any

from jausml.generation.artifact import MethodContract, SkeletonContract
from jausml.generation.literals import python_literal, python_string
from jausml.generators.bridge.connections import ConnectionView, argument, query_of
from jausml.generators.bridge.examples import Example, example_of
from jausml.generators.common.components import (
    SUBSYSTEM_TYPES,
    address_call,
    service_identities,
    transport_names,
    transport_settings,
)
from jausml.generators.common.layout import Call, statement
from jausml.generators.common.message_builder import build_message, build_messages
from jausml.generators.common.names import Scope, class_name, package_name, snake_case
from jausml.generators.common.ros import RosType, import_lines, ros_type

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.generators.common.messages import MessageView

_ARGUMENT = 16


def _names(text: str) -> frozenset[str]:
    return frozenset(text.split())


# Attributes that the base class has anyway.
_TAKEN_ATTRIBUTES = _names(
    """
    accept close component connections loop now on_not_ready open publisher rate_parameter report
    ros settings silence_parameter subscribe
    """
)
# Classes of the runtime that generated modules import.
_TAKEN_CLASSES = _names(
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
        bridge: The `bridge.Bridge`.
        system: The `system.System` that owns it.
        source: Model file.
    """

    bridge: Any
    system: Any
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
        return self.bridge.documentation or f"Bridge {self.name} of the system {self.system.name}."

    @functools.cached_property
    def connections(self) -> tuple[ConnectionView, ...]:
        """The connections in model order, under names that are unique in Python."""
        scope = Scope(_TAKEN_ATTRIBUTES)
        return tuple(
            ConnectionView(
                connection,
                scope.claim(snake_case(connection.name)),
                self.ros_names[ros_type(connection.map.type)],
                self.message_of,
                self._requested(connection.map.message),
            )
            for connection in self.bridge.bridgeConnections
        )

    @functools.cached_property
    def messages(self) -> tuple[MessageView, ...]:
        """The classes of the JAUS messages that the bridge takes, makes and asks for."""
        return build_messages(
            element
            for connection in self.bridge.bridgeConnections
            for element in (connection.map.message, query_of(connection))
            if element is not None
        )

    @functools.cached_property
    def ros_names(self) -> dict[RosType, str]:
        """Names of the ROS message classes in the generated modules.

        A class that shares its name with another, as messages that mirror JAUS do, is imported
        under a name with its package.
        """
        taken = {view.class_name for view in self.messages} | _TAKEN_CLASSES
        taken |= {self.class_name, self.base_name}
        found: dict[RosType, str] = {}
        for connection in self.bridge.bridgeConnections:
            kind = ros_type(connection.map.type)
            if kind not in found:
                package = "".join(word.capitalize() for word in kind.package.split("_"))
                found[kind] = f"{package}{kind.name}" if kind.name in taken else kind.name
                taken.add(found[kind])
        return found

    def message_of(self, element: Any) -> MessageView:
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
            inner = [indent(f"{statement(each, '', 21)},", "    ") for each in self.services]
            lines.append("\n".join(["services=(", *inner, ")"]))
        return tuple(lines)

    # ------------------------------------------------------------------ imports

    @property
    def base_import_lines(self) -> tuple[str, ...]:
        """Import lines of the base: ROS and the runtime, then the messages."""
        runtime = {
            ("jausml_runtime.address", "JausAddress"),
            ("jausml_runtime.bridge", "Bridge"),
            ("jausml_runtime.bridge", "BridgeSettings"),
            ("jausml_runtime.component", "ComponentSettings"),
            ("jausml_runtime.topics", "Topic"),
        }
        if self.services:
            runtime.add(("jausml_runtime.component", "ServiceIdentity"))
        runtime |= transport_names(self.system, self.bridge)
        for view in self.connections:
            runtime |= view.runtime_names
        own = import_lines((".messages", name) for name in self.message_names)
        return (*import_lines(runtime | self._ros_names(self.ros_names.values())), "", *own)

    @functools.cached_property
    def examples(self) -> tuple[Example, ...]:
        """One example for each translation that has one, for the generated tests."""
        return tuple(filter(None, map(example_of, self.connections)))

    @property
    def test_import_lines(self) -> tuple[str, ...]:
        """Import lines of the generated tests."""
        package = self.package
        shown = [example.connection for example in self.examples]
        third = self._ros_names(view.ros_name for view in shown)
        if any(example.refuses_absent for example in self.examples):
            third.add(("jausml_runtime.bridge_statistics", "AbsentFieldError"))
        own = {(f"{package}.{package}", self.class_name)}
        own |= {(f"{package}.messages", view.message_name) for view in shown}
        return ("import pytest", *import_lines(third), "", *import_lines(own))

    @property
    def message_names(self) -> tuple[str, ...]:
        """JAUS message classes that the base imports."""
        return tuple(sorted({name for view in self.connections for name in view.message_names}))

    @property
    def dependencies(self) -> tuple[str, ...]:
        """ROS packages that the package needs at run time, sorted."""
        used = {view.ros_type.package for view in self.connections}
        return tuple(
            sorted(used | {"diagnostic_msgs", "jausml_runtime", "rcl_interfaces", "rclpy"})
        )

    def contract(self) -> SkeletonContract:
        """Returns what the base expects of the user's class."""
        methods = tuple(
            MethodContract(
                f"translate_{view.name}",
                ("source",),
                "",  # nothing stays when a connection is renamed
                _stub(view),
                optional=True,
            )
            for view in self.connections
        )
        hook = MethodContract("on_not_ready", (), "hook:on_not_ready", "", optional=True)
        return SkeletonContract(self.class_name, self.base_name, (*methods, hook))

    def _ros_names(self, used: Iterable[str]) -> set[tuple[str, str]]:
        wanted = set(used)
        return {
            (kind.module, kind.name if name == kind.name else f"{kind.name} as {name}")
            for kind, name in self.ros_names.items()
            if name in wanted
        }

    def _requested(self, message: Any) -> frozenset[str]:
        """Fields of a report that some connection of the bridge reads."""
        return frozenset(
            path.strip().split(".")[0]
            for connection in self.bridge.bridgeConnections
            if connection.direction.name == "jausToRos" and connection.map.message is message
            for assignment in connection.map.toRos
            if assignment.eClass.name == "FieldAssignment"
            for path in assignment.source.split(",")
        )


def _stub(view: ConnectionView) -> str:
    return (
        f"    def translate_{view.name}(self, source: {view.source_name})"
        f" -> {view.target_name} | None:\n"
        f"        return super().translate_{view.name}(source)\n"
    )

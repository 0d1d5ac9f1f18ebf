"""View of a bridge package, for its templates."""

from __future__ import annotations

import functools
from collections.abc import Collection, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass

from jausml.generation.artifact import MethodContract, SkeletonContract
from jausml.generation.literals import python_literal, python_string
from jausml.generation.python import Imports, offered
from jausml.generation.target import source_of, system_of
from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.metamodel.classes.bridge import Bridge, Connection
from jausml.language.metamodel.classes.system import System
from jausml.language.model.model import Model
from jausml.language.semantics.connections import calls, stops
from jausml.language.semantics.connections.calls import told_command
from jausml.language.semantics.connections.reports import requested_fields
from jausml.language.semantics.directions import is_to_ros
from jausml.language.semantics.jaus.core_services import with_standard
from jausml.language.semantics.paths.scopes import used_maps
from jausml.language.semantics.ros_types import package_of
from jausml_generators.bridge.connections import ConnectionView
from jausml_generators.bridge.ends import messages_of_joins, query_of
from jausml_generators.bridge.light_module import LightModule
from jausml_generators.bridge.services_and_actions import (
    ActionView,
    CallView,
    answers_of_driver,
    carried,
    messages_of_driver,
)
from jausml_generators.bridge.translation.places import PathError
from jausml_generators.bridge.translation.surroundings import BaseModule, names_of, stub
from jausml_generators.bridge.translation.translating import Translations, translate
from jausml_generators.bridge.translation.values import AssignmentError
from jausml_generators.common.components import (
    SUBSYSTEM_TYPES,
    address_call,
    clients,
    component_settings,
    optional_services,
    own_bridges,
    service_identities,
    transport_settings,
    with_inherited,
)
from jausml_generators.cpp.core import Core
from jausml_generators.python.codec.message_builder import build_message_map
from jausml_generators.python.codec.messages import MessageView
from jausml_generators.python.package import FACE, EntryPoint, ProgramView, laid_out, runtime_names
from jausml_generators.python.statements import long_string

_HANDOFF_CONTROLLER = "urn:jaus:jss:iop:HandoffController"
_HOOKS: dict[str, tuple[str, ...]] = {"on_not_ready": (), "on_control_lost": ()}
_HANDOFF_HOOKS = {"on_handoff_requested": ("target", "requests")}


@dataclass(frozen=True)
class BridgeView(ProgramView):
    """A modelled bridge."""

    KIND = "bridge"

    bridge: Bridge
    system: System
    source: str

    @property
    def element(self) -> Bridge:
        """The model element."""
        return self.bridge

    @property
    def title(self) -> str:
        """The name in texts, e.g. `bridge turtle`; one that is named `bridge` just that."""
        return "bridge" if self.name.lower() == "bridge" else f"bridge {self.name}"

    @property
    def superclass(self) -> str:
        """Class of the runtime that the base derives from."""
        return "HandoffBridge" if self._hears_of_handoffs else "Bridge"

    @property
    def _hears_of_handoffs(self) -> bool:
        """Whether it gets requests for control of its peers."""
        provided = with_inherited(with_standard(self.bridge))
        return _HANDOFF_CONTROLLER in (str(service.urn) for service in provided)

    @property
    def documentation(self) -> str:
        """The documentation of the bridge."""
        return self.bridge.documentation or f"The {self.title} of the system {self.system.name}."

    @functools.cached_property
    def translations(self) -> Translations:
        """The translations of the connections."""
        taken = {*self.imported, *runtime_names(), "Any", self.class_name, self.base_name}
        return translate(self.bridge, self._carried, self.message_of, taken, self.light)

    @property
    def core(self) -> Core:
        """The compiled form of the translations."""
        return self.translations.core

    @property
    def has_core(self) -> bool:
        """Whether any translation has a compiled form."""
        with suppress(AssignmentError, PathError):
            return bool(self.core.functions)
        return False

    @functools.cached_property
    def light(self) -> LightModule:
        """The light classes of the ROS types of the connections."""
        return LightModule(
            [*_ros_types_of(self._carried), *_types_of_calls(self.bridge.serviceConnections)]
        )

    @functools.cached_property
    def connections(self) -> tuple[ConnectionView, ...]:
        """The connections in model order, under names that are unique in Python."""
        requested = requested_fields(self.bridge)
        translated = self.translations.connections
        count = len(self.bridge.bridgeConnections)
        own = zip(self.bridge.bridgeConnections, translated[:count], strict=True)
        lists = zip(
            self._carried[count:], translated[count:], self.bridge.actionConnections, strict=True
        )
        return (
            *(
                ConnectionView(connection, translation, self.message_of, requested)
                for connection, translation in own
            ),
            *(
                ActionView(connection, translation, self.message_of, action=action)
                for connection, translation, action in lists
            ),
        )

    @property
    def actions(self) -> tuple[ActionView, ...]:
        """The connections with ROS actions."""
        return tuple(
            connection for connection in self.connections if isinstance(connection, ActionView)
        )

    @functools.cached_property
    def _carried(self) -> tuple[Connection, ...]:
        return tuple(carried(self.bridge))

    @functools.cached_property
    def calls(self) -> tuple[CallView, ...]:
        """The service connections in model order."""
        pairs = zip(self.bridge.serviceConnections, self.translations.calls, strict=True)
        return tuple(CallView(connection, call, self.message_of) for connection, call in pairs)

    @functools.cached_property
    def translated(self) -> tuple[ConnectionView, ...]:
        """All connections and halves of calls: those that have a translation."""
        halves = (half for call in self.calls for half in call.halves.values())
        return (*self.connections, *halves)

    @functools.cached_property
    def words(self) -> frozenset[str]:
        """The names of the connections in Python and of the classes of messages."""
        names = (view.name for view in self.connections)
        return frozenset((*names, *(view.class_name for view in self.messages)))

    @functools.cached_property
    def message_map(self) -> dict[jaus.MessageDef, MessageView]:
        """The JAUS messages that the bridge takes, makes and asks for."""
        drivers = map(messages_of_driver, self.bridge.actionConnections)
        elements = (
            element
            for connection in self._carried
            for element in (
                *_messages_of(connection),
                query_of(connection),
                *messages_of_joins(connection),
            )
        )
        of_calls = (
            element
            for connection in self.bridge.serviceConnections
            for element in _messages_of_calls(connection)
        )
        of_drivers = (message for driver in drivers for message in driver.all)
        answered = (
            message
            for action in self.bridge.actionConnections
            for answer in answers_of_driver(action)
            for message in (answer.query, answer.report)
        )
        command_messages = (
            message
            for connection in self.bridge.bridgeConnections
            if (answer := told_command(connection)) is not None
            for message in (answer.query, answer.report)
        )
        messages = (*elements, *of_calls, *of_drivers, *answered, *command_messages)
        return build_message_map(message for message in messages if message is not None)

    @functools.cached_property
    def messages(self) -> tuple[MessageView, ...]:
        """The classes of these messages."""
        return tuple(dict.fromkeys(self.message_map.values()))

    def message_of(self, element: jaus.MessageDef) -> MessageView:
        """Returns the class of a JAUS message of the bridge."""
        return self.message_map[element]

    @property
    def imported(self) -> Collection[str]:
        """Names of messages: of the runtime, its skeleton and its tests import no class."""
        return {view.class_name for view in self.messages}

    @property
    def settings(self) -> tuple[tuple[str, str], ...]:
        """Arguments of BridgeSettings, as names and expressions."""
        bridge = self.bridge
        services = tuple(("services", f"({', '.join(self.services)},)") for _ in self.services[:1])
        return (
            ("name", python_string(self.name)),
            ("address", address_call(bridge)),
            ("description", long_string(" ".join(self.documentation.split()))),
            ("namespace", python_string(bridge.namespace or "")),
            ("frequency", python_literal(float(bridge.frequency))),
            ("component_type", str(SUBSYSTEM_TYPES[bridge.type.name])),
            ("authority", str(bridge.authority)),
            ("component", component_settings(self.system, bridge)),
            ("transport", transport_settings(self.system, bridge)),
            *((("guardian", "Guardian"),) if bridge.guardian and stops.has_stops(bridge) else ()),
            *services,
        )

    @property
    def optional_services(self) -> tuple[str, ...]:
        """Classes of the core services that it provides and not every component has."""
        return optional_services(self.bridge)

    @property
    def clients(self) -> tuple[str, ...]:
        """Classes of clients of others that it has from the start."""
        return clients(self.system, self.bridge)

    @functools.cached_property
    def services(self) -> tuple[str, ...]:
        """The services that the bridge provides, inherited ones before those that inherit."""
        return service_identities(self.bridge)

    # ------------------------------------------------------------------ the modules

    @property
    def base_imports(self) -> Imports:
        """The names that the base may import."""
        return Imports(
            {
                **runtime_names(),
                **self.light.origins(self.translations.ros_classes, ".ros_types"),
                **offered(".messages", *(view.class_name for view in self.messages)),
                **offered("typing", "Any"),
            }
        )

    @property
    def skeleton_imports(self) -> Imports:
        """The names that the skeleton may import."""
        return self.base_imports.and_also(offered(f".{self.package}_base", self.base_name))

    @functools.cached_property
    def module(self) -> BaseModule:
        """The parts of the module of the base besides the connections."""
        return BaseModule(self.translations.uses)

    @property
    def dependencies(self) -> tuple[str, ...]:
        """Packages that the package needs at run time, by their names for rosdep, sorted."""
        packages = {"diagnostic_msgs", FACE, "rcl_interfaces", "rclpy"}
        # A translation that cannot be written is reported by the template that it stands in.
        with suppress(AssignmentError, PathError):
            packages |= {kind.package for kind in self.translations.ros_classes.names}
            packages |= {
                package_of(connection.type) for connection in self.bridge.actionConnections
            }
        return tuple(sorted(packages))

    @property
    def entry_point(self) -> EntryPoint:
        """How its process runs."""
        return EntryPoint(
            title=self.title,
            runner="run_bridge",
            arguments=f"{self.class_name}(), arguments",
            end="SIGINT, SIGTERM or a JAUS Shutdown",
        )

    def contract(self) -> SkeletonContract:
        """Returns the methods that the base expects of the user's class."""
        translations = tuple(
            MethodContract(
                f"translate_{view.name}",
                ("source", *(join.name for join in view.joins)),
                "",  # nothing stays when a connection is renamed
                _stub(view),
                optional=True,
            )
            for view in self.translated
        )
        of_goals = tuple(
            MethodContract(action.hook, action.hook_parameters, "", action.hook_stub, optional=True)
            for action in self.actions
        )
        of_handoffs = _HANDOFF_HOOKS if self._hears_of_handoffs else {}
        hooks = tuple(
            MethodContract(name, parameters, f"hook:{name}", "", optional=True)
            for name, parameters in (_HOOKS | of_handoffs).items()
        )
        conversions = tuple(
            MethodContract(
                method.name, names_of(method), f"conversion:{method.model_name}", stub(method)
            )
            for method in self.module.methods
        )
        return SkeletonContract(
            self.class_name, self.base_name, (*translations, *of_goals, *hooks, *conversions)
        )


def bridge_views(model: Model) -> tuple[BridgeView, ...]:
    """Returns the bridges of the system that is generated; `model.derived` shares them."""
    system, source = system_of(model), source_of(model)
    return tuple(BridgeView(own_bridge, system, source) for own_bridge in own_bridges(system))


def _messages_of(connection: bridge.Connection) -> Iterator[jaus.MessageDef]:
    """Yields the message of a connection, and messages inside it with maps of their own."""
    to_ros = is_to_ros(connection)
    for attribute_map in used_maps(connection.map, to_ros=to_ros):
        yield attribute_map.message


def _messages_of_calls(connection: bridge.RosServiceConnection) -> Iterator[jaus.MessageDef]:
    """Yields the messages of a service connection and those inside them."""
    yield from calls.messages(connection)
    for half in calls.halves(connection):
        for attribute_map in used_maps(half.map, to_ros=half.to_ros):
            yield attribute_map.message


def _ros_types_of(connections: Iterable[bridge.Connection]) -> Iterator[ros.MessageType]:
    """Yields the ROS types that connections take and make, joined and nested ones too."""
    for connection in connections:
        to_ros = is_to_ros(connection)
        for attribute_map in used_maps(connection.map, to_ros=to_ros):
            yield attribute_map.type
            yield from (join.type for join in attribute_map.joins)


def _types_of_calls(
    connections: Iterable[bridge.RosServiceConnection],
) -> Iterator[ros.MessageType]:
    """Yields the types of requests and responses, and nested ones too."""
    for connection in connections:
        yield from calls.types(connection)
        for half in calls.halves(connection):
            yield from (map_.type for map_ in used_maps(half.map, to_ros=half.to_ros))


def _stub(view: ConnectionView) -> str:
    name, parameters = f"translate_{view.name}", ", ".join(view.parameters)
    arguments = ", ".join(["source", *(join.name for join in view.joins)])
    return laid_out(
        f"    def {name}({parameters}) -> {view.target_name} | None:\n"
        f"        return super().{name}({arguments})\n"
    )

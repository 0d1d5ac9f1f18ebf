"""View of a component package, for its templates."""

from __future__ import annotations

import functools
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

from jausml.generation.artifact import MethodContract, SkeletonContract
from jausml.generation.literals import clean, docstring, python_string, sentence
from jausml.generation.python import Imports, Origin, offered
from jausml.generation.target import source_of, system_of
from jausml.language.metamodel.classes import jaus
from jausml.language.metamodel.classes.system import System
from jausml.language.model.model import Model
from jausml.language.semantics.jaus.commands import guard_of
from jausml.language.semantics.jaus.core_services import SERVED_BY_RUNTIME, is_core_message
from jausml.language.semantics.jaus.services import provided_services
from jausml_generators.common import components
from jausml_generators.jaus_component import machines
from jausml_generators.jaus_component.handlers import (
    GUARD_TEXTS,
    Answer,
    Handler,
    Method,
    Peer,
    Peers,
    Received,
    documented,
    simulated,
)
from jausml_generators.jaus_component.machine_views import EventView, MachineView
from jausml_generators.python import names
from jausml_generators.python.codec.examples import examples, numbers
from jausml_generators.python.codec.message_builder import build_message_map
from jausml_generators.python.codec.messages import MessageView
from jausml_generators.python.package import MESSAGES, EntryPoint, ProgramView, runtime_names
from jausml_generators.python.statements import condition, long_string, may_set_limits

# Hooks of every component, with their parameters; the base does nothing in them.
_HOOKS = {
    "on_initialize": (),
    "on_ready": (),
    "on_not_ready": (),
    "on_control_lost": (),
    "on_controller_changed": ("controller",),
    "on_handoff_requested": ("target", "requests"),
    "on_emergency": ("active",),
    "on_set_time": ("time",),
    "on_list_changed": (),
    "on_shutdown": (),
    "host_time": (),
    "supports_element": ("element",),
}
# Methods of the component itself that a message of an unlucky name must not replace.
_TAKEN = (
    frozenset([*_HOOKS, "on_message", "on_payload", "report_changed"]) | machines.COMPONENT_NAMES
)


@dataclass(frozen=True)
class ComponentView(ProgramView):
    """A modelled component."""

    KIND = "component"

    component: jaus.Component
    system: System
    source: str

    @property
    def element(self) -> jaus.Component:
        """The model element."""
        return self.component

    @property
    def name(self) -> str:
        """Name of the component in the model, clean."""
        return clean(self.component.name)

    @property
    def documentation(self) -> str:
        """The documentation of the component."""
        known = clean(self.component.documentation)
        return sentence(known or f"component {self.name} of the system {clean(self.system.name)}")

    def docstring(self, column: int) -> str:
        """Returns the docstring of a module or class of the component."""
        return docstring(self.documentation, column)

    # -- messages --------------------------------------------------------------------------------

    @functools.cached_property
    def _services(self) -> tuple[jaus.Service, ...]:
        """Provided services whose messages the component itself handles, bases first."""
        provided = components.with_inherited(self.component.provides)
        return tuple(service for service in provided if service.urn not in SERVED_BY_RUNTIME)

    @functools.cached_property
    def _provided(self) -> tuple[jaus.Service, ...]:
        """All services that the component provides, which decide whom it obeys."""
        return tuple(provided_services(self.component))

    @functools.cached_property
    def _messages(self) -> dict[jaus.MessageDef, MessageView]:
        """Every message of the component by model element."""
        used = components.with_inherited(self.component.uses)
        services = [
            *self._services,
            *(service for service in used if service.urn not in SERVED_BY_RUNTIME),
        ]
        elements = [
            message for service in services for message in [*service.inputs, *service.outputs]
        ]
        elements += machines.messages_of(self._services)
        for connection in self.component.connections:
            elements += [connection.message, self._query_of(connection)]
        return build_message_map(dict.fromkeys(elements))

    @property
    def message_map(self) -> dict[jaus.MessageDef, MessageView]:
        """The messages that are not in the runtime, as those of core services are."""
        return {
            element: view
            for element, view in self._messages.items()
            if not is_core_message(element)
        }

    @property
    def messages(self) -> tuple[MessageView, ...]:
        """The classes of these messages."""
        return tuple(dict.fromkeys(self.message_map.values()))

    @property
    def examples(self) -> tuple[str, ...]:
        """Class name and bytes of an example of each message of the package, as tuples.

        Those that nobody could read in a test are left out.
        """
        return examples(self.messages)

    @property
    def numbers(self) -> tuple[str, ...]:
        """Class names and what the scaled fields of their examples hold, as tuples."""
        return numbers(self.messages)

    def _query_of(self, connection: jaus.ServiceConnection) -> jaus.MessageDef:
        if connection.query is not None:
            return connection.query
        return components.query_for(connection.message, (), f"connection '{connection.name}'")

    # -- methods ---------------------------------------------------------------------------------

    @functools.cached_property
    def _methods(self) -> names.Scope:
        return names.Scope(_TAKEN)

    @functools.cached_property
    def parts(self) -> tuple[tuple[Handler, ...], tuple[Answer, ...], tuple[Received, ...]]:
        """Handlers, answers and received reports, under method names that are unique."""
        handlers: dict[int, Handler] = {}
        answers: dict[int, Answer] = {}
        for service in self._services:
            for message in service.inputs:
                view = self._messages[message]
                report = components.report_for(message, components.with_inherited([service]))
                if view.code in handlers or view.code in answers or self._machines.takes(view.code):
                    continue
                if report is None:
                    handlers[view.code] = self._handler(message, service)
                else:
                    answers[view.code] = self._answer(message, report)
        received = tuple(self._received(connection) for connection in self.component.connections)
        if self.component.simulated:
            return *simulated(handlers.values(), answers.values()), received
        return tuple(handlers.values()), tuple(answers.values()), received

    @functools.cached_property
    def _machines(self) -> machines.Machines:
        return machines.Machines(self._services, self._messages, self._methods)

    @property
    def state_machines(self) -> tuple[MachineView, ...]:
        """The state machines."""
        return self._machines.views

    @property
    def condition_methods(self) -> Mapping[str, str]:
        """Names of the methods of conditions of its machines, by their names in guards."""
        return self._machines.condition_methods

    @property
    def events(self) -> tuple[EventView, ...]:
        """Internal events that the component may raise."""
        return self._machines.events if self.state_machines else ()

    @property
    def machine_registrations(self) -> tuple[str, ...]:
        """Statements of the constructor that give messages to the machines."""
        registrations: dict[int, str] = {}
        for service in self._services:
            for message in service.inputs:
                code = self._messages[message].code
                if self._machines.takes(code):
                    registrations[code] = self._machines.registration(
                        message, service, self._provided
                    )
        return tuple(registrations.values())

    @property
    def is_simulated(self) -> bool:
        """Whether methods of the base keep commanded values, and report them."""
        return any(method.simulation for method in self.methods)

    @property
    def superclasses(self) -> tuple[str, ...]:
        """Classes of the runtime that the base derives from: what the component does, no more.

        Whoever uses a service of others asks for its reports, and edits its list or controls its
        provider where the service inherits that.
        """
        subscribed = {received.is_found for received in self.received if not received.is_asked}
        queried = {received.is_found for received in self.received if received.is_asked}
        used = {
            str(service.urn).rpartition(":")[2]
            for service in components.with_inherited(self.component.uses)
        }
        wanted = {
            "PeerSubscriber": True in subscribed,
            "EventSubscriber": True not in subscribed and (False in subscribed or used),
            "PeerQuerier": True in queried,
            "Querier": True not in queried and (False in queried or used),
            "PeerController": "AccessControl" in used or self.component.controls,
            "Commander": "AccessControl" in used,
            "ListEditor": "ListManager" in used,
            "ListHolder": "ListManagerService" in self.optional_services,
        }
        own = "ModelledComponent" if self.state_machines else "Component"
        return (*(name for name, is_wanted in wanted.items() if is_wanted), own)

    @property
    def optional_services(self) -> tuple[str, ...]:
        """Classes of the core services that it provides besides those of its superclass."""
        classes = components.optional_services(self.component)
        known = "MachineStatesService" if self.state_machines else ""
        return tuple(name for name in classes if name != known)

    @property
    def clients(self) -> tuple[str, ...]:
        """Classes of clients of others that it has from the start."""
        return components.clients(self.system, self.component)

    @property
    def handlers(self) -> tuple[Handler, ...]:
        """Input messages that are no queries."""
        return self.parts[0]

    @property
    def answers(self) -> tuple[Answer, ...]:
        """Queries and their reports."""
        return self.parts[1]

    @property
    def received(self) -> tuple[Received, ...]:
        """Reports of other components."""
        return self.parts[2]

    @property
    def methods(self) -> tuple[Method, ...]:
        """The methods of the skeleton."""
        return tuple(self._all_methods())

    def _all_methods(self) -> Iterator[Method]:
        yield from (handler.method for handler in self.handlers)
        yield from (answer.method for answer in self.answers)
        yield from self._machines.methods
        for received in self.received:
            yield received.method
            if received.silent:
                yield received.silent

    def _handler(self, message: jaus.MessageDef, service: jaus.Service) -> Handler:
        view, guard = self._messages[message], guard_of(message, service, self._provided)
        whom = GUARD_TEXTS[guard]
        if guard == "READY" and may_set_limits(message):
            whom += "; limits in Standby too"
        method = Method(
            self._methods.claim(f"on_{names.snake_case(view.class_name)}"),
            (("message", view.class_name), ("sender", "JausAddress")),
            "Completion | None",
            documented(message, f"take {clean(message.name)} {whom}"),
            view.code_text,
        )
        return Handler(view, method, condition(message, guard))

    def _answer(self, query: jaus.MessageDef, report: jaus.MessageDef) -> Answer:
        asked, report_view = self._messages[query], self._messages[report]
        stem = names.snake_case(report_view.class_name).removeprefix("report_")
        method = Method(
            self._methods.claim(f"report_{stem}"),
            (("query", asked.class_name), ("sender", "JausAddress")),
            f"{report_view.class_name} | None",
            documented(report, f"return {clean(report.name)}, or None while there is none"),
            asked.code_text,
        )
        return Answer(asked, report_view, method)

    def _received(self, connection: jaus.ServiceConnection) -> Received:
        view = self._messages[connection.message]
        identity = f"connection:{connection.name}"
        name = f"on_{names.snake_case(str(connection.name))}"
        provider, peer_name = self._peers.provider_of(connection)
        method = Method(
            self._methods.claim(name),
            (("report", view.class_name), ("provider", "JausAddress")),
            "None",
            documented(connection, f"take {clean(view.jaus_name)} of {peer_name}"),
            identity,
        )
        silent = None
        if connection.silenceTimeout > 0 and connection.exchange.name != "oneTime":
            silent = Method(
                self._methods.claim(f"{method.name}_silent"),
                (("provider", "JausAddress"),),
                "None",
                sentence(f"take notice that {peer_name} has stopped to report"),
                f"{identity}:silent",
            )
        query = self._messages[self._query_of(connection)]
        return Received(connection, query, view, provider, method, silent)

    @functools.cached_property
    def _peers(self) -> Peers:
        return Peers(self.component)

    @property
    def peers(self) -> tuple[Peer, ...]:
        """Other components that this one controls or receives reports from."""
        return tuple(self._peers.known.values())

    @property
    def is_managed(self) -> bool:
        """Whether the component has the states of Management."""
        return components.provides(self.component, "Management")

    # -- text ------------------------------------------------------------------------------------

    @property
    def address(self) -> str:
        """The modelled address."""
        return components.address_call(self.component)

    @property
    def services(self) -> tuple[str, ...]:
        """The services that Discovery reports."""
        return components.service_identities(self.component)

    @property
    def component_type(self) -> int:
        """The type that Discovery reports."""
        return components.SUBSYSTEM_TYPES[self.component.type.name]

    @property
    def name_text(self) -> str:
        """The name as a Python string."""
        return python_string(self.name)

    @property
    def description(self) -> str:
        """The documentation, as a Python string."""
        return long_string(self.documentation)

    @property
    def settings(self) -> str:
        """The modelled behaviour."""
        return components.component_settings(self.system, self.component)

    @property
    def transport(self) -> str:
        """The modelled settings of the transport."""
        return components.transport_settings(self.system, self.component)

    @property
    def entry_point(self) -> EntryPoint:
        """How its process runs."""
        return EntryPoint(
            title=f"component {self.name}",
            runner="run_component",
            arguments=f"{self.class_name}, PROGRAM, arguments",
            end="SIGINT, SIGTERM or a JAUS Shutdown",
            needs_program=True,
        )

    @property
    def imported(self) -> Collection[str]:
        """Names that its modules may import."""
        return self.base_imports.names

    @property
    def base_imports(self) -> Imports:
        """The names that the base may import."""
        core = [
            view.class_name for element, view in self._messages.items() if is_core_message(element)
        ]
        return Imports(
            {
                **runtime_names(),
                **offered(MESSAGES, *core),
                **offered(".messages", *(view.class_name for view in self.messages)),
            }
        )

    @property
    def skeleton_imports(self) -> Imports:
        """The names that the skeleton may import."""
        own = offered(f".{self.package}_base", "ADDRESS", "SETTINGS", self.base_name)
        return self.base_imports.and_also(own)

    @property
    def test_imports(self) -> Imports:
        """The names that the tests may import."""
        return Imports(
            {
                **runtime_names(),
                "messages": Origin(self.package, "messages"),
                **offered(f"{self.package}.{self.package}", self.class_name),
            },
            own=self.package,
        )

    def contract(self) -> SkeletonContract:
        """Returns the methods that the base expects of the user's class."""
        hooks = (
            MethodContract(name, parameters, f"hook:{name}", "", optional=True)
            for name, parameters in _HOOKS.items()
        )
        methods = (*(method.contract for method in self.methods), *hooks)
        return SkeletonContract(self.class_name, self.base_name, methods)


def component_views(model: Model) -> tuple[ComponentView, ...]:
    """Returns the components of the system that is generated; `model.derived` shares them."""
    system, source = system_of(model), source_of(model)
    return tuple(
        ComponentView(component, system, source)
        for component in components.plain_components(system)
    )

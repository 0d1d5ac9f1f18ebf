"""The state machines of a component: tables of states, and the methods that the user writes."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator, Mapping

from jausml.generation.literals import clean, python_string, sentence
from jausml.language.attributes.guards import (
    AllOf,
    AnyOf,
    Condition,
    Guard,
    Negation,
    conditions,
    parse_guard,
)
from jausml.language.metamodel.classes import jaus
from jausml.language.semantics.jaus.commands import guard_of
from jausml.language.semantics.jaus.inherited_machines import (
    Machine,
    event_name,
    is_core_trigger,
    machines_of,
)
from jausml_generators.common import components
from jausml_generators.jaus_component.handlers import Method, documented
from jausml_generators.jaus_component.machine_views import (
    EventView,
    MachineMethod,
    MachineView,
    walks,
)
from jausml_generators.python import names
from jausml_generators.python.codec.messages import MessageView
from jausml_generators.python.statements import call, condition, tuple_of

STANDARD_GUARDS = {
    "isControllingClient": "is_controlling_client",
    "isControlAvailable": "is_control_available",
    "isIDStored": "is_id_stored",
}
"""Guards of the core services that the runtime evaluates, and their methods."""
# Nothing of a guard or an action stays when it is renamed: names that resemble tell.
_NAME_ALONE = ""

_NAMES = """
acted add_machine address allows attempt authority call clear_emergency clients clock command
command_handler component_type control control_available controller core core_event core_services
core_state core_state_changed core_version counters current_time decide_handoff delete_elements
discover discovery_server drops_before drops_of elements encoded_report event_clock event_path fail
fast_path find_peers handle handle_by_machines handle_payload has_control_lapsed host_time ignored
is_control_available is_controlling_client is_id_stored lift_emergency loop may_control name
note_heard part payload_caller permissions_changed permit_control provide provide_by_machines
provision query query_found raise_event read_list refused request_core_state request_handoff
run_action run_condition running send services set_emergency set_list settings shut_down simulation
start status stop subscribe subscribe_to_found supports_element time_offset transport
unanswered_greetings walk watch_unwanted when_permitted when_shut_down when_started when_stopped
"""
COMPONENT_NAMES = frozenset(_NAMES.split())
"""Names of the class of a component, or of its test, that no method of a machine may replace."""

_ENVELOPE = "send"


class _Use:
    """How a guard or an action is used, which decides its parameters."""

    def __init__(self, name: str, documentation: str) -> None:
        self.name = name
        self.documentation = documentation
        self.messages: dict[str, None] = {}
        self.is_plain = False
        self.report: MessageView | None = None

    @property
    def parameters(self) -> tuple[tuple[str, str], ...]:
        """Its parameters: none without a message; with an event too, the message is optional."""
        if not self.messages:
            return ()
        kinds = ["Message"] if "Message" in self.messages else list(self.messages)
        if self.is_plain:
            union = " | ".join([*kinds, "None"])
            return (("message", f"{union} = None"), ("sender", "JausAddress | None = None"))
        return (("message", " | ".join(kinds)), ("sender", "JausAddress"))


class Machines:
    """All machines of a component."""

    def __init__(
        self,
        services: tuple[jaus.Service, ...],
        messages: Mapping[jaus.MessageDef, MessageView],
        scope: names.Scope,
    ) -> None:
        self._services = services
        self._messages = messages
        self._scope = scope
        self._machines = machines_of(services)
        self._guards: dict[str, _Use] = {}
        self._actions: dict[tuple[str, int], _Use] = {}
        self._taken: dict[int, tuple[jaus.MessageDef, bool]] = {}
        for machine in self._machines:
            for _, transition in machine.transitions():
                if not is_core_trigger(transition):
                    self._use_transition(transition, extends_core=machine.extends_core)
            for node in machine.nodes.values():
                for state in node.elements:
                    self._use_actions([*state.entry, *state.exit], None, is_plain=True)

    # -- what is used ----------------------------------------------------------------------------

    def _use_transition(self, transition: jaus.Transition, *, extends_core: bool) -> None:
        message, kind = transition.message, None
        is_plain = message is None
        if message is not None:
            kind = self._view(message).class_name
            _, is_free = self._taken.get(self._view(message).code, (None, False))
            self._taken[self._view(message).code] = (message, is_free or extends_core)
        elif not event_name(transition.event):
            kind = "Message"
            for service in self._services:
                for input_message in service.inputs:
                    self._taken.setdefault(
                        self._view(input_message).code, (input_message, extends_core)
                    )
        for name in conditions(parse_guard(transition.guard)):
            if name not in STANDARD_GUARDS:
                use = self._guards.setdefault(name, _Use(name, ""))
                _note(use, kind, is_plain=is_plain)
        self._use_actions(transition.actions, kind, is_plain=is_plain)

    def _use_actions(
        self, actions: Iterable[jaus.Action], kind: str | None, *, is_plain: bool
    ) -> None:
        for action in actions:
            use = self._actions.setdefault(_key(action), _Use(_action_name(action), ""))
            use.documentation = use.documentation or clean(action.documentation)
            if action.sends is not None:
                use.report = self._view(action.sends)
            _note(use, kind, is_plain=is_plain)

    def _view(self, message: jaus.MessageDef) -> MessageView:
        return self._messages[message]

    # -- what is generated -----------------------------------------------------------------------

    @functools.cached_property
    def _guard_methods(self) -> dict[str, Method]:
        return {name: self._guard_method(use) for name, use in self._guards.items()}

    @functools.cached_property
    def _action_methods(self) -> dict[tuple[str, int], Method]:
        return {key: self._action_method(use) for key, use in self._actions.items()}

    @property
    def methods(self) -> tuple[Method, ...]:
        """Guards and actions, as methods of the skeleton."""
        return (*self._guard_methods.values(), *self._action_methods.values())

    @property
    def condition_methods(self) -> dict[str, str]:
        """Names of the methods of conditions that the user writes, by their names in guards."""
        return {name: method.name for name, method in self._guard_methods.items()}

    def _guard_method(self, use: _Use) -> Method:
        name = self._scope.claim(names.snake_case(use.name))
        text = sentence(f"tell whether the guard {clean(use.name)} holds")
        return MachineMethod(name, use.parameters, "bool", text, _NAME_ALONE)

    def _action_method(self, use: _Use) -> Method:
        name = self._scope.claim(names.snake_case(use.name))
        if use.report is None:
            text = sentence(use.documentation or f"do what {clean(use.name)} means")
            return MachineMethod(name, use.parameters, "None", text, _NAME_ALONE)
        instruction = f"return {use.report.jaus_name} to send, or None to send nothing"
        return MachineMethod(
            name,
            use.parameters,
            f"{use.report.class_name} | None",
            sentence(use.documentation or instruction),
            _NAME_ALONE,
        )

    @functools.cached_property
    def views(self) -> tuple[MachineView, ...]:
        """The machines."""
        views = []
        for machine in self._machines:
            name = self._scope.claim(_attribute(machine))
            displays = tuple(self._states(machine))
            walks = tuple(self._walks(machine))
            views.append(MachineView(machine, name, self._scope.claim(f"_{name}"), displays, walks))
        return tuple(views)

    @functools.cached_property
    def events(self) -> tuple[EventView, ...]:
        """Internal events that the component may raise."""
        elements = {
            str(event.name): event for service in self._services for event in service.events
        }
        return tuple(
            EventView(
                self._scope.claim(f"raise_{names.snake_case(name)}"),
                clean(name),
                documented(event, f"raise the internal event {clean(name)}"),
            )
            for name, event in elements.items()
        )

    def takes(self, code: int) -> bool:
        """Tells whether a machine takes a message."""
        return code in self._taken

    def registration(
        self, message: jaus.MessageDef, service: jaus.Service, provided: tuple[jaus.Service, ...]
    ) -> str:
        """Returns the statement of the constructor that gives a message to the machines."""
        view = self._view(message)
        report = components.report_for(message, components.with_inherited([service]))
        if report is not None:
            code = self._view(report).code
            makers = [
                f"self.{self._action_methods[key].name}"
                for key in self._actions
                if key[1] == code and view.class_name in self._actions[key].messages
            ]
            if makers:
                classes = (view.class_name, self._view(report).class_name)
                return call("self.provide_by_machines", *classes, *makers)
        _, is_free = self._taken[view.code]
        # Where the core services are extended, the guards of the machine say who is obeyed.
        is_free = is_free and components.inherits(service, "AccessControl")
        guard = "ANY" if is_free else guard_of(message, service, provided)
        when = [f"when={condition(message, guard)}"] if guard != "ANY" else []
        arguments = (view.class_name, *when)
        return call("self.handle_by_machines", *arguments)

    # -- tables ----------------------------------------------------------------------------------

    def _states(self, machine: Machine) -> Iterator[str]:
        for node in machine.nodes.values():
            items = [python_string(node.path)]
            is_core = node.path in machine.core_states
            if not is_core and machine.initial(node.path.rpartition(".")[0]) == node.path:
                items.append("initial=True")
            entry = [action for state in node.elements for action in state.entry]
            leaving = [action for state in node.elements for action in state.exit]
            for argument, actions in (("entry=", entry), ("exit=", leaving)):
                if actions:
                    items.append(argument + tuple_of(*map(self._reference, actions)))
            for argument, transitions in (
                ("transitions=", node.transitions),
                ("defaults=", node.defaults),
            ):
                if transitions:
                    transition_texts = [
                        self._on(machine, node.path, transition) for transition in transitions
                    ]
                    items.append(argument + tuple_of(*transition_texts))
            if len(items) > 1 or not is_core:
                yield call("State", *items)

    def _walks(self, machine: Machine) -> Iterator[str]:
        for way in walks(machine):
            yield tuple_of(
                *(
                    tuple_of(
                        self._named(step.trigger),
                        str(step.refused),
                        python_string(step.state),
                        tuple_of(*map(self._called, step.actions)),
                    )
                    for step in way
                )
            )

    def _called(self, action: jaus.Action) -> str:
        """Returns the name of the method of an action as a Python string."""
        return python_string(self._action_methods[_key(action)].name)

    def _named(self, trigger: jaus.MessageDef | str) -> str:
        """Returns the name of a trigger as a Python string."""
        return python_string(
            trigger if isinstance(trigger, str) else self._view(trigger).class_name
        )

    def _on(self, machine: Machine, path: str, transition: jaus.Transition) -> str:
        items = [self._trigger(transition)]
        guard = parse_guard(transition.guard)
        if guard is not None:
            items.append(f"when={self._condition(guard)}")
        if transition.actions:
            items.append(f"do={tuple_of(*map(self._reference, transition.actions))}")
        if transition.target:
            target = machine.resolve(path, transition.target) or transition.target
            items.append(f"target={python_string(machine.innermost(target))}")
        if transition.kind.name != "simple":
            items.append(f"kind=Kind.{transition.kind.name.upper()}")
        return call("On", *items)

    def _trigger(self, transition: jaus.Transition) -> str:
        if transition.message is not None:
            return self._view(transition.message).class_name
        event = event_name(transition.event)
        return python_string(event) if event else "None"

    def _condition(self, guard: Guard) -> str:
        if isinstance(guard, Condition):
            known = STANDARD_GUARDS.get(guard.name)
            return f"self.{known or self._guard_methods[guard.name].name}"
        if isinstance(guard, Negation):
            return call("negation", self._condition(guard.operand))
        function = {AllOf: "all_of", AnyOf: "any_of"}[type(guard)]
        return call(function, *map(self._condition, guard.operands))

    def _reference(self, action: jaus.Action) -> str:
        return f"self.{self._action_methods[_key(action)].name}"


def messages_of(services: Iterable[jaus.Service]) -> list[jaus.MessageDef]:
    """Returns the messages that trigger transitions of services or that actions send."""
    messages: dict[jaus.MessageDef | None, None] = {}
    for machine in machines_of(services):
        for state in (state for node in machine.nodes.values() for state in node.elements):
            transitions = [*state.transitions, *state.defaults]
            actions = [*state.entry, *state.exit]
            for transition in transitions:
                if not is_core_trigger(transition):
                    actions += transition.actions
                    messages[transition.message] = None
            messages.update(dict.fromkeys(action.sends for action in actions))
    return [message for message in messages if message is not None]


def _attribute(machine: Machine) -> str:
    """Returns the name of a machine in code; several services may extend that of the core."""
    if not machine.extends_core:
        return names.snake_case(machine.name)
    return names.snake_case(f"{machine.service_name}_{machine.name}")


def _note(use: _Use, kind: str | None, *, is_plain: bool) -> None:
    if kind is not None:
        use.messages[kind] = None
    use.is_plain = use.is_plain or is_plain


def _key(action: jaus.Action) -> tuple[str, int]:
    sent = action.sends
    return _action_name(action), int(str(sent.code), 16) if sent is not None else -1


def _action_name(action: jaus.Action) -> str:
    """Returns the name of an action, without the prefix of AS5684.

    Its Send stands for all messages that a service sends: each has a method of its own.
    """
    name = str(action.name).rpartition(".")[2]
    if action.sends is None or name.lower() != _ENVELOPE:
        return name
    message = str(action.sends.name)
    return message if message.startswith("Report") else f"make{message}"

"""State machines as the protocol behaviour of JSIDL: what the importer's `behaviour` reads."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from typing import Any
from xml.etree.ElementTree import Element

from jausml.language.attributes.guards import LONGEST, alternatives, parse_guard
from jausml.language.exporters.jsidl.elements import element, explained
from jausml.language.metamodel.classes import jaus
from jausml.language.semantics.jaus.core_services import CORE
from jausml.language.semantics.jaus.inheritance import lineage
from jausml.language.semantics.jaus.inherited_machines import (
    CORE_MACHINE,
    Machine,
    canonical,
    core_machine,
    event_name,
    machine_with,
)

_MESSAGE = "msg"
_SENDER = "transportData"
_SENT_WITH = "Receive.Body.ReceiveRec"
_OF_SENDER = ("isControllingClient", "isIDStored")
_CONDITION = re.compile(r"([A-Za-z_][\w.]*)(\s*\([^()|&!]*\))?")
_NAME = re.compile(r"[A-Za-z_]\w*")


def behaviour(service: jaus.Service) -> Element:
    """Returns the machines of a service, or that it is stateless: AS5684 asks for a machine."""
    machines = [(machine, machine_with(machine)) for machine in service.machines]
    written = [
        _Writer(service, machine.name, whole, machine.states).machine(machine)
        for machine, whole in machines
        if whole
    ]
    if not written:
        silent = Machine(CORE_MACHINE, core_machine(service))
        written = [_Writer(service, CORE_MACHINE, silent, ()).machine()]
    parts = [part for kind in zip(*written, strict=True) for part in kind]
    return element("protocol_behavior", parts, is_stateless=not machines)


class _Writer:
    """Writes one machine."""

    def __init__(
        self, service: jaus.Service, name: str, whole: Machine, states: Iterable[jaus.State]
    ) -> None:
        self._service = service
        self._name = name
        self._whole = whole
        self._states: dict[str, list[jaus.State]] = {}
        for path, state in _paths(states):
            self._states.setdefault(path, []).extend([state] if state is not None else [])
        # Who extends a machine says its states again: generators of others look for them.
        inherited = (
            machine
            for ancestor in lineage(service)[1:]
            for machine in ancestor.machines
            if machine.name == name
        )
        for machine in inherited:
            self._states |= {
                path: [] for path, _ in _paths(machine.states) if path not in self._states
            }
        self._states = self._states or {whole.core.states[0]: []}

    def machine(self, *explaining: jaus.StateMachine) -> tuple[Element, Element]:
        """Returns where the machine starts, and the machine."""
        name = _machine_name(self._name, self._service)
        first = ""
        while inside := self._initial(first):
            first = inside
        start = element("start", state_machine_name=name, state_name=first)
        machine_element = element("state_machine", self._inside(""), name=name)
        return start, explained(machine_element, *explaining)

    def _paths_in(self, outer: str) -> list[str]:
        return [state for state in self._states if state.rpartition(".")[0] == outer]

    def _inside(self, outer: str) -> list[Element]:
        return [self._state(path) for path in self._paths_in(outer)]

    def _state(self, path: str) -> Element:
        def all_of(feature: str) -> list[Any]:
            return [member for state in self._states[path] for member in getattr(state, feature)]

        parts = [
            *self._steps("entry", all_of("entry")),
            *self._steps("exit", all_of("exit")),
            *self._transitions(all_of("transitions"), path),
            *self._inside(path),
        ]
        if defaults := self._transitions(all_of("defaults"), path):
            parts.append(element("default_state", defaults))
        name, initial = path.rpartition(".")[2], (self._initial(path) or "").rpartition(".")[2]
        state_element = element("state", parts, name=name, initial_state=initial or None)
        return explained(state_element, *self._states[path])

    def _initial(self, outer: str) -> str | None:
        """Returns the state that is entered with one: as the machine says, or the core."""
        inside = self._paths_in(outer)
        own = (
            substate
            for substate in inside
            if any(state.initial for state in self._states[substate])
        )
        of_core = (substate for substate in inside if substate == self._whole.initial(outer))
        return next(own, None) or next(of_core, None)

    def _steps(self, tag: str, actions: list[jaus.Action]) -> Iterator[Element]:
        if actions:
            yield element(tag, [self._action(action, has_sender=False) for action in actions])

    def _transitions(self, transitions: list[jaus.Transition], path: str) -> list[Element]:
        # Those for all triggers stand behind the others (AS5684).
        ordered = sorted(
            transitions,
            key=lambda transition: transition.message is None and not event_name(transition.event),
        )
        return [self._transition(transition, path) for transition in ordered]

    def _transition(self, transition: jaus.Transition, path: str) -> Element:
        message, event = transition.message, event_name(transition.event)
        name = None
        if message is not None:
            name = self._of_transport("Receive")
        elif event:
            name = _qualified(
                event,
                self._service,
                lambda service: any(declared.name == event for declared in service.events),
            )
        carried = self._parameters(transition)
        parts = [
            element("parameter", type=type_, value=parameter)
            for parameter, type_ in carried.items()
        ]
        if transition.guard:
            of_message = next(iter(carried)) if message is not None else None
            parts.append(element("guard", condition=_called(transition.guard, of_message)))
        parts.append(self._kind(transition, path))
        parts += [
            self._action(action, has_sender=message is not None) for action in transition.actions
        ]
        transition_element = element(
            "transition" if name else "default_transition", parts, name=name
        )
        return explained(transition_element, transition)

    def _parameters(self, transition: jaus.Transition) -> dict[str, str]:
        """Returns the types of the parameters of a transition by their names.

        The first name that guard and actions use is the message, `msg` without one; names for
        what an event carries are those of the event, and its body in lower case.
        """
        names = [name for name in _names(transition) if name != _SENDER]
        if transition.message is not None:
            first = names[0] if names and _MESSAGE not in names else _MESSAGE
            return {first: str(transition.message.name), _SENDER: _SENT_WITH}
        event = event_name(transition.event)
        events = (
            declared
            for ancestor in lineage(self._service)
            for declared in ancestor.events
            if declared.name == event
        )
        body = next(
            (str(declared.body.name) for declared in events if declared.body is not None), ""
        )
        of_body = {body[:1].lower() + body[1:]: f"{event}.Body.{body}"}
        return {name: of_body.get(name, event) for name in names} if event else {}

    def _kind(self, transition: jaus.Transition, path: str) -> Element:
        """Returns the kind of a transition with the whole path of its target state."""
        kind, target = transition.kind.name, transition.target
        if not target:
            return element(kind)
        resolved = self._whole.resolve(canonical(path), target) or target
        is_whole = canonical(target) == resolved
        return element(kind, [element("end_state", state=target if is_whole else resolved)])

    def _action(self, action: jaus.Action, *, has_sender: bool) -> Element:
        values = arguments_of(action, has_sender=has_sender)
        arguments = [element("argument", value=value) for value in values]
        name = action.name if action.sends is None else self._of_transport("Send")
        return explained(element("action", arguments, name=name), action)

    def _of_transport(self, name: str) -> str:
        return _qualified(name, self._service, lambda service: service.urn == f"{CORE}Transport")


def _paths(
    states: Iterable[jaus.State], outer: str = ""
) -> Iterator[tuple[str, jaus.State | None]]:
    """Yields the paths of states as they are written, with implied outer states before them."""
    for state in states:
        path = outer
        for name in str(state.name).split("."):
            path = f"{path}.{name}" if path else name
            yield path, None
        yield path, state
        yield from _paths(state.states, path)


def arguments_of(action: jaus.Action, *, has_sender: bool) -> list[str]:
    """Returns the arguments of an action: of one that sends, the message and the receiver."""
    arguments = list(action.arguments)
    sent = f"'{action.sends.name}'" if action.sends is not None else ""
    if not sent or arguments[:1] == [sent]:
        return arguments
    return [sent, _SENDER] if has_sender else [sent]


def _names(transition: jaus.Transition) -> list[str]:
    """Returns the names among the arguments of the guard and the actions of a transition."""
    conditions = _CONDITION.finditer(transition.guard or "")
    arguments = [word for match in conditions for word in (match[2] or "").strip(" ()").split(",")]
    arguments += [argument for action in transition.actions for argument in action.arguments]
    return [value.strip() for value in arguments if _NAME.fullmatch(value.strip())]


def _called(guard: str, message: str | None) -> str:
    """Returns a guard whose conditions have arguments, as those of AS5684 have.

    The generator of the JAUS Tool Set reads no parentheses around conditions: there are none,
    unless the guard would become too long.
    """

    def with_arguments(match: re.Match[str]) -> str:
        name, arguments = match.groups()
        asked = _SENDER if name in _OF_SENDER else message
        default = f"({asked})" if message else "()"
        return f"{name}{arguments or default}"

    parsed = parse_guard(guard)
    choices = (parsed and alternatives(parsed)) or []
    flat = " || ".join(
        " && ".join(
            condition.written if holds else f"!{condition.written}"
            for condition, holds in alternative
        )
        for alternative in choices
    )
    return _CONDITION.sub(with_arguments, flat if 0 < len(flat) <= LONGEST else guard)


def reference_name(service: jaus.Service) -> str:
    """Returns the name under which heirs refer to a service, e.g. `accessControl`."""
    name = str(service.name)
    return name[:1].lower() + name[1:]


def _machine_name(name: str, service: jaus.Service) -> str:
    is_core = name == CORE_MACHINE
    return _qualified(
        name,
        service,
        lambda service: (
            (is_core and str(service.urn).startswith(CORE))
            or any(machine.name == name for machine in service.machines)
        ),
    )


def _qualified(name: str, service: jaus.Service, is_owner: Callable[[jaus.Service], bool]) -> str:
    """Returns a name as a service writes it: `management.accessControl.Timedout`.

    Of the services that declare it the farthest is meant, and without one the service itself.
    """
    chain = lineage(service)
    owners = [place for place, ancestor in enumerate(chain) if is_owner(ancestor)]
    inherited = chain[1 : owners[-1] + 1] if owners else []
    return ".".join([*map(reference_name, inherited), name])

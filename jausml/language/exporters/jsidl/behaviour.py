"""State machines as the protocol behaviour of JSIDL: what the importer's `behaviour` reads."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from jausml.language.exporters.jsidl.elements import element, said
from jausml.language.semantics.jaus.core_services import CORE
from jausml.language.semantics.jaus.inherited_machines import (
    CORE_MACHINE,
    Machine,
    canonical,
    event_name,
    machine_with,
)
from jausml.language.semantics.jaus.services import lineage

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from xml.etree.ElementTree import Element

    from jausml.language.metamodel.classes import jaus

_SENDER = "transportData"
_SENT_WITH = "Receive.Body.ReceiveRec"


@dataclass
class _StateGroup:
    """The states of one path in one machine, of which several may say something."""

    states: list[jaus.State] = field(default_factory=list)
    inside: dict[str, _StateGroup] = field(default_factory=dict)

    def enter(self, state: jaus.State) -> None:
        """Adds a state, whose name may be a path, and those inside it."""
        group = self
        for name in str(state.name).split("."):
            group = group.inside.setdefault(name, _StateGroup())
        group.states.append(state)
        for inner in state.states:
            group.enter(inner)

    @property
    def is_initial(self) -> bool:
        """Whether one of them says that it is initial."""
        return any(state.initial for state in self.states)


class BehaviourWriter:
    """Writes the behaviour of one service."""

    def __init__(self, service: jaus.Service) -> None:
        self._service = service

    def behaviour(self) -> Element:
        """Returns its machines, or that it is stateless: AS5684 has no behaviour without one."""
        machines = [(each, machine_with(each)) for each in self._service.machines]
        written = [self._machine(element, whole) for element, whole in machines if whole]
        if not written:
            name, state = self._machine_name(CORE_MACHINE), "Receiving"
            start = element("start", state_machine_name=name, state_name=state)
            silent = element("state_machine", [element("state", name=state)], name=name)
            written = [(start, silent)]
        parts = [each for kind in zip(*written, strict=True) for each in kind]
        return element("protocol_behavior", parts, is_stateless=not machines)

    def _machine_name(self, name: str) -> str:
        def has_it(service: jaus.Service) -> bool:
            is_core = name == CORE_MACHINE and str(service.urn).startswith(CORE)
            return is_core or any(each.name == name for each in service.machines)

        return _qualified(name, self._service, has_it)

    def _machine(self, machine: jaus.StateMachine, whole: Machine) -> tuple[Element, Element]:
        """Returns where a machine starts, and the machine."""
        name = self._machine_name(str(machine.name))
        outermost = _StateGroup()
        for state in machine.states:
            outermost.enter(state)
        start = element("start", state_machine_name=name, state_name=whole.innermost(""))
        states = self._states(outermost, "", whole)
        text = said(machine.documentation)
        return start, element("state_machine", states, name=name, interpretation=text)

    # -- states ----------------------------------------------------------------------------------

    def _states(self, group: _StateGroup, path: str, whole: Machine) -> list[Element]:
        return [
            self._state(inner, name, f"{path}.{name}" if path else name, whole)
            for name, inner in group.inside.items()
        ]

    def _state(self, group: _StateGroup, name: str, path: str, whole: Machine) -> Element:
        def all_of(feature: str) -> list[Any]:
            return [each for state in group.states for each in getattr(state, feature)]

        first = (whole.initial(path) or "").rpartition(".")[2]
        of_core = first if first in group.inside else None
        initial = next((n for n, each in group.inside.items() if each.is_initial), of_core)
        texts = filter(None, (said(each.documentation) for each in group.states))
        parts = [
            *self._steps("entry", all_of("entry")),
            *self._steps("exit", all_of("exit")),
            *self._transitions(all_of("transitions"), path, whole),
            *self._states(group, path, whole),
        ]
        if defaults := self._transitions(all_of("defaults"), path, whole):
            parts.append(element("default_state", defaults))
        text = " ".join(texts) or None
        return element("state", parts, name=name, initial_state=initial, interpretation=text)

    def _steps(self, tag: str, actions: list[jaus.Action]) -> Iterator[Element]:
        if actions:
            yield element(tag, [self._action(each, has_sender=False) for each in actions])

    # -- transitions -----------------------------------------------------------------------------

    def _transitions(
        self, transitions: Iterable[jaus.Transition], path: str, whole: Machine
    ) -> list[Element]:
        # Those for all triggers stand behind the others (AS5684).
        ordered = sorted(transitions, key=lambda t: t.message is None and not event_name(t.event))
        return [self._transition(each, path, whole) for each in ordered]

    def _transition(self, transition: jaus.Transition, path: str, whole: Machine) -> Element:
        message, event = transition.message, event_name(transition.event)
        parts: list[Element] = []
        name = None
        if message is not None:
            name = self._of_transport("Receive")
            parts += [
                element("parameter", type=message.name, value="msg"),
                element("parameter", type=_SENT_WITH, value=_SENDER),
            ]
        elif event:
            name = _qualified(event, self._service, lambda each: event in _names(each.events))
        if transition.guard:
            parts.append(element("guard", condition=transition.guard))
        parts.append(_kind(transition, path, whole))
        parts += [self._action(a, has_sender=message is not None) for a in transition.actions]
        tag, text = "transition" if name else "default_transition", said(transition.documentation)
        return element(tag, parts, name=name, interpretation=text)

    def _action(self, action: jaus.Action, *, has_sender: bool) -> Element:
        arguments = arguments_of(action, has_sender=has_sender)
        return element(
            "action",
            [element("argument", value=each) for each in arguments],
            name=action.name if action.sends is None else self._of_transport("Send"),
            interpretation=said(action.documentation),
        )

    def _of_transport(self, name: str) -> str:
        return _qualified(name, self._service, lambda each: each.urn == f"{CORE}Transport")


def reference_name(service: jaus.Service) -> str:
    """Returns the name under which heirs refer to a service, e.g. `accessControl`."""
    name = str(service.name)
    return name[:1].lower() + name[1:]


def _qualified(name: str, service: jaus.Service, is_owner: Callable[[jaus.Service], bool]) -> str:
    """Returns a name as a service writes it: `management.accessControl.Timedout`.

    Of the services that declare it the farthest is meant, and without one the service itself.
    """
    chain = lineage(service)
    owners = [place for place, each in enumerate(chain) if is_owner(each)]
    inherited = chain[1 : owners[-1] + 1] if owners else []
    return ".".join([*map(reference_name, inherited), name])


def arguments_of(action: jaus.Action, *, has_sender: bool) -> list[str]:
    """Returns the arguments of an action: of one that sends, what is sent, and to whom."""
    arguments = list(action.arguments)
    if action.sends is None:
        return arguments
    sent = f"'{action.sends.name}'"
    if arguments[:1] == [sent]:
        return arguments
    return [sent, _SENDER] if has_sender else [sent]


def _names(events: Iterable[jaus.InternalEvent]) -> set[str]:
    return {str(each.name) for each in events}


def _kind(transition: jaus.Transition, path: str, whole: Machine) -> Element:
    """Returns the kind of a transition with the state that it enters, by its whole path."""
    kind, target = transition.kind.name, transition.target
    if not target:
        return element(kind)
    resolved = whole.resolve(canonical(path), target) or target
    is_whole = canonical(target) == resolved
    state = element("end_state", state=target if is_whole else resolved)
    return element(kind, [state])

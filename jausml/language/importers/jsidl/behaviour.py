"""Protocol behaviour: state machines of JSIDL become those of the model.

JSIDL knows one kind of trigger, internal events: the event Receive of Transport with a message as
its first parameter is what the model calls a transition on a message. Sending is an action too,
Send of Transport: with the name of a message, to the sender of the message that came, it becomes an
action that sends; to somebody else it stays an action of its own.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from jausml.language.attributes.guards import GuardError, parse_guard
from jausml.language.importers.findings import ImportFindings
from jausml.language.importers.jsidl.building import DEEPEST, Builder
from jausml.language.importers.jsidl.services import BehaviourNames
from jausml.language.importers.jsidl.vocabulary import (
    Values,
    children,
    documentation,
    folded,
    joined,
)
from jausml.language.metamodel.classes import jaus
from jausml.language.model.reading.problems import NodePlace
from jausml.language.model.values import show, suggest
from jausml.language.model.xmi.parsing import Node
from jausml.language.semantics.names import parts, snake_case

_KINDS = ("simple", "internal", "push", "pop")
_STEPS = ("action", "send_action")
_RECEIVE = "Receive"
_SEND = "Send"
_SENDER = "transportData"


class BehaviourBuilder:
    """Builder of the state machines of one service."""

    def __init__(
        self, names: BehaviourNames, builder: Builder, values: Values, findings: ImportFindings
    ) -> None:
        self._builder = builder
        self._values = values
        self._findings = findings
        self._known = names
        self._guards: dict[str, str] = {}

    def machines(self, place: NodePlace) -> list[jaus.StateMachine]:
        """Makes the machines; none of a stateless behaviour without actions.

        AS5684 has no service without a machine, the model has: each message is handled by itself.
        """
        if self._values.flag(place, "is_stateless") and not _acts(place.node):
            return []
        machines: dict[str, jaus.StateMachine] = {}
        starts = children(place, "start")
        for child in children(place, "state_machine"):
            machine = self._machine(child, starts)
            if machine.name in machines:
                message = f"machine '{machine.name}' is there twice"
                self._findings.report("JML624", child, message, "the second one is left out")
            machines.setdefault(machine.name, machine)
        for start in starts:
            name = last(start.node.get("state_machine_name"))
            if name and name not in machines:
                message = f"no machine {show(name)} starts: there is none"
                at = start.at("state_machine_name")
                self._findings.report("JML624", at, message, suggest(name, machines))
        return list(machines.values())

    # -- states ----------------------------------------------------------------------------------

    def _machine(self, place: NodePlace, starts: list[NodePlace]) -> jaus.StateMachine:
        name = last(place.node.get("name"))
        path = next(
            (
                "".join((start.node.get("state_name") or "").split()).split(".")
                for start in starts
                if last(start.node.get("state_machine_name")) == name
            ),
            [],
        )
        states = self._states(place, path, [])
        if not states:
            self._findings.report("JML604", place, f"machine {show(name)} has no state")
        self._report_staying(place)
        for child in children(place, "default_state"):
            # What holds in all states is a transition of each of the outermost ones.
            for state in states:
                self._builder.set(state, "transitions", self._transitions(child))
        said = documentation(place.node)
        return self._builder.new(
            jaus.StateMachine, place, name=name, documentation=said, states=states
        )

    def _states(self, place: NodePlace, start: list[str], outer: list[str]) -> list[jaus.State]:
        """Makes the states inside a state or machine."""
        initial = folded(place.node.get("initial_state"))
        started = start[0] if start else ""
        if initial and started and initial != started:
            message = f"the machine starts in {show(started)}, but the group in {show(initial)}"
            self._findings.report(
                "JML624", place.at("initial_state"), message, f"{show(initial)} was taken"
            )
        states = []
        for child in children(place, "state"):
            name = folded(child.node.get("name"))
            inside = start[1:] if name == started else []
            is_initial = name == (initial or started)
            states.append(self._state(child, inside, [*outer, name], is_initial=is_initial))
        return states

    def _state(
        self, place: NodePlace, start: list[str], path: list[str], *, is_initial: bool
    ) -> jaus.State:
        if len(path) > DEEPEST:
            self._findings.report("JML612", place, "states are nested too deeply")
        inside = self._states(place, start, path) if len(path) <= DEEPEST else []
        return self._builder.new(
            jaus.State,
            place,
            name=path[-1],
            documentation=documentation(place.node),
            initial=is_initial or None,
            entry=[action for child in children(place, "entry") for action in self._actions(child)],
            exit=[action for child in children(place, "exit") for action in self._actions(child)],
            transitions=self._transitions(place),
            defaults=[
                transition
                for child in children(place, "default_state")
                for transition in self._transitions(child)
            ],
            states=inside,
        )

    # -- transitions -----------------------------------------------------------------------------

    def _transitions(self, place: NodePlace) -> list[jaus.Transition]:
        """Makes the transitions directly inside an element, default transitions last."""
        places = (*children(place, "transition"), *children(place, "default_transition"))
        transitions = [self._transition(node) for node in places]
        return [transition for transition in transitions if transition is not None]

    def _transition(self, place: NodePlace) -> jaus.Transition | None:
        trigger = self._trigger(place)
        if trigger is None or self._is_served(place, trigger.get("message")):
            return None
        kind, target = self._kind(place)
        guard, said = self._guard(place)
        return self._builder.new(
            jaus.Transition,
            place,
            **trigger,
            kind=kind,
            target=target,
            guard=guard,
            documentation=joined(documentation(place.node), said),
            actions=self._actions(place, has_sender="message" in trigger),
        )

    def _is_served(self, place: NodePlace, message: jaus.MessageDef | None) -> bool:
        """Reports a transition that would never be taken, as the runtime takes its message."""
        owner = self._known.served.get(message) if message is not None else None
        if message is None or owner is None:
            return False
        text = f"{message.name} is taken by {owner} of the runtime, not by a transition"
        self._findings.report("JML624", place, text, "the transition is left out")
        return True

    def _trigger(self, place: NodePlace) -> dict[str, Any] | None:
        """Returns the features that name the trigger, None when it is not known."""
        if place.node.tag == "default_transition":
            return {}
        name = last(place.node.get("name"))
        parameters = children(place, "parameter")
        if name == _RECEIVE and parameters:
            at = parameters[0].at("type")
            type_name = folded(parameters[0].node.get("type"))
            message = self._known.inputs.get(last(type_name))
            if message is None and self._is_broken(last(type_name)):
                return None
            if message is None:
                text = f"the service takes no message {show(type_name)}"
                hint = suggest(last(type_name), self._known.inputs)
                self._findings.report("JML622", at, text, hint)
                return None
            return {"message": message}
        if not name or self._is_broken(name):
            return None
        if name not in self._known.events:
            text = f"neither the service nor one that it inherits has an event {show(name)}"
            hint = suggest(name, self._known.events)
            self._findings.report("JML622", place.at("name"), text, hint)
            return None
        if parameters:
            text = f"what the event {show(name)} carries is not handed to guards and actions"
            self._findings.report("JML626", parameters[0], text)
        for parameter in parameters:
            value, type_name = (
                folded(parameter.node.get("value")),
                folded(parameter.node.get("type")),
            )
            if type_name not in (name, f"{name}.Body.{value[:1].upper()}{value[1:]}"):
                text = f"{show(value)} is taken for the event, not for {show(type_name)}"
                self._findings.report("JML624", parameter.at("type"), text)
        return {"event": name}

    def _is_broken(self, name: str) -> bool:
        """Tells whether a message or event may be missing because of an error in its definition."""
        known = name in self._known.events or name in self._known.outputs
        return not known and self._findings.has_errors and self._known.is_declared(name)

    def _kind(self, place: NodePlace) -> tuple[str, str | None]:
        """Returns kind and target of a transition."""
        places = children(place, *_KINDS)
        if not places:
            message = f"a transition has none of {', '.join(f'<{kind}>' for kind in _KINDS)}"
            self._findings.report("JML604", place, message)
            return "internal", None
        kind, tag = places[0], places[0].node.tag
        for second in places[1:]:
            self._findings.report("JML602", second, f"a transition is <{tag}> already")
        ends = children(kind, "end_state")
        target = "".join((ends[0].node.get("state") or "").split()) if ends else None
        self._report_lost(kind)
        if tag == "push" and not target:
            message = "a push without an end_state enters no state"
            self._findings.report("JML604", kind, message)
        return tag, target or None

    def _report_lost(self, place: NodePlace) -> None:
        """Reports what push and pop have beyond entering and leaving a state."""
        for child in children(place):
            if place.node.tag == "push" and child.node.tag == "simple":
                message = "the push remembers the present state, not the one of <simple>"
                self._findings.report("JML624", child, message)
            elif child.node.tag == "argument":
                self._findings.report("JML624", child, "the pop hands no argument over")
        if place.node.get("transition"):
            message = f"the pop triggers no {show(place.node.get('transition') or '')}"
            hint = "the state that was left is entered, and nothing further happens"
            self._findings.report("JML624", place.at("transition"), message, hint)

    def _report_staying(self, place: NodePlace) -> None:
        """Reports the first transition that stays in a state with exit or entry actions."""
        for node in _states_below(place.node):
            acting = next(
                (inner_state for inner_state in _states_below(node) if _has_actions(inner_state)),
                None,
            )
            staying = next(
                (transition for transition in _transitions_of(node) if _is_internal(transition)),
                None,
            )
            if acting is not None and staying is not None:
                at = NodePlace(place.document, staying)
                state = show(folded(acting.get("name")) or folded(place.node.get("name")))
                message = f"the transition leaves and enters no state: {state} keeps what it does"
                hint = "an end_state that is the state itself runs its exit and entry actions"
                self._findings.report("JML629", at, message, hint)
                return

    def _guard(self, place: NodePlace) -> tuple[str | None, str | None]:
        """Returns the guard of a transition, and a remark on it."""
        guards = children(place, "guard")
        if not guards:
            return None, None
        at, node = guards[0].at("condition"), guards[0].node
        text, said = folded(node.get("condition")), documentation(node)
        try:
            return (_tidy(text) if parse_guard(text) is not None else None), said
        except GuardError as error:
            name = self._guard_name(text)
            message = f"condition {show(text)} is no guard: {error}"
            self._findings.report("JML623", at, message, f"the guard is '{name}'")
            return name, joined(f"Guard: {text}", said)

    def _guard_name(self, text: str) -> str:
        """Returns the name of the condition that stands for a text, the same for the same text."""
        if text not in self._guards:
            base = name = f"guard_{snake_case(text) or 'condition'}"
            taken = set(self._guards.values())
            number = 1
            while name in taken:
                number += 1
                name = f"{base}_{number}"
            self._guards[text] = name
        return self._guards[text]

    # -- actions ---------------------------------------------------------------------------------

    def _actions(self, place: NodePlace, *, has_sender: bool = False) -> list[jaus.Action]:
        steps = children(place, *_STEPS)
        return [self._action(step, has_sender=has_sender) for step in steps]

    def _action(self, place: NodePlace, *, has_sender: bool) -> jaus.Action:
        name = last(place.node.get("name"))
        nodes = [child.node for child in children(place, "argument")]
        arguments = [folded(node.get("value")) for node in nodes]
        sends = None
        if name == _SEND and arguments:
            name, sends = self._send(place, arguments, has_sender=has_sender)
        return self._builder.new(
            jaus.Action,
            place,
            name=name,
            sends=sends,
            arguments=arguments,
            documentation=documentation(place.node, *nodes),
        )

    def _send(
        self, place: NodePlace, arguments: list[str], *, has_sender: bool
    ) -> tuple[str, jaus.MessageDef | None]:
        """Returns the name of an action that sends, and the message if the model can say it."""
        wanted = arguments[0].strip("'\" ")
        quoted = [text.strip("'\" ") for text in arguments[1:] if text[:1] in ("'", '"')]
        suffix = "".join(_camel(text) for text in quoted)
        message = self._known.outputs.get(wanted)
        if message is None:
            if arguments[0][:1] in ("'", '"') and not self._is_broken(wanted):
                text = f"the service sends no message {show(wanted)}"
                hint = suggest(wanted, self._known.outputs)
                self._findings.report("JML624", place, text, hint or "the action is a method")
            return f"send{_camel(wanted)}{suffix}", None
        if not has_sender or _SENDER not in arguments:
            text = f"{show(wanted)} goes to another than the sender of a message"
            self._findings.report("JML624", place, text, "the action is a method that sends it")
            return f"send{wanted}{suffix}", None
        name = wanted if wanted.startswith("Report") else f"make{wanted}"
        return f"{name}{suffix}", message


def last(name: str | None) -> str:
    """Returns the last name of a dotted path, without the services that stand before it."""
    return (name or "").rpartition(".")[2].strip()


def _tidy(guard: str) -> str:
    """Returns a guard without blanks inside parentheses and after `!`."""
    return re.sub(r"(?<=[(!]) | (?=\))", "", guard)


def _camel(text: str) -> str:
    return "".join(
        word[:1].upper() + word[1:].lower() if word.isupper() else word[:1].upper() + word[1:]
        for word in parts(text)
    )


def _states_below(node: Node) -> Iterator[Node]:
    """Yields a state or machine and the states inside it."""
    yield node
    for child in node.children:
        if child.tag == "state":
            yield from _states_below(child)


def _acts(node: Node) -> bool:
    """Tells whether an element has an action on a trigger, an entry or an exit."""
    return any(
        child.tag in (*_STEPS, "transition", "default_transition") or _acts(child)
        for child in node.children
    )


def _has_actions(state: Node) -> bool:
    return any(child.tag in ("entry", "exit") and child.children for child in state.children)


def _transitions_of(state: Node) -> Iterator[Node]:
    """Yields the transitions of a state, those of its default state too."""
    for child in state.children:
        if child.tag in ("transition", "default_transition"):
            yield child
        elif child.tag == "default_state":
            yield from _transitions_of(child)


def _is_internal(transition: Node) -> bool:
    kind = next((child for child in transition.children if child.tag in _KINDS), None)
    return kind is not None and kind.tag == "simple" and not kind.children

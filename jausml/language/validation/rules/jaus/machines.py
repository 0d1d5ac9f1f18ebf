"""Rules about state machines of services (AS5684, protocol behaviour)."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator

from jausml.language.attributes.guards import Guard, GuardError, parse_guard
from jausml.language.metamodel.classes import jaus
from jausml.language.model.diagnostics import Severity
from jausml.language.semantics.jaus.core_services import CORE, SERVED_BY_RUNTIME
from jausml.language.semantics.jaus.inheritance import lineage
from jausml.language.semantics.jaus.inherited_machines import (
    CORE_MACHINE,
    core_events,
    core_machine,
    event_name,
)
from jausml.language.semantics.jaus.machines import Behaviour, behaviours_of, described, trigger
from jausml.language.semantics.jaus.services import find_same
from jausml.language.semantics.subject import Subject
from jausml.language.validation.rule import Finding, Note, rule


@rule("JML341", "not exactly one initial state", kinds=jaus.Service)
def initial_states(subject: Subject, service: jaus.Service) -> Iterator[Finding]:
    """One of the states that lie side by side is initial: it is entered with what encloses it.

    A single state is initial by default. For the states of the core services, the core decides.

    Bad: `<states name="Idle"/><states name="Moving"/>`

    Good: `<states name="Idle" initial="true"/><states name="Moving"/>`
    """
    for behaviour in behaviours_of(subject, service):
        machine = behaviour.machine
        own = {path for path, _ in behaviour.states()}
        groups = dict.fromkeys(path.rpartition(".")[0] for path in own)
        for outer in groups:
            inside = machine.children(outer)
            if any(path in machine.core_states for path in inside):
                continue
            marked = [path for path in inside if machine.nodes[path].is_initial]
            if len(marked) == 1 or len(inside) == 1:
                continue
            where = f"'{outer}'" if outer else f"machine '{machine.name}'"
            count = "none" if not marked else f"{len(marked)}"
            element = _element(behaviour, marked[1] if marked else outer)
            yield Finding(
                element, f"{count} of the {len(inside)} states of {where} are initial", None
            )


@rule("JML342", "no such state", kinds=jaus.Service)
def targets(subject: Subject, service: jaus.Service) -> Iterator[Finding]:
    """The target of a transition is a state of the machine or of the core that it extends.

    It is named by its path from the outermost state, or from a state that the source encloses,
    stands beside, or lies in.

    Bad: `target="Movng"`

    Good: `target="Moving"` or `target="Moving.PayingOut"`
    """
    for behaviour in behaviours_of(subject, service):
        for path, transition in behaviour.transitions():
            target = transition.target
            if target and behaviour.machine.resolve(path, target) is None:
                message = f"'{behaviour.machine.name}' has no state {target!r}"
                nodes = behaviour.machine.nodes
                names = {*nodes, *(node.rpartition(".")[2] for node in nodes)}
                known = (name for name in names if behaviour.machine.resolve(path, name))
                yield Finding(transition, message, "target", _suggestion(target, known))


@rule("JML343", "message of another service", kinds=jaus.Service)
def messages(subject: Subject, service: jaus.Service) -> Iterator[Finding]:
    """A transition is triggered by an input, and an action sends an output, of the service.

    Messages of services that it inherits count.

    Bad: a transition on ReportVelocityState, which the service sends

    Good: a transition on QueryVelocityState with an action that sends ReportVelocityState
    """
    for behaviour in behaviours_of(subject, service):
        services = lineage(behaviour.service)
        taken = [message for ancestor in services for message in ancestor.inputs]
        sent = [message for ancestor in services for message in ancestor.outputs]
        name = behaviour.service.name
        for _, transition in behaviour.transitions():
            message = transition.message
            if message is not None and find_same(message, taken) is None:
                text = f"'{name}' does not take {message.name}"
                yield Finding(transition, text, "message")
        for action in behaviour.actions():
            if action.sends is not None and find_same(action.sends, sent) is None:
                text = f"'{name}' does not send {action.sends.name}"
                yield Finding(action, text, "sends")


@rule("JML344", "unknown internal event", kinds=jaus.Service)
def events(subject: Subject, service: jaus.Service) -> Iterator[Finding]:
    """The event of a transition is one of the service or of a service that it inherits.

    AccessControl and Management have the events Timedout, Initialized and Failure. A transition is
    triggered by either a message or an event.

    Bad: `<transitions event="LoadLst" .../>`

    Good: `<events name="LoadLost"/>` and `<transitions event="LoadLost" .../>`
    """
    for behaviour in behaviours_of(subject, service):
        services = lineage(behaviour.service)
        known = {event.name for ancestor in services for event in ancestor.events if event.name}
        if any(str(ancestor.urn).startswith(CORE) for ancestor in services):
            known |= core_events()
        for _, transition in behaviour.transitions():
            name = event_name(transition.event)
            if name and transition.message is not None:
                text = f"a transition on {transition.message.name} and on the event {name!r}"
                yield Finding(transition, text, "event", "make two transitions of it")
            elif name and name not in known:
                text = f"'{behaviour.service.name}' has no internal event {name!r}"
                yield Finding(transition, text, "event", _suggestion(name, known))


@rule("JML345", "malformed guard", kinds=jaus.Service)
def guards(subject: Subject, service: jaus.Service) -> Iterator[Finding]:
    """A guard joins names of conditions by &&, || and !, with parentheses.

    Each name becomes a method. Arguments in parentheses behind a name are allowed and kept for
    the reader; the method is given the message and its sender.

    Bad: `guard="speed > 0"`

    Good: `guard="isControllingClient &amp;&amp; !isLocked"`
    """
    for behaviour in behaviours_of(subject, service):
        for _, transition in behaviour.transitions():
            try:
                parse_guard(transition.guard)
            except GuardError as error:
                hint = "names of conditions, joined by &&, || and !"
                yield Finding(transition, f"malformed guard: {error}", "guard", hint)


@rule("JML346", "state that is never entered", severity=Severity.WARNING, kinds=jaus.Service)
def reachable(subject: Subject, service: jaus.Service) -> Iterator[Finding]:
    """A state is initial, or a transition leads to it.

    Bad: a state `Locked` that is not initial and no target of a transition

    Good: a transition with `target="Locked"`
    """
    for behaviour in behaviours_of(subject, service):
        entered = {around for path in behaviour.entered() for around in _with_outer(path)}
        reported: set[str] = set()
        for path, state in behaviour.states():
            if path in entered or path in behaviour.machine.core_states:
                continue
            # Of states within each other, the outermost alone is told.
            if _is_foreign(behaviour, path) or not reported.isdisjoint(_with_outer(path)):
                continue
            reported.add(path)
            yield Finding(state, f"no transition leads to the state '{path}'", "name")


@rule("JML347", "transition that is never taken", severity=Severity.WARNING, kinds=jaus.Service)
def taken(subject: Subject, service: jaus.Service) -> Iterator[Finding]:
    """Transitions of a state are tried in their order; one without a guard is always taken.

    Of two transitions on the same message with the same guard, the first one is taken.

    Bad: a transition on LockBrake without a guard, and a second one on LockBrake after it

    Good: the one with the guard first
    """
    for behaviour in behaviours_of(subject, service):
        for _, state in behaviour.states():
            yield from _shadowed(state.transitions)
            yield from _shadowed(state.defaults)


@rule("JML348", "target, push and pop do not fit", kinds=jaus.Service)
def kinds(subject: Subject, service: jaus.Service) -> Iterator[Finding]:
    """A push has a target, a pop and an internal transition have none; push and pop go together.

    A push remembers the current state, and a pop returns to it.

    Bad: a machine with a transition of `kind="pop"` and none of `kind="push"`

    Good: `kind="push" target="Inspection"`, and `kind="pop"` in Inspection
    """
    for behaviour in behaviours_of(subject, service):
        used = {transition.kind.name for _, transition in behaviour.machine.transitions()}
        for _, transition in behaviour.transitions():
            kind = transition.kind.name
            name = described(transition)
            if kind == "push" and not transition.target:
                yield Finding(transition, f"the push on {name} has no target", "kind")
            elif kind in ("pop", "internal") and transition.target:
                yield Finding(transition, f"the {kind} transition on {name} has a target", "target")
            elif kind in ("push", "pop") and not {"push", "pop"} <= used:
                other = "push" if kind == "pop" else "pop"
                text = f"'{behaviour.machine.name}' has a {kind} on {name}, but no {other}"
                yield Finding(transition, text, "kind")


@rule("JML349", "not what the core services do", kinds=jaus.Service)
def core_states(subject: Subject, service: jaus.Service) -> Iterator[Finding]:
    """A machine named ReceiveFSM extends that of the core services, and keeps to its states.

    States of its own lie inside one of the innermost states of the core services that the service
    inherits: those of Management (Standby, Ready and so on), or of AccessControl (Available and
    NotAvailable). Of Management's states, a transition may enter Standby, Failure and Shutdown;
    into the others leads a message that the core services take. A service that inherits
    AccessControl alone may make control available or not, and let go of it. A machine of another
    name is independent.

    Bad: `<machines name="ReceiveFSM"><states name="Idle"/></machines>`

    Good: `<machines name="ReceiveFSM"><states name="Receiving.Ready.Controlled.Available.Ready">
    <states name="Idle"/></states></machines>`
    """
    for behaviour in behaviours_of(subject, service):
        if not behaviour.machine.extends_core:
            yield from _foreign_machine(behaviour)
        elif not any(str(ancestor.urn).startswith(CORE) for ancestor in lineage(behaviour.service)):
            text = f"'{behaviour.service.name}' inherits no core service whose {CORE_MACHINE}"
            yield Finding(behaviour.element, f"{text} it could extend", "name")
        else:
            yield from _foreign_states(behaviour)
            yield from _refused_targets(behaviour)


@rule(
    "JML350",
    "transition that the core services take",
    severity=Severity.WARNING,
    kinds=jaus.Service,
)
def core_messages(subject: Subject, service: jaus.Service) -> Iterator[Finding]:
    """Messages of the core services and of ListManager are taken by the runtime.

    The runtime follows AS5710. A transition of a service on one of these messages is not generated;
    use entry and exit actions of the core states instead.

    Bad: in Ready, a transition on Standby with the action stopMotor

    Good: the state Ready with the exit action stopMotor
    """
    for behaviour in behaviours_of(subject, service):
        for _, transition in behaviour.transitions():
            message = transition.message
            owner = None if message is None else message.eContainer()
            if message is None or owner is None:
                continue
            if owner.urn in SERVED_BY_RUNTIME:
                text = (
                    f"{message.name} is taken by {owner.name} of the runtime, not by a transition"
                )
                hint = "entry and exit actions of the core states tell what has happened"
                is_management = owner.name in ("AccessControl", "Management")
                yield Finding(transition, text, "message", hint if is_management else "")


def _element(behaviour: Behaviour, path: str) -> jaus.State | jaus.StateMachine:
    """Returns an element at which to point for a state, even one that only a path implies."""
    node = behaviour.machine.nodes.get(path)
    return node.elements[0] if node is not None and node.elements else behaviour.element


def _shadowed(transitions: Iterable[jaus.Transition]) -> Iterator[Finding]:
    earlier: dict[tuple[tuple[str, str], Guard | None], jaus.Transition] = {}
    for transition in transitions:
        try:
            guard = parse_guard(transition.guard)
        except GuardError:
            continue
        on, name = trigger(transition), described(transition)
        always, same = earlier.get((on, None)), earlier.get((on, guard))
        if always is not None:
            text = f"an earlier transition on {name} is always taken"
            note = Note(always, f"on {name}, without a guard")
            yield Finding(transition, text, related=(note,))
        elif same is not None:
            text = f"an earlier transition on {name} has the same guard"
            yield Finding(transition, text, "guard", related=(Note(same, f"on {name}", "guard"),))
        else:
            earlier[on, guard] = transition


def _foreign_machine(behaviour: Behaviour) -> Iterator[Finding]:
    outermost = core_machine(behaviour.service).states[0]
    for path, state in behaviour.states():
        if path.partition(".")[0] == outermost:
            text = f"'{behaviour.machine.name}' has the core state {outermost}"
            hint = f"name the machine {CORE_MACHINE} to extend the core services"
            yield Finding(state, text, "name", hint)
            return


def _foreign_states(behaviour: Behaviour) -> Iterator[Finding]:
    reported: set[str] = set()
    known = core_machine(None).states
    for path, state in behaviour.states():
        if not _is_foreign(behaviour, path) or not reported.isdisjoint(_with_outer(path)):
            continue
        reported.add(path)
        text, hint = f"the core services have no state '{path}'", _suggestion(path, known)
        if path in known:
            text = f"'{path}' is a state of core services that '{behaviour.service.name}' does not"
            text, hint = f"{text} inherit", "inherit Management"
        yield Finding(state, text, "name", hint)


def _refused_targets(behaviour: Behaviour) -> Iterator[Finding]:
    for path, transition in behaviour.transitions():
        machine, target = behaviour.machine, behaviour.target(path, transition)
        entered = machine.core_leaf(target) if target else None
        # A state that encloses core states is left from any of them.
        left = machine.core_leaf(path) or path
        if entered in (None, left) or machine.core.may_enter(left, entered):
            continue
        text = f"a transition may not enter '{entered}' from '{path}'"
        yield Finding(transition, text, "target", "only a message of the core services may")


def _is_foreign(behaviour: Behaviour, path: str) -> bool:
    machine = behaviour.machine
    if not machine.extends_core or path in machine.core_states:
        return False
    return machine.core_leaf(path) is None or path in core_machine(None).states


def _with_outer(path: str) -> Iterator[str]:
    """Yields the path of a state, and those of the states that it lies in."""
    while path:
        yield path
        path = path.rpartition(".")[0]


def _suggestion(name: str, known: Iterable[str]) -> str:
    close = difflib.get_close_matches(name, sorted(known), 1)
    return f"did you mean {close[0]!r}?" if close else ""

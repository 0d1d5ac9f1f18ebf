"""Lines in the views of services and of their machines: heritage, messages, transitions."""

from __future__ import annotations

from collections.abc import Iterator

from jausml.authoring.editing.commands import Add, Child, Set
from jausml.authoring.proposals.bridging import is_served
from jausml.authoring.proposals.elements import (
    AnswerError,
    Choice,
    Option,
    Options,
    Scope,
    everywhere,
)
from jausml.authoring.proposals.new_elements import free_code
from jausml.authoring.studio.views.spots import element_of
from jausml.language.metamodel import FeatureTable
from jausml.language.metamodel.classes import jaus
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.names import around, name_of
from jausml.language.model.refs import LIBRARY
from jausml.language.semantics.jaus.commands import is_command
from jausml.language.semantics.jaus.inheritance import lineage
from jausml.language.semantics.jaus.inherited_machines import (
    DEEPEST,
    Machine,
    canonical,
    core_events,
    event_name,
    machine_with,
)
from jausml.language.semantics.jaus.services import query_name
from jausml.views.diagrams.views.connections import PROVIDES, USES

_MARK = "!"
_INHERITS = f"{_MARK}inherits"
_QUERY, _REPORT = "Query", "Report"
_HOW = "draw from a service to what it shall inherit, or from a query to where its report shall be"


def join(scope: Scope, source: tuple[str, str], target: tuple[str, str]) -> Options:
    """Returns the changes that a line in the view of a service may mean.

    `target`: those where it ends; a box may be named by the reference to its service.
    """
    start = _element_of(scope, source[1] or _service_of(source[0]))
    heir = start if isinstance(start, jaus.Service) else start.eContainer()
    if not isinstance(heir, jaus.Service):
        return Options(refusal=_HOW)
    if scope.ref(heir).startswith(LIBRARY):
        refusal = f"{name_of(heir)} belongs to the shipped library, which is not changed here"
        return Options(refusal=refusal)
    if isinstance(start, jaus.MessageDef):
        return _partner(scope, heir, start)
    if _MARK in source[0]:
        return Options(refusal=_HOW)
    end = _element_of(scope, _service_of(target[0]))
    return inherit(scope, heir, end) if isinstance(end, jaus.Service) else Options(refusal=_HOW)


def inherit(scope: Scope, heir: jaus.Service, base: jaus.Service) -> Options:
    """Returns the change by which a service inherits another one instead of the present one."""
    if heir.inherits is base:
        return Options(refusal=f"{name_of(heir)} inherits {name_of(base)} already")
    if heir in lineage(base):
        return Options(refusal=f"{name_of(base)} inherits {name_of(heir)} itself")
    label = f"{name_of(heir)} inherits {name_of(base)} {base.version or ''}".strip()
    why = str(base.documentation or "")
    if heir.inherits is not None:
        why = f"instead of {name_of(heir.inherits)}; {why}"
    command = Set(scope.ref(heir), "inherits", (scope.ref(base),))
    return Options((Option(label, why, (command,), is_best=True),))


def heritage(scope: Scope, box: str) -> Iterator[Choice]:
    """Yields the services that the service of a box may inherit; none for rows."""
    own = _element_of(scope, _service_of(box))
    table = scope.model.metamodels.class_of(own)
    if isinstance(own, jaus.Service) and _MARK not in box:
        for choice in everywhere(scope, table, own):
            service = scope.find(choice.value)
            if isinstance(service, jaus.Service) and own not in lineage(service):
                yield choice


def cut(scope: Scope, line: str) -> Options:
    """Returns the changes that remove a line or row of no element: an inheritance, or a use."""
    for way in (PROVIDES, USES):
        owner, mark, service = line.partition(f"!{way}!")
        if mark:
            return _dropped(scope, owner, way, service)
    if not line.endswith(_INHERITS):
        return Options(refusal="this line follows from what it joins: delete one of its ends")
    heir = _element_of(scope, line.removesuffix(_INHERITS))
    if not isinstance(heir, jaus.Service) or heir.inherits is None:
        raise AnswerError("there is no such line any more")
    label = f"{name_of(heir)} no longer inherits {name_of(heir.inherits)}"
    command = Set(scope.ref(heir), "inherits")
    return Options((Option(label, "", (command,), is_best=True),))


def _dropped(scope: Scope, owner: str, way: str, which: str) -> Options:
    """A component that provides or uses a service no more; the service itself stays.

    `which`: its name and version.
    """
    own, name = _element_of(scope, owner), which.rpartition(" ")[0]
    services = list(getattr(own, way, ()))
    kept = [service for service in services if f"{name_of(service)} {service.version}" != which]
    if len(kept) == len(services):
        raise AnswerError("there is no such row any more")
    label = f"{name_of(own)} no longer {way} {name}; the service stays"
    command = Set(scope.ref(own), way, tuple(map(scope.ref, kept)))
    return Options((Option(label, "", (command,), is_best=True),))


def _service_of(box: str) -> str:
    return box.partition(_MARK)[0]


def _element_of(scope: Scope, identifier: str) -> EObject:
    """Returns the element of an id of the view, or of a reference."""
    try:
        return scope.find(identifier)
    except AnswerError:
        return element_of(scope, identifier)


def _partner(scope: Scope, service: jaus.Service, message: jaus.MessageDef) -> Options:
    """The report that answers a query, or the query that asks for a report."""
    name = name_of(message)
    if message in service.inputs and name.startswith(_QUERY):
        feature, wanted = "outputs", f"{_REPORT}{name.removeprefix(_QUERY)}"
        why = f"it answers {name}"
    elif message in service.outputs and name.startswith(_REPORT):
        feature, wanted = "inputs", query_name(message)
        why = f"it asks for {name}"
    else:
        return Options(refusal=f"only a query and its report belong together; {name} is neither")
    if any(name_of(output) == wanted for output in (*service.inputs, *service.outputs)):
        return Options(refusal=f"{name_of(service)} has its {wanted} already")
    code = free_code(scope.model)
    values = {"name": (wanted,), "code": (code,)}
    add = Add(scope.ref(service), feature, "jaus.MessageDef", values)
    return Options((Option(f"add {wanted}", why, (add,), is_best=True),))


_GUARD = "isControllingClient"
"""The guard that commands of machines in the states of the core have (rule JML351)."""


def lead(scope: Scope, element: jaus.StateMachine, source: str, target: str) -> Options:
    """Returns the transitions that may lead from a state to another, those of messages first.

    `target`: id of the box of the state that is entered; the same one is left and entered again.
    """
    if scope.ref(element).startswith(LIBRARY):
        refusal = f"{name_of(element)} belongs to the shipped library, which is not changed here"
        return Options(refusal=refusal)
    machine = machine_with(element)
    if machine is None:
        raise AnswerError(f"{name_of(element)} stands in no service")
    start, end = _path(machine, source), _path(machine, target)
    way = targets_from(machine, start).get(end, end)
    taken = set(_taken(machine, start))
    options = [
        Option(
            f"transition on {label}" + (" (again)" if key in taken else ""),
            why,
            (_added(scope, element, machine, start, values),),
        )
        for key, label, why, values in _triggers(scope, element, machine, way)
    ]
    # What is taken already needs another guard: it comes last.
    return Options(tuple(sorted(options, key=lambda option: option.label.endswith("(again)"))))


def usual_texts(element: EObject, feature: FeatureTable) -> list[Choice]:
    """Returns the usual texts of a transition: the states and the internal events there are."""
    if not isinstance(element, jaus.Transition) or feature.name not in ("target", "event"):
        return []
    names: list[str] = []
    state: EObject | None = element.eContainer()
    while isinstance(state, jaus.State):
        names.append(str(state.name))
        state = state.eContainer()
    machine = machine_with(state) if isinstance(state, jaus.StateMachine) else None
    if machine is None or not isinstance(state, jaus.StateMachine):
        return []
    if feature.name == "event":
        return [Choice(event, event) for event in events_of(state, machine)]
    source = ".".join(reversed(names))
    source = canonical(source) if machine.extends_core else source
    return [Choice(text, path) for path, text in targets_from(machine, source).items()]


def targets_from(machine: Machine, source: str) -> dict[str, str]:
    """Returns the shortest target that transitions of a state may write for each state."""
    shortest_names = {}
    for path in dict.fromkeys([*machine.nodes, *machine.core_states]):
        names = path.split(".")
        shorter = (".".join(names[at:]) for at in range(len(names) - 1, -1, -1))
        shortest_names[path] = next(
            (name for name in shorter if machine.resolve(source, name) == path), path
        )
    return shortest_names


def events_of(element: jaus.StateMachine, machine: Machine) -> list[str]:
    """Returns the names of the internal events that a machine is told of."""
    own = [name_of(event) for service in lineage(element.eContainer()) for event in service.events]
    return list(dict.fromkeys([*own, *(sorted(core_events()) if machine.extends_core else ())]))


def _path(machine: Machine, box: str) -> str:
    """Returns the path of the state of a box."""
    path = box.partition(_MARK)[2]
    if path not in machine.nodes and path not in machine.core_states:
        raise AnswerError("draw from a state to a state")
    if path.count(".") >= DEEPEST:
        raise AnswerError("that state lies too deep")
    return path


def _taken(machine: Machine, path: str) -> Iterator[str]:
    """Yields the triggers for which a state has a transition, whatever its guard."""
    node = machine.nodes.get(path)
    for state in node.elements if node is not None else ():
        for transition in (*state.transitions, *state.defaults):
            yield (
                name_of(transition.message)
                if transition.message is not None
                else event_name(transition.event)
            )


_Values = dict[str, tuple[str, ...]]


def _triggers(
    scope: Scope, element: jaus.StateMachine, machine: Machine, way: str
) -> Iterator[tuple[str, str, str, _Values]]:
    """Yields the possible triggers of a transition: key, label, reason, and the values it has."""
    for service in lineage(element.eContainer()):
        # What the runtime takes is no trigger (rule JML350).
        for message in () if is_served(service) else service.inputs:
            values: _Values = {"message": (scope.ref(message),), "target": (way,)}
            if is_command(message) and machine.extends_core:
                values["guard"] = (_GUARD,)
            why = str(message.documentation or "") or f"{name_of(service)} takes it"
            yield name_of(message), name_of(message), why, values
    for name in events_of(element, machine):
        yield name, name, "internal event", {"event": (name,), "target": (way,)}
    why = "on whatever no other transition of the state takes"
    yield "", "anything else", why, {"target": (way,)}


def _added(
    scope: Scope, element: jaus.StateMachine, machine: Machine, source: str, values: _Values
) -> Add:
    """Returns the command that adds a transition, with its state where the machine has none."""
    is_around = any(path.startswith(f"{source}.") for path in machine.nodes)
    feature = "defaults" if is_around else "transitions"
    node = machine.nodes.get(source)
    own = (
        [state for state in node.elements if around(state, jaus.StateMachine) is element]
        if node is not None
        else []
    )
    if own:
        return Add(scope.ref(own[0]), feature, "jaus.Transition", values)
    child = Child(feature, "jaus.Transition", values)
    return Add(scope.ref(element), "states", "jaus.State", {"name": (source,)}, (child,))

"""The views of a service and of its state machines: messages and events, states and transitions."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import partial
from itertools import pairwise

from jausml.language.metamodel.classes import jaus
from jausml.language.model.model import Model
from jausml.language.semantics.jaus.inheritance import lineage
from jausml.language.semantics.jaus.inherited_machines import DEEPEST, Machine, machine_with
from jausml.language.semantics.jaus.services import query_name
from jausml.views.diagrams.graph import Edge, End, Finding, Graph, Group, Node, Port
from jausml.views.diagrams.views.context import Builder, Context, details, name_of
from jausml.views.diagrams.views.members import Member, jaus_members

SERVICE, BODIES = "service:", "bodies:"
"""Prefixes of the name of a service in its views, without and with bodies of messages."""


def offered(
    model: Model, *, library: bool
) -> Iterator[tuple[tuple[str, ...], Callable[[Context], Graph]]]:
    """Yields the names of each service, by name, name and version, and URN, and its graph."""
    for service in model.instances(jaus.Service, library=library):
        if service.name:
            names = (service.name, f"{service.name}/{service.version}", service.urn)
            yield tuple(f"{SERVICE}{name}" for name in names), partial(graph, service=service)


def graph(context: Context, service: jaus.Service) -> Graph:
    """Returns the view of a service."""
    builder = Builder(context)
    chain = lineage(service)
    for ancestor in chain:
        _add_service(builder, ancestor, is_subject=ancestor is service)
    for heir, parent in pairwise(chain):
        own = context.id_of(heir)
        builder.edges.append(
            Edge(f"{own}!inherits", End(own), End(context.id_of(parent)), "inherits",
                 "inherits", ("inherits",))
        )  # fmt: skip
    return builder.graph(f"service {name_of(service)} {service.version or ''}".strip(), service)


def _add_service(builder: Builder, service: jaus.Service, *, is_subject: bool) -> None:
    context = builder.context
    own = context.id_of(service)
    kind = "subject" if is_subject else "service"
    builder.groups.append(Group(own, kind, f"{name_of(service)} {service.version or ''}"))
    builder.add(
        Node(
            own,
            "service",
            name_of(service),
            str(service.urn or ""),
            tuple(context.row(event, name_of(event), "internal event") for event in service.events),
            own,
            column=0,
            details=details(service),
            findings=context.findings(service, deep=False),
        )
    )
    has_bodies = is_subject and context.view.startswith(BODIES)
    takes = _messages(builder, service, service.inputs, "takes", 1, has_bodies=has_bodies)
    sends = _messages(builder, service, service.outputs, "sends", 2, has_bodies=has_bodies)
    if takes:
        builder.edges.append(Edge(f"{takes}!edge", End(own), End(takes), "owns", "takes"))
    reports = {name_of(output): output for output in service.outputs}
    queries: defaultdict[str, list[jaus.MessageDef]] = defaultdict(list)
    for query in service.inputs:
        queries[name_of(query)].append(query)
    for name, report in reports.items():
        for query in queries[query_name(report)]:
            builder.edges.append(
                Edge(
                    f"{context.id_of(query)}!{name}",
                    End(takes, context.id_of(query)),
                    End(sends, context.id_of(report)),
                    "answers",
                    "answered by",
                )
            )
    if sends and not any(edge.target.node == sends for edge in builder.edges):
        builder.edges.append(Edge(f"{sends}!edge", End(takes or own), End(sends), "owns", "sends"))


def _messages(
    builder: Builder,
    service: jaus.Service,
    messages: Iterable[jaus.MessageDef],
    way: str,
    column: int,
    *,
    has_bodies: bool,
) -> str:
    """Adds a box of messages, and returns its id, empty when there are none.

    `has_bodies`: whether the members of messages are shown too.
    """
    context = builder.context
    own = context.id_of(service)
    ports: list[Port] = []
    for message in messages:
        ports.append(_message(context, message))
        members = jaus_members(context, message) if has_bodies else ()
        ports += _body(context.id_of(message), members, 1)
    if not ports:
        return ""
    return builder.add(
        Node(f"{own}!{way}", "messages", way, ports=tuple(ports), group=own, column=column)
    )


def _body(message: str, members: Iterable[Member], depth: int) -> Iterator[Port]:
    for member in members:
        yield replace(member.port, id=f"{message}!{member.path}", depth=depth)
        yield from _body(message, member.inner, depth + 1)


def _message(context: Context, message: jaus.MessageDef) -> Port:
    mark = "command" if message.isCommand else ""
    return context.row(message, name_of(message), str(message.code or ""), mark, code=message.code)


def offered_machines(
    model: Model, *, library: bool
) -> Iterator[tuple[tuple[str, ...], Callable[[Context], Graph]]]:
    """Yields the names of each machine, by service and name, and by name alone, and its graph."""
    for state_machine in model.instances(jaus.StateMachine, library=library):
        service = state_machine.eContainer()
        if state_machine.name:
            names = (f"{name_of(service)}.{state_machine.name}", state_machine.name)
            yield (
                tuple(f"machine:{name}" for name in names),
                partial(machine_graph, element=state_machine),
            )


def machine_graph(context: Context, element: jaus.StateMachine) -> Graph:
    """Returns the view of a machine, with the one that it extends."""
    builder = Builder(context)
    machine = machine_with(element)
    if machine is not None:
        drawn = _drawn(machine)
        composite = {outer for path in drawn for outer in _enclosing(path)}
        for path in drawn:
            _add_state(builder, machine, path, is_composite=path in composite)
        for path in machine.nodes:
            _add_transitions(builder, machine, path)
    title = f"machine {name_of(element)} of {name_of(element.eContainer())}"
    return builder.graph(title, element, downwards=True)


def _drawn(machine: Machine) -> list[str]:
    """Returns the paths of the states that are shown, enclosing ones first."""
    core = [core_state for core_state in machine.core_states if core_state not in machine.nodes]
    targets = {
        machine.resolve(path, transition.target)
        for path, node in machine.nodes.items()
        for state in node.elements
        for transition in (*state.transitions, *state.defaults)
        if transition.target
    }
    paths = [*machine.nodes, *(state_path for state_path in core if state_path in targets)]
    enclosing = {outer for path in paths for outer in _enclosing(path)}
    ordered = dict.fromkeys([*paths, *sorted(enclosing)])
    return sorted(
        (state_path for state_path in ordered if state_path.count(".") < DEEPEST),
        key=lambda state_path: state_path.count("."),
    )


def _enclosing(path: str) -> Iterator[str]:
    """Yields the paths of the states that a state lies in."""
    while path := path.rpartition(".")[0]:
        yield path


def _id(builder: Builder, machine: Machine, path: str) -> str:
    return f"{builder.context.id_of(machine.elements[-1])}!{path}"


def _add_state(builder: Builder, machine: Machine, path: str, *, is_composite: bool) -> None:
    context = builder.context
    own = _id(builder, machine, path)
    outer, _, name = path.rpartition(".")
    around = _id(builder, machine, outer) if outer else ""
    node = machine.nodes.get(path)
    elements = node.elements if node is not None else []
    element = context.reference(elements[-1]) if elements else ""
    if is_composite:
        builder.groups.append(Group(own, "state", name, around, element=element))
    initial = machine.initial(outer) == path
    rows = [row for state in elements for row in _rows(context, machine, path, state)]
    if is_composite and not elements:
        return
    builder.add(
        Node(
            own,
            "state",
            f"{name} (all inside)" if is_composite else name,
            "initial" if initial else "",
            tuple(rows),
            own if is_composite else around,
            column=0 if initial and not is_composite else 1,
            is_initial=initial,
            details=tuple(detail for state in elements for detail in details(state)),
            findings=tuple(
                finding for state in elements for finding in context.findings(state, deep=False)
            ),
            element=element,
            key=context.key(elements[-1]) if elements else "",
        )
    )


def _rows(context: Context, machine: Machine, path: str, state: jaus.State) -> Iterator[Port]:
    """Yields the rows of a state: actions at entry and exit, and on triggers that keep it."""
    for word, actions in (("entry", state.entry), ("exit", state.exit)):
        for action in actions:
            yield context.row(action, f"{word} / {_action(action)}")
    for transition in (*state.transitions, *state.defaults):
        target = machine.resolve(path, transition.target) if transition.target else None
        if target is None:
            goal = f"\N{RIGHTWARDS ARROW} {transition.target}" if transition.target else ""
            wrong = Finding("error", "", f"there is no state '{transition.target}'")
            findings = context.findings(transition) or ((wrong,) if transition.target else ())
            first, *more = [*_labels(transition), *filter(None, (goal,))]
            yield Port(context.id_of(transition), first, transition.kind.name,
                       details=details(transition), findings=findings)  # fmt: skip
            # A guard and what is done have rows of their own: together they are too long to read.
            for number, text in enumerate(more):
                yield Port(f"{context.id_of(transition)}!{number}", text, depth=1,
                           element=context.reference(transition))  # fmt: skip


def _add_transitions(builder: Builder, machine: Machine, path: str) -> None:
    context = builder.context
    own = _id(builder, machine, path)
    for state in machine.nodes[path].elements:
        for transition in (*state.transitions, *state.defaults):
            target = machine.resolve(path, transition.target) if transition.target else None
            end = _id(builder, machine, target) if target is not None else ""
            end = _inside(builder, machine, target, end) if target is not None else ""
            if end and own in builder.boxes:
                labels = tuple(_labels(transition))
                builder.edges.append(
                    Edge(
                        context.id_of(transition),
                        End(own),
                        End(end),
                        "transition",
                        labels[0],
                        labels,
                        details=details(transition, kind=transition.kind.name, target=target),
                        findings=context.findings(transition),
                    )
                )


def _inside(builder: Builder, machine: Machine, target: str, end: str) -> str:
    """Returns the box of a state, or of the innermost that entering it enters."""
    if end in builder.boxes:
        return end
    inner = _id(builder, machine, machine.innermost(target))
    if inner in builder.boxes:
        return inner
    below = [box for box in builder.boxes if box.startswith(f"{end}.")]
    return below[0] if below else ""


def _labels(transition: jaus.Transition) -> Iterator[str]:
    """Yields the trigger of a transition, its guard and its actions."""
    if transition.message is not None:
        yield name_of(transition.message)
    else:
        yield str(transition.event or "anything else")
    if transition.guard:
        yield f"[{transition.guard}]"
    if transition.kind.name in ("push", "pop"):
        yield f"({transition.kind.name})"
    if transition.actions:
        yield "/ " + ", ".join(_action(action) for action in transition.actions)


def _action(action: jaus.Action) -> str:
    sends = f" sends {name_of(action.sends)}" if action.sends is not None else ""
    return f"{action.name or '?'}{sends}"

"""The view of a service: what it inherits, the messages that it takes and sends, its events."""

from __future__ import annotations

from collections import defaultdict
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import jaus
from jausml.language.semantics.jaus.services import lineage, query_name
from jausml.views.diagrams.graph import Edge, End, Graph, Group, Node, Port
from jausml.views.diagrams.views.context import Builder, details, name_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from jausml.language.model.model import Model
    from jausml.views.diagrams.views.context import Context


def offered(
    model: Model, *, library: bool
) -> Iterator[tuple[tuple[str, ...], Callable[[Context], Graph]]]:
    """Yields the names of each service, by name, name and version, and URN, and its graph."""
    for each in model.instances(jaus.Service, library=library):
        if each.name:
            names = (each.name, f"{each.name}/{each.version}", each.urn)
            yield tuple(f"service:{name}" for name in names), partial(graph, service=each)


def graph(context: Context, service: jaus.Service) -> Graph:
    """Returns the view of a service."""
    builder = Builder(context)
    chain = lineage(service)
    for each in chain:
        _add_service(builder, each)
    for heir, parent in pairwise(chain):
        own = context.id_of(heir)
        builder.edges.append(
            Edge(f"{own}!inherits", End(own), End(context.id_of(parent)), "inherits",
                 "inherits", ("inherits",))
        )  # fmt: skip
    return builder.graph(f"service {name_of(service)} {service.version or ''}".strip(), service)


def _add_service(builder: Builder, service: jaus.Service) -> None:
    context = builder.context
    own = context.id_of(service)
    builder.groups.append(Group(own, "service", f"{name_of(service)} {service.version or ''}"))
    builder.add(
        Node(
            own,
            "service",
            name_of(service),
            str(service.urn or ""),
            tuple(context.row(each, name_of(each), "internal event") for each in service.events),
            own,
            column=0,
            details=details(service),
            findings=context.findings(service, deep=False),
        )
    )
    takes = _messages(builder, service, service.inputs, "takes", 1)
    sends = _messages(builder, service, service.outputs, "sends", 2)
    if takes:
        builder.edges.append(Edge(f"{takes}!edge", End(own), End(takes), "owns", "takes"))
    reports = {name_of(each): each for each in service.outputs}
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
    if sends and not any(each.target.node == sends for each in builder.edges):
        builder.edges.append(Edge(f"{sends}!edge", End(takes or own), End(sends), "owns", "sends"))


def _messages(
    builder: Builder,
    service: jaus.Service,
    messages: Iterable[jaus.MessageDef],
    way: str,
    column: int,
) -> str:
    """Adds a box of messages, and returns its id, empty when there are none."""
    context = builder.context
    own = context.id_of(service)
    ports = tuple(_message(context, each) for each in messages)
    if not ports:
        return ""
    return builder.add(Node(f"{own}!{way}", "messages", way, ports=ports, group=own, column=column))


def _message(context: Context, message: jaus.MessageDef) -> Port:
    mark = "command" if message.isCommand else ""
    return context.row(message, name_of(message), str(message.code or ""), mark, code=message.code)

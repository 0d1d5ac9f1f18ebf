"""The system view: components, bridges with their connections, ROS nodes, and what flows."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Sequence

from jausml.language.metamodel.classes import bridge, jaus, ros
from jausml.language.metamodel.classes import system as systems
from jausml.language.model.model import Model
from jausml.language.semantics.hosts import host_of
from jausml.language.semantics.paths.ros_paths import ros_name
from jausml.views.diagrams.graph import (
    BRIDGE_COLUMN,
    JAUS_COLUMN,
    ROS_COLUMN,
    Edge,
    End,
    Graph,
    Group,
    Port,
)
from jausml.views.diagrams.graph import Node as Box
from jausml.views.diagrams.views import connections
from jausml.views.diagrams.views.context import Builder, Context, details, name_of


def participants(model: Model) -> Sequence[jaus.Component | ros.Node]:
    """Returns the components, bridges and nodes of a model, the library's left out."""
    return [
        *model.instances(jaus.Component, library=False),
        *model.instances(ros.Node, library=False),
    ]


def graph(context: Context) -> Graph:
    """Returns the system view."""
    builder = Builder(context)
    members = participants(context.model)
    boxes = [_box(context, participant) for participant in members]
    _add_hosts(context, builder, {node.group for node in boxes})
    for box in boxes:
        builder.add(box)
    for participant in members:
        if isinstance(participant, ros.Node):
            _add_endpoints(builder, participant)
    for participant in members:
        if isinstance(participant, jaus.Component):
            for connection in participant.connections:
                connections.add_service_connection(builder, participant, connection)
            _add_control(builder, participant)
        if isinstance(participant, bridge.Bridge):
            connections.add_bridge(builder, participant)
    for participant in members:
        if isinstance(participant, jaus.Component):
            connections.add_idle_services(builder, participant)
    _add_topics(
        builder, [participant for participant in members if isinstance(participant, ros.Node)]
    )
    root = context.model.root
    name = name_of(root) if isinstance(root, systems.System) else context.view
    return builder.graph(f"system {name}" if isinstance(root, systems.System) else name)


def _add_hosts(context: Context, builder: Builder, used: Collection[str]) -> None:
    for host in context.model.instances(systems.Host, library=False):
        transport = host.transport.name
        title = f"host {name_of(host)} ({transport})"
        if context.id_of(host) in used:
            builder.groups.append(Group(context.id_of(host), "host", title))
        else:
            # There is no frame around nothing: until something runs there it is a box.
            builder.add(Box(context.id_of(host), "host", title, "nothing runs here yet"))


def _box(context: Context, element: jaus.Component | ros.Node) -> Box:
    group = ""
    owner = element.eContainer()
    if isinstance(owner, systems.System):
        host = host_of(owner, element)
        group = context.id_of(host) if host is not None else ""
    if isinstance(element, ros.Node):
        return Box(
            context.id_of(element),
            "node",
            name_of(element),
            f"ROS node {element.namespace or ''}".strip(),
            group=group,
            column=ROS_COLUMN,
            details=details(element),
            findings=context.findings(element),
        )
    is_bridge = isinstance(element, bridge.Bridge)
    words = "bridge" if is_bridge else "JAUS component"
    return Box(
        context.id_of(element),
        "bridge" if is_bridge else "component",
        name_of(element),
        f"{'external ' if element.external else ''}{words} {element.address or ''}".strip(),
        group=group,
        column=BRIDGE_COLUMN if is_bridge else JAUS_COLUMN,
        details=details(
            element,
            provides=", ".join(name_of(provide) for provide in element.provides),
            uses=", ".join(name_of(service) for service in element.uses),
        ),
        # What a bridge has in its connections is told there.
        findings=context.findings(element, *element.connections, deep=False)
        if is_bridge
        else context.findings(element),
    )


def _add_endpoints(builder: Builder, node: ros.Node) -> None:
    context = builder.context
    topics = ("publishers", "publishes"), ("subscriptions", "subscribes")
    services = ("serviceServers", "serves"), ("serviceClients", "calls")
    for named, ends in (("topic", topics), ("service", services)):
        for feature, way in ends:
            for endpoint in getattr(node, feature):
                name, kind = connections.topic(getattr(endpoint, named), node), _type(endpoint.type)
                quality = connections.qos(endpoint.qos) if named == "topic" else ""
                more = details(endpoint, way=way, type=kind, QoS=quality)
                port = Port(context.id_of(endpoint), name, kind, details=more)
                builder.put(context.id_of(node), port)
                builder.endpoints.append((name, way, End(context.id_of(node), port.id)))


def _type(kind: ros.MessageType | ros.ServiceType | None) -> str:
    return ros_name(kind) if kind is not None else "?"


def _add_control(builder: Builder, component: jaus.Component) -> None:
    context = builder.context
    for index, other in enumerate(component.controls):
        if context.id_of(other) in builder.boxes:
            builder.edges.append(
                Edge(
                    f"{context.id_of(component)}!controls.{index}",
                    End(context.id_of(component)),
                    End(context.id_of(other)),
                    "control",
                    "control",
                    ("controls",),
                )
            )


def _add_topics(builder: Builder, nodes: Sequence[ros.Node]) -> None:
    """Adds the topics and calls among ROS nodes."""
    inside = {builder.context.id_of(node) for node in nodes}
    ends = [endpoint for endpoint in builder.endpoints if endpoint[2].node in inside]
    pairs = (("publishes", "subscribes", "topic"), ("calls", "serves", "call"))
    ends_by_name: defaultdict[tuple[str, str], list[End]] = defaultdict(list)
    for name, way, end in ends:
        ends_by_name[name, way].append(end)
    for name, way, start in ends:
        for source_way, target_way, kind in pairs:
            for end in ends_by_name[name, target_way] if way == source_way else ():
                identifier = f"{start.port}!{end.port}"
                builder.edges.append(Edge(identifier, start, end, kind, name))

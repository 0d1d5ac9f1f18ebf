"""`jausml new bridge`, `connection`, `component`, `node`, `service`: the parts of a system."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.cli.authoring.new import (
    add_to,
    graph_options,
    model_option,
    pairs,
    place_for,
    report,
    stopping,
    topic_options,
)

if TYPE_CHECKING:
    from jausml.authoring.editing.commands import Add, Child, Command
    from jausml.authoring.projects.places import Opened
    from jausml.cli.authoring.new import Choosing


@click.command("service")
@click.argument("name", metavar="NAME")
@click.option(
    "--message",
    "messages",
    metavar="NAME",
    multiple=True,
    help="Message, such as ReportDepth or SetDepth; may be repeated.",
)
@click.option(
    "--urn",
    default="",
    show_default=False,
    metavar="URN",
    help="URN, by default urn:example:SYSTEM:NAME.",
)
@click.option(
    "--inherits",
    default="",
    show_default=False,
    metavar="SERVICE",
    help="Name or URN of the service that it extends, or none; by default a core service.",
)
@model_option
def service(
    name: str, messages: tuple[str, ...], urn: str, inherits: str, model: Path | None
) -> None:
    """Add a JAUS service named NAME with messages, in its own service set.

    A FILE that has a service set and no system gets the service in that set, and so does a FILE
    that does not exist yet.

    The name of a message determines its kind: Query..., Report..., Confirm... and Reject...,
    otherwise a command. Each report gets the query that asks for it and an example of a field, and
    each message a code that is free in the project and the library; its fields are written in the
    model. A service with commands inherits Management; one without commands inherits Events, so
    that clients can subscribe to its reports. Without --message, the service gets one report.

    Exit status: 0 done, 2 usage or environment, 3 internal error.
    """
    from jausml.authoring.proposals.system_parts import new_service

    additions: list[Add] = []

    def commands(at: Opened) -> list[Command]:
        scope, own = at.scope_without_maps, at.home_of_services
        additions.append(new_service(scope, own, name, messages, urn=urn, inherits=inherits))
        return [*additions]

    def show() -> None:
        [service] = additions if additions[0].feature != "serviceSets" else additions[0].children
        for child in service.children:
            click.echo(_message_line(child))

    add_to(model, f"Add service {name}", commands, show, is_of_services=True)


def _message_line(message: Child) -> str:
    """Returns the line of a message: code, name, and fields."""
    fields = [child.values["name"][0] for body in message.children for child in body.children]
    way = "sends" if message.feature == "outputs" else "takes"
    head = f"{way} {message.values['code'][0]} {message.values['name'][0]}"
    return f"{head}: {', '.join(fields)}" if fields else head


@click.command("component")
@click.argument("name", metavar="NAME")
@click.option(
    "--provides",
    metavar="SERVICE",
    multiple=True,
    help="Name or URN of a service; may be repeated.",
)
@click.option(
    "--uses", metavar="SERVICE", multiple=True, help="Name or URN of a service; may be repeated."
)
@click.option("--address", metavar="ID", help="JAUS id; by default, a free one.")
@click.option(
    "--simulated",
    is_flag=True,
    help="Until its methods are written, keep what it is told, and report it.",
)
@model_option
def component(
    name: str,
    provides: tuple[str, ...],
    uses: tuple[str, ...],
    address: str | None,
    simulated: bool,
    model: Path | None,
) -> None:
    """Add a JAUS component named NAME, with services of the model or the library.

    Exit status: 0 done, 2 usage or environment, 3 internal error.
    """
    from jausml.authoring.projects.adding import check_name
    from jausml.authoring.proposals.system_parts import new_component

    def commands(at: Opened) -> list[Command]:
        check_name(name, at.system)
        scope = at.scope_without_maps
        addition = new_component(
            scope,
            at.system,
            name,
            provides=provides,
            uses=uses,
            address=address or "",
            simulated=simulated,
        )
        return [addition]

    add_to(model, f"Add component {name}", commands)


_EXAMPLE = "cmd_vel:geometry_msgs/Twist"


@click.command("node")
@click.argument("name", metavar="NAME")
@click.option(
    "--publishes", metavar="TOPIC:TYPE", multiple=True, help="Topic and its type; may be repeated."
)
@click.option(
    "--subscribes", metavar="TOPIC:TYPE", multiple=True, help="Topic and its type; may be repeated."
)
@model_option
def node(
    name: str, publishes: tuple[str, ...], subscribes: tuple[str, ...], model: Path | None
) -> None:
    """Add a ROS node named NAME, for which code with a skeleton is generated.

    Exit status: 0 done, 2 usage or environment, 3 internal error.
    """
    from jausml.authoring.projects.adding import check_name
    from jausml.authoring.proposals.system_parts import new_node

    published = pairs(publishes, ":", _EXAMPLE)
    heard = pairs(subscribes, ":", _EXAMPLE)

    def commands(at: Opened) -> list[Command]:
        check_name(name, at.system)
        scope = at.scope_without_maps
        return [new_node(scope, at.system, name, publishes=published, subscribes=heard)]

    add_to(model, f"Add node {name}", commands)


@click.command("bridge")
@click.argument("name", metavar="NAME")
@click.argument("words", metavar="[TOPIC:TYPE[:MAP,...]]...", nargs=-1)
@click.option(
    "--topics", "by_topics", is_flag=True, help="Read the arguments as topics (the default)."
)
@graph_options
@click.option("--address", metavar="ID", help="JAUS id; by default, a free one.")
@click.option(
    "--namespace",
    metavar="NAMESPACE",
    help="Take the topics of one robot of several from ROS: those in this namespace; / is the "
    "root.",
)
@topic_options
@model_option
def bridge(
    name: str,
    words: tuple[str, ...],
    by_topics: bool,
    from_graph: bool,
    seconds: float,
    address: str | None,
    namespace: str | None,
    choosing: Choosing,
    model: Path | None,
) -> None:
    """Add a bridge named NAME that carries ROS topics by ready maps.

    For each topic, proposes service, map, direction, exchange and quality of service. If several
    maps fit, asks which one to use; --yes takes the likeliest, and TOPIC:TYPE:MAP names one. A
    topic whose name does not suggest a command becomes a report, which moves nothing. A value of
    std_msgs is left out unless its name says what that of a map does, or you name the map.

    With --from-graph, lists the running ROS topics, services and actions, the joints and frames
    that messages name, and the parameters that say something for a model. Takes types, directions,
    quality of service and names of joints and frames from them. What no ready map carries is left
    out, with the reason and the command that comes next. Limits and time-outs of the robot are
    shown and never filled in. Where several robots run, --namespace says which one is meant.

    Exit status: 0 done, 2 usage or environment, 3 internal error.
    """
    from jausml.authoring.projects.adding import add_bridge, ready_maps, scope_of
    from jausml.cli.authoring import running
    from jausml.cli.authoring.topics import (
        chosen_crossings,
        show_chosen,
        show_unanswered,
        show_undecided,
        topics_of,
    )

    if by_topics and from_graph:
        raise click.UsageError("--topics and --from-graph exclude each other")
    if not words and not from_graph:
        raise click.UsageError("name topics, such as cmd_vel:geometry_msgs/Twist")
    if namespace is not None and (words or not from_graph):
        raise click.UsageError("--namespace goes with --from-graph and without named topics")
    with stopping():
        place = place_for(model)
        scope = scope_of(place)
        left = None
        if from_graph:
            here = running.what_runs_here(seconds)
            topics = running.topics_in(here, words)
            if not words:
                topics = running.of_one_robot(topics, namespace)
                running.show_left(here, scope, namespace or "")
                left = running.left_topic(scope)
        else:
            topics = topics_of(words)
        chosen = chosen_crossings(topics, ready_maps(scope), choosing, left)
        written = add_bridge(place, name, chosen, topics, address or "", namespace or "")
    show_chosen(chosen, topics)
    show_unanswered(chosen)
    report(place, written)
    show_undecided(chosen)


@click.command("connection")
@click.argument("words", metavar="TOPIC:TYPE[:MAP,...]...", nargs=-1, required=True)
@click.option(
    "--bridge", metavar="NAME", help="Bridge that gets the connections, if there are several."
)
@graph_options
@topic_options
@model_option
def connection(
    words: tuple[str, ...],
    bridge: str | None,
    from_graph: bool,
    seconds: float,
    choosing: Choosing,
    model: Path | None,
) -> None:
    """Add connections to a bridge, which carry further ROS topics by ready maps.

    Proposes a connection for each topic, as `jausml new bridge` does, and adds the services that
    the bridge needs for it.

    Exit status: 0 done, 2 usage or environment, 3 internal error.
    """
    from jausml.authoring.projects.adding import add_connections, namespace_of, ready_maps, scope_of
    from jausml.cli.authoring import running
    from jausml.cli.authoring.topics import (
        chosen_crossings,
        show_chosen,
        show_undecided,
        topics_of,
    )

    with stopping():
        place = place_for(model)
        space = namespace_of(place, bridge or "")
        if from_graph:
            topics = running.topics_in(running.what_runs_here(seconds), words, space)
        else:
            topics = topics_of(words)
        maps = ready_maps(scope_of(place))
        chosen = chosen_crossings(topics, maps, choosing)
        written = add_connections(place, bridge or "", chosen, topics)
    show_chosen(chosen, topics)
    report(place, written)
    show_undecided(chosen)

"""`jausml new bridge` and `new connection`: topics that a bridge carries, named or running."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from jausml.cli.authoring.new import model_option, place_for, report, stopping
from jausml.cli.authoring.running import (
    graph_options,
    left_topic,
    show_left,
    topics_in,
    what_runs_here,
)
from jausml.cli.authoring.topics import (
    chosen_crossings,
    show_chosen,
    show_unanswered,
    show_undecided,
    topic_options,
    topics_of,
)

if TYPE_CHECKING:
    from pathlib import Path


@click.command("bridge")
@click.argument("name", metavar="NAME")
@click.argument("words", metavar="[TOPIC:TYPE[:MAP,...]]...", nargs=-1)
@click.option(
    "--topics", "by_topics", is_flag=True, help="Read the arguments as topics (the default)."
)
@graph_options
@click.option("--address", metavar="ID", help="JAUS id; by default, a free one.")
@topic_options
@model_option
def bridge(
    name: str,
    words: tuple[str, ...],
    by_topics: bool,
    from_graph: bool,
    seconds: float,
    address: str | None,
    side: str,
    yes: bool,
    holds: tuple[str, ...],
    joints: tuple[str, ...],
    model: Path | None,
) -> None:
    """Add a bridge named NAME that carries ROS topics by ready maps.

    For each topic, proposes service, map, direction, exchange and quality of service. If several
    maps fit, asks which one to use; --yes takes the likeliest, and TOPIC:TYPE:MAP names one. A
    topic whose name does not suggest a command becomes a report, which moves nothing.

    With --from-graph, lists the running ROS topics, services and actions, the joints and frames
    that messages name, and the parameters that say something for a model. Takes types, directions,
    quality of service and names of joints and frames from them. What no ready map carries is left
    out, with the reason and the command that comes next. Limits and time-outs of the robot are
    shown and never filled in.

    Exit status: 0 done, 2 usage or environment, 3 internal error.
    """
    from jausml.authoring.projects.adding import add_bridge, ready_maps, scope_of

    if by_topics and from_graph:
        raise click.UsageError("--topics and --from-graph exclude each other")
    if not words and not from_graph:
        raise click.UsageError("name topics, such as cmd_vel:geometry_msgs/Twist")
    with stopping():
        place = place_for(model)
        scope = scope_of(place)
        left = None
        if from_graph:
            running = what_runs_here(seconds)
            topics = topics_in(running, words)
            if not words:
                show_left(running, scope)
                left = left_topic(scope)
        else:
            topics = topics_of(words)
        chosen = chosen_crossings(
            topics, ready_maps(scope), side=side, yes=yes, holds=holds, joints=joints, left_out=left
        )
        files = add_bridge(place, name, chosen, topics, address or "")
    show_chosen(chosen, topics)
    show_unanswered(chosen)
    report(place, files)
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
    side: str,
    yes: bool,
    holds: tuple[str, ...],
    joints: tuple[str, ...],
    model: Path | None,
) -> None:
    """Add connections to a bridge, which carry further ROS topics by ready maps.

    Proposes a connection for each topic, as `jausml new bridge` does, and adds the services that
    the bridge needs for it.

    Exit status: 0 done, 2 usage or environment, 3 internal error.
    """
    from jausml.authoring.projects.adding import (
        add_connections,
        namespace_of,
        ready_maps,
        scope_of,
    )

    with stopping():
        place = place_for(model)
        space = namespace_of(place, bridge or "")
        if from_graph:
            topics = topics_in(what_runs_here(seconds), words, space)
        else:
            topics = topics_of(words)
        maps = ready_maps(scope_of(place))
        chosen = chosen_crossings(topics, maps, side=side, yes=yes, holds=holds, joints=joints)
        files = add_connections(place, bridge or "", chosen, topics)
    show_chosen(chosen, topics)
    report(place, files)
    show_undecided(chosen)

"""`jausml new bridge`: a bridge of topics."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from jausml.cli.graph import graph_options, topics_that_run
from jausml.cli.new_places import model_option, place_for, report, stopping
from jausml.cli.topics import (
    chosen_crossings,
    tell,
    tell_unanswered,
    tell_undecided,
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
def command(
    name: str,
    words: tuple[str, ...],
    by_topics: bool,
    from_graph: bool,
    seconds: float,
    address: str | None,
    side: str,
    yes: bool,
    holds: tuple[str, ...],
    model: Path | None,
) -> None:
    """Add a bridge named NAME that carries ROS topics by ready maps.

    For each topic, proposes service, map, direction, exchange and quality of service. If several
    maps fit, asks which one to use; --yes takes the likeliest, and TOPIC:TYPE:MAP names one. A
    topic whose name does not suggest a command becomes a report, which moves nothing.

    With --from-graph, lists the running ROS topics, and takes types, directions and quality of
    service from them. Topics without a ready map are left out, with a message.

    Exit status: 0 done, 2 usage or environment, 3 internal error.
    """
    from jausml.authoring.projects.adding import add_bridge, ready_maps

    if by_topics and from_graph:
        raise click.UsageError("--topics and --from-graph exclude each other")
    if not words and not from_graph:
        raise click.UsageError("name topics, such as cmd_vel:geometry_msgs/Twist")
    with stopping():
        place = place_for(model)
        topics = topics_that_run(words, seconds) if from_graph else topics_of(words)
        chosen = chosen_crossings(
            topics, ready_maps(place), side=side, yes=yes, holds=holds, all_needed=bool(words)
        )
        files = add_bridge(place, name, chosen, topics, address or "")
    tell(chosen, topics)
    tell_unanswered(chosen)
    report(place, files)
    tell_undecided(chosen)

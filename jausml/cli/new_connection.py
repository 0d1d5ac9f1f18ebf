"""`jausml new connection`: further topics for a bridge."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from jausml.cli.graph import graph_options, topics_that_run
from jausml.cli.new_places import model_option, place_for, report, stopping
from jausml.cli.topics import chosen_crossings, tell, tell_undecided, topic_options, topics_of

if TYPE_CHECKING:
    from pathlib import Path


@click.command("connection")
@click.argument("words", metavar="TOPIC:TYPE[:MAP,...]...", nargs=-1, required=True)
@click.option(
    "--bridge", metavar="NAME", help="Bridge that gets the connections, if there are several."
)
@graph_options
@topic_options
@model_option
def command(
    words: tuple[str, ...],
    bridge: str | None,
    from_graph: bool,
    seconds: float,
    side: str,
    yes: bool,
    holds: tuple[str, ...],
    model: Path | None,
) -> None:
    """Add connections to a bridge, which carry further ROS topics by ready maps.

    Proposes a connection for each topic, as `jausml new bridge` does, and adds the services that
    the bridge needs for it.

    Exit status: 0 done, 2 usage or environment, 3 internal error.
    """
    from jausml.authoring.projects.adding import add_connections, namespace_of, ready_maps

    with stopping():
        place = place_for(model)
        space = namespace_of(place, bridge or "")
        topics = topics_that_run(words, seconds, space) if from_graph else topics_of(words)
        chosen = chosen_crossings(topics, ready_maps(place), side=side, yes=yes, holds=holds)
        files = add_connections(place, bridge or "", chosen, topics)
    tell(chosen, topics)
    report(place, files)
    tell_undecided(chosen)

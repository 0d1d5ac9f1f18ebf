"""`jausml new node`: a node of ROS."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from jausml.cli.new_places import model_option, pairs, place_for, report, stopping

if TYPE_CHECKING:
    from pathlib import Path

    from jausml.authoring.editing.commands import Command
    from jausml.authoring.projects.places import Opened

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
def command(
    name: str, publishes: tuple[str, ...], subscribes: tuple[str, ...], model: Path | None
) -> None:
    """Add a ROS node named NAME, for which code with a skeleton is generated.

    Exit status: 0 done, 2 usage or environment, 3 internal error.
    """
    from jausml.authoring.projects.adding import add, check_name
    from jausml.authoring.proposals.participants import new_node

    published = pairs(publishes, ":", _EXAMPLE)
    heard = pairs(subscribes, ":", _EXAMPLE)

    def commands(at: Opened) -> list[Command]:
        check_name(name, at.system)
        return [new_node(at.scope, at.system, name, publishes=published, subscribes=heard)]

    with stopping():
        place = place_for(model)
        report(place, add(place, f"Add node {name}", commands))

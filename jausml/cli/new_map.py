"""`jausml new map`: a map between a JAUS message and a ROS type."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from jausml.cli.new_places import model_option, pairs, place_for, report, stopping

if TYPE_CHECKING:
    from pathlib import Path

    from jausml.editing.commands import Command
    from jausml.projects.places import Opened

_EXAMPLE = "twist.linear.x=Velocity_X"


@click.command("map")
@click.argument("name", metavar="NAME")
@click.argument("message", metavar="MESSAGE")
@click.argument("kind", metavar="TYPE")
@click.option(
    "--to-ros",
    metavar="TARGET=SOURCE",
    multiple=True,
    help="Assignment to a member of the ROS type from a field of the message; may be repeated.",
)
@click.option(
    "--to-jaus",
    metavar="TARGET=SOURCE",
    multiple=True,
    help="Assignment to a field of the message from a member of the ROS type; may be repeated.",
)
@click.option("--bridge", metavar="NAME", help="Bridge that gets the map, if there are several.")
@model_option
def command(
    name: str,
    message: str,
    kind: str,
    to_ros: tuple[str, ...],
    to_jaus: tuple[str, ...],
    bridge: str | None,
    model: Path | None,
) -> None:
    """Add a map named NAME to a bridge, between MESSAGE and TYPE.

    `jausml validate` reports what the map leaves empty, and where units, axes or ranges need a
    conversion. `jausml list maps` lists the ready maps.

    Exit status: 0 done, 2 usage or environment, 3 internal error.
    """
    from jausml.projects.adding import add, bridge_in
    from jausml.proposals.parts import new_map

    ros, jaus = pairs(to_ros, "=", _EXAMPLE), pairs(to_jaus, "=", _EXAMPLE)

    def commands(at: Opened) -> list[Command]:
        owner = bridge_in(at, bridge or "")
        return [new_map(at.scope, owner, name, message, kind, to_ros=ros, to_jaus=jaus)]

    with stopping():
        place = place_for(model)
        report(place, add(place, f"Add map {name}", commands))

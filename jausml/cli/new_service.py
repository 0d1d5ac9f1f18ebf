"""`jausml new service`: a JAUS service of one's own."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from jausml.cli.new_places import model_option, pairs, place_for, report, stopping

if TYPE_CHECKING:
    from pathlib import Path

    from jausml.editing.commands import Command
    from jausml.projects.places import Opened

_EXAMPLE = "SetLamp:D100"


@click.command("service")
@click.argument("name", metavar="NAME")
@click.option(
    "--urn",
    required=True,
    metavar="URN",
    help="URN of the service, such as urn:example:light:Lamp.",
)
@click.option("--inherits", metavar="SERVICE", help="Name or URN of the service that it extends.")
@click.option(
    "--takes", metavar="MESSAGE:CODE", multiple=True, help="Message and its code; may be repeated."
)
@click.option(
    "--sends", metavar="MESSAGE:CODE", multiple=True, help="Message and its code; may be repeated."
)
@model_option
def command(
    name: str,
    urn: str,
    inherits: str | None,
    takes: tuple[str, ...],
    sends: tuple[str, ...],
    model: Path | None,
) -> None:
    """Add a JAUS service named NAME in its own service set, with empty messages.

    Exit status: 0 done, 2 usage or environment, 3 internal error.
    """
    from jausml.projects.adding import add
    from jausml.proposals.parts import new_service

    inputs, outputs = pairs(takes, ":", _EXAMPLE), pairs(sends, ":", _EXAMPLE)

    def commands(at: Opened) -> list[Command]:
        made = new_service(
            at.scope, at.system, name, urn, inherits=inherits or "", takes=inputs, sends=outputs
        )
        return [made]

    with stopping():
        place = place_for(model)
        report(place, add(place, f"Add service {name}", commands))

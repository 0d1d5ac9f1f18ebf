"""`jausml new component`: a JAUS component."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from jausml.cli.new_places import model_option, place_for, report, stopping

if TYPE_CHECKING:
    from pathlib import Path

    from jausml.authoring.editing.commands import Command
    from jausml.authoring.projects.places import Opened


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
@model_option
def command(
    name: str,
    provides: tuple[str, ...],
    uses: tuple[str, ...],
    address: str | None,
    model: Path | None,
) -> None:
    """Add a JAUS component named NAME, with services of the model or the library.

    Exit status: 0 done, 2 usage or environment, 3 internal error.
    """
    from jausml.authoring.projects.adding import add, check_name
    from jausml.authoring.proposals.participants import new_component

    def commands(at: Opened) -> list[Command]:
        check_name(name, at.system)
        made = new_component(
            at.scope, at.system, name, provides=provides, uses=uses, address=address or ""
        )
        return [made]

    with stopping():
        place = place_for(model)
        report(place, add(place, f"Add component {name}", commands))

"""`jausml rules`: lists the rules."""

from __future__ import annotations

import click

from jausml.validation.catalogue import catalogue


@click.command("rules")
def command() -> None:
    """List the rules: id, severity and title."""
    for entry in catalogue():
        click.echo(f"{entry.id} {entry.severity.value:7} {entry.title}")

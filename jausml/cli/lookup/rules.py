"""`jausml rules`: lists the rules."""

from __future__ import annotations

import click

from jausml.cli.shared.known import known


@click.command("rules")
def command() -> None:
    """List the rules: id, severity and title."""
    for entry in known("rules"):
        click.echo(f"{entry['rule']} {entry['severity']:7} {entry['title']}")

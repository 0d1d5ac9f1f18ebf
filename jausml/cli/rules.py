"""`jausml rules`: lists the rules."""

from __future__ import annotations

import click

from jausml.importers.jsidl.rules import JSIDL_RULES
from jausml.importers.ros.rules import ROS_RULES
from jausml.text.rules import TEXT_RULES
from jausml.validation.catalogue import catalogue


@click.command("rules")
def command() -> None:
    """List the rules: id, severity and title."""
    for entry in catalogue(JSIDL_RULES, ROS_RULES, TEXT_RULES):
        click.echo(f"{entry.id} {entry.severity.value:7} {entry.title}")

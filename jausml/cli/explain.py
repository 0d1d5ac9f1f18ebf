"""`jausml explain`: shows what a rule demands and why."""

from __future__ import annotations

from difflib import get_close_matches

import click

from jausml.importers.jsidl.rules import JSIDL_RULES
from jausml.importers.ros.rules import ROS_RULES
from jausml.text.rules import TEXT_RULES
from jausml.validation.catalogue import catalogue


@click.command("explain")
@click.argument("rule_id", metavar="RULE")
def command(rule_id: str) -> None:
    """Explain a rule: what it demands and why, with a bad and a good example."""
    entries = {entry.id: entry for entry in catalogue(JSIDL_RULES, ROS_RULES, TEXT_RULES)}
    entry = entries.get(rule_id.upper())
    if entry is None:
        near = get_close_matches(rule_id.upper(), entries, n=1)
        hint = f", did you mean {near[0]}?" if near else ""
        raise click.UsageError(f"no rule {rule_id!a}{hint} ('jausml rules' lists them)")
    click.echo(f"{entry.id}: {entry.title} ({entry.severity.value})\n\n{entry.documentation}")

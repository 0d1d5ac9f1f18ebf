"""`jausml rules` and `jausml explain`: the rules, what each demands, and why."""

from __future__ import annotations

from difflib import get_close_matches

import click

from jausml.cli.shared.known import known
from jausml.cli.shared.names import completing, rule_names


@click.command("rules")
def rules() -> None:
    """List the rules: id, severity and title."""
    for entry in known("rules"):
        click.echo(f"{entry['rule']} {entry['severity']:7} {entry['title']}")


@click.command("explain")
@click.argument("rule_id", metavar="RULE", shell_complete=completing(rule_names))
def explain(rule_id: str) -> None:
    """Explain a rule: what it requires and why, with a bad and a good example."""
    entries = {entry["rule"]: entry for entry in known("rules")}
    entry = entries.get(rule_id.upper())
    if entry is None:
        near = get_close_matches(rule_id.upper(), entries, n=1)
        hint = f", did you mean {near[0]}?" if near else ""
        raise click.UsageError(f"no rule {rule_id!a}{hint} ('jausml rules' lists them)")
    heading = f"{entry['rule']}: {entry['title']} ({entry['severity']})"
    click.echo(f"{heading}\n\n{entry['documentation']}")

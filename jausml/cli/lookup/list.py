"""`jausml list`, `jausml rules` and `jausml explain`: services, messages, maps and rules."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from difflib import get_close_matches
from operator import itemgetter
from typing import Any

import click

from jausml.cli.shared.files import in_columns, line_format_option, to_json, write
from jausml.cli.shared.models import model_option
from jausml.cli.shared.names import completing

Columns = Mapping[str, Callable[[dict[str, Any]], str]]
"""The texts in the columns of a table, by their heads."""


@click.group("list")
def command() -> None:
    """List the JAUS services, messages and attribute maps of the library and of your models."""


@command.command("services")
@click.option(
    "--set", "set_name", metavar="NAME", help="List only the services of this service set."
)
@line_format_option
@model_option
def services(set_name: str | None, output_format: str, models: tuple[str, ...]) -> None:
    """List services with their versions.

    Exit status: 0 done, 1 a model has errors, 2 usage (an unknown service set), 3 internal error.
    """
    from jausml.cli.lookup import listed

    entries = listed.services(models)
    if set_name is not None:
        known_sets = sorted({service["set"] for service in entries})
        entries = [service for service in entries if set_name == service["set"]]
        if not entries:
            sets = ", ".join(known_sets)
            raise click.UsageError(f"no service set {set_name!r}, there are: {sets}")
    columns: Columns = {
        "SERVICE": itemgetter("service"),
        "VERSION": itemgetter("version"),
        "SET": itemgetter("set"),
        "INHERITS": lambda service: service["inherits"] or "",
    }
    _write(entries, output_format, columns)


@command.command("messages")
@click.option(
    "--service",
    metavar="SERVICE",
    help="List only the messages of this service, including inherited ones: URN or name, "
    "optionally with /VERSION.",
)
@line_format_option
@model_option
def messages(service: str | None, output_format: str, models: tuple[str, ...]) -> None:
    """List messages with their codes.

    Exit status: 0 done, 1 a model has errors, 2 usage (an unknown service), 3 internal error.
    """
    from jausml.cli.lookup import listed

    columns: Columns = {
        "CODE": itemgetter("code"),
        "MESSAGE": itemgetter("message"),
        "": lambda entry: "command" if entry["command"] else "",
        "SERVICE": lambda entry: _shortened(entry["services"]),
    }
    _write(listed.messages(models, service), output_format, columns)


def _shortened(services: Sequence[str]) -> str:
    more = f" and {len(services) - 2} more" if len(services) > 2 else ""
    return ", ".join(services[:2]) + more


@command.command("maps")
@click.option(
    "--ros",
    "ros_type",
    metavar="TYPE",
    help="List only maps of this ROS type, including joined ones.",
)
@click.option(
    "--jaus", "message_name", metavar="MESSAGE", help="List only maps of this JAUS message."
)
@line_format_option
@model_option
def maps(
    ros_type: str | None, message_name: str | None, output_format: str, models: tuple[str, ...]
) -> None:
    """List attribute maps with their message, ROS type and directions.

    TYPE is nav_msgs/Odometry, nav_msgs/msg/Odometry or Odometry. `jausml show map` shows the
    details of a map.

    Exit status: 0 done, 1 a model has errors, 2 usage (a type or message without a map), 3 internal
    error.
    """
    from jausml.cli.lookup import listed

    entries = listed.maps(models)
    if ros_type is not None:
        wanted = ros_type.replace("/msg/", "/")
        entries = _chosen(entries, wanted, ("type", "joins"), "ROS type")
    if message_name is not None:
        entries = _chosen(entries, message_name, ("message", "reportJoins"), "JAUS message")
    columns: Columns = {
        "MAP": itemgetter("map"),
        "MESSAGE": itemgetter("message"),
        "ROS TYPE": itemgetter("type"),
        "DIRECTIONS": lambda entry: " and ".join(entry["directions"]),
        "IMPORT": lambda entry: entry["module"] or "",
    }
    _write(entries, output_format, columns)


def _chosen(
    entries: Sequence[dict[str, Any]], wanted: str, place: tuple[str, str], what: str
) -> list[dict[str, Any]]:
    """Returns the maps of a name, or of the end of a name behind its slash.

    `place`: where a map has the name, and where its joins are, which have one at the same place.
    """
    key, joins = place

    def names(map_entry: dict[str, Any]) -> list[str]:
        return [map_entry[key], *(join[key] for join in map_entry[joins])]

    def are_meant(map_entry: dict[str, Any]) -> bool:
        return any(wanted in (name, name.rpartition("/")[2]) for name in names(map_entry))

    chosen = [entry for entry in entries if are_meant(entry)]
    if not chosen:
        from jausml.live.messages.errors import did_you_mean, similar

        everything = {name for entry in entries for name in names(entry)}
        everything |= {name.rpartition("/")[2] for name in everything if "/" not in wanted}
        hint = did_you_mean(similar(wanted, everything))
        raise click.UsageError(f"no map of the {what} {wanted!r}{hint}")
    return chosen


def _write(entries: Iterable[dict[str, Any]], output_format: str, columns: Columns) -> None:
    """Writes an object of JSON for each entry, or a table with the columns of some heads."""
    if output_format == "json":
        lines: Iterable[str] = map(to_json, entries)
    else:
        cells = ([cell(entry) for cell in columns.values()] for entry in entries)
        lines = in_columns([tuple(columns), *map(tuple, cells)])
    for line in lines:
        write(line)


@click.command("rules")
def rules() -> None:
    """List the rules: id, severity and title."""
    from jausml.cli.lookup import listed

    for entry in listed.rules():
        click.echo(f"{entry['rule']} {entry['severity']:7} {entry['title']}")


def _rule_names(_models: Sequence[str]) -> list[str]:
    from jausml.cli.lookup import listed

    return [entry["rule"] for entry in listed.rules()]


@click.command("explain")
@click.argument("rule_id", metavar="RULE", shell_complete=completing(_rule_names))
def explain(rule_id: str) -> None:
    """Explain a rule: what it requires and why, with a bad and a good example."""
    from jausml.cli.lookup import listed

    entries = {entry["rule"]: entry for entry in listed.rules()}
    entry = entries.get(rule_id.upper())
    if entry is None:
        # A rule says of which others it has taken the place.
        wanted = rule_id.upper()
        near = [id_ for id_, rule in entries.items() if wanted in rule["documentation"]]
        near = near or get_close_matches(wanted, entries, n=1)
        hint = f", did you mean {near[0]}?" if near else ""
        raise click.UsageError(f"no rule {rule_id!r}{hint} ('jausml rules' lists them)")
    heading = f"{entry['rule']}: {entry['title']} ({entry['severity']})"
    click.echo(f"{heading}\n\n{entry['documentation']}")

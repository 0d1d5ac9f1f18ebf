"""`jausml list`: lists the JAUS services, messages and attribute maps that are known."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from jausml.cli.messages import (
    format_option,
    model_option,
    open_catalogue,
    to_json,
    write,
)
from jausml.live.messages import UnknownServiceError
from jausml.live.messages.errors import did_you_mean, similar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from jausml.cli.maps import FoundMap
    from jausml.live.messages import Catalogue, MessageEntry, ServiceEntry


@click.group("list")
def command() -> None:
    """List the JAUS services, messages and attribute maps of the library and of your models."""


@command.command("services")
@click.option("--set", "set_name", metavar="NAME", help="Only the services of a service set.")
@format_option
@model_option
def services(set_name: str | None, output_format: str, models: tuple[str, ...]) -> None:
    """List services with their versions.

    Exit status: 0 done, 1 a model has errors, 2 usage (an unknown service set), 3 internal error.
    """
    catalogue = open_catalogue(models)
    found = list(catalogue.services.values())
    if set_name is not None:
        found = [service for service in found if set_name == service.set_name]
        if not found:
            known = sorted({service.set_name for service in catalogue.services.values()})
            raise click.UsageError(f"no service set {set_name!a}, there are: {', '.join(known)}")
    if output_format == "json":
        for service in found:
            write(to_json(_service_json(service)))
        return
    _table(
        ("SERVICE", "VERSION", "SET", "INHERITS"),
        ((s.urn, s.version, s.set_name, s.inherits.label if s.inherits else "") for s in found),
    )


def _service_json(service: ServiceEntry) -> dict[str, Any]:
    return {
        "service": service.urn,
        "version": service.version,
        "name": service.name,
        "set": service.set_name,
        "inherits": service.inherits.label if service.inherits else None,
        "inputs": [entry.name for entry in service.inputs],
        "outputs": [entry.name for entry in service.outputs],
    }


@command.command("messages")
@click.option(
    "--service",
    metavar="SERVICE",
    help="Only those of a service, inherited ones too: URN or name, then /VERSION if meant.",
)
@format_option
@model_option
def messages(service: str | None, output_format: str, models: tuple[str, ...]) -> None:
    """List messages with their codes.

    Exit status: 0 done, 1 a model has errors, 2 usage (an unknown service), 3 internal error.
    """
    found = _messages(open_catalogue(models), service)
    if output_format == "json":
        for entry in found:
            write(to_json(_message_json(entry)))
        return
    rows = (
        (
            entry.code_text,
            entry.name,
            "command" if entry.is_command else "",
            ", ".join(each.label for each in entry.services[:2])
            + (f" and {len(entry.services) - 2} more" if len(entry.services) > 2 else ""),
        )
        for entry in found
    )
    _table(("CODE", "MESSAGE", "", "SERVICE"), rows)


@command.command("maps")
@click.option(
    "--ros", "ros_type", metavar="TYPE", help="Only those of a ROS type, joined ones too."
)
@click.option("--jaus", "message_name", metavar="MESSAGE", help="Only those of a JAUS message.")
@format_option
@model_option
def maps(
    ros_type: str | None, message_name: str | None, output_format: str, models: tuple[str, ...]
) -> None:
    """List attribute maps with their message, ROS type and directions.

    TYPE is nav_msgs/Odometry, nav_msgs/msg/Odometry or Odometry. `jausml show map` tells more.

    Exit status: 0 done, 1 a model has errors, 2 usage (a type or message without a map), 3
    internal error.
    """
    from jausml.cli.maps import open_maps  # noqa: PLC0415 - services and messages need no maps

    found = open_maps(models)
    if ros_type is not None:
        wanted = ros_type.replace("/msg/", "/")
        found = _chosen(found, wanted, lambda each: each.overview.types, "ROS type")
    if message_name is not None:
        found = _chosen(found, message_name, lambda each: [each.overview.message], "JAUS message")
    if output_format == "json":
        for each in found:
            write(to_json(each.to_json()))
        return
    rows = (
        (each.name, each.message, each.type, " and ".join(each.directions), found_map.module)
        for found_map in found
        for each in (found_map.overview,)
    )
    _table(("MAP", "MESSAGE", "ROS TYPE", "DIRECTIONS", "IMPORT"), rows)


def _chosen(
    found: Sequence[FoundMap], wanted: str, names: Callable[[FoundMap], Sequence[str]], what: str
) -> list[FoundMap]:
    """Returns the maps of a name, or of the end of one behind its slash."""

    def are_meant(each: FoundMap) -> bool:
        return any(wanted in (name, name.rpartition("/")[2]) for name in names(each))

    chosen = [each for each in found if are_meant(each)]
    if not chosen:
        known = {name for each in found for name in names(each)}
        known |= {name.rpartition("/")[2] for name in known if "/" not in wanted}
        hint = did_you_mean(similar(wanted, known))
        raise click.UsageError(f"no map of the {what} {wanted!a}{hint}")
    return chosen


def _messages(catalogue: Catalogue, service: str | None) -> Sequence[MessageEntry]:
    if service is None:
        return catalogue.messages
    try:
        meant = catalogue.find_services(service)
    except UnknownServiceError as error:
        raise click.UsageError(str(error)) from error
    every = (entry for each in meant for owner in each.lineage for entry in owner.messages)
    return sorted(dict.fromkeys(every), key=lambda entry: (entry.code, entry.name))


def _message_json(entry: MessageEntry) -> dict[str, Any]:
    return {
        "message": entry.name,
        "code": entry.code_text,
        "command": entry.is_command,
        "services": [service.label for service in entry.services],
    }


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> None:
    """Writes rows in columns as wide as they need."""
    table = [head, *rows]
    widths = [max(len(row[column]) for row in table) for column in range(len(head))]
    for row in table:
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        write("  ".join(cells).rstrip())

"""`jausml list`: lists the JAUS services and messages that are known."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from jausml.cli.messages import FORMATS, model_option, open_catalogue, to_json, write
from jausml.live.messages import UnknownServiceError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jausml.live.messages import Catalogue, MessageEntry, ServiceEntry


_format_option = click.option(
    "--format",
    "output_format",
    type=FORMATS,
    default="text",
    show_default=True,
    help="A table, or one JSON object a line.",
)


@click.group("list")
def command() -> None:
    """List the JAUS services and messages of the library and of your models."""


@command.command("services")
@click.option("--set", "set_name", metavar="NAME", help="Only the services of a service set.")
@_format_option
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
@_format_option
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

"""`jausml show`: shows one message, service, ROS type or attribute map, and how to write it."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import click

from jausml.cli.shared.files import line_format_option, to_json, write
from jausml.cli.shared.models import beside_library, explained, model_option, open_catalogue
from jausml.cli.shared.names import completing, message_names, service_names

if TYPE_CHECKING:
    from jausml.live.messages import Catalogue, MessageEntry, ServiceEntry
    from jausml.live.messages.text import Row


def _map_names(models: Sequence[str] = ()) -> list[str]:
    from jausml.cli.lookup import listed

    return [entry["map"] for entry in listed.maps(models)]


_NAMES = {"message": message_names, "service": service_names, "map": _map_names}
"""The functions that name all known elements of a kind."""


class Kinds(click.Group):
    """Group of the kinds of elements; for a name without its kind it names that."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Returns the kind that is meant and its command."""
        name = args[0]
        if name not in self.commands:
            named = (kind for kind, names in _NAMES.items() if name in names())
            kind = next(named, "type" * ("/" in name))
            if kind:
                ctx.fail(f"{name} is a {kind}: jausml show {kind} {name}")
        return super().resolve_command(ctx, args)


@click.group("show", cls=Kinds)
def command() -> None:
    """Show one message, service, ROS type or attribute map, of the library or of your models."""


@command.command("message")
@click.argument("name", metavar="NAME", shell_complete=completing(message_names))
@click.option(
    "--service",
    metavar="SERVICE",
    help="Service of the message: URN or name, optionally with /VERSION.",
)
@line_format_option
@model_option
def message(name: str, service: str | None, output_format: str, models: tuple[str, ...]) -> None:
    """Show the fields of the message NAME, and an example for `encode` and `ocu`.

    NAME is a name or a code. Without --service, all messages of that name or code are shown.

    Exit status: 0 done, 1 a model has errors, 2 usage (an unknown message), 3 internal error.
    """
    from jausml.live.messages import MessageError
    from jausml.live.messages.text import rows

    catalogue = open_catalogue(models)
    try:
        message_rows = [(entry, rows(entry)) for entry in _meanings(catalogue, name, service)]
    except MessageError as error:
        raise click.UsageError(explained(error, models)) from error
    if output_format == "json":
        _write(to_json(_message_json(entry, fields)) for entry, fields in message_rows)
        return
    _write_apart(message_rows, lambda pair: _message_lines(*pair))


def _meanings(catalogue: Catalogue, name: str, service: str | None) -> Sequence[MessageEntry]:
    """Returns the messages of a name or code; that of a service if one is named."""
    entries = catalogue.named(name) if service is None else ()
    return entries or (catalogue.message(name, service),)


def _message_json(entry: MessageEntry, fields: Sequence[Row]) -> dict[str, Any]:
    return {
        **_named(entry),
        "services": [service.label for service in entry.services],
        "documentation": entry.documentation,
        "fields": [field.to_json() for field in fields],
        "example": _example(entry),
    }


def _example(entry: MessageEntry) -> dict[str, Any]:
    from jausml.live.messages.text import example

    return {"message": entry.name, "fields": example(entry)}


def _message_lines(entry: MessageEntry, fields: Sequence[Row]) -> Iterator[str]:
    yield f"{entry.name} {entry.code_text}{' (command)' if entry.is_command else ''}"
    if entry.documentation:
        yield f"  {entry.documentation}"
    yield f"  of {', '.join(service.label for service in entry.services)}"
    yield ""
    if not fields:
        yield "  no fields"
    yield from _field_lines(fields)
    yield ""
    yield "example, of which optional fields may be left out:"
    yield f"  jausml encode:  {json.dumps(_example(entry))}"
    yield f"  jausml ocu:     {entry.name} '{json.dumps(_example(entry)['fields'])}'"


def _field_lines(fields: Sequence[Row]) -> Iterator[str]:
    """Yields the fields in columns, with the names of their values below them."""
    cells = [
        (f"{'  ' * field.depth}{field.name}", field.type, field.presence, _values(field))
        for field in fields
    ]
    widths = [max(len(cell[column]) for cell in cells) for column in range(3)] if cells else []
    for field, (*columns, values) in zip(fields, cells, strict=True):
        padded = "  ".join(cell.ljust(width) for cell, width in zip(columns, widths, strict=True))
        names = (f"{value} '{name}'" for value, name in sorted((field.names or {}).items()))
        remarks = (values, field.documentation, *names, *field.markers)
        notes = [note for note in remarks if note] or [""]
        yield f"  {padded}  {notes[0]}".rstrip()
        yield from (" " * (len(padded) + 4) + note for note in notes[1:])


def _values(field: Row) -> str:
    unit = f" {field.units}" if field.units else ""
    return f"{field.legal}{unit}".strip()


@command.command("service")
@click.argument("name", metavar="NAME", shell_complete=completing(service_names))
@line_format_option
@model_option
def service(name: str, output_format: str, models: tuple[str, ...]) -> None:
    """Show the service NAME: what it inherits, takes and sends.

    NAME is a URN or its last part. Without /VERSION after it, all versions are shown.

    Exit status: 0 done, 1 a model has errors, 2 usage (an unknown service), 3 internal error.
    """
    from jausml.live.messages import MessageError

    try:
        services = open_catalogue(models).find_services(name)
    except MessageError as error:
        raise click.UsageError(explained(error, models)) from error
    if output_format == "json":
        _write(to_json(_service_json(entry)) for entry in services)
        return
    _write_apart(services, _service_lines)


def _service_json(entry: ServiceEntry) -> dict[str, Any]:
    return {
        "service": entry.urn,
        "version": entry.version,
        "name": entry.name,
        "set": entry.set_name,
        "documentation": entry.documentation,
        "inherits": [ancestor.label for ancestor in list(entry.lineage)[1:]],
        "inputs": [_named(message_entry) for message_entry in entry.inputs],
        "outputs": [_named(output) for output in entry.outputs],
    }


def _named(entry: MessageEntry) -> dict[str, Any]:
    return {"message": entry.name, "code": entry.code_text, "command": entry.is_command}


def _service_lines(entry: ServiceEntry) -> Iterator[str]:
    yield f"{entry.name} {entry.version} ({entry.set_name})"
    yield f"  {entry.urn}"
    if entry.documentation:
        yield f"  {entry.documentation}"
    ancestors = [f"{ancestor.name} {ancestor.version}" for ancestor in list(entry.lineage)[1:]]
    if ancestors:
        yield f"  inherits {', which inherits '.join(ancestors)}"
    yield ""
    for word, entries in (("takes", entry.inputs), ("sends", entry.outputs)):
        for message_entry in entries:
            mark = " (command)" if message_entry.is_command else ""
            yield f"  {word}  {message_entry.code_text}  {message_entry.name}{mark}"


@command.command("type")
@click.argument("name", metavar="TYPE")
@line_format_option
@model_option
def type_(name: str, output_format: str, models: tuple[str, ...]) -> None:
    """Show the fields of the ROS type TYPE, and by which values they say that they have none.

    TYPE is nav_msgs/Odometry or nav_msgs/msg/Odometry, or a part of a call or action such as
    std_srvs/SetBool.request.

    Exit status: 0 done, 1 a model has errors, 2 usage (an unknown type), 3 internal error.
    """
    from jausml.authoring.proposals.elements import plain_type
    from jausml.language.metamodel.classes import ros
    from jausml.language.model.library import library_paths
    from jausml.language.semantics.paths.ros_paths import ros_name
    from jausml.live.messages.errors import did_you_mean, similar
    from jausml.live.messages.ros_rows import ros_rows

    plain = plain_type(name)
    package = plain.partition("/")[0]
    ready = [path for path in library_paths("ros") if path.stem == package]
    kinds = beside_library(ready, models, "types").instances(ros.MessageType)
    types_by_name = {ros_name(message_type): message_type for message_type in kinds}
    if plain not in types_by_name:
        raise click.UsageError(f"no ROS type {name!r}{did_you_mean(similar(plain, types_by_name))}")
    kind, fields = types_by_name[plain], list(ros_rows(types_by_name[plain]))
    documentation = str(kind.documentation or "")
    if output_format == "json":
        shown = [field.to_json() for field in fields]
        write(to_json({"type": plain, "documentation": documentation, "fields": shown}))
        return
    head = [plain, *(f"  {line}" for line in documentation.splitlines())]
    _write((*head, "", *_field_lines(fields)))


@command.command("map")
@click.argument("name", metavar="NAME", shell_complete=completing(_map_names))
@line_format_option
@model_option
def map_(name: str, output_format: str, models: tuple[str, ...]) -> None:
    """Show the attribute map NAME: what it connects, its quantities, and how to use it.

    Exit status: 0 done, 1 a model has errors, 2 usage (an unknown map), 3 internal error.
    """
    from jausml.cli.lookup import listed
    from jausml.live.messages.errors import did_you_mean, similar

    entries = [entry for entry in listed.maps(models, name) if entry["map"] == name]
    if not entries:
        hint = did_you_mean(similar(name, {entry["map"] for entry in listed.maps(models)}))
        raise click.UsageError(f"no map {name!r}{hint or '; `jausml list maps` lists them'}")
    if output_format == "json":
        _write(map(to_json, entries))
        return
    _write_apart(entries, _map_lines)


def _map_lines(entry: dict[str, Any]) -> Iterator[str]:
    name, module = entry["map"], entry["module"]
    yield f"{name}: {entry['message']} ({entry['service']}) and {entry['type']}"
    if entry["documentation"]:
        yield f"  {entry['documentation']}"
    yield ""
    yield f"  directions: {', '.join(entry['directions']) or 'none'}"
    for quantity in entry["quantities"]:
        shown = f"  quantity {quantity['name']}: {quantity['value']:g} {quantity['units']}".rstrip()
        yield f"{shown}, which a bridge may override"
    for join in (*entry["joins"], *entry["reportJoins"]):
        kind, stale = join.get("type") or join["message"], join["whenStale"]
        yield f"  join {join['name']}: {kind}, fresh for {join['freshness']:g} s, then {stale}"
    yield f"  test vectors: {entry['vectors']}"
    yield f"  file: {entry['file']}:{entry['line']}"
    if module:
        xmi = f"{module.partition('.')[2]}.xmi"
        yield ""
        yield f"in text:  import {module}"
        yield f"          map: {name}"
        yield f"in XMI:   jausml convert {entry['file']} {xmi}"
        yield f'          <map href="{xmi}#{name}"/>'


def _write_apart(entries: Iterable[Any], lines: Callable[[Any], Iterator[str]]) -> None:
    """Writes the lines of each thing, with an empty line between two."""
    for index, entry in enumerate(entries):
        if index:
            write("")
        _write(lines(entry))


def _write(lines: Iterable[str]) -> None:
    for line in lines:
        write(line)

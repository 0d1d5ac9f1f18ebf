"""`jausml encode`: turns messages in JSON into hex."""

from __future__ import annotations

import json
from collections import Counter
from typing import Any

import click

from jausml.cli.shared.files import PROBLEMS, STDIN, read_lines, shown_path, write
from jausml.cli.shared.models import model_option, open_catalogue, told


@click.command("encode")
@click.argument("words", nargs=-1, metavar="[JSON|NAME FIELDS|FILE|-]")
@model_option
def command(words: tuple[str, ...], models: tuple[str, ...]) -> None:
    """Turn messages in JSON into hex, one message per line.

    A line of a file, or an argument, is an object as `jausml decode --format json` prints it:
    "message" (name) or "code", "fields", and a "service" (with "service_version") if several
    messages have the name. `_pv`, and the name of the one record of a body, may be omitted. A line
    can also be the name of the message and its fields, as `jausml ocu` takes them. Without an
    argument, reads stdin.

    Exit status: 0 done, 1 a line is wrong (the others are encoded), 2 usage or an unreadable file,
    3 internal error.
    """
    from jausml.live.messages import MessageError

    failed = False
    catalogue = open_catalogue(models)
    path = " ".join(words) or STDIN
    is_message = len(words) > 1 or path.lstrip().startswith("{")
    name = "argument" if is_message else shown_path(path)
    for number, line in enumerate([path] if is_message else read_lines(path), 1):
        if not line.strip():
            continue
        try:
            write(catalogue.encode(_message(line)).hex())
        except (MessageError, _LineError) as error:
            failed = True
            click.echo(f"{name}:{number}: {told(error, models)}", err=True)
    if failed:
        raise click.exceptions.Exit(PROBLEMS)


class _LineError(ValueError):
    """A line that is not an object of JSON."""


def _message(line: str) -> dict[str, Any]:
    from jausml.live.messages.legal import shown
    from jausml.live.messages.paths import parse_fields

    name, _, fields = line.strip().partition(" ")
    if name.isidentifier() and name not in ("null", "true", "false"):
        try:
            return {"message": name, "fields": parse_fields(fields) if fields.strip() else {}}
        except ValueError as error:
            raise _LineError(str(error)) from error
    try:
        value = json.loads(line.rstrip(), object_pairs_hook=_object)
    except json.JSONDecodeError as error:
        raise _LineError(f"column {error.colno}: {error.msg}") from error
    except _LineError:
        raise
    except ValueError:
        raise _LineError("an integer has too many digits") from None
    except RecursionError:
        raise _LineError("nested too deep") from None
    if isinstance(value, dict) and isinstance(value.get("message"), dict):
        value = value["message"]  # a line of `jausml decode --datagram`
    if not isinstance(value, dict):
        raise _LineError(f"an object is needed, this is {shown(value)}")
    return value


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Returns an object of JSON; of a name that stands in it twice nobody knows which counts."""
    found = dict(pairs)
    if len(found) < len(pairs):
        ((twice, _),) = Counter(name for name, _ in pairs).most_common(1)
        raise _LineError(f"{twice!a} stands twice in an object")
    return found

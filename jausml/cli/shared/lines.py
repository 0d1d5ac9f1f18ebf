"""Lines that the message verbs read and print: hex and JSON, from files, stdin and arguments."""

from __future__ import annotations

import json
import math
import sys
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jausml.cli.shared.files import EnvironmentFault
from jausml.cli.shared.options import TEXT_OR_JSON, format_option

if TYPE_CHECKING:
    from collections.abc import Iterator


STDIN = "-"

_LONGEST_LINE = 1 << 26

FORMATS = click.Choice(TEXT_OR_JSON)
"""Formats of the output: for people and for programs."""

line_format_option = format_option("Text for people, or one JSON object per line.")


def read_lines(path: str) -> Iterator[str]:
    """Yields the lines of a file, or of stdin for `-`, without a byte order mark."""
    try:
        with nullcontext(sys.stdin.buffer) if path == STDIN else Path(path).open("rb") as stream:
            encoding = "utf-8-sig"
            while line := stream.readline(_LONGEST_LINE):
                if len(line) == _LONGEST_LINE:
                    reason = f"a line has {_LONGEST_LINE} bytes or more; this is no text"
                    raise EnvironmentFault(f"{shown_path(path)}: {reason}")
                yield line.decode(encoding, errors="replace")
                encoding = "utf-8"
    except (OSError, ValueError) as error:
        raise EnvironmentFault(f"{shown_path(path)}: {reason_of(error)}") from error


def reason_of(error: Exception) -> str:
    """Returns why a path cannot be read, without the path."""
    return str(getattr(error, "strerror", None) or error)


def shown_path(path: str) -> str:
    """Returns how messages name an input."""
    return "<stdin>" if path == STDIN else click.format_filename(path)


def write(line: str) -> None:
    """Writes a line to stdout; faster than click's echo, which counts for 100000 lines."""
    sys.stdout.write(f"{line}\n")


def to_json(value: Any) -> str:
    """Returns a value as one line of JSON; JSON has no infinity, which becomes a string."""
    try:
        return json.dumps(value, allow_nan=False)
    except ValueError:
        return json.dumps(_finite(value))


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_finite(each) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value

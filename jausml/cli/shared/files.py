"""Files and lines that verbs read and write, and what is wrong outside of the models."""

from __future__ import annotations

import json
import math
import os
import sys
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from jausml.cli.shared.options import TEXT_OR_JSON, format_option

if TYPE_CHECKING:
    import subprocess

    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.model import Model

PROBLEMS = 1
"""Exit status for problems of the models."""


class EnvironmentFault(click.ClickException):
    """A fault outside the models: a path, a permission, a missing package."""

    exit_code = 2


@contextmanager
def ending_at(
    *kinds: type[Exception], kind: type[click.ClickException] = EnvironmentFault, about: str = ""
) -> Iterator[None]:
    """Ends the verb at an error of some kinds, with its text, as an error of `kind`.

    `about`: what stands before its text, such as the path that cannot be read.
    """
    try:
        yield
    except kinds as error:
        raise kind(f"{about}{reason_of(error)}") from error


def find_files(paths: Iterable[str], suffixes: tuple[str, ...]) -> list[str]:
    """Returns files as they are, and the files with certain endings below folders."""
    from jausml.language.model import project

    with ending_at(project.InputError):
        return project.find_files(paths, suffixes)


@contextmanager
def writing(path: str | Path) -> Iterator[None]:
    """Ends the verb where a file or folder cannot be written."""
    try:
        yield
    except OSError as error:
        raise cannot_write(path, error) from error


def cannot_write(path: str | Path, error: OSError) -> EnvironmentFault:
    """Returns the error of a file or folder that cannot be written."""
    name = click.format_filename(path)
    return EnvironmentFault(f"cannot write {name}: {error.strerror or error}")


def git(*arguments: str, cwd: Path | None = None) -> subprocess.CompletedProcess[bytes]:
    """Returns the result of the user's git; ends the verb where it cannot be run."""
    import subprocess

    try:
        return subprocess.run(  # noqa: S603 - no shell, and git checks what it is given
            ["git", *arguments],  # noqa: S607
            cwd=cwd,
            capture_output=True,
            check=False,
        )
    except OSError as error:
        raise EnvironmentFault(f"git cannot be run: {error.strerror}") from error


def write_report(
    rendered: str | bytes, output: str | None, inputs: Iterable[str | Path] = ()
) -> None:
    """Writes a report or picture to a file, or a report to stdout where none is named.

    `inputs`: files that it does not take the place of.
    """
    if output is None:
        click.echo(rendered, nl=False)
        return
    from jausml.language.model.files import replace_file

    _check_inputs(output, inputs)
    if isinstance(rendered, str):
        rendered = rendered.encode("utf-8", errors="backslashreplace")
    with writing(output):
        # A file that is there is never half of the new one; a pipe or a device is no such file.
        write = replace_file if Path(output).is_file() else Path.write_bytes
        write(Path(output), rendered)


def made_folder(folder: Path) -> Path:
    """Returns a folder that is there, which files can be written into."""
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
    return folder


def document(roots: Sequence[EObject], model: Model, output: str) -> bytes:
    """Returns root elements as the bytes of a document.

    `output`: the file that is to hold them; its ending says in which notation.
    """
    from jausml.language.model.xmi.printing import UnwritableError
    from jausml.language.model.xmi.writer import to_xmi
    from jausml.language.text.notation import SUFFIX
    from jausml.language.text.writing.unparsing import to_text

    write = to_text if output.endswith(SUFFIX) else to_xmi
    try:
        return write(roots, model, output).encode("utf-8")
    except UnwritableError as error:
        shown = click.format_filename(output)
        raise click.ClickException(f"cannot write {shown}: {error}") from error


def write_document(output: str, data: bytes, inputs: Iterable[str], *, force: bool) -> str:
    """Writes a document unless that would harm; returns what became of the file."""
    from jausml.language.model.files import read_input, replace_file

    check_output(output, inputs)
    path = Path(output)
    with writing(output):
        if path.exists():
            if read_input(path) == data:
                return "unchanged"
            if not force:
                shown = click.format_filename(output)
                raise EnvironmentFault(f"{shown} is there and differs; --force overwrites it")
        replace_file(path, data)
    return "written"


def check_output(output: str, inputs: Iterable[str | Path]) -> None:
    """Refuses to write over a file that is read, or over what is no file."""
    _check_inputs(output, inputs)
    path = Path(output)
    if path.exists() and not path.is_file():
        shown = click.format_filename(output)
        raise EnvironmentFault(f"cannot write {shown}: it is no file; name one by -o")


def _check_inputs(output: str, inputs: Iterable[str | Path]) -> None:
    """Refuses to write over a file that is read."""
    if os.path.realpath(output) in {os.path.realpath(input_path) for input_path in inputs}:
        shown = click.format_filename(output)
        raise EnvironmentFault(f"{shown} is read; name another file to write")


def counted(*counts: tuple[int, str]) -> str:
    """Returns numbers of things as words, such as `1 set, 2 services`."""
    return ", ".join(f"{number} {noun}{'' if number == 1 else 's'}" for number, noun in counts)


def say(line: str, *, quiet: bool) -> None:
    """Prints a line of the summary."""
    if not quiet:
        click.echo(line, err=True)


STDIN = "-"

_LONGEST_LINE = 1 << 26

FORMATS = click.Choice(TEXT_OR_JSON)
"""Formats of the output: for people and for programs."""

line_format_option = format_option("Text for people, or one JSON object per line.")


def read_lines(path: str) -> Iterator[str]:
    """Yields the lines of a file, or of stdin for `-`, without a byte order mark.

    What was written of a line of stdin goes out before one waits for the next.
    """
    for line in _lines_of(path):
        yield line
        if path == STDIN:
            sys.stdout.flush()


def _lines_of(path: str) -> Iterator[str]:
    with (
        ending_at(OSError, ValueError, about=f"{shown_path(path)}: "),
        nullcontext(sys.stdin.buffer) if path == STDIN else Path(path).open("rb") as stream,
    ):
        encoding = "utf-8-sig"
        while line := stream.readline(_LONGEST_LINE):
            if len(line) == _LONGEST_LINE:
                reason = f"a line has {_LONGEST_LINE} bytes or more; this is no text"
                raise EnvironmentFault(f"{shown_path(path)}: {reason}")
            yield line.decode(encoding, errors="replace")
            encoding = "utf-8"


def reason_of(error: Exception) -> str:
    """Returns why a path cannot be read, without the path."""
    return str(getattr(error, "strerror", None) or error)


def shown_path(path: str) -> str:
    """Returns how messages name an input."""
    return "<stdin>" if path == STDIN else click.format_filename(path)


def write(line: str) -> None:
    """Writes a line to stdout; faster than click's echo, which counts for 100000 lines."""
    sys.stdout.write(f"{line}\n")


def in_columns(rows: Sequence[Sequence[str]], numbers: Collection[int] = ()) -> Iterator[str]:
    """Yields rows in columns as wide as they need; those of numbers are flush right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        cells = (
            cell.rjust(width) if index in numbers else cell.ljust(width)
            for index, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        yield "  ".join(cells).rstrip()


def to_json(value: Any) -> str:
    """Returns a value as one line of JSON; JSON has no infinity, which becomes a string."""
    try:
        return json.dumps(value, allow_nan=False)
    except ValueError:
        return json.dumps(finite(value))


def finite(value: Any) -> Any:
    """Returns JSON in which numbers that are not finite, for which it has none, are texts."""
    if isinstance(value, dict):
        return {key: finite(member) for key, member in value.items()}
    if isinstance(value, list | tuple):
        return [finite(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value

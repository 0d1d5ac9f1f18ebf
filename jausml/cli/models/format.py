"""`jausml format`: lays out ros2jaus text anew."""

from __future__ import annotations

from difflib import unified_diff
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.cli.shared.files import PROBLEMS, EnvironmentFault, find_files
from jausml.cli.shared.options import quiet_option

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.language.text.reading.parsing import Parsed


@click.command("format")
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@click.option("--check", is_flag=True, help="Write nothing; fail if a file would change.")
@click.option("--diff", is_flag=True, help="Write nothing; show the changes as a patch.")
@quiet_option("Do not list the changed files.")
def command(files: tuple[str, ...], check: bool, diff: bool, quiet: bool) -> None:
    """Lay out ros2jaus text uniformly: files, or all *.ros2jaus files below folders.

    Changes neither the meaning of the text nor its comments. If a file has syntax errors, reports
    them and writes no file.

    Exit status: 0 done (--check: nothing to do), 1 syntax errors (--check: or a file would change),
    2 a file cannot be read or written or is not ros2jaus text, 3 internal error.
    """
    from jausml.language.text.notation import SUFFIX
    from jausml.language.text.reading.parsing import parse
    from jausml.language.text.writing.layout import lay_out

    texts = {name: _read(name) for name in find_files(files, (SUFFIX,))}
    parsed = {name: parse(text) for name, text in texts.items()}
    if _report(parsed):
        raise click.exceptions.Exit(PROBLEMS)
    laid_out = {name: lay_out(each.document) for name, each in parsed.items()}
    changed = {name: new for name, new in laid_out.items() if new != texts[name]}
    for name, new in changed.items():
        if diff:
            click.echo(_patch(name, texts[name], new), nl=False)
        elif not quiet:
            click.echo(click.format_filename(name))
        if not (check or diff):
            _write(name, new)
    if check and changed:
        raise click.exceptions.Exit(PROBLEMS)


def _read(name: str) -> str:
    """Returns the text of a file as it is, line ends and byte order mark included."""
    from jausml.language.model.diagnostics import Location
    from jausml.language.model.inputs import read_input
    from jausml.language.text.notation import SUFFIX, decode

    if not name.endswith(SUFFIX):
        raise EnvironmentFault(f"{click.format_filename(name)}: the file is no *{SUFFIX} file")
    try:
        data = read_input(name)
    except OSError as error:
        raise EnvironmentFault(f"{click.format_filename(name)}: {error.strerror}") from error
    _, fault = decode(data)
    if fault is not None:
        place = Location(name, fault.line, fault.column)
        raise EnvironmentFault(f"{place}: {fault.message}")
    return data.decode("utf-8")


def _report(parsed: Mapping[str, Parsed]) -> bool:
    """Reports the syntax errors of files, and tells whether there are any."""
    from jausml.language.model.diagnostics import Diagnostic, Location, Severity
    from jausml.language.validation.formats.text import lines_of

    findings = [
        Diagnostic(
            "JML701",
            Severity.ERROR,
            Location(name, fault.span.line, fault.span.column),
            fault.message,
            fault.hint,
        )
        for name, each in parsed.items()
        for fault in each.faults
    ]
    for finding in sorted(findings):
        for line in lines_of(finding):
            click.echo(line)
    return bool(findings)


def _patch(name: str, old: str, new: str) -> str:
    # Lines end at line feeds alone, not at all that Unicode has.
    before, after = (list(StringIO(text, newline="\n")) for text in (old, new))
    lines = unified_diff(before, after, f"a/{name}", f"b/{name}")
    marked = (
        line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in lines
    )
    return "".join(marked)


def _write(name: str, text: str) -> None:
    from jausml.language.model.xmi.writer import replace_file

    try:
        replace_file(Path(name), text.encode("utf-8"))
    except OSError as error:
        shown = click.format_filename(name)
        raise EnvironmentFault(f"cannot write {shown}: {error.strerror}") from error

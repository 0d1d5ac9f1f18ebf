"""`jausml merge`: merges two states of a model that came of a third one."""

from __future__ import annotations

from pathlib import Path
from typing import NoReturn

import click

from jausml.cli.shared.files import PROBLEMS, EnvironmentFault, git, write_report

_MOST_CONFLICTS = 127
"""What git says of more; above it are faults."""


@click.command("merge")
@click.argument("base", metavar="BASE")
@click.argument("ours", metavar="OURS")
@click.argument("theirs", metavar="THEIRS")
@click.option(
    "--as",
    "file",
    metavar="FILE",
    help="File whose states they are, by default OURS; references are resolved from its folder.",
)
@click.option("-o", "--output", metavar="FILE", help="Write the merge to a file instead of stdout.")
def command(base: str, ours: str, theirs: str, file: str | None, output: str | None) -> None:
    """Merge the changes of two sides, OURS and THEIRS, to BASE, by the elements of the model.

    Elements are matched as in `jausml diff`. The changes of THEIRS are applied to OURS by small
    edits, so that the layout of the file is kept. Where changes of both sides conflict, OURS is
    kept and the location is reported. Files that cannot be read as models are merged line by line
    as git does.

    Exit status: 0 merged, 1 merged with conflicts, 2 usage or environment, 3 internal error.
    """
    from jausml.authoring.merging.merging import UnmergeableError, merged
    from jausml.authoring.merging.planning import AS_LINES
    from jausml.language.model.project import find_project_root
    from jausml.language.text.notation import SUFFIX
    from jausml.language.validation.formats.text import lines_of

    named = Path(file or ours)
    states = [_read(each) for each in (base, ours, theirs)]
    root = find_project_root([named]).resolve()
    path = named.parent.resolve() / named.name
    try:
        outcome = merged(path.relative_to(root).as_posix(), root, *states)
    except UnmergeableError as error:
        data, is_clean = _as_lines(ours, base, theirs)
        write_report(data, output)
        if is_clean and named.name.endswith(SUFFIX):
            # It refers by names, which the merge of other lines does not shift.
            click.echo(f"{named}: note: merged as lines: {error}", err=True)
            return
        _fail(f"{named}:1:1: error: {AS_LINES} merged as lines: {error}")
    write_report(outcome.data, output)
    for each in outcome.left_out:
        click.echo(f"{named}: note: a comment of theirs is left out: {each}", err=True)
    if outcome.findings:
        _fail(*(line for each in outcome.findings for line in lines_of(each)))


def _read(file: str) -> bytes:
    from jausml.language.model.inputs import read_input

    try:
        return read_input(file)
    except OSError as error:
        name = click.format_filename(file)
        raise EnvironmentFault(f"cannot read {name}: {error.strerror}") from error


def _as_lines(ours: str, base: str, theirs: str) -> tuple[bytes, bool]:
    """Returns what git makes of three files as lines, and whether there were no conflicts."""
    labels = [part for each in ("ours", "base", "theirs") for part in ("-L", each)]
    done = git("merge-file", "-p", *labels, "--", ours, base, theirs)
    if not 0 <= done.returncode <= _MOST_CONFLICTS:
        reason = done.stderr.decode(errors="replace").strip()
        raise EnvironmentFault(f"git cannot merge the lines: {reason}")
    return done.stdout, done.returncode == 0


def _fail(*lines: str) -> NoReturn:
    for line in lines:
        click.echo(line, err=True)
    raise click.exceptions.Exit(PROBLEMS)

"""`jausml merge`: merges two states of a model that came of a third one."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import click

from jausml.cli.shared.files import PROBLEMS, EnvironmentFault, git, write_report

if TYPE_CHECKING:
    from jausml.authoring.merging.merging import States

_MOST_CONFLICTS = 127  # the status of git for this many conflicts or more; above it are faults


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

    Elements are matched as in `jausml diff`. The changes of THEIRS are applied to OURS; comments
    stay, and the file is written as `jausml format` or Eclipse lays it out. Where changes of both
    sides conflict, OURS is kept and the location is reported. Files that cannot be read as models
    are merged line by line as git does.

    Exit status: 0 merged, 1 merged with conflicts, 2 usage or environment, 3 internal error.
    """
    from jausml.authoring.merging.merging import UnmergeableError, merged
    from jausml.authoring.merging.planning import AS_LINES
    from jausml.language.model.files import read_input
    from jausml.language.model.project import find_project_root
    from jausml.language.text.notation import SUFFIX
    from jausml.language.validation.formats.text import lines_of

    named = Path(file or ours)
    states = read_input(base), read_input(ours), read_input(theirs)
    root = find_project_root([named]).resolve()
    path = Path(os.path.realpath(named))  # of a link, that which is read
    try:
        around = _around(path, root, *states)
        outcome = merged(path.relative_to(root).as_posix(), root, *states, around)
    except UnmergeableError as error:
        data, is_clean = _as_lines(ours, base, theirs)
        write_report(data, output)
        if is_clean and named.name.endswith(SUFFIX):
            # It refers by names, which the merge of other lines does not shift.
            click.echo(f"{named}: note: merged as lines: {error}", err=True)
            return
        _fail(f"{named}:1:1: error: {AS_LINES} merged as lines: {error}")
    write_report(outcome.data, output)
    if outcome.findings:
        _fail(*(line for finding in outcome.findings for line in lines_of(finding)))


def _around(path: Path, root: Path, *states: bytes) -> dict[str, States]:
    """Returns the states of the other models of a merge, where git names its other commit.

    git names the other commit in GITHEAD_<id>, in a merge and in nothing else; the work tree is as
    it was before until all files are merged.
    """
    from jausml.authoring.merging.merging import States
    from jausml.language.model.library import SUFFIXES

    prefix = "GITHEAD_"
    heads = [
        variable.removeprefix(prefix) for variable in os.environ if variable.startswith(prefix)
    ]
    if len(heads) != 1:
        return {}
    bases = git("merge-base", "--all", "HEAD", heads[0]).stdout.decode().split()
    commits = (bases[0] if bases else "", "HEAD", heads[0])
    top = Path(os.fsdecode(git("rev-parse", "--show-toplevel").stdout.rstrip(b"\n"))).resolve()
    named = path.relative_to(top).as_posix() if path.is_relative_to(top) else ""
    if len(bases) != 1 or tuple(_shown(commit, named) for commit in commits) != states:
        return {}  # a merge of several bases, or a file that was moved
    changed: set[str] = set()
    for commit in commits[1:]:
        listed = git(
            "diff", "--name-only", "-z", "--no-renames", commits[0], commit, "--", str(root)
        )
        changed |= set(os.fsdecode(listed.stdout).split("\0"))
    others = [model_path for model_path in changed - {named} if model_path.endswith(SUFFIXES)]
    return {
        (top / other).relative_to(root).as_posix(): States(
            *(_shown(commit, other) for commit in commits)
        )
        for other in others
    }


def _shown(commit: str, file: str) -> bytes | None:
    """Returns a file of a commit, None where it is not there."""
    done = git("cat-file", "blob", f"{commit}:{file}")
    return done.stdout if done.returncode == 0 else None


def _as_lines(ours: str, base: str, theirs: str) -> tuple[bytes, bool]:
    """Returns git's merge of three files by lines, and whether there were no conflicts."""
    labels = [part for label in ("ours", "base", "theirs") for part in ("-L", label)]
    done = git("merge-file", "-p", *labels, "--", ours, base, theirs)
    if not 0 <= done.returncode <= _MOST_CONFLICTS:
        reason = done.stderr.decode(errors="replace").strip()
        raise EnvironmentFault(f"git cannot merge the lines: {reason}")
    return done.stdout, done.returncode == 0


def _fail(*lines: str) -> NoReturn:
    for line in lines:
        click.echo(line, err=True)
    raise click.exceptions.Exit(PROBLEMS)

"""`jausml init`: makes a project of models."""

from __future__ import annotations

import shlex
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.authoring.projects.starting import EXAMPLE, STARTING_POINTS, starting_point
from jausml.cli.authoring.new import topic_options
from jausml.cli.shared.files import PROBLEMS, EnvironmentFault, ending_at
from jausml.cli.shared.models import show_findings
from jausml.cli.shared.options import quiet_option, refuse_options

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.authoring.projects.creating import Wish
    from jausml.authoring.proposals.topics import Crossing
    from jausml.cli.authoring.new import Choosing
    from jausml.language.importers.jsidl import ImportResult

_TOPICS, _JSIDL = "topics", "jsidl"
_EXAMPLES = {_TOPICS: "odom:nav_msgs/Odometry", _JSIDL: "services/Winch.jsidl"}
"""A SOURCE for each way to begin that needs some."""


@click.command("init")
@click.argument("folder", metavar="DIR", type=click.Path(file_okay=False, path_type=Path))
@click.argument("sources", metavar="[SOURCE]...", nargs=-1)
@click.option("--name", metavar="NAME", help="Name of the system; by default, that of the folder.")
@click.option(
    "--notation",
    type=click.Choice(["xmi", "text"]),
    help="Notation of the model; by default, xmi, and text of a profile or an example.",
)
@click.option(
    "--from",
    "origin",
    type=click.Choice([_TOPICS, _JSIDL, *(start_point.name for start_point in STARTING_POINTS)]),
    default=EXAMPLE,
    help="Content of the model. topics: a bridge for the SOURCEs, which are topics such as "
    "odom:nav_msgs/Odometry; jsidl: a component with the services of the SOURCEs, which are JSIDL "
    f"files and folders; {'; '.join(f'{start.name}: {start.about}' for start in STARTING_POINTS)}.",
)
@click.option(
    "--copies",
    is_flag=True,
    help="Only renew the copies of metamodels and library in a project, after an update of jausml.",
)
@topic_options
@quiet_option("Print no summary.")
def command(
    folder: Path,
    sources: tuple[str, ...],
    name: str | None,
    notation: str | None,
    origin: str,
    copies: bool,
    quiet: bool,
    choosing: Choosing,
) -> None:
    """Make a project of models in DIR, which may already exist.

    The project contains a model that validates, generates and runs; copies of the metamodels and
    the library, so that Eclipse can open it; a workflow for CI, hooks for pre-commit, and a README.
    Your own files are never overwritten.

    Exit status: 0 done, 1 errors in JSIDL files, 2 usage or environment (a file already exists), 3
    internal error.
    """
    from jausml.authoring.projects.creating import Wish, create, name_for
    from jausml.authoring.projects.errors import ProjectError

    if copies:
        refused = ("name", "notation", "origin", "side", "yes", "holds", "joints")
        refuse_options("not with --copies", *refused)
        if sources:
            raise click.UsageError("--copies takes no SOURCE")
        _renew(folder, quiet=quiet)
        return
    _check_origin(origin, sources)
    point = starting_point(origin)
    is_text_only = point is not None and point.is_text_only
    if is_text_only and notation == "xmi":
        text = f"--from {origin} uses ready maps, which are text; leave out --notation"
        raise click.UsageError(text)
    chosen: Sequence[Crossing] = ()
    with ending_at(ProjectError):
        wish = Wish(name or name_for(folder), notation == "text" or is_text_only, origin)
        if origin == _TOPICS:
            written, chosen = _from_topics(folder, wish, sources, choosing)
        elif origin == _JSIDL:
            written = _from_jsidl(folder, wish, sources)
        else:
            with _writing():
                written = create(folder, wish)
    if not quiet:
        _show_next(folder, len(written), wish)
    if chosen:
        from jausml.cli.authoring.topics import show_undecided

        show_undecided(chosen)


def _check_origin(origin: str, sources: Sequence[str]) -> None:
    """Refuses sources and options that do not fit an origin, and missing sources."""
    if origin != _TOPICS:
        refuse_options(f"only with --from {_TOPICS}", "side", "yes", "holds", "joints")
    if not sources and origin in _EXAMPLES:
        raise click.UsageError(f"--from {origin} needs SOURCEs, such as {_EXAMPLES[origin]}")
    if sources and origin not in _EXAMPLES:
        are_topics = all(":" in source for source in sources)
        hint = f"; did you mean --from {_TOPICS}?" if are_topics else ""
        raise click.UsageError(f"--from {origin} takes no SOURCE{hint}")


@contextmanager
def _writing() -> Iterator[None]:
    """Ends the verb where a file of the project cannot be written, with its path."""
    try:
        yield
    except OSError as error:
        raise EnvironmentFault(f"{error.filename} cannot be written: {error.strerror}") from error


def _show_next(folder: Path, count: int, wish: Wish) -> None:
    """Shows how many files were written, and the commands that one types next."""
    click.echo(f"{count} files in {folder}; next:")
    if folder.resolve() != Path.cwd().resolve():
        where = f"./{folder}" if str(folder).startswith("-") else str(folder)
        click.echo(f"  cd {shlex.quote(where)}")
    click.echo("  jausml validate models")
    click.echo(f"  jausml generate {wish.model} -o src")
    click.echo("  jausml run src --for 10")


def _renew(folder: Path, *, quiet: bool) -> None:
    """Renews the copies in a project; shows which stay, as somebody has changed them."""
    from jausml.authoring.projects.creating import is_project, renew_copies

    if not is_project(folder):
        shown = click.format_filename(folder)
        raise click.UsageError(f"{shown} is no project whose copies could be renewed")
    with _writing():
        written, kept = renew_copies(folder)
    for path in kept:
        click.echo(f"{path} stays: it was changed here", err=True)
    if not quiet:
        click.echo(f"{len(written)} copies in {folder} renewed")


def _from_topics(
    folder: Path, wish: Wish, sources: Sequence[str], choosing: Choosing
) -> tuple[list[str], Sequence[Crossing]]:
    """Begins with a bridge of topics, and shows the maps that it uses.

    Returns the files that were written, and how each topic crosses.
    """
    from jausml.authoring.projects.adding import start_from_topics
    from jausml.cli.authoring.topics import (
        chosen_crossings,
        show_chosen,
        show_unanswered,
        topics_of,
    )
    from jausml.language.metamodel.classes import bridge
    from jausml.language.project import library

    topics = topics_of(sources)
    maps = library().instances(bridge.AttributeMap)
    chosen = chosen_crossings(topics, maps, choosing)
    with _writing():
        written = start_from_topics(folder, wish, chosen, topics)
    show_chosen(chosen, topics)
    show_unanswered(chosen)
    return written, chosen


def _from_jsidl(folder: Path, wish: Wish, sources: Sequence[str]) -> list[str]:
    from jausml.authoring.projects.adding import start_from_services

    imported = _imported(sources)
    with _writing():
        return start_from_services(folder, wish, imported)


def _imported(paths: Sequence[str]) -> ImportResult:
    """Returns services in JSIDL; ends when the files have errors."""
    from jausml.cli.models.exchange import findings_of, read_jsidl

    result, _ = read_jsidl(paths)
    report = findings_of(result)
    if report.diagnostics:
        show_findings(report)
    if report.has_errors or not result.sets:
        click.echo("nothing written", err=True)
        raise click.exceptions.Exit(PROBLEMS)
    return result

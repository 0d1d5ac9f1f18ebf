"""Shared parts of the verbs that add elements: the model that gets them, and what was written."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.cli.shared.files import EnvironmentFault

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from jausml.authoring.projects.places import Place
    from jausml.authoring.proposals.new_elements import OpenPoint


def model_option(command: Callable[..., None]) -> Callable[..., None]:
    """Adds the option of the model that gets the element to a verb."""
    return click.option(
        "-m",
        "--model",
        metavar="FILE",
        type=click.Path(dir_okay=False, path_type=Path),
        help="Model to change; by default, the one in this project that has a system.",
    )(command)


def pairs(words: Sequence[str], sign: str, example: str) -> list[tuple[str, str]]:
    """Returns the two parts of words that have a sign between them."""
    found = []
    for word in words:
        first, mark, second = word.partition(sign)
        if not (first and mark and second):
            raise click.UsageError(f"{word!a} should be like {example}")
        found.append((first.strip(), second.strip()))
    return found


def place_for(model: Path | None) -> Place:
    """Returns the place of a model, by default that of the project of the current folder."""
    from jausml.authoring.projects.places import place_of, system_in

    return place_of(model) if model is not None else system_in(Path.cwd())


@contextmanager
def stopping() -> Iterator[None]:
    """Ends the verb where something cannot be added."""
    from jausml.authoring.projects.places import ProjectError

    try:
        yield
    except ProjectError as error:
        raise EnvironmentFault(str(error)) from error
    except OSError as error:
        raise EnvironmentFault(f"{error.filename}: {error.strerror}") from error


def report(place: Place, files: Sequence[str]) -> None:
    """Says what was written, and what comes next."""
    for each in files:
        click.echo(f"{_shown(place.root / each)} written", err=True)
    click.echo(f"next: jausml validate {_shown(place.path)}", err=True)


def show_open(points: Sequence[OpenPoint], findings: Sequence[str] = ()) -> None:
    """Says what a person has to decide, and what else to know of a new element.

    Args:
        findings: What rules report of the element as it is.
    """
    decisions = [*(str(each) for each in points if each.rule), *findings]
    remarks = [each.text for each in points if not each.rule]
    for title, lines in (("open", decisions), ("remarks", remarks)):
        for line in [title, *(f"  {each}" for each in lines)] if lines else ():
            click.echo(line)


def _shown(path: Path) -> str:
    here = Path.cwd()
    return click.format_filename(path.relative_to(here) if path.is_relative_to(here) else path)

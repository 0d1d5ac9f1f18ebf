"""`jausml model-check`: searches the protocol of a model for deadlocks and late stops."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.cli.shared.files import (
    PROBLEMS,
    EnvironmentFault,
    made_folder,
    write_document,
    write_report,
)
from jausml.cli.shared.models import model_argument, reading_options, valid_model
from jausml.cli.shared.options import FiniteRange, format_option, quiet_option

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.language.model import Model
    from jausml.language.project import Reading
    from jausml.model_checking.checking import Outcome

FORMATS = ("text", "json", "sarif")
"""`jausml.model_checking.formats`."""

_STATES = 1_000_000
_BUDGET = 60.0


@click.command("model-check")
@model_argument
@format_option("Format of the report.", FORMATS)
@click.option("--output", metavar="FILE", help="Write the report to a file instead of stdout.")
@click.option(
    "-o",
    "--examples",
    metavar="FOLDER",
    type=click.Path(file_okay=False),
    help="Write each counter-example to FOLDER: as a sequence diagram, and as a test in virtual "
    "time.",
)
@click.option("--force", is_flag=True, help="Overwrite files in FOLDER that differ.")
@click.option(
    "--within",
    type=FiniteRange(0, min_open=True),
    metavar="SECONDS",
    help="Demand each stop this soon after its source is lost; by default, as the model says.",
)
@click.option(
    "--states",
    type=click.IntRange(min=1),
    default=_STATES,
    show_default=True,
    help="Search at most this many states of each product.",
)
@click.option(
    "--budget",
    type=FiniteRange(0, min_open=True),
    default=_BUDGET,
    show_default=True,
    metavar="SECONDS",
    help="Search at most this long.",
)
@reading_options
@quiet_option("Print no summary.")
def command(
    model: str,
    output_format: str,
    output: str | None,
    examples: str | None,
    force: bool,
    within: float | None,
    states: int,
    budget: float,
    reading: Reading,
    quiet: bool,
) -> None:
    """Check the protocol of the system in MODEL: control, states, connections and stops together.

    Searches all states that each product of them can reach. In none of them may a command take
    effect outside of control, stand too long after its source is lost, or wait for ever. Prints for
    each fault the shortest way to it.

    Exit status: 0 nothing found, 1 something found or errors in the model, 2 usage or environment,
    3 internal error.
    """
    import time

    from jausml.generation.errors import NoSystemError
    from jausml.generation.system import system_of
    from jausml.model_checking.checking import check_system, without_allowed
    from jausml.model_checking.formats import RENDERERS, summary

    read = valid_model(model, reading)
    try:
        system = system_of(read)
    except NoSystemError as error:
        raise EnvironmentFault(str(error)) from error
    end = time.monotonic() + budget
    found = check_system(system, states, lambda: time.monotonic() > end, within or 0.0)
    outcomes = without_allowed(found, read)
    if examples is not None:
        _write_examples(outcomes, read, Path(examples), force=force)
    write_report(RENDERERS[output_format](outcomes, read), output)
    if not quiet:
        click.echo(summary(outcomes), err=True)
    if any(each.found for each in outcomes):
        raise click.exceptions.Exit(PROBLEMS)


def _write_examples(
    outcomes: Sequence[Outcome], model: Model, folder: Path, *, force: bool
) -> None:
    """Writes the files of each counter-example that has steps."""
    from jausml.model_checking.courses import course_of
    from jausml.model_checking.virtual_test import virtual_test
    from jausml.views.diagrams.writers import sequence

    made_folder(folder)
    for outcome in outcomes:
        for each in (each for each in outcome.found if each.moments):
            words = re.findall(r"\w+", f"{outcome.subject.name} {each.rule.lower()}")
            name, course = "_".join(words), course_of(outcome.subject, each)
            test = virtual_test(model, outcome.subject, each) or ""
            texts = {
                f"{name}.mmd": sequence.mermaid(course),
                f"{name}.svg": sequence.svg(course),
                f"test_{name}.py": test,
            }
            for file, text in texts.items():
                if text:
                    write_document(str(folder / file), text.encode(), (), force=force)

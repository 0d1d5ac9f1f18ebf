"""`jausml validate` and `jausml model-check`: check models by rules, and by a search."""

from __future__ import annotations

import re
from collections.abc import Sequence
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
from jausml.cli.shared.models import (
    bridge_options,
    checked,
    frequency_option,
    model_argument,
    models_argument,
    reading_options,
    valid_system,
)
from jausml.cli.shared.options import REPORT_FORMATS, FiniteRange, format_option, quiet_option
from jausml.cli.shared.terminal import painted_findings

if TYPE_CHECKING:
    from jausml.language.model import Model
    from jausml.language.model.project import Reading
    from jausml.language.validation.rule import Report
    from jausml.model_checking.checking import Outcome


@click.command("validate")
@models_argument
@format_option("Format of the report.", REPORT_FORMATS)
@click.option("--output", metavar="FILE", help="Write the report to a file instead of stdout.")
@reading_options
@bridge_options
@frequency_option
@click.option("--strict", is_flag=True, help="Also fail on warnings.")
@click.option("--baseline", metavar="FILE", help="Ignore the findings that FILE lists.")
@click.option(
    "--write-baseline",
    is_flag=True,
    help="Write the findings of this run to the FILE of --baseline.",
)
@click.option(
    "--help-uri",
    metavar="URI",
    help="Address of your copy of the page of rules, to which SARIF links each rule.",
)
@quiet_option("Print no summary.")
def validate(
    paths: tuple[str, ...],
    output_format: str,
    output: str | None,
    reading: Reading,
    strict: bool,
    baseline: str | None,
    write_baseline: bool,
    help_uri: str | None,
    quiet: bool,
) -> None:
    """Check models: files, or all *.xmi and *.ros2jaus files below folders.

    Without a PATH, checks the project of the current folder.

    Follows references to other files. Reports all problems in one run, the same on each run.
    Ignores findings that an @allow in the documentation of an element allows, until its date.

    Exit status: 0 no errors, 1 errors (with --strict: or warnings), 2 a path cannot be read or a
    folder holds no models, 3 internal error.
    """
    from jausml.language.validation.formats import RENDERERS, sarif, text

    if write_baseline and baseline is None:
        raise click.UsageError("--write-baseline needs --baseline FILE")
    if help_uri is not None and output_format != "sarif":
        raise click.UsageError("--help-uri is for --format sarif")
    report, gone = checked(paths, reading), 0
    if baseline is not None:
        report, gone = _against(report, Path(baseline), is_written=write_baseline)
    shown = RENDERERS[output_format](report) if help_uri is None else sarif.render(report, help_uri)
    is_painted = output is None and output_format == "text"
    inputs = filter(None, (*report.files, baseline))
    write_report(painted_findings(shown) if is_painted else shown, output, inputs)
    if not quiet:
        click.echo(text.summary(report), err=True)
    if gone and not quiet:
        what = "finding of it is" if gone == 1 else "findings of it are"
        click.echo(f"{baseline}: {gone} {what} gone: write it anew", err=True)
    if report.has_errors or (strict and report.has_warnings):
        raise click.exceptions.Exit(PROBLEMS)


def _against(report: Report, path: Path, *, is_written: bool) -> tuple[Report, int]:
    """Returns a report without what a baseline lists, which is written first if that is wanted."""
    from collections import Counter

    from jausml.language.validation import baseline

    name = click.format_filename(path)
    try:
        if is_written:
            former = baseline.read(path) if path.exists() else Counter()
            write_report(baseline.written(report, former, path), str(path))
        return baseline.without_known(report, baseline.read(path), path)
    except OSError as error:
        hint = "; --write-baseline makes it" if isinstance(error, FileNotFoundError) else ""
        raise EnvironmentFault(f"cannot read {name}: {error.strerror}{hint}") from error
    except baseline.BaselineError as error:
        raise EnvironmentFault(f"{name} is no baseline: {error}") from error


FORMATS = ("text", "json", "sarif")
"""`jausml.model_checking.checking`."""

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
    help="Search at most this many states of each product.",
)
@click.option(
    "--budget",
    type=FiniteRange(0, min_open=True),
    default=_BUDGET,
    metavar="SECONDS",
    help="Search at most this long.",
)
@reading_options
@quiet_option("Print no summary.")
def model_check(
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

    from jausml.model_checking.checking import RENDERERS, check_system, summary, without_allowed

    read, system = valid_system(model, reading)
    end = time.monotonic() + budget
    all_outcomes = check_system(system, states, lambda: time.monotonic() > end, within or 0.0)
    outcomes = without_allowed(all_outcomes, read)
    if examples is not None:
        _write_examples(outcomes, read, Path(examples), force=force)
    inputs = (document.path for document in read.documents)
    write_report(RENDERERS[output_format](outcomes, read), output, inputs)
    if not quiet:
        click.echo(summary(outcomes), err=True)
    if any(outcome.found for outcome in outcomes):
        raise click.exceptions.Exit(PROBLEMS)


def _write_examples(
    outcomes: Sequence[Outcome], model: Model, folder: Path, *, force: bool
) -> None:
    """Writes the files of each counter-example that has steps."""
    from jausml.model_checking.checking import sequence_diagram
    from jausml.model_checking.virtual_test import virtual_test
    from jausml.views.diagrams.writers import sequence

    made_folder(folder)
    for outcome in outcomes:
        for counter_example in (example for example in outcome.found if example.moments):
            words = re.findall(r"\w+", f"{outcome.subject.name} {counter_example.rule.lower()}")
            name = "_".join(words)
            diagram = sequence_diagram(outcome.subject, counter_example)
            test = virtual_test(model, outcome.subject, counter_example) or ""
            texts = {
                f"{name}.mmd": sequence.mermaid(diagram),
                f"{name}.svg": sequence.svg(diagram),
                f"test_{name}.py": test,
            }
            for file, text in texts.items():
                if text:
                    write_document(str(folder / file), text.encode(), (), force=force)

"""`jausml validate`: checks models and reports in several formats."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.cli.shared.files import PROBLEMS, EnvironmentFault, write_report
from jausml.cli.shared.models import (
    bridge_options,
    checked,
    frequency_option,
    models_argument,
    reading_options,
)
from jausml.cli.shared.options import REPORT_FORMATS, format_option, quiet_option
from jausml.cli.shared.terminal import painted_findings

if TYPE_CHECKING:
    from jausml.language.project import Reading
    from jausml.language.validation.rule import Report


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
    help="Address of your copy of docs/reference/rules.md, to which SARIF links each rule.",
)
@quiet_option("Print no summary.")
def command(
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
    report = checked(paths, reading)
    gone = 0
    if baseline is not None:
        report, gone = _against(report, Path(baseline), is_written=write_baseline)
    rendered = (
        sarif.render(report, help_uri) if help_uri is not None else RENDERERS[output_format](report)
    )
    if output is None and output_format == "text":
        rendered = painted_findings(rendered)
    write_report(rendered, output)
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
    if is_written:
        try:
            former = baseline.read(path)
        except (OSError, baseline.BaselineError):
            former = Counter()  # what cannot be read is written anew
        write_report(baseline.written(report, former, path), str(path))
    try:
        return baseline.without_known(report, baseline.read(path), path)
    except OSError as error:
        hint = "; --write-baseline makes it" if isinstance(error, FileNotFoundError) else ""
        raise EnvironmentFault(f"cannot read {name}: {error.strerror}{hint}") from error
    except baseline.BaselineError as error:
        raise EnvironmentFault(f"{name} is no baseline: {error}") from error

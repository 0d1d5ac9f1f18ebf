"""`jausml validate`: checks models and reports in several formats."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from jausml.cli.choices import REPORT_FORMATS
from jausml.cli.common import (
    PROBLEMS,
    bridge_options,
    find_models,
    frequency_option,
    notations_for,
    reading_options,
    write_report,
)
from jausml.cli.manners import step
from jausml.cli.options import format_option, quiet_option

if TYPE_CHECKING:
    from jausml.cli.common import Reading


@click.command("validate")
@click.argument("paths", nargs=-1, required=True, metavar="PATH...")
@format_option("Format of the report.", REPORT_FORMATS)
@click.option("--output", metavar="FILE", help="Write the report to a file, not to stdout.")
@reading_options
@bridge_options
@frequency_option
@click.option("--strict", is_flag=True, help="Fail on warnings too.")
@quiet_option("Print no summary.")
def command(
    paths: tuple[str, ...],
    output_format: str,
    output: str | None,
    reading: Reading,
    bridge_address: str | None,
    frequency: float | None,
    strict: bool,
    quiet: bool,
) -> None:
    """Check models: files, or all *.xmi and *.ros2jaus files below folders.

    Follows references to other files. Reports all problems in one run, the same on each run.

    Exit status: 0 no errors, 1 errors (with --strict: or warnings), 2 a path cannot be read or a
    folder holds no models, 3 internal error.
    """
    from jausml.validation.engine import validate
    from jausml.validation.formats import RENDERERS, text

    if bridge_address is not None and len(paths) > 1:
        raise click.UsageError("--bridge-address takes one file of maps")
    notations = notations_for(paths[0], bridge_address, frequency)
    models = find_models(paths)
    with step("checking models"):
        report = validate(models, notations=notations, **reading)
    write_report(RENDERERS[output_format](report), output)
    if not quiet:
        click.echo(text.summary(report), err=True)
    if report.has_errors or (strict and report.has_warnings):
        raise click.exceptions.Exit(PROBLEMS)

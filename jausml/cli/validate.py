"""`jausml validate`: checks models and reports in several formats."""

from __future__ import annotations

import click

from jausml.cli.common import (
    PROBLEMS,
    bridge_options,
    find_models,
    frequency_option,
    notations_for,
    write_report,
)
from jausml.validation.engine import validate
from jausml.validation.formats import RENDERERS, text


@click.command("validate")
@click.argument("paths", nargs=-1, required=True, metavar="PATH...")
@click.option(
    "--format",
    "output_format",
    type=click.Choice(list(RENDERERS)),
    default="text",
    show_default=True,
    help="Format of the report.",
)
@click.option("--output", metavar="FILE", help="Write the report to a file, not to stdout.")
@click.option(
    "--project-root",
    metavar="DIR",
    type=click.Path(exists=True, file_okay=False),
    help="Folder that references may not leave; by default the Git checkout.",
)
@click.option("--allow-outside", is_flag=True, help="Let references leave the project root.")
@bridge_options
@frequency_option
@click.option("--strict", is_flag=True, help="Fail on warnings too.")
@click.option("-q", "--quiet", is_flag=True, help="Print no summary.")
def command(
    paths: tuple[str, ...],
    output_format: str,
    output: str | None,
    project_root: str | None,
    allow_outside: bool,
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
    if bridge_address is not None and len(paths) > 1:
        raise click.UsageError("--bridge-address takes one file of maps")
    notations = notations_for(paths[0], bridge_address, frequency)
    models = find_models(paths)
    report = validate(
        models, project_root=project_root, allow_outside=allow_outside, notations=notations
    )
    write_report(RENDERERS[output_format](report), output)
    if not quiet:
        click.echo(text.summary(report), err=True)
    if report.has_errors or (strict and report.has_warnings):
        raise click.exceptions.Exit(PROBLEMS)

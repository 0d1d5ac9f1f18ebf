"""`jausml validate`: checks models and reports in several formats."""

from __future__ import annotations

from pathlib import Path

import click

from jausml.cli.common import PROBLEMS, EnvironmentFault, find_models
from jausml.text.notation import NOTATIONS
from jausml.validation.engine import validate
from jausml.validation.formats import github, json, junit, sarif, text

_RENDERERS = {
    "text": text.render,
    "json": json.render,
    "junit": junit.render,
    "sarif": sarif.render,
    "github": github.render,
}


@click.command("validate")
@click.argument("paths", nargs=-1, required=True, metavar="PATH...")
@click.option(
    "--format",
    "output_format",
    type=click.Choice(list(_RENDERERS)),
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
@click.option("--strict", is_flag=True, help="Fail on warnings too.")
@click.option("-q", "--quiet", is_flag=True, help="Print no summary.")
def command(
    paths: tuple[str, ...],
    output_format: str,
    output: str | None,
    project_root: str | None,
    allow_outside: bool,
    strict: bool,
    quiet: bool,
) -> None:
    """Check models: files, or all *.xmi and *.ros2jaus files below folders.

    Follows references to other files. Reports all problems in one run, the same on each run.

    Exit status: 0 no errors, 1 errors (with --strict: or warnings), 2 a path cannot be read or a
    folder holds no models, 3 internal error.
    """
    models = find_models(paths)
    report = validate(
        models, project_root=project_root, allow_outside=allow_outside, notations=NOTATIONS
    )
    rendered = _RENDERERS[output_format](report)
    if output is None:
        click.echo(rendered, nl=False)
    else:
        _write(output, rendered)
    if not quiet:
        click.echo(text.summary(report), err=True)
    if report.has_errors or (strict and report.has_warnings):
        raise click.exceptions.Exit(PROBLEMS)


def _write(output: str, rendered: str) -> None:
    try:
        Path(output).write_text(rendered, encoding="utf-8", errors="backslashreplace", newline="\n")
    except OSError as error:
        name = click.format_filename(output)
        raise EnvironmentFault(f"cannot write {name}: {error.strerror}") from error

"""`jausml export`: writes services of a model as JSIDL."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.cli.shared.files import (
    PROBLEMS,
    EnvironmentFault,
    counted,
    made_folder,
    say,
    write_document,
)
from jausml.cli.shared.models import model_argument, reading_options, valid_model
from jausml.cli.shared.options import REPORT_FORMATS, format_option, quiet_option

if TYPE_CHECKING:
    from jausml.language.metamodel.classes import jaus
    from jausml.language.model.model import Model
    from jausml.language.project import Reading


@click.group("export")
def command() -> None:
    """Write services as JSIDL."""


@command.command("jsidl")
@model_argument
@click.option(
    "-o", "--output", required=True, metavar="DIR", help="Folder of the files, one per service."
)
@click.option("--with-inherited", is_flag=True, help="Write the services that they inherit, too.")
@click.option("--force", is_flag=True, help="Overwrite files that differ.")
@reading_options
@format_option("Format of the findings.", REPORT_FORMATS)
@quiet_option("Print no summary.")
def jsidl(
    model: str,
    output: str,
    with_inherited: bool,
    force: bool,
    reading: Reading,
    output_format: str,
    quiet: bool,
) -> None:
    """Export the services of MODEL as JSIDL 1.1 (AS5684).

    These are the services of its service sets, and those that its components provide, of the
    library too. An import of the files gives the same services; what JSIDL cannot say is a finding.

    Exit status: 0 done, 1 errors in the model or a service that is no JSIDL, 2 a path cannot be
    read or written, 3 internal error.
    """
    from jausml.language.exporters.jsidl import JSIDL_EXPORT_RULES, export_jsidl
    from jausml.language.semantics.jaus import services
    from jausml.language.validation.formats import RENDERERS, text
    from jausml.language.validation.rule import Report

    read = valid_model(model, reading, outcome="nothing written")
    chosen = _services(read)
    if not chosen:
        raise EnvironmentFault(f"{click.format_filename(model)} has no services")
    result = export_jsidl(read, services.with_inherited(chosen) if with_inherited else chosen)
    report = Report(read, (model,), tuple(result.diagnostics), rules=JSIDL_EXPORT_RULES)
    click.echo(RENDERERS[output_format](report), nl=False)
    if report.has_errors:
        say(f"{text.summary(report)}; nothing written", quiet=quiet)
        raise click.exceptions.Exit(PROBLEMS)
    folder = made_folder(Path(output))
    states = [
        write_document(str(folder / name), data, (), force=force)
        for name, data in result.documents.items()
    ]
    counts = ", ".join(f"{number} {state}" for state, number in Counter(states).items())
    summary = f"{counted((len(states), 'service'))}, {counts}"
    say(f"{click.format_filename(output)}: {summary}", quiet=quiet)


def _services(model: Model) -> list[jaus.Service]:
    """Returns the services of the file that was named, then those that its components provide."""
    from jausml.language.metamodel.classes import jaus

    given = [each for each in model.documents if each.given]
    elements = [each for document in given for each in model.elements_of(document)]
    own = [each for each in elements if isinstance(each, jaus.Service)]
    components = [each for each in elements if isinstance(each, jaus.Component)]
    provided = [service for each in components for service in each.provides]
    return list(dict.fromkeys([*own, *provided]))

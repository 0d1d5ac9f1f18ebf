"""`jausml partition`: proposes how to split bridges over several."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from jausml.cli.models.assumptions import assumption_options, whole_number
from jausml.cli.shared.files import document, write_document
from jausml.cli.shared.models import SUFFIXES, reading_options, valid_model

if TYPE_CHECKING:
    from jausml.language.model.model import Model
    from jausml.language.validation.project import Reading
    from jausml.views.analysis.assumptions import Assumptions

AUTO = "auto"


def _number(_: click.Context, __: click.Parameter, value: str) -> int | None:
    """Returns how many bridges there shall be, None for as many as are needed."""
    if value == AUTO:
        return None
    number = whole_number(value)
    if not number:
        raise click.BadParameter(f"{value!a} is neither a number of bridges nor '{AUTO}'")
    return number


@click.command("partition")
@click.argument("model", metavar="MODEL")
@click.option(
    "--bridges",
    "number",
    default=AUTO,
    show_default=True,
    metavar="N|auto",
    callback=_number,
    help="Number of bridges to split into.",
)
@click.option("-o", "--output", metavar="FILE", help="Write the split model to this file.")
@click.option("--force", is_flag=True, help="Overwrite FILE if it differs.")
@assumption_options
@reading_options
def command(
    model: str,
    number: int | None,
    output: str | None,
    force: bool,
    assumptions: Assumptions,
    reading: Reading,
) -> None:
    """Propose how to split the bridges in MODEL into several.

    Connections that share a topic, a report, a service or a controlled component stay together.
    With auto, there are as many bridges as are needed to separate commands from heavy traffic, and
    to overload none of them. The first part of a bridge keeps its name and address.

    Exit status: 0 done, 1 errors in the model or no such split, 2 usage or environment, 3 internal
    error.
    """
    from jausml.cli.models.assumptions import check_names, read_system
    from jausml.views.analysis.formats.partition import render
    from jausml.views.analysis.partition import UnsplittableError, propose
    from jausml.views.analysis.splitting import AddressesExhaustedError, split

    if output is not None and not output.endswith(_suffix(model)):
        raise click.UsageError(f"FILE must end with {_suffix(model)}, as MODEL does")
    read, system = read_system(model, reading)
    check_names(assumptions, system)
    try:
        proposal = propose(system, assumptions, number)
        bridges = split(proposal, system)
    except (UnsplittableError, AddressesExhaustedError) as error:
        raise click.ClickException(str(error)) from error
    for part, made in zip(proposal.parts, bridges, strict=True):
        if read.identifier(part.origin) is not None:
            read.name_by_id(made, str(made.name))
    click.echo(render(proposal, bridges), nl=False)
    if output is not None:
        _write(read, model, output, reading, force=force)


def _suffix(model: str) -> str:
    return next((each for each in SUFFIXES if model.endswith(each)), SUFFIXES[0])


def _write(read: Model, model: str, output: str, reading: Reading, *, force: bool) -> None:
    """Writes the model, reads it again, and shows what it has of errors."""
    data = document(read.documents[0].roots, read, output)
    state = write_document(output, data, (model,), force=force)
    click.echo(f"{click.format_filename(output)}: {state}", err=True)
    valid_model(output, reading)

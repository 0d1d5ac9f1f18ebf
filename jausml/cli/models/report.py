"""`jausml report`: tells what load and which worst-case times the system of a model has."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from jausml.cli.models.assumptions import assumption_options
from jausml.cli.shared.files import write_report
from jausml.cli.shared.models import reading_options
from jausml.cli.shared.options import format_option

if TYPE_CHECKING:
    from jausml.language.validation.project import Reading
    from jausml.views.analysis.assumptions import Assumptions

FORMATS = ("text", "json", "html")


@click.command("report")
@click.argument("model", metavar="MODEL")
@format_option("Format of the report; HTML is a single self-contained page.", FORMATS)
@click.option("-o", "--output", metavar="FILE", help="Write to a file instead of stdout.")
@click.option("--bridge", "bridge_name", metavar="NAME", help="Report only this bridge.")
@assumption_options
@reading_options
def command(
    model: str,
    output_format: str,
    output: str | None,
    bridge_name: str | None,
    assumptions: Assumptions,
    reading: Reading,
) -> None:
    """Report the load and the worst-case times of the system in MODEL.

    Shows for each connection its rates, sizes on the wire, packets, bandwidth, and how old a value
    may be on the other side. Starts nothing. Values that the model does not state are assumed, and
    marked as such.

    Exit status: 0 done, 1 errors in the model, 2 usage or environment, 3 internal error.
    """
    from dataclasses import replace
    from importlib import import_module

    from jausml.cli.models.assumptions import check_names, read_system
    from jausml.views.analysis.report import report_of

    _, system = read_system(model, reading)
    check_names(assumptions, system)
    report = report_of(system, assumptions)
    if bridge_name is not None:
        chosen = tuple(each for each in report.bridges if each.name == bridge_name)
        if not chosen:
            known = ", ".join(each.name for each in report.bridges) or "none"
            raise click.UsageError(f"no bridge {bridge_name!a}; there are: {known}")
        report = replace(report, components=chosen, hosts=())
    render = import_module(f"jausml.views.analysis.formats.{output_format}").render
    write_report(render(report), output)

"""`jausml diagram`: draws views of a model."""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING

import click

from jausml.cli.shared.files import EnvironmentFault, write_report
from jausml.cli.shared.models import checked, fail, model_argument, reading_options, show_findings
from jausml.cli.shared.terminal import step

if TYPE_CHECKING:
    from jausml.language.project import Reading
    from jausml.views.diagrams.graph import Graph

SUFFIXES = (".svg", ".png", ".html", ".mmd", ".dot")
THEMES = ("auto", "light", "dark")


@click.command("diagram")
@model_argument
@click.option(
    "--view",
    default="system",
    show_default=True,
    metavar="VIEW",
    help="View to draw: system, map:NAME, service:NAME or machine:NAME.",
)
@click.option(
    "-o",
    "--output",
    required=True,
    metavar="FILE",
    help=f"The file to write; its ending says what: {', '.join(SUFFIXES)}.",
)
@click.option(
    "--theme",
    type=click.Choice(THEMES),
    default="auto",
    show_default=True,
    help="Colours of pictures; auto follows the viewer's settings.",
)
@reading_options
def command(model: str, view: str, output: str, theme: str, reading: Reading) -> None:
    """Draw a view of MODEL.

    The view of the system shows components, bridges with their connections, and ROS nodes; a map,
    the members of both ends and its assignments; a service, its messages and what it inherits; a
    machine, its states and transitions. If the model has errors, the readable part is drawn
    together with the errors.

    Exit status: 0 done, 1 drawn, with errors in the model, 2 usage (an unknown view) or
    environment, 3 internal error.
    """
    from jausml.views.diagrams.views import UnknownViewError, graph_of

    suffix = PurePath(output).suffix
    if suffix not in SUFFIXES:
        raise click.UsageError(f"-o {output!a} ends in none of {', '.join(SUFFIXES)}")
    report = checked([model], reading)
    try:
        graph = graph_of(report.model, view, report.diagnostics)
    except UnknownViewError as error:
        if report.has_errors:
            show_findings(report)
        raise EnvironmentFault(str(error)) from error
    with step("drawing"):
        picture = _rendered(graph, suffix, theme)
    write_report(picture, output)
    if report.has_errors:
        show_findings(report)
        fail(report)


def _rendered(graph: Graph, suffix: str, theme: str) -> str | bytes:
    from jausml.views.diagrams.layout.graphviz import Graphviz
    from jausml.views.diagrams.layout.sheet import LayoutError
    from jausml.views.diagrams.writers import dot, html, mermaid, png, svg

    match suffix:
        case ".mmd":
            return mermaid.render(graph)
        case ".dot":
            return dot.render(graph)
    try:
        match suffix:
            case ".png":
                return png.render(graph, Graphviz(), theme)
            case ".html":
                return html.render(graph, Graphviz(), theme)
            case _:
                return svg.render(graph, Graphviz(), theme)
    except LayoutError as error:
        raise EnvironmentFault(str(error)) from error

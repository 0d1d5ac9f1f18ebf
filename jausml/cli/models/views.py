"""`jausml diagram` and `jausml report`: pictures of a model, and load and times of its system."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from pathlib import PurePath
from typing import TYPE_CHECKING, TypeVar

import click

from jausml.cli.shared.files import EnvironmentFault, ending_at, write_report
from jausml.cli.shared.models import (
    checked,
    fail,
    model_argument,
    reading_options,
    show_findings,
    valid_system,
)
from jausml.cli.shared.options import format_option
from jausml.cli.shared.terminal import step

if TYPE_CHECKING:
    from jausml.language.metamodel.classes.system import System
    from jausml.language.model.project import Reading
    from jausml.views.analysis.sizes import Assumptions
    from jausml.views.diagrams.graph import Graph

SUFFIXES = (".svg", ".png", ".html", ".mmd", ".dot")
THEMES = ("auto", "light", "dark")


@click.command("diagram")
@model_argument
@click.option(
    "--view",
    default="system",
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
    "--bodies",
    "has_bodies",
    is_flag=True,
    help="With the members of the messages that a service itself defines; for views of services.",
)
@click.option(
    "--theme",
    type=click.Choice(THEMES),
    default="auto",
    help="Colours of pictures; auto follows the viewer's settings.",
)
@reading_options
def diagram(
    model: str, view: str, output: str, has_bodies: bool, theme: str, reading: Reading
) -> None:
    """Draw a view of MODEL.

    The view of the system shows components, bridges with their connections, and ROS nodes; a map,
    the members of both ends and its assignments; a service, its messages and what it inherits; a
    machine, its states and transitions. If the model has errors, the readable part is drawn
    together with the errors.

    Exit status: 0 done, 1 drawn, with errors in the model, 2 usage (an unknown view) or
    environment, 3 internal error.
    """
    from jausml.views.diagrams.views import UnknownViewError, graph_of
    from jausml.views.diagrams.views.services import BODIES, SERVICE

    suffix = PurePath(output).suffix
    if suffix not in SUFFIXES:
        raise click.UsageError(f"-o {output!r} ends in none of {', '.join(SUFFIXES)}")
    if has_bodies and not view.startswith(SERVICE):
        raise click.UsageError(f"--bodies is for views of services, and not for {view!r}")
    validation_report = checked([model], reading)
    if has_bodies:
        view = BODIES + view.removeprefix(SERVICE)
    try:
        graph = graph_of(validation_report.model, view, validation_report.diagnostics)
    except UnknownViewError as error:
        if validation_report.has_errors:
            show_findings(validation_report)
        raise EnvironmentFault(str(error)) from error
    with step("drawing"):
        picture = _rendered(graph, suffix, theme)
    write_report(picture, output)
    if validation_report.has_errors:
        show_findings(validation_report)
        fail(validation_report)


def _rendered(graph: Graph, suffix: str, theme: str) -> str | bytes:
    from jausml.views.diagrams.layout.sheet import LayoutError
    from jausml.views.diagrams.writers import html, svg
    from jausml.views.diagrams.writers.text import render_dot, render_mermaid

    match suffix:
        case ".mmd":
            return render_mermaid(graph)
        case ".dot":
            return render_dot(graph)
    with ending_at(LayoutError):
        match suffix:
            case ".png":
                return svg.render_png(graph, theme)
            case ".html":
                return html.render(graph, theme)
            case _:
                return svg.render(graph, theme)


Number = TypeVar("Number", int, float)

_LARGEST_RATE = 1e6
_LARGEST_LENGTH = 1 << 32
_MOST_DIGITS = 18


def assumption_options(command: Callable[..., None]) -> Callable[..., None]:
    """Adds the options of assumed figures; the verb gets them as `assumptions`."""

    @click.option(
        "--assume-rate",
        "rates",
        multiple=True,
        metavar="[NAME=]HZ",
        help="Messages per second of topics and senders for which the model states no rate, 10 by "
        "default; with NAME or BRIDGE.NAME, of that connection. May be repeated.",
    )
    @click.option(
        "--assume-length",
        "lengths",
        multiple=True,
        metavar="[NAME=]N",
        help="Elements in unbounded lists, 100 by default; with NAME, in the messages of that "
        "connection. May be repeated.",
    )
    @functools.wraps(command)
    def with_assumptions(
        *arguments: object, rates: tuple[str, ...], lengths: tuple[str, ...], **others: object
    ) -> None:
        from jausml.views.analysis.sizes import DEFAULT_LENGTH, DEFAULT_RATE, Assumptions

        hertz = _named(rates, _rate)
        elements = _named(lengths, _length)
        assumptions = Assumptions(
            hertz.pop("", DEFAULT_RATE), elements.pop("", DEFAULT_LENGTH), hertz, elements
        )
        command(*arguments, assumptions=assumptions, **others)

    return with_assumptions


def check_names(assumptions: Assumptions, system: System) -> None:
    """Refuses assumptions about connections that a system does not have."""
    from jausml.views.analysis.sizes import names_of

    known = {
        name
        for owner in (*system.components, *system.bridges)
        for connection in (*owner.connections, *getattr(owner, "bridgeConnections", ()))
        for name in names_of(connection)
    }
    for name in sorted(assumptions.names - known):
        raise click.UsageError(f"no connection {name!r} of which to assume something")


def _named(values: tuple[str, ...], parse: Callable[[str], Number]) -> dict[str, Number]:
    """Returns values by the names before them, the empty one for all."""
    numbers_by_name = {}
    for value in values:
        name, _, number = value.rpartition("=")
        numbers_by_name[name] = parse(number)
    return numbers_by_name


def _rate(text: str) -> float:
    try:
        rate = float(text)
    except ValueError:
        rate = math.nan
    if not 1 / _LARGEST_RATE <= rate <= _LARGEST_RATE:
        raise click.UsageError(f"--assume-rate: {text!r} is no rate above 0 in hertz")
    return rate


def _length(text: str) -> int:
    is_number = text.isascii() and text.isdigit() and len(text) <= _MOST_DIGITS
    length = int(text) if is_number else None
    if length is None or length > _LARGEST_LENGTH:
        raise click.UsageError(f"--assume-length: {text!r} is no number of elements")
    return length


FORMATS = ("text", "json", "html")


@click.command("report")
@model_argument
@format_option("Format of the report; HTML is a single self-contained page.", FORMATS)
@click.option("-o", "--output", metavar="FILE", help="Write to a file instead of stdout.")
@click.option("--bridge", "bridge_name", metavar="NAME", help="Report only this bridge.")
@assumption_options
@reading_options
def report(
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

    from jausml.views.analysis.formats.plan import changes_of
    from jausml.views.analysis.report import report_of

    read, system = valid_system(model, reading)
    check_names(assumptions, system)
    report = replace(report_of(system, assumptions), changes=changes_of(system, assumptions))
    if bridge_name is not None:
        chosen = tuple(bridge for bridge in report.bridges if bridge.name == bridge_name)
        if not chosen:
            known = ", ".join(bridge.name for bridge in report.bridges) or "none"
            raise click.UsageError(f"no bridge {bridge_name!r}; there are: {known}")
        report = replace(report, components=chosen, hosts=(), changes=())
    render = import_module(f"jausml.views.analysis.formats.{output_format}").render
    write_report(render(report), output, (document.path for document in read.documents))

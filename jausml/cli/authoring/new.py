"""`jausml new`, and what its verbs share: the model that gets an element, and what was written."""

from __future__ import annotations

import functools
import shlex
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from jausml.cli.shared.files import ending_at
from jausml.cli.shared.options import FiniteRange, LazyGroup, format_option, refuse_options
from jausml.cli.shared.terminal import remark

if TYPE_CHECKING:
    from jausml.authoring.editing.commands import Command
    from jausml.authoring.projects.adding import Written
    from jausml.authoring.projects.places import Opened, Place
    from jausml.authoring.proposals.new_elements import OpenPoint

_KINDS = {
    "bridge": ("authoring.new_parts:bridge", "A bridge of topics, or of what runs in ROS."),
    "connection": ("authoring.new_parts:connection", "Further topics for a bridge."),
    "service-connection": ("authoring.new_calls:service_connection", "A ROS service for a bridge."),
    "action-connection": ("authoring.new_calls:action_connection", "A ROS action for a bridge."),
    "component": ("authoring.new_parts:component", "A JAUS component."),
    "node": ("authoring.new_parts:node", "A node of ROS."),
    "map": ("authoring.new_map:map_", "A map between a JAUS message and a ROS type."),
    "service": ("authoring.new_parts:service", "A JAUS service."),
    "partition": ("authoring.new_partition:partition", "Other bridges for the connections."),
}
"""The kinds, as `LazyGroup` has them."""


@click.group("new", cls=LazyGroup, verbs=_KINDS, invoke_without_command=True, no_args_is_help=True)
@click.option(
    "--open", "is_open", is_flag=True, help="List what is open in the project, and add nothing."
)
@format_option("Format of what --open lists.")
@click.pass_context
def command(context: click.Context, is_open: bool, output_format: str) -> None:
    """Add an element to a model, and keep its layout, comments and order.

    The model is the one in the project that has a system, or the file of --model, which is created
    if it does not exist.

    What no tool can decide stays open until a person decides it: `jausml new --open` lists it, as
    far as `jausml validate` reports it, with its place and what comes next.
    """
    if not is_open:
        refuse_options("only with --open", "output_format")
    elif context.invoked_subcommand is not None:
        raise click.UsageError(f"--open adds no {context.invoked_subcommand}")
    else:
        _list_open(output_format)


def _list_open(output_format: str) -> None:
    """Lists the findings of rules that ask for a decision of a person."""
    from dataclasses import replace

    from jausml.cli.shared.models import checked, project
    from jausml.cli.shared.terminal import painted_findings, warn
    from jausml.language.model.diagnostics import Severity
    from jausml.language.validation.formats import RENDERERS, text
    from jausml.language.validation.rules import all_rules

    report = checked([project()])
    asking = {rule.id for rule in all_rules() if rule.is_decision}
    open_findings = tuple(
        diagnostic for diagnostic in report.diagnostics if diagnostic.rule in asking
    )
    listed = replace(report, diagnostics=open_findings, set_aside=())
    rendered = RENDERERS[output_format](listed)
    is_text = output_format == "text"
    click.echo(painted_findings(rendered) if is_text else rendered, nl=False)
    if is_text:
        remark(text.summary(listed) if open_findings else "nothing is open")
    if others := report.count(Severity.ERROR) - listed.count(Severity.ERROR):
        said = "1 error" if others == 1 else f"{others} errors"
        warn(f"{said} besides, which may hide what is open: jausml validate")


def model_option(command: Callable[..., None]) -> Callable[..., None]:
    """Adds the option of the model that gets the element to a verb."""
    return click.option(
        "-m",
        "--model",
        metavar="FILE",
        type=click.Path(dir_okay=False, path_type=Path),
        help="Model to change; by default, the one in this project that has a system.",
    )(command)


def side_option(command: Callable[..., None]) -> Callable[..., None]:
    """Adds the option of what the nodes of ROS are to a verb."""
    return click.option(
        "--side",
        type=click.Choice(["vehicle", "operator"]),
        default="vehicle",
        help="Role of the ROS nodes: a vehicle that JAUS commands, or an operator that commands "
        "one.",
    )(command)


@dataclass(frozen=True)
class Choosing:
    """The options on how topics are bridged.

    `holds`: why last commands may stand, `TOPIC=REASON`. What is missing is asked on a terminal,
    unless the likeliest is taken, and nothing else answers it. `joints`: names of joints that a
    person states, `TOPIC=NAME,...`.
    """

    side: str
    yes: bool = False
    holds: tuple[str, ...] = ()
    joints: tuple[str, ...] = ()


def topic_options(command: Callable[..., None]) -> Callable[..., None]:
    """Adds the options of how topics are bridged to a verb, which takes them as `choosing`."""
    yes = click.option("--yes", is_flag=True, help="Take the likeliest map without asking.")
    hold = click.option(
        "--hold",
        "holds",
        metavar="TOPIC=REASON",
        multiple=True,
        help="Why the last command of a topic may stand when its source is lost: what you know "
        "about its receiver. May be repeated.",
    )
    joints = click.option(
        "--joints",
        metavar="TOPIC=NAME,...",
        multiple=True,
        help="Names of the joints of a topic, in the order that JAUS has. May be repeated.",
    )

    @functools.wraps(command)
    def with_choosing(
        *arguments: object,
        side: str,
        yes: bool,
        holds: tuple[str, ...],
        joints: tuple[str, ...],
        **others: object,
    ) -> None:
        command(*arguments, choosing=Choosing(side, yes, holds, joints), **others)

    return side_option(hold(joints(yes(with_choosing))))


def graph_options(command: Callable[..., None]) -> Callable[..., None]:
    """Adds the options of looking at what runs to a verb."""
    from_graph = click.option(
        "--from-graph",
        is_flag=True,
        help="Use the topics that exist in ROS now: all, or those named by arguments "
        "TOPIC[:MAP,...].",
    )
    seconds = click.option(
        "--for",
        "seconds",
        type=FiniteRange(0.1, 600),
        default=10.0,
        metavar="SECONDS",
        help="Longest time to look at the running system.",
    )

    @functools.wraps(command)
    def with_graph(*arguments: object, from_graph: bool, **others: object) -> None:
        if not from_graph:
            refuse_options("only with --from-graph", "seconds")
        command(*arguments, from_graph=from_graph, **others)

    return from_graph(seconds(with_graph))


def pairs(words: Sequence[str], sign: str, example: str) -> list[tuple[str, str]]:
    """Returns the two parts of words that have a sign between them."""
    word_pairs = []
    for word in words:
        first, mark, second = word.partition(sign)
        if not (first and mark and second):
            raise click.UsageError(f"{word!r} should be like {example}")
        word_pairs.append((first.strip(), second.strip()))
    return word_pairs


def place_for(model: Path | None) -> Place:
    """Returns the place of a model, by default that of the project of the current folder."""
    from jausml.authoring.projects.places import place_of, system_in

    return place_of(model) if model is not None else system_in(Path.cwd())


@contextmanager
def stopping() -> Iterator[None]:
    """Ends the verb where something cannot be added."""
    from jausml.authoring.projects.errors import ProjectError

    with ending_at(ProjectError):
        yield


def add_to(
    model: Path | None,
    label: str,
    commands: Callable[[Opened], Sequence[Command]],
    show: Callable[[], None] = lambda: None,
    *,
    is_of_services: bool = False,
) -> None:
    """Adds elements to a model, and shows remarks and the written files."""
    from jausml.authoring.projects.adding import add

    with stopping():
        place = place_for(model)
        written = add(place, label, commands, is_of_services=is_of_services)
    show()
    report(place, written)


def report(place: Place, written: Written) -> None:
    """Shows the written files, and the next command."""
    for file in written.files:
        done = "written and formatted" if file in written.formatted else "written"
        remark(f"{_shown(place.root / file)} {done}")
    remark(f"next: jausml validate {shlex.quote(_shown(place.path))}")


def show_open(points: Sequence[OpenPoint], findings: Sequence[str] = ()) -> None:
    """Shows the decisions that are left to a person, and remarks on a new element.

    `findings`: what rules report of the element as it is.
    """
    decisions = [*(str(point) for point in points if point.rule), *findings]
    remarks = [point.text for point in points if not point.rule]
    for title, lines in (("open", decisions), ("remarks", remarks)):
        for line in [title, *(f"  {point_text}" for point_text in lines)] if lines else ():
            click.echo(line)


def _shown(path: Path) -> str:
    here = Path.cwd()
    return click.format_filename(path.relative_to(here) if path.is_relative_to(here) else path)

"""`jausml new`: adds elements to the models of a project."""

from __future__ import annotations

from importlib import import_module

import click

from jausml.cli.shared.options import format_option

_KINDS = {
    "bridge": ("new_bridges:bridge", "A bridge of topics, or of what runs in ROS."),
    "connection": ("new_bridges:connection", "Further topics for a bridge."),
    "service-connection": ("new_calls:service_connection", "A ROS service for a bridge."),
    "action-connection": ("new_calls:action_connection", "A ROS action for a bridge."),
    "component": ("new_parts:component", "A JAUS component."),
    "node": ("new_parts:node", "A node of ROS."),
    "map": ("new_map:map_", "A map between a JAUS message and a ROS type."),
    "service": ("new_parts:service", "A JAUS service."),
}
"""The kinds: module and name of the verb, and what `--help` says before it is loaded."""


class Kinds(click.Group):
    """The kinds of elements; the module of one is imported when it is wanted."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002 - click's signature
        """Returns the kinds."""
        return list(_KINDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002
        """Returns the verb of a kind, or None when there is none of the name."""
        if cmd_name not in _KINDS:
            return None
        module, _, name = _KINDS[cmd_name][0].partition(":")
        command: click.Command = getattr(import_module(f"jausml.cli.authoring.{module}"), name)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        """Writes the list of kinds, without loading them."""
        with formatter.section("Commands"):
            formatter.write_dl([(kind, text) for kind, (_, text) in _KINDS.items()])


@click.group("new", cls=Kinds, invoke_without_command=True, no_args_is_help=True)
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
    if is_open and context.invoked_subcommand is not None:
        raise click.UsageError(f"--open adds no {context.invoked_subcommand}")
    if is_open:
        _list_open(output_format)
    elif context.invoked_subcommand is None:
        raise click.UsageError("--format is for --open")


def _list_open(output_format: str) -> None:
    """Lists the findings of rules that ask for a decision of a person."""
    from dataclasses import replace

    from jausml.cli.shared.models import checked, project
    from jausml.cli.shared.terminal import painted_findings, warn
    from jausml.language.model.diagnostics import Severity
    from jausml.language.validation.formats import RENDERERS, text
    from jausml.language.validation.rules import all_rules

    report = checked([project()])
    asking = {each.id for each in all_rules() if each.is_decision}
    found = tuple(each for each in report.diagnostics if each.rule in asking)
    listed = replace(report, diagnostics=found, set_aside=())
    rendered = RENDERERS[output_format](listed)
    is_text = output_format == "text"
    click.echo(painted_findings(rendered) if is_text else rendered, nl=False)
    if is_text:
        click.echo(text.summary(listed) if found else "nothing is open", err=True)
    if others := report.count(Severity.ERROR) - listed.count(Severity.ERROR):
        said = "1 error" if others == 1 else f"{others} errors"
        warn(f"{said} besides, which may hide what is open: jausml validate")

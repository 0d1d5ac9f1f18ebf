"""`jausml new`: adds elements to the models of a project."""

from __future__ import annotations

from importlib import import_module

import click

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


@click.group("new", cls=Kinds)
def command() -> None:
    """Add an element to a model, and keep its layout, comments and order.

    The model is the one in the project that has a system, or the file of --model, which is created
    if it does not exist.
    """

"""Shared parts of the commands of `jausml ocu`: options, arguments, and an operator for a while."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from functools import wraps
from typing import TYPE_CHECKING, Any

import click

from jausml.cli.common import EnvironmentFault, FiniteRange
from jausml.cli.manners import remark, warn
from jausml.cli.messages import open_catalogue
from jausml.cli.network import (
    ended_by_signals,
    identified_network,
    network_from,
    network_options,
    transport_options,
)
from jausml.cli.options import completing, format_option

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from jausml.live.messages import MessageEntry
    from jausml.live.peers.network import Network
    from jausml.live.peers.operator import Operator
    from jausml.runtime.base.address import JausAddress

_REMEDY = (
    "To go through a node manager: --transport node-manager; or use another port and say where the "
    "components are: --port 3795 --peer ID=HOST:3794"
)


@dataclass(frozen=True)
class Settings:
    """Options that all commands of the operator share.

    Attributes:
        timeout: Seconds to wait for an answer.
    """

    network: Network
    models: tuple[str, ...]
    timeout: float
    as_json: bool

    @contextmanager
    def operator(self) -> Iterator[Operator]:
        """Yields an operator; its errors become those of the command line."""
        from jausml.live.messages import MessageError
        from jausml.live.peers.asking import NoAnswer
        from jausml.live.peers.network import fault
        from jausml.live.peers.operator import Refused, running_operator

        try:
            with (
                identified_network(self.network) as network,
                running_operator(network, open_catalogue(self.models), self.timeout) as operator,
            ):
                try:
                    yield operator
                finally:
                    for peer, learnt in operator.quirks():
                        remark(f"note: {peer} {learnt}")
                    if operator.is_impersonated:
                        warn(f"warning: another program of the network sends as {operator.own}")
        except NoAnswer as error:
            raise EnvironmentFault(str(error)) from error
        except Refused as error:
            raise click.ClickException(str(error)) from error
        except MessageError as error:
            raise click.UsageError(str(error)) from error
        except OSError as error:
            raise EnvironmentFault(fault(error, self.network, _REMEDY)) from error

    def show(self, source: JausAddress, entry: MessageEntry, fields: dict[str, Any]) -> None:
        """Prints a report."""
        from jausml.live.peers import rendering

        render = rendering.report_json if self.as_json else rendering.report_line
        click.echo(render(source, entry, fields))


def _address(_context: click.Context, _parameter: click.Parameter, value: str) -> JausAddress:
    from jausml.live.peers.network import component_address

    try:
        return component_address(value)
    except ValueError as error:
        raise click.BadParameter(str(error)) from error


def _fields(
    _context: click.Context, _parameter: click.Parameter, value: str | None
) -> dict[str, Any] | None:
    from jausml.live.peers.console import parse_fields

    try:
        return None if value is None else parse_fields(value)
    except ValueError as error:
        raise click.BadParameter(str(error)) from error


TARGET = click.argument("target", metavar="ID", callback=_address)
MESSAGE = click.argument(
    "message", metavar="MESSAGE", shell_complete=completing("messages", "message")
)
FIELDS = click.argument("fields", metavar="[FIELDS]", callback=_fields, required=False)


def operator_options(function: Callable[..., None]) -> Callable[..., None]:
    """Adds the shared options and hands them to the function as `Settings`."""

    @network_options
    @transport_options
    @click.option(
        "--timeout",
        type=FiniteRange(0.05, 600),
        default=3.0,
        show_default=True,
        help="Seconds to wait for an answer.",
    )
    @format_option("Format of the output.")
    @wraps(function)
    def run(
        *arguments: Any,
        own_id: str | None,
        interface: str,
        port: int,
        multicast_group: str,
        peers: tuple[str, ...],
        models: tuple[str, ...],
        transport: str,
        node_manager_directory: str,
        timeout: float,
        output_format: str,
        **others: Any,
    ) -> None:
        network = network_from(
            own_id,
            interface,
            port,
            multicast_group,
            peers,
            transport=transport,
            node_manager_directory=node_manager_directory,
        )
        settings = Settings(network, models, timeout, output_format == "json")
        function(*arguments, settings=settings, **others)

    return run


@contextmanager
def until_interrupted() -> Iterator[None]:
    """Ends a block with Ctrl-C in good order: what is held is released by who holds it."""
    try:
        with ended_by_signals():
            yield
    except KeyboardInterrupt:
        remark("interrupted")

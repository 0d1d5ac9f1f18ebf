"""Options of the live tools: who we are, and how the network is reached."""

from __future__ import annotations

import signal
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TypeVar

import click

from jausml.cli.messages import model_option
from jausml.live.peers.identity import identified
from jausml.live.peers.network import (
    DEFAULT_GROUP,
    DEFAULT_INTERFACE,
    DEFAULT_PORT,
    Network,
    make_network,
    silence_log,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

F = TypeVar("F", bound="Callable[..., Any]")

_OPTIONS = (
    click.option(
        "--id",
        "own_id",
        metavar="ID",
        help="JAUS id of this tool, subsystem.node.component; by default a free one of 65000.",
    ),
    click.option(
        "--interface",
        default=DEFAULT_INTERFACE,
        show_default=True,
        metavar="ADDRESS",
        help="IPv4 address of the network interface.",
    ),
    click.option(
        "--port",
        type=click.IntRange(1, 65535),
        default=DEFAULT_PORT,
        show_default=True,
        help="UDP port of JUDP.",
    ),
    click.option(
        "--multicast-group",
        default=DEFAULT_GROUP,
        show_default=True,
        metavar="ADDRESS",
        help="Multicast group of JUDP.",
    ),
    click.option(
        "--peer",
        "peers",
        multiple=True,
        metavar="ID=HOST:PORT",
        help="Where a component is, when multicast does not reach it; may be repeated.",
    ),
    model_option,
)


def network_options(function: F) -> F:
    """Adds the options that `network_from` and `open_catalogue` take."""
    for option in reversed(_OPTIONS):
        function = option(function)
    return function


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """Lets SIGTERM end a block like Ctrl-C, so that what is held is released."""
    former = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, former)


@contextmanager
def identified_network(network: Network, count: int = 1) -> Iterator[Network]:
    """Yields the network with our id, and warns when another tool has it.

    Args:
        network: The network.
        count: Ids that are needed, one after the other.
    """
    with identified(network, count) as ours:
        if ours.is_shared:
            click.echo(
                f"warning: another jausml tool of this host has the id {ours.own} too, and answers "
                "may go there; without --id each has its own",
                err=True,
            )
        yield ours


def network_from(
    own_id: str | None, interface: str, port: int, multicast_group: str, peers: Sequence[str]
) -> Network:
    """Returns the network that the options describe, and keeps the runtime's log quiet.

    Raises:
        click.UsageError: An option cannot be.
    """
    silence_log()
    try:
        return make_network(own_id, interface, port, multicast_group, peers)
    except ValueError as error:
        raise click.UsageError(str(error)) from error

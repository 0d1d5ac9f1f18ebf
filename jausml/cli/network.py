"""Options of the live tools: who we are, and how the network is reached."""

from __future__ import annotations

import signal
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

from jausml.cli.choices import TRANSPORTS
from jausml.cli.messages import model_option
from jausml.cli.options import (
    interface_option,
    multicast_group_option,
    peer_option,
    port_option,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from jausml.live.peers.network import Network

_OPTIONS = (
    click.option(
        "--id",
        "--jaus-id",
        "own_id",
        metavar="ID",
        help="JAUS id of this tool, subsystem.node.component; by default, a free one in subsystem "
        "65000.",
    ),
    interface_option(),
    port_option(),
    multicast_group_option(),
    peer_option(),
    model_option,
)


_TRANSPORT_OPTIONS = (
    click.option(
        "--transport",
        "--jaus-transport",
        "transport",
        type=click.Choice(TRANSPORTS),
        default=TRANSPORTS[0],
        show_default=True,
        help="UDP, TCP, or the node manager of this host.",
    ),
    click.option(
        "--node-manager-directory",
        "--jaus-node-manager-directory",
        "node_manager_directory",
        default="",
        metavar="FOLDER",
        help="Folder of the local sockets of the node manager; by default, the one for temporary "
        "files.",
    ),
)


def transport_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Adds the options that choose a transport."""
    for option in reversed(_TRANSPORT_OPTIONS):
        function = option(function)
    return function


def network_options(function: Callable[..., Any]) -> Callable[..., Any]:
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
    """Yields the network with our id, and warns when another tool has it."""
    from jausml.live.peers.identity import identified

    with identified(network, count) as ours:
        if ours.is_shared:
            click.echo(
                f"warning: another jausml tool of this host has the id {ours.own} too, and answers "
                "may go there; without --id each has its own",
                err=True,
            )
        yield ours


def network_from(
    own_id: str | None,
    interface: str,
    port: int,
    multicast_group: str,
    peers: Sequence[str],
    **transport: str,
) -> Network:
    """Returns the network that the options describe, and keeps the runtime's log quiet.

    Args:
        own_id: Our JAUS id, None for a free one.
    """
    from jausml.live.peers.network import make_network, silence_log

    silence_log()
    try:
        return make_network(own_id, interface, port, multicast_group, peers, **transport)
    except ValueError as error:
        raise click.UsageError(str(error)) from error

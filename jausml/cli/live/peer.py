"""`jausml peer`: starts a rover as other makes have it, before the real one is there."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import click

from jausml.cli.live.network import (
    network_from,
    parsed_address,
    reaching,
    until_interrupted,
)
from jausml.cli.shared.models import open_catalogue
from jausml.cli.shared.options import (
    MAKES,
    format_option,
    multicast_group_option,
    port_option,
)

if TYPE_CHECKING:
    from jausml.live.messages import MessageEntry
    from jausml.runtime.base.address import JausAddress

_HOST = "127.0.0.2"
_REMEDY = "Give the peer an address of its own: --interface 127.0.0.3"


@click.command("peer")
@click.argument("make", type=click.Choice(MAKES))
@click.option(
    "--id",
    "address",
    callback=parsed_address,
    default="152.1.1",
    metavar="ID",
    help="JAUS id of the rover.",
)
@format_option("Format of the commands that it obeys.")
@click.option(
    "--interface",
    default=_HOST,
    metavar="ADDRESS",
    help="IPv4 address that the rover has; by default, a host of its own on this computer.",
)
@port_option()
@multicast_group_option()
def command(
    make: str,
    address: JausAddress,
    output_format: str,
    interface: str,
    port: int,
    multicast_group: str,
) -> None:
    """Start a rover of MAKE, to try a bridge or an operator unit with.

    It has the habits of its make on the wire, those that trouble others too: junior is a rover on
    Junior, jts one as the JAUS Tool Set generates it, jaus++ one on JAUS++ 5. It takes
    SetWrenchEffort and reports VelocityState, at 2 m/s for an effort of 100 percent, and prints
    each command that it obeys, until Ctrl-C.

    Exit status: 0 done, 2 the network cannot be used or an option is wrong, 3 internal error.
    """
    from jausml.live.peers import rendering
    from jausml.live.peers.makes.rover import MAKES as MAKERS
    from jausml.live.peers.makes.rover import Rover
    from jausml.live.peers.makes.vehicle import Place

    as_json = output_format == "json"
    render = rendering.report_json if as_json else rendering.report_line

    def obeyed(source: JausAddress, entry: MessageEntry, fields: dict[str, Any]) -> None:
        click.echo(render(source, entry, fields))

    network = network_from(None, interface, port, multicast_group, [])
    rover = Rover(open_catalogue([]), obeyed)
    with reaching(network, _REMEDY):
        peer = MAKERS[make](address, rover, Place(interface, port, multicast_group))
    click.echo(f"{make} rover {address} at {interface}:{port}", err=True)
    try:
        with until_interrupted():
            threading.Event().wait()
    finally:
        peer.close()

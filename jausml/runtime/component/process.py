"""What processes of JAUS components have in common: command line, transport, watchdog."""

from __future__ import annotations

import argparse
import os
import re
import socket
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace

from ..base.address import JausAddress
from ..base.api import optional_part
from ..base.counters import LOGGER
from ..base.loop import Loop
from ..base.process import LOG_LEVELS, log_counts
from ..base.settings import TransportKind, TransportSettings
from ..services.definitions import ComponentSettings, Scope, server_type
from ..transports.transport import Transport
from ..transports.udp.judp import JudpTransport

_EMPTY_OPTION = re.compile("--[a-z-]+=")


def given_options(line: Sequence[str]) -> list[str]:
    """Returns a command line without options that are empty, such as ``--jaus-port=``.

    Launch files pass on all of their arguments; an empty one leaves what model and parameters say.
    """
    return [word for word in line if not _EMPTY_OPTION.fullmatch(word)]


def add_component_arguments(parser: argparse.ArgumentParser, address: JausAddress) -> None:
    """Adds the options of a component that are not the transport's."""
    group = parser.add_argument_group("JAUS component")
    group.add_argument(
        "--jaus-id",
        type=_address,
        default=address,
        metavar="ID",
        help="address subsystem.node.component (default %(default)s)",
    )
    group.add_argument(
        "--jaus-digital-resources",
        type=_digital_resources,
        default=(),
        metavar="URLS",
        help="where streams and files of the component are, with spaces between them",
    )
    group.add_argument(
        "--discovery-scope",
        choices=[scope.name.lower() for scope in Scope],
        help="what the component's Discovery service answers for",
    )
    group.add_argument(
        "--control-survives-emergency",
        action="store_true",
        help="let the controller keep control in an emergency, for clients that count on it",
    )
    group.add_argument(
        "--log-level", choices=LOG_LEVELS, default="info", help="default %(default)s"
    )


def component_settings(
    arguments: argparse.Namespace, defaults: ComponentSettings | None = None
) -> ComponentSettings:
    """Returns the settings that the options of ``add_component_arguments`` describe."""
    known = ComponentSettings() if defaults is None else defaults
    if arguments.control_survives_emergency:
        known = replace(known, control_survives_emergency=True)
    if arguments.jaus_digital_resources:
        known = replace(known, digital_resources=arguments.jaus_digital_resources)
    if arguments.discovery_scope is None:
        return known
    return replace(known, discovery_scope=Scope[arguments.discovery_scope.upper()])


@contextmanager
def running_transport(settings: TransportSettings) -> Iterator[Transport]:
    """Opens a transport on a loop of its own for a block; OSError where the network refuses."""
    with Loop() as loop:
        transport = create_transport(settings, loop)
        transport.open()
        try:
            loop.start()
            loop.call_soon(lambda: feed_watchdog(loop))
            yield transport
        finally:
            transport.close()
            log_counts("drops", transport.counters.drops())


def _address(text: str) -> JausAddress:
    try:
        address = JausAddress.parse(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error
    if not address.is_concrete:
        raise argparse.ArgumentTypeError(f"{text} does not name one component")
    return address


def _digital_resources(text: str) -> tuple[str, ...]:
    urls = tuple(text.split())
    try:
        for url in urls:
            server_type(url)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error
    return urls


_OPTIONAL_TRANSPORTS = {
    TransportKind.JTCP: ("transports.jtcp", "JtcpTransport"),
    TransportKind.NODE_MANAGER: ("transports.node_manager", "NodeManagerTransport"),
}
"""Modules and classes of transports that a workspace has where its model asks for them."""


def create_transport(settings: TransportSettings, loop: Loop) -> Transport:
    """Returns the transport of settings, not yet open; JausError where the workspace has none."""
    if settings.transport is TransportKind.JUDP:
        return JudpTransport(settings, loop)
    kind: Callable[[TransportSettings, Loop], Transport] = optional_part(
        *_OPTIONAL_TRANSPORTS[settings.transport]
    )
    return kind(settings, loop)


_TIMES_IN_TIME_OUT = 3
"""Notifications within the time after which a silent process is killed and started again."""


def feed_watchdog(loop: Loop, environment: Mapping[str, str] = os.environ) -> None:
    """Tells systemd that the loop turns, as long as it does; nothing where nobody watches.

    The lock of the loop is held.
    """
    place, time_out = environment.get("NOTIFY_SOCKET", ""), environment.get("WATCHDOG_USEC", "")
    # A process that this one starts inherits the environment, and is not who is watched.
    watched = environment.get("WATCHDOG_PID", str(os.getpid()))
    is_time_out = time_out.isdecimal() and int(time_out) > 0
    if not place or not is_time_out or watched != str(os.getpid()):
        return
    # A name that begins with @ is one of Linux's abstract sockets.
    address = f"\0{place[1:]}" if place.startswith("@") else place
    period, was_told = int(time_out) / 1e6 / _TIMES_IN_TIME_OUT, True

    def feed() -> None:
        nonlocal was_told
        try:
            with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC) as sender:
                # A manager that reads nothing must not hold up the loop.
                sender.settimeout(0)
                sender.sendto(b"WATCHDOG=1", address)
        except OSError as error:
            if was_told:
                LOGGER.warning("the watchdog at %s cannot be told: %s", address, error)
            was_told = False
        else:
            was_told = True
        # Also where it failed: a manager that is away for a moment would kill a sound process.
        loop.call_later(period, feed)

    feed()

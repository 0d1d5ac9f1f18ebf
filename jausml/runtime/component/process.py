"""Common parts of processes of JAUS components: command line, transport, watchdog."""

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
    """Returns a command line without empty options, such as ``--jaus-port=``.

    Launch files pass on all of their arguments; an empty one keeps the value of the model.
    """
    return [word for word in line if not _EMPTY_OPTION.fullmatch(word)]


def add_component_arguments(parser: argparse.ArgumentParser, address: JausAddress) -> None:
    """Adds the options of a component; those of the transport are not among them."""
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
    """Returns settings with the values of the options of ``add_component_arguments``."""
    settings = ComponentSettings() if defaults is None else defaults
    if arguments.control_survives_emergency:
        settings = replace(settings, control_survives_emergency=True)
    if arguments.jaus_digital_resources:
        settings = replace(settings, digital_resources=arguments.jaus_digital_resources)
    if arguments.discovery_scope is None:
        return settings
    return replace(settings, discovery_scope=Scope[arguments.discovery_scope.upper()])


@contextmanager
def running_transport(settings: TransportSettings) -> Iterator[Transport]:
    """Runs a transport on a loop of its own within the block; raises OSError of the network."""
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


# Modules and classes of transports that are only in workspaces whose model uses them.
_OPTIONAL_TRANSPORTS = {
    TransportKind.JTCP: ("transports.jtcp", "JtcpTransport"),
    TransportKind.NODE_MANAGER: ("transports.node_manager", "NodeManagerTransport"),
}


def create_transport(settings: TransportSettings, loop: Loop) -> Transport:
    """Returns a transport, not yet open; raises JausError if the workspace does not have it."""
    if settings.transport is TransportKind.JUDP:
        return JudpTransport(settings, loop)
    kind: Callable[[TransportSettings, Loop], Transport] = optional_part(
        *_OPTIONAL_TRANSPORTS[settings.transport]
    )
    return kind(settings, loop)


_NOTIFICATIONS = 3  # within the time after which systemd kills a silent process


def feed_watchdog(loop: Loop, environment: Mapping[str, str] = os.environ) -> None:
    """Notifies systemd while the loop runs, if the process has a watchdog.

    The caller holds the lock of the loop.
    """
    path, time_out = environment.get("NOTIFY_SOCKET", ""), environment.get("WATCHDOG_USEC", "")
    # A child process inherits the environment, but is not watched.
    watched = environment.get("WATCHDOG_PID", str(os.getpid()))
    is_time_out = time_out.isdecimal() and int(time_out) > 0
    if not path or not is_time_out or watched != str(os.getpid()):
        return
    # A name that begins with @ is one of Linux's abstract sockets.
    address = f"\0{path[1:]}" if path.startswith("@") else path
    period, was_notified = int(time_out) / 1e6 / _NOTIFICATIONS, True

    def feed() -> None:
        nonlocal was_notified
        try:
            with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC) as sender:
                # A manager that does not read must not block the loop.
                sender.settimeout(0)
                sender.sendto(b"WATCHDOG=1", address)
        except OSError as error:
            if was_notified:
                LOGGER.warning("the watchdog at %s cannot be told: %s", address, error)
            was_notified = False
        else:
            was_notified = True
        # Also after an error, as the manager may come back.
        loop.call_later(period, feed)

    feed()

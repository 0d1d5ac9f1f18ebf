"""Process of JAUS components: command line, transport, log, signals, clean shutdown, exit code."""

from __future__ import annotations

import argparse
import atexit
import logging
import re
import signal
import sys
from contextlib import contextmanager
from dataclasses import dataclass, replace
from queue import SimpleQueue
from typing import TYPE_CHECKING

from ..base.address import JausAddress
from ..base.api import JausError, part_of_whole
from ..base.loop import Loop
from ..base.settings import TransportKind, TransportSettings, add_arguments, from_arguments
from ..services.definitions import ComponentSettings, Scope, server_type
from ..transports.udp.judp import JudpTransport
from .watchdog import feed_watchdog

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from types import FrameType

    from ..transports.transport import Transport
    from .base import Component

    Factory = Callable[[Transport, JausAddress, ComponentSettings], Component]


LOGGER = logging.getLogger("jausml")

LOG_FORMAT = "%(asctime)s %(levelname)s %(name)s: %(message)s"

LOG_LEVELS = ("debug", "info", "warn", "warning", "error")

_NOT_GIVEN = re.compile("--[a-z-]+=")

EXIT_OK = 0
EXIT_FAILED = 1
EXIT_USAGE = 2


@dataclass(frozen=True)
class ComponentProgram:
    """What the model says of a component's process; options override it."""

    name: str
    description: str
    address: JausAddress
    transport: TransportSettings | None = None
    settings: ComponentSettings | None = None


def run_component(
    factory: Factory, program: ComponentProgram, argv: Sequence[str] | None = None
) -> int:
    """Run one component until SIGINT, SIGTERM or a JAUS Shutdown ends it.

    Args:
        argv: Command line without the program's name; the process's own when None.

    Returns:
        The exit code: 0 after a clean shutdown, 1 when the component could not start.

    Raises:
        SystemExit: The command line is wrong (code 2) or asks for help (code 0).
    """
    name = program.name
    parser = argparse.ArgumentParser(prog=name, description=program.description)
    add_component_arguments(parser, program.address)
    add_arguments(parser, program.transport)
    arguments = parser.parse_args(given_options(sys.argv[1:] if argv is None else argv))
    configure_log(arguments.log_level)
    behaviour = component_settings(arguments, program.settings)
    try:
        transport_settings = from_arguments(arguments, program.transport)
    except ValueError as error:
        parser.error(str(error))
    stop = StopRequest()
    try:
        with stop.on_signals(), running_transport(transport_settings) as network:
            network.loop.on_failure = stop.fail
            component = factory(network, arguments.jaus_id, behaviour)
            component.when_shut_down(lambda: stop.request("JAUS Shutdown"))
            component.start()
            LOGGER.info("%s runs as %s", name, arguments.jaus_id)
            try:
                reason = stop.wait()
                LOGGER.info("%s ends: %s", name, reason)
            finally:
                component.stop()
    except OSError as error:
        LOGGER.error("%s cannot use the network: %s", name, error)
        return EXIT_FAILED
    except JausError as error:
        LOGGER.error("%s cannot run: %s", name, error)
        return EXIT_FAILED
    except Exception:
        LOGGER.exception("%s failed", name)
        return EXIT_FAILED
    return EXIT_OK


def given_options(line: Sequence[str]) -> list[str]:
    """Returns a command line without options that are empty, such as `--jaus-port=`.

    Launch files pass all of their arguments on; those without a value leave what the model and the
    parameters say.
    """
    return [word for word in line if not _NOT_GIVEN.fullmatch(word)]


def add_component_arguments(parser: argparse.ArgumentParser, address: JausAddress) -> None:
    """Add the options of a component that are not the transport's."""
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
    """Return the settings that the options of ``add_component_arguments`` describe."""
    known = ComponentSettings() if defaults is None else defaults
    if arguments.control_survives_emergency:
        known = replace(known, control_survives_emergency=True)
    if arguments.jaus_digital_resources:
        known = replace(known, digital_resources=arguments.jaus_digital_resources)
    if arguments.discovery_scope is None:
        return known
    return replace(known, discovery_scope=Scope[arguments.discovery_scope.upper()])


def configure_log(level: str) -> None:
    """Log to standard error."""
    logging.basicConfig(format=LOG_FORMAT, level=level.upper())


@contextmanager
def running_transport(settings: TransportSettings) -> Iterator[Transport]:
    """Open a transport on a loop of its own for the duration of a block.

    Raises:
        OSError: The network cannot be used as the settings say.
    """
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


def log_counts(label: str, counts: Mapping[str, int]) -> None:
    """Log names and numbers on one line, as the last word of a process on what it did."""
    pairs = " ".join(f"{name}={number}" for name, number in counts.items())
    LOGGER.info("%s: %s", label, pairs or "none")


class StopRequest:
    """Ends the wait of the main thread; may be requested by signals and by any thread."""

    def __init__(self) -> None:
        # Unlike Event.set, SimpleQueue.put may be called in a signal handler that interrupts
        # the very thread that waits.
        self._requests: SimpleQueue[str | BaseException] = SimpleQueue()

    def request(self, reason: str) -> None:
        """End the wait."""
        self._requests.put(reason)

    def fail(self, error: BaseException) -> None:
        """End the wait by an error of a thread without which the process is of no use."""
        self._requests.put(error)

    def wait(self) -> str:
        """Wait for a request and return its reason.

        Raises:
            BaseException: The error of a thread that failed.
        """
        request = self._requests.get()
        if isinstance(request, BaseException):
            raise request
        return request

    @contextmanager
    def on_signals(self) -> Iterator[None]:
        """Let SIGINT and SIGTERM request the stop during a block."""

        def handle(number: int, _frame: FrameType | None) -> None:
            self.request(signal.Signals(number).name)

        atexit.register(ignore_signals)
        numbers = (signal.SIGINT, signal.SIGTERM)
        former = {number: signal.signal(number, handle) for number in numbers}
        try:
            yield
        finally:
            for number, handler in former.items():
                signal.signal(number, handler)


def ignore_signals() -> None:
    """Lets a process that is at its end end, whoever signals once more."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)


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


_OTHERS = {
    TransportKind.JTCP: ("transports.jtcp", "JtcpTransport"),
    TransportKind.NODE_MANAGER: ("transports.node_manager", "NodeManagerTransport"),
}


def create_transport(settings: TransportSettings, loop: Loop) -> Transport:
    """Return the transport that the settings name, not yet open.

    Raises:
        JausError: It is none that the model asks for, and the workspace does not have it.
    """
    if settings.transport is TransportKind.JUDP:
        return JudpTransport(settings, loop)
    kind: Callable[[TransportSettings, Loop], Transport] = part_of_whole(
        *_OTHERS[settings.transport]
    )
    return kind(settings, loop)

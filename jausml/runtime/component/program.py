"""The program of a process with one JAUS component."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ..base.address import JausAddress
from ..base.counters import LOGGER
from ..base.process import EXIT_OK, StopRequest, configure_log, failed
from ..base.settings import TransportSettings, add_arguments, from_arguments
from ..services.definitions import ComponentSettings
from ..transports.transport import Transport
from .base import Component
from .process import add_component_arguments, component_settings, given_options, running_transport

Factory = Callable[[Transport, JausAddress, ComponentSettings], Component]


@dataclass(frozen=True)
class ComponentProgram:
    """Settings of the process of a component from its model; options override them."""

    name: str
    description: str
    address: JausAddress
    transport: TransportSettings | None = None
    settings: ComponentSettings | None = None


def run_component(
    factory: Factory, program: ComponentProgram, argv: Sequence[str] | None = None
) -> int:
    """Runs one component until SIGINT, SIGTERM, SIGHUP or a JAUS Shutdown ends it.

    Args:
        argv: Command line without the program's name; that of the process when None.

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
    except Exception as error:
        return failed(name, error)
    return EXIT_OK

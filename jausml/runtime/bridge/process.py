"""Process of one bridge: command line, signals, clean shutdown on both sides, exit code."""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from typing import TYPE_CHECKING

from ..base.counters import LOGGER
from ..base.settings import add_arguments, from_arguments
from ..component.process import (
    EXIT_FAILED,
    EXIT_OK,
    StopRequest,
    add_component_arguments,
    component_settings,
    configure_log,
    log_counts,
    running_transport,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ..base.settings import TransportSettings
    from .bridge import Bridge
    from .ros import RosNode


def run_bridge(bridge: Bridge, arguments: Sequence[str] | None = None) -> int:
    """Runs a bridge until SIGINT, SIGTERM or a JAUS Shutdown ends it.

    Args:
        bridge: The bridge, not yet opened.
        arguments: Command line without the program's name, with --ros-args; that of the process
            when None.

    Returns:
        The exit code: 0 after a clean shutdown, 1 when the bridge could not run.

    Raises:
        SystemExit: The command line is wrong (code 2) or asks for help (code 0).
    """
    # Components that are no bridges, and their computers, need no ROS.
    from . import ros  # noqa: PLC0415

    line = sys.argv[1:] if arguments is None else list(arguments)
    transport = _configure(bridge, ros.without_ros_arguments(line))
    stop = StopRequest()
    try:
        with stop.on_signals():
            node = ros.RosNode(bridge.settings.name, bridge.settings.namespace, line)
            try:
                _serve(bridge, node, transport, stop)
            finally:
                node.close()
    except OSError as error:
        LOGGER.error("%s cannot use the network: %s", bridge.settings.name, error)
        return EXIT_FAILED
    except Exception:
        LOGGER.exception("%s failed", bridge.settings.name)
        return EXIT_FAILED
    return EXIT_OK


def run_node(factory: Callable[[], object], arguments: Sequence[str] | None = None) -> int:
    """Spins a ROS 2 node until SIGINT or SIGTERM.

    Args:
        factory: Makes the node, after ROS has begun; the class itself, as a rule.
        arguments: Command line without the program's name, with --ros-args; that of the process
            when None.

    Returns:
        The exit code 0.
    """
    from . import ros  # noqa: PLC0415

    ros.spin(factory, arguments)
    return EXIT_OK


def _configure(bridge: Bridge, line: Sequence[str]) -> TransportSettings:
    """Applies the command line to the bridge; returns the settings of the transport."""
    model = bridge.settings
    parser = argparse.ArgumentParser(prog=model.name, description=model.description)
    add_component_arguments(parser, model.address)
    add_arguments(parser, model.transport)
    options = parser.parse_args(line)
    configure_log(options.log_level)
    component = component_settings(options, model.component)
    bridge.settings = replace(model, address=options.jaus_id, component=component)
    try:
        return from_arguments(options, model.transport)
    except ValueError as error:
        parser.error(str(error))


def _serve(bridge: Bridge, node: RosNode, transport: TransportSettings, stop: StopRequest) -> None:
    with running_transport(transport) as network:
        bridge.open(node, network)
        bridge.component.when_shut_down(lambda: stop.request("JAUS Shutdown"))
        node.start()
        LOGGER.info("%s runs as %s", node.name, bridge.settings.address)
        try:
            LOGGER.info("%s ends: %s", node.name, stop.wait())
        finally:
            # JAUS first: control is released while ROS still delivers.
            bridge.close()
            passed = {each.name: each.statistics.passed for each in bridge.connections}
            log_counts("messages", passed)

"""Process of one bridge: command line, lifecycle, garbage collection, exit code."""

from __future__ import annotations

import argparse
import gc
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

from ..base.counters import LOGGER
from ..base.loop import Loop
from ..base.process import (
    EXIT_FAILED,
    EXIT_OK,
    EXIT_USAGE,
    StopRequest,
    configure_log,
    failed,
    log_counts,
)
from ..base.settings import TransportSettings, add_arguments, from_arguments
from ..component.process import (
    add_component_arguments,
    component_settings,
    given_options,
    running_transport,
)
from ..transports.transport import Transport
from .bridge import Bridge
from .ends import parameters
from .ends.ends import BridgeSettings
from .ends.topics import ParameterError
from .messages.limits import RosLostError
from .ros.environment import permits_ros
from .ros.spared import spare_modules

if TYPE_CHECKING:
    from .ros.node import RosNode


class ManagedBridge:
    """Performs the transitions of a bridge as a managed node (ROS 2 design, managed nodes).

    | state | on ROS | on JAUS |
    |---|---|---|
    | unconfigured | no topics | no component |
    | inactive | topics, no messages pass | Standby; control is not available |
    | active | messages pass | Standby, Ready or Emergency, as its controller says |
    | finalized | no topics | no component, after Shutdown |

    A method that raises leaves the bridge in the state before.
    """

    def __init__(
        self, bridge: Bridge, ros: RosNode, transport: Transport, end: Callable[[str], None]
    ) -> None:
        self._bridge = bridge
        self._ros = ros
        self._transport = transport
        self._end = end
        self._is_closing = False

    def configure(self) -> None:
        """Makes topics and the JAUS component; no messages pass yet."""
        try:
            self._bridge.open(self._ros, self._transport, active=False)
        except BaseException:
            self._bridge.close()
            self._ros.release()
            raise
        self._bridge.component.when_shut_down(self._note_shutdown)
        self._ros.listen()

    def activate(self) -> None:
        """Begins to pass messages on."""
        self._bridge.set_active(True)
        LOGGER.info("%s runs as %s", self._ros.name, self._bridge.settings.address)

    def deactivate(self) -> None:
        """Sends the stops of commands, releases control, and lets no messages pass."""
        self._bridge.set_active(False)
        LOGGER.info("%s is inactive", self._ros.name)

    def cleanup(self) -> None:
        """Ends the JAUS component and destroys the topics."""
        self._is_closing = True
        try:
            # JAUS first, as stops are published on ROS.
            self._bridge.close()
        finally:
            self._is_closing = False
        self._ros.release()

    def shut_down(self) -> None:
        """Does the same, and ends the process."""
        self.cleanup()
        self._end("shutdown of the node")

    def _note_shutdown(self) -> None:
        if not self._is_closing:
            self._end("JAUS Shutdown")


PERIOD = 1.0  # seconds between two collections
LONGEST_DELAY = 10.0  # seconds after which garbage is collected even while messages wait


@contextmanager
def without_collection() -> Iterator[None]:
    """Disables automatic collection of garbage within the block, once in a process."""
    gc.disable()
    try:
        yield
    finally:
        gc.unfreeze()
        gc.enable()


class QuietCollection:
    """Collects garbage while a loop is idle.

    After its start a bridge has tens of thousands of objects that never become garbage. A full
    collection would visit all of them, and block messages for tens of milliseconds. So these are
    frozen, and later objects are collected while the loop is idle.
    """

    def __init__(self, loop: Loop) -> None:
        self._loop = loop
        self._last = loop.now()

    def start(self) -> None:
        """Freezes present objects, and starts to collect later ones."""
        gc.freeze()
        self._last = self._loop.now()
        self._loop.call_later(PERIOD, self._run)

    def _run(self) -> None:
        if self._loop.is_idle() or self._loop.now() - self._last >= LONGEST_DELAY:
            gc.collect()
            self._last = self._loop.now()
        self._loop.call_later(PERIOD, self._run)


def run_bridge(bridge: Bridge, arguments: Sequence[str] | None = None) -> int:
    """Runs a bridge until SIGINT, SIGTERM, SIGHUP or a JAUS Shutdown ends it.

    Args:
        arguments: Command line without the program's name, with --ros-args; that of the process
            when None.

    Returns:
        The exit code: 0 after a clean shutdown, 1 when the bridge could not run or has lost ROS, 2
        when a parameter or the environment does not allow it.

    Raises:
        SystemExit: The command line is wrong (code 2) or asks for help (code 0).
    """
    if not permits_ros(bridge.settings.name):
        return EXIT_USAGE
    spare_modules()
    # Imported here, as components that are no bridges run without ROS.
    from .ros.lifecycle import without_ros_arguments  # noqa: PLC0415
    from .ros.node import RosNode  # noqa: PLC0415

    line = sys.argv[1:] if arguments is None else list(arguments)
    try:
        own = given_options(without_ros_arguments(line))
    except ParameterError as error:
        configure_log("error")  # the wanted level is not known yet
        LOGGER.error("%s cannot run: %s", bridge.settings.name, error)
        return EXIT_USAGE
    parser = _parser(bridge.settings)
    options = parser.parse_args(own)
    configure_log(options.log_level)
    stop = StopRequest()
    try:
        with without_collection(), stop.on_signals():
            model = bridge.settings
            node = RosNode(model.name, model.namespace, line, options.ros_waiting)
            try:
                transport = _configure(bridge, node, parser, own)
                _serve(bridge, node, transport, stop, line)
            finally:
                node.close()
    except ParameterError as error:
        for problem in str(error).splitlines():
            LOGGER.error("%s cannot run: %s", bridge.settings.name, problem)
        return EXIT_USAGE
    except RosLostError as error:
        LOGGER.error("%s failed: %s", bridge.settings.name, error)
        return EXIT_FAILED
    except Exception as error:
        return failed(bridge.settings.name, error)
    return EXIT_OK


def _parser(model: BridgeSettings) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog=model.name, description=model.description)
    add_component_arguments(parser, model.address)
    add_arguments(parser, model.transport)
    parser.add_argument_group("ROS").add_argument(
        "--ros-waiting",
        choices=("automatic", "listener", "wait-set"),
        default="automatic",
        help="how to wait for topics: on the loop by listeners of the middleware, or on a thread"
        " with a wait set, which is slower with many topics (default %(default)s)",
    )
    return parser


def _configure(
    bridge: Bridge, node: RosNode, parser: argparse.ArgumentParser, line: Sequence[str]
) -> TransportSettings:
    """Applies command line, parameters and model to the bridge, in this order of precedence.

    Returns the settings of the transport; raises ParameterError.
    """
    model = bridge.settings
    # argparse converts defaults that are text like options.
    defaults = (
        *parameters.network(model),
        parameters.digital_resources(model.component.digital_resources),
    )
    parser.set_defaults(**{parameter.name: node.parameter(parameter) for parameter in defaults})
    options = parser.parse_args(line)
    component = component_settings(options, model.component)
    bridge.settings = replace(
        model,
        address=options.jaus_id,
        authority=node.parameter(parameters.AUTHORITY.of(model.authority)),
        component=replace(
            component,
            max_events=node.parameter(parameters.MAX_EVENTS.of(component.max_events)),
            event_rate_budget=node.parameter(
                parameters.EVENT_RATE_BUDGET.of(float(component.event_rate_budget))
            ),
        ),
    )
    node.check_parameters()
    try:
        return from_arguments(options, model.transport)
    except ValueError as error:
        raise ParameterError(str(error)) from error


@contextmanager
def _guarded(bridge: Bridge, node: RosNode, loop: Loop, line: Sequence[str]) -> Iterator[None]:
    """Gives a bridge its guardian within the block, if the model has stops."""
    if not bridge.settings.guardian:
        yield
        return
    ward = bridge.settings.guardian(loop, node, line, bridge.guardian_stopped)
    bridge.ward = node.ward = ward
    try:
        yield
    finally:
        ward.close()


def _serve(
    bridge: Bridge,
    node: RosNode,
    transport: TransportSettings,
    stop: StopRequest,
    line: Sequence[str],
) -> None:
    with running_transport(transport) as network, _guarded(bridge, node, network.loop, line):
        network.loop.on_failure = stop.fail
        managed = ManagedBridge(bridge, node, network, stop.request)
        try:
            node.manage(managed)
            if node.parameter(parameters.AUTOSTART.of(value=True)):
                with network.loop.lock:  # no message is taken between the two transitions
                    node.bring_up()
            else:
                LOGGER.info("%s waits to be configured", node.name)
            node.start(stop.fail)
            QuietCollection(network.loop).start()
            LOGGER.info("%s ends: %s", node.name, stop.wait())
        finally:
            node.shut_down()
            managed.cleanup()
            passed = {
                connection.name: connection.statistics.passed for connection in bridge.connections
            }
            log_counts("messages", passed)

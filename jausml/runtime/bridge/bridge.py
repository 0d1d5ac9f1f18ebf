"""Bridge: one process that is a JAUS component and a ROS 2 node at the same time.

All messages are translated on the thread of the loop, which waits for packets and topics alike.

    JAUS message ─► translate ─► publish
    ROS message  ─► translate ─► send
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from ctypes import CDLL
from dataclasses import replace
from functools import partial
from typing import Any

from ..base.address import JausAddress
from ..base.api import JausError
from ..base.clocks import Timing
from ..base.counters import LOGGER
from ..base.fast_path import FastSending
from ..base.loop import Loop
from ..component.base import Component
from ..conversions import Time
from ..services.definitions import HandoffRequest, Status
from ..services.host import CoreService, Host
from ..services.management import PASSIVE, ManagementService
from ..transports.transport import Transport
from .connections.translations import Form
from .diagnosing import Carried, Diagnosing
from .ends import parameters
from .ends.ends import BridgeSettings, SharedMessages, SharedTopics
from .ends.parameters import AttributeParameter
from .ends.ros_side import RosSide
from .ends.simulation import Simulation
from .fastpath.library import NoFastPathError
from .fastpath.side import FastSide, FastSubscriber
from .messages.compiled import Compiled, Core, Function, NoCoreError, Translation
from .reports.states import Standing, StopReason

_COST = "where a scan or path costs 20 to 100 times as much"  # for the log: cost of Python


class Bridge:
    """Base class of all bridges; a generated class derives from it and lists the connections.

    Attributes:
        clock: Time by which ages and time-outs of messages are measured while the bridge is open:
            that of the loop, or that of a simulation.
        core: The generated C translations of the bridge; None where there are none.
        core_services: Core services that the bridge can provide; its settings select from them.
        clients: Clients of core services of other components, besides those of the connections.
    """

    ros: RosSide
    component: Component
    clock: Timing
    simulation: Simulation | None = None
    ward: Any = None  # the `Guardian`, where the settings ask for one
    core: Core | None = None
    core_services: Sequence[Callable[[Host], CoreService]] = Component.core_services
    clients: Sequence[Callable[[Host], object]] = ()
    _live: frozenset[str] = frozenset()

    def __init__(self, settings: BridgeSettings) -> None:
        """Prepares a bridge with the settings of its model; opens nothing."""
        self.settings = settings
        self.connections: list[Carried] = []
        self.parameters: Sequence[AttributeParameter] = ()
        self._is_open = False
        self.standing = Standing(Status.INITIALIZE, None)
        self.is_active = True
        self._side: _BridgeComponent
        self._diagnosing: Diagnosing | None = None
        self._library: tuple[Core, CDLL] | None = None
        self._fast: FastSide | None = None
        self.shared_topics: SharedTopics
        self.shared_messages: SharedMessages

    # ------------------------------------------------------------------ life

    def open(self, ros: RosSide, transport: Transport, *, active: bool = True) -> None:
        """Makes publishers, subscriptions and events, then starts the JAUS component.

        All of them exist before the first message is taken. Messages that are published before ROS
        has found a subscriber are counted. Unless `active`, messages pass only after `set_active`.
        """
        self.ros = ros
        self.component = self._side = _BridgeComponent(self, transport)
        ros.attach(transport.loop)
        self.clock = self._chosen_clock()
        self.component.event_clock = self.clock
        self.shared_topics = SharedTopics(ros)
        self.shared_messages = SharedMessages(self.component)
        self._load_core(ros.parameter(parameters.COMPILED.of(value=True)))
        frequency = parameters.DIAGNOSTICS_FREQUENCY.of(
            min(max(self.settings.frequency, parameters.LEAST_DIAGNOSTICS), 1.0)
        )
        period = 1 / ros.parameter(frequency)
        default_rate = ros.parameter(parameters.FREQUENCY.of(self.settings.frequency))
        self.settings = replace(self.settings, frequency=default_rate)
        for parameter in self.parameters:
            self._follow_parameter(parameter)
        with self.loop.lock:
            self._side.begin_control(active)
            self._open_connections()
            self._measure_latency(
                ros.parameter(parameters.ALL_LATENCY.of(value=False), self._measure_latency)
            )
            ros.parameter(parameters.lift_emergency(self._check_lift), self._lift_emergency)
            ros.check_parameters()
            self.is_active = self.component.control_available = active
            self.component.start()
            self.standing = self._present_standing()
            self._is_open = True
            for connection in self.connections:
                connection.watch()
                connection.follow(self.standing, None)
            self._diagnosing = Diagnosing(self, period)
            self._diagnosing.start()

    def _chosen_clock(self) -> Timing:
        """Returns the clock of the loop, or a simulated one that follows `/clock` from now on."""
        if not self.ros.is_simulated:
            return self.loop
        self.simulation = Simulation(self.loop, self._stop_watched)
        self.ros.follow_clock(self.simulation.take)
        return self.simulation.clock

    def guardian_stopped(self) -> None:
        """Marks all commands as stopped, since the guardian has sent their stops."""
        self._stop_watched(StopReason.STOOD_STILL)

    def _stop_watched(self, reason: StopReason) -> None:
        self._log_stops(
            [connection for connection in self.connections if connection.lose(reason)], reason
        )

    def _load_core(self, wanted: bool) -> None:  # noqa: FBT001
        """Loads the library of the compiled translations, if it was built and is `wanted`."""
        self._library = None
        if self.core is None:
            return
        if not wanted:
            LOGGER.info("the compiled core is off; Python translates, %s", _COST)
            return
        try:
            self._library = self.core, self.core.load()
        except NoCoreError as error:
            sentence = "no compiled core: %s; Python translates, %s, see `jausml build`"
            LOGGER.info(sentence, error, _COST)
            return
        try:
            self._fast = FastSide(self._library[1], self.component)
        except NoFastPathError as error:
            LOGGER.info("the compiled core translates, and Python does the rest: %s", error)

    def _open_connections(self) -> None:
        for connection in self.connections:
            connection.open(self)
        self.shared_topics.subscribe()
        self.shared_messages.handle()
        self._log_forms()

    def _log_forms(self) -> None:
        """Logs which connections use the message classes of ROS, which take longer."""
        names = [
            connection.name
            for connection in self.connections
            if connection.form is Form.ROS_CLASSES
        ]
        if names:
            LOGGER.info("translations on %s: %s", Form.ROS_CLASSES.value, ", ".join(names))

    def close(self) -> None:
        """Sends the stops of commands, releases control and cancels events; ROS is closed later."""
        if not self._is_open:
            return
        with self.loop.lock:
            if self._diagnosing is not None:
                self._diagnosing.stop()
            ended = [connection for connection in self.connections if connection.end()]
            self._log_stops(ended, StopReason.END)
            if self._fast is not None:
                self._fast.close()
                self._fast = None
            self.component.stop()
            if self.ward is not None:
                self.ward.release()
            for connection in self.connections:
                account = "; ".join(
                    f"{name} {number}" for name, number in connection.close_account() if number
                )
                LOGGER.info("account of %s: %s", connection.name, account or "nothing")
            self._is_open = False

    def set_active(self, wanted: bool) -> None:  # noqa: FBT001
        """Begins to pass messages on, or sends the stops of commands and passes none on.

        An inactive bridge is a JAUS component in Standby of which control is not available.
        """
        with self.loop.lock:
            self.is_active = self.component.control_available = wanted
            if not wanted:
                self.component.part(ManagementService).withdraw()
            self.component.permit_control(self.component.status not in PASSIVE)
            self.follow()

    def on_not_ready(self) -> None:
        """Hook: the bridge left Ready; the stops of commands are sent already."""

    def on_control_lost(self) -> None:
        """Hook: the controller has lost control; the stops of commands are sent already."""

    def on_handoff_requested(
        self, target: JausAddress, requests: tuple[HandoffRequest, ...]
    ) -> None:
        """Hook of a `HandoffBridge`: the clients in `requests` ask for control of `target`."""

    def follow(self) -> None:
        """Stops the connections that may not go on in the present state or without a controller."""
        if not self._is_open:
            return
        former, self.standing = self.standing, self._present_standing()
        lost = self.standing.lost_since(former)
        stopped = [
            connection for connection in self.connections if connection.follow(self.standing, lost)
        ]
        reason = lost or self.standing.halt
        if reason is not None:
            self._log_stops(stopped, reason)

    def _present_standing(self) -> Standing:
        component = self.component
        lapsed = component.has_control_lapsed
        return Standing(component.status, component.controller, self.is_active, lapsed)

    def _log_stops(self, connections: Sequence[Carried], reason: StopReason) -> None:
        commands = [connection for connection in connections if connection.is_command]
        if commands:
            description = "; ".join(f"{command.name}: {command.when_lost}" for command in commands)
            LOGGER.warning("%s: %s", reason.value, description)

    # ------------------------------------------------------------------ for translations

    def now(self) -> Time:
        """Returns the time of the ROS clock, or of the system while the bridge is not open."""
        return self.ros.now() if self._is_open else Time(*divmod(time.time_ns(), 10**9))

    def compiled(self, compiled: Compiled, note: Callable[[str], None]) -> Function | None:
        """Returns the compiled function of a translation; None if its library is not loaded.

        Args:
            note: Called with the path of each field that the function leaves out.
        """
        if self._library is None:
            return None
        core, library = self._library
        return compiled.of(self, library, note) if compiled.core == core else None

    def fast_translation(self, compiled: Compiled) -> Translation | None:
        """Returns a translation for the core to run without Python; None where it needs Python.

        A simulated clock, or an overridden `now`, can only be read in Python.
        """
        own_clock = self.simulation is not None or type(self).now is not Bridge.now
        if self._library is None or (compiled.needs_clock and own_clock):
            return None
        core, library = self._library
        if compiled.core != core:
            return None
        self._live |= {*compiled.quantities, *compiled.texts}
        return compiled.alone(self, library)

    def fast_subscriber(self, feed: Any, path: FastSending) -> FastSubscriber | None:
        """Returns the taker by which the core reads a subscription itself; None without a core."""
        return None if self._fast is None else self._fast.subscriber(feed, path)

    def __setattr__(self, name: str, value: object) -> None:
        """Sets an attribute; fast paths that hold a copy of its value are made anew."""
        super().__setattr__(name, value)
        if name in self._live:
            self.loop.revision.changed()

    @contextmanager
    def frozen_at(self, moment: Time) -> Iterator[None]:
        """Makes `now` return `moment` within the block."""
        vars(self)["now"] = lambda: moment
        try:
            yield
        finally:
            del vars(self)["now"]

    # ------------------------------------------------------------------ for connections

    @property
    def loop(self) -> Loop:
        """The loop of the JAUS side."""
        return self.component.loop

    def _follow_parameter(self, attribute_parameter: AttributeParameter) -> None:
        """Sets an attribute to the value of its parameter, now and whenever the value changes."""
        assign = partial(setattr, self, attribute_parameter.attribute)
        assign(
            self.ros.parameter(
                attribute_parameter.of(getattr(self, attribute_parameter.attribute)), assign
            )
        )

    def _check_lift(self, clients: str) -> None:
        """Raises ValueError where an emergency of `clients` (a JAUS ID) cannot be lifted."""
        try:
            if clients:
                with self.loop.lock:
                    management = self.component.part(ManagementService)
                    management.check_lift(JausAddress.parse(clients))
        except JausError as error:
            raise ValueError(str(error)) from error

    def _lift_emergency(self, clients: str) -> None:
        """Lifts emergencies; `_check_lift` has rejected the parameter where that is impossible."""
        if clients:
            with suppress(JausError):
                self.component.lift_emergency(JausAddress.parse(clients))

    def _measure_latency(self, wanted: bool) -> None:  # noqa: FBT001
        with self.loop.lock:
            for connection in self.connections:
                connection.measure_latency(wanted)


class _BridgeComponent(Component):
    """JAUS component of a bridge, which passes changes of state and control on to it."""

    def __init__(self, bridge: Bridge, transport: Transport) -> None:
        settings = bridge.settings
        self.core_services, self.clients = bridge.core_services, bridge.clients
        super().__init__(
            transport,
            settings.address,
            name=settings.name,
            services=settings.services,
            component_type=settings.component_type,
            settings=settings.component,
        )
        self._bridge = bridge

    def on_not_ready(self) -> None:
        self._bridge.follow()
        self._bridge.on_not_ready()

    def on_control_lost(self) -> None:
        self._bridge.follow()
        self._bridge.on_control_lost()

    def on_handoff_requested(
        self, target: JausAddress, requests: tuple[HandoffRequest, ...]
    ) -> None:
        self._bridge.on_handoff_requested(target, requests)

    def core_state_changed(self) -> None:
        self._bridge.follow()

    def begin_control(self, permitted: bool) -> None:  # noqa: FBT001
        """Sets, before the first session, whether the component may control others at the start."""
        self._jaus_permit(permitted)

    def permit_control(self, permitted: bool) -> None:  # noqa: FBT001
        super().permit_control(permitted and self._bridge.is_active)

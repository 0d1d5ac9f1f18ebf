"""Bridge: one process that is a JAUS component and a ROS 2 node at the same time.

A value crosses on the thread of the loop, which waits for both sides. Nothing is polled and nothing
is handed over.

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

_COST = "where a scan or path costs 20 to 100 times as much"
"""What is said of translations in Python."""


class Bridge:
    """The common part of all bridges; a generated base derives from it and names connections.

    Attributes:
        clock: The time by which messages are late, while the bridge is open: that of the loop, or
            of a simulation.
        core: What was generated to be compiled; None where nothing was.
        core_services: The core services that it may provide; the settings say which it does.
        clients: Clients of others that it has besides those of its connections.
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
        """Prepares a bridge of which the model says what its settings are; nothing is opened."""
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

        All of them are there before the first message. What is published before ROS has found a
        subscriber is counted. Unless it is active, messages pass from `set_active` on.
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
        usual = ros.parameter(parameters.FREQUENCY.of(self.settings.frequency))
        self.settings = replace(self.settings, frequency=usual)
        for parameter in self.parameters:
            self._read(parameter)
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
        """Returns the time of the loop, or that of a simulation, which it begins to follow."""
        if not self.ros.is_simulated:
            return self.loop
        self.simulation = Simulation(self.loop, self._stop_watched)
        self.ros.follow_clock(self.simulation.take)
        return self.simulation.clock

    def note_guardian(self) -> None:
        """Takes the word of the guardian for the stop that it is: it has spoken."""
        self._stop_watched(StopReason.STOOD_STILL)

    def _stop_watched(self, reason: StopReason) -> None:
        self._log_stops(
            [connection for connection in self.connections if connection.lose(reason)], reason
        )

    def _load_core(self, wanted: bool) -> None:  # noqa: FBT001
        """Loads what was compiled of the translations, if it is there."""
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
        """Names the translations that make objects of ROS, which takes longer."""
        names = [
            connection.name
            for connection in self.connections
            if connection.form is Form.ROS_CLASSES
        ]
        if names:
            LOGGER.info("translations on %s: %s", Form.ROS_CLASSES.value, ", ".join(names))

    def close(self) -> None:
        """Stops what was commanded, releases control and cancels events; ROS is closed after it."""
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
                account = "; ".join(f"{name} {n}" for name, n in connection.close_account() if n)
                LOGGER.info("account of %s: %s", connection.name, account or "nothing")
            self._is_open = False

    def set_active(self, wanted: bool) -> None:  # noqa: FBT001
        """Lets messages pass, or stops what is commanded and lets nothing pass.

        While nothing passes, the JAUS component is in Standby and control is not available.
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
        """Hook: another controls the bridge, or nobody; the stops of commands are sent already."""

    def on_handoff_requested(
        self, target: JausAddress, requests: tuple[HandoffRequest, ...]
    ) -> None:
        """Hook of a `HandoffBridge`: others ask for control of a peer; a person decides."""

    def follow(self) -> None:
        """Stops what must not go on now that the state or the controller is another."""
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
        """Time of the ROS clock, or of the system while the bridge is not open."""
        return self.ros.now() if self._is_open else Time(*divmod(time.time_ns(), 10**9))

    def compiled(self, compiled: Compiled, note: Callable[[str], None]) -> Function | None:
        """Returns the function of a translation; None where its library is not there."""
        if self._library is None:
            return None
        core, library = self._library
        return compiled.of(self, library, note) if compiled.core == core else None

    def fast_translation(self, compiled: Compiled) -> Translation | None:
        """Returns what a core is given to translate alone; None where Python has a part in it.

        A clock that is simulated, or is the user's, is read in Python.
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
        """Returns a core that takes the messages of a subscription; None where none can."""
        return None if self._fast is None else self._fast.subscriber(feed, path)

    def __setattr__(self, name: str, value: object) -> None:
        """Ends the fast paths of translations that were lent an attribute that changes."""
        super().__setattr__(name, value)
        if name in self._live:
            self.loop.revision.changed()

    @contextmanager
    def at(self, moment: Time) -> Iterator[None]:
        """Lets translations take a moment for the present."""
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

    def _read(self, attribute_parameter: AttributeParameter) -> None:
        """Gives an attribute the value of its parameter, now and whenever that changes."""
        assign = partial(setattr, self, attribute_parameter.attribute)
        assign(
            self.ros.parameter(
                attribute_parameter.of(getattr(self, attribute_parameter.attribute)), assign
            )
        )

    def _check_lift(self, clients: str) -> None:
        """Raises ValueError where an emergency cannot be lifted."""
        try:
            if clients:
                with self.loop.lock:
                    management = self.component.part(ManagementService)
                    management.check_lift(JausAddress.parse(clients))
        except JausError as error:
            raise ValueError(str(error)) from error

    def _lift_emergency(self, clients: str) -> None:
        """Lifts emergencies; who sets the parameter was told before why that cannot be."""
        if clients:
            with suppress(JausError):
                self.component.lift_emergency(JausAddress.parse(clients))

    def _measure_latency(self, wanted: bool) -> None:  # noqa: FBT001
        with self.loop.lock:
            for connection in self.connections:
                connection.measure_latency(wanted)


class _BridgeComponent(Component):
    """The JAUS side, which tells the bridge when it must not obey any more."""

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
        """Says, before the first session, whether others may be controlled at the start."""
        self._jaus_permit(permitted)

    def permit_control(self, permitted: bool) -> None:  # noqa: FBT001
        super().permit_control(permitted and self._bridge.is_active)

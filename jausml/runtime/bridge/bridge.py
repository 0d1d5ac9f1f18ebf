"""Bridge: one process that is a JAUS component and a ROS 2 node at the same time.

Both kinds of values cross on the loop, which waits for sockets and topics alike. Nothing is polled
and nothing is handed over.

    JAUS message ─► loop ─► translate ─► publish
    ROS message  ─► loop ─► translate ─► encode ─► send
"""

from __future__ import annotations

import time
from functools import partial
from typing import TYPE_CHECKING, Any

from ..base.counters import LOGGER
from ..component.component import JausComponent
from ..conversions import Time
from ..services.definitions import Guard, Status
from . import parameters
from .diagnostics import double_status
from .ends import ReportHolder
from .light_message import is_light
from .stops import Standing, StopReason

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ..base.address import JausAddress
    from ..base.loop import Loop
    from ..transports.transport import Transport
    from ..wire.message import Message
    from .connection import AnyConnection
    from .ends import RosSide
    from .parameters import AttributeParameter
    from .settings import BridgeSettings
    from .topics import Topic


class Bridge:
    """The common part of all bridges; a generated base derives from it and names connections.

    Attributes:
        settings: What the model says.
        connections: What is carried across.
        parameters: Attributes that parameters of the node may change.
        ros: The ROS side, while the bridge is open.
        component: The JAUS side, while the bridge is open.
    """

    ros: RosSide
    component: JausComponent

    def __init__(self, settings: BridgeSettings) -> None:
        """Prepares a bridge; nothing is opened.

        Args:
            settings: What the model says.
        """
        self.settings = settings
        self.connections: list[AnyConnection] = []
        self.parameters: Sequence[AttributeParameter] = ()
        self._is_open = False
        self._standing = Standing(Status.INITIALIZE, None)
        self._publishers: dict[tuple[type[Any], Topic, bool], Callable[[Any], None]] = {}
        self._greeters: dict[tuple[type[Any], Topic, bool], list[Callable[[], None]]] = {}
        self._takers: dict[tuple[type[Any], Topic], list[Callable[[Any], None]]] = {}
        self._reports: dict[type[Message], ReportHolder] = {}
        self._commands: dict[type[Message], list[Callable[[Any, JausAddress], None]]] = {}
        self._period = 1.0
        self._next_diagnostics = 0.0

    # ------------------------------------------------------------------ life

    def open(self, ros: RosSide, transport: Transport) -> None:
        """Makes publishers, subscriptions and events, then starts the JAUS component.

        All of them are there before the first message, so that none is lost at the start.

        Args:
            ros: The ROS side; it starts to wait for messages afterwards.
            transport: The JAUS side.
        """
        self.ros = ros
        self.component = _BridgeComponent(self, transport)
        ros.attach(transport.loop)
        diagnostics = parameters.diagnostics_frequency(min(self.settings.frequency, 1.0))
        self._period = 1 / ros.parameter(diagnostics)
        for each in self.parameters:
            self._read(each)
        with transport.loop.lock:
            for connection in self.connections:
                connection.open(self)
            self.component.start()
            self._standing = self._present_standing()
            self._is_open = True
            for connection in self.connections:
                connection.watch()
            self._next_diagnostics = self.loop.now() + self._period
            self.loop.call_at(self._next_diagnostics, self._diagnose)

    def close(self) -> None:
        """Stops what was commanded, releases control and cancels events; ROS is closed after it."""
        if not self._is_open:
            return
        with self.loop.lock:
            ended = [each for each in self.connections if each.end()]
            self._log_stops(ended, StopReason.END)
            self.component.stop()
            self._is_open = False

    def on_not_ready(self) -> None:
        """Hook: the bridge left Ready; the stops of commands are sent already."""

    def on_control_lost(self) -> None:
        """Hook: another controls the bridge, or nobody; the stops of commands are sent already."""

    def follow(self) -> None:
        """Stops what must not go on now that the state or the controller is another."""
        if not self._is_open:
            return
        former, self._standing = self._standing, self._present_standing()
        lost = self._standing.lost_since(former)
        stopped = [each for each in self.connections if each.follow(self._standing, lost)]
        reason = lost or self._standing.halt
        if reason is not None:
            self._log_stops(stopped, reason)

    def _present_standing(self) -> Standing:
        return Standing(self.component.status, self.component.controller)

    def _log_stops(self, connections: Sequence[AnyConnection], reason: StopReason) -> None:
        commands = [each for each in connections if each.is_command]
        if commands:
            told = "; ".join(f"{each.name}: {each.when_lost}" for each in commands)
            LOGGER.warning("%s: %s", reason.value, told)

    # ------------------------------------------------------------------ for translations

    def now(self) -> Time:
        """Time of the ROS clock, or of the system while the bridge is not open."""
        return self.ros.now() if self._is_open else Time(*divmod(time.time_ns(), 10**9))

    # ------------------------------------------------------------------ for connections

    @property
    def loop(self) -> Loop:
        """The loop of the JAUS side."""
        return self.component.loop

    def publisher(
        self, message_type: type[Any], topic: Topic, greet: Callable[[], None] | None = None
    ) -> Callable[[Any], None]:
        """Returns what publishes on a topic; connections that name it alike share it.

        Args:
            message_type: Class of the messages.
            topic: The topic.
            greet: Called for each subscriber that is found.
        """
        # To hear of subscribers has its price at each message: only those pay it who ask.
        key = (message_type, topic, greet is not None)
        greeters = self._greeters.setdefault(key, [])
        if greet is not None:
            greeters.append(greet)
        if key not in self._publishers:
            tell = (lambda: _each(greeters)) if greet is not None else None
            made = self.ros.publisher(message_type, topic, tell)
            self._publishers[key] = (
                (lambda message: made.publish(message.to_cdr()))
                if is_light(message_type)
                else made.publish_message
            )
        return self._publishers[key]

    def subscribe(self, message_type: type[Any], topic: Topic, take: Callable[[Any], None]) -> None:
        """Subscribes to a topic; connections that name it alike share its subscription."""
        key = (message_type, topic)
        takers = self._takers.setdefault(key, [])
        takers.append(take)
        if len(takers) == 1:
            light = message_type.from_cdr if is_light(message_type) else None
            decode = light or self.ros.codec(message_type).decode
            self.ros.subscribe(message_type, topic, lambda data, _: _each(takers, decode(data)))

    def accept(
        self,
        message: type[Message],
        take: Callable[[Any, JausAddress], None],
        when: Guard | Callable[[Any], Guard],
    ) -> None:
        """Takes messages that other components send to the bridge.

        Args:
            message: The message.
            take: Takes each message and its sender.
            when: Whom to obey, or a function that tells it from the message; a command has one
                handler, which its connections share.
        """
        if when is Guard.ANY:
            self.component.on_message(message, take)
            return
        takers = self._commands.setdefault(message, [])
        takers.append(take)
        if len(takers) == 1:
            handler = lambda command, sender: _each(takers, command, sender)  # noqa: E731
            self.component.handle(message, handler, when=when)

    def report(self, query: type[Message], report: type[Message]) -> ReportHolder:
        """Offers a report; connections that feed one report share its value.

        Args:
            query: The query that asks for it.
            report: The report.
        """
        if query not in self._reports:
            holder = self._reports[query] = ReportHolder()
            self.component.provide(query, report, lambda _query, _sender: holder.value)
        return self._reports[query]

    def _read(self, each: AttributeParameter) -> None:
        """Gives an attribute the value of its parameter, now and whenever that changes."""
        assign = partial(setattr, self, each.attribute)
        assign(self.ros.parameter(each.of(getattr(self, each.attribute)), assign))

    # ------------------------------------------------------------------ diagnostics

    def _diagnose(self) -> None:
        self._next_diagnostics = max(self._next_diagnostics + self._period, self.loop.now())
        self.loop.call_at(self._next_diagnostics, self._diagnose)
        statuses = [connection.status() for connection in self.connections]
        double = self.component.transport.double_of(self.settings.address)
        if double is not None:
            statuses.append(double_status(double, self.loop.now()))
        self.ros.publish_diagnostics(statuses)


class _BridgeComponent(JausComponent):
    """The JAUS side, which tells the bridge when it must not obey any more."""

    def __init__(self, bridge: Bridge, transport: Transport) -> None:
        settings = bridge.settings
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

    def core_state_changed(self) -> None:
        self._bridge.follow()


def _each(takers: Sequence[Callable[..., None]], *arguments: object) -> None:
    for take in takers:
        take(*arguments)

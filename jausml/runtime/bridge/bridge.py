"""Bridge: one process that is a JAUS component and a ROS 2 node at the same time.

A value crosses on the thread on which it arrived: from JAUS on the loop of the transport, from ROS
on the thread that waits for ROS messages. Nothing is polled and nothing is handed over.

    JAUS message ─► loop thread ─► translate ─► publish
    ROS message  ─► ROS thread  ─► translate ─► encode ─► send
"""

from __future__ import annotations

import time
from functools import partial
from typing import TYPE_CHECKING, Any

from ..component.component import JausComponent
from ..conversions import Time
from ..services.definitions import Guard
from . import parameters
from .ends import ReportHolder

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
        self._publishers: dict[tuple[type[Any], Topic], Callable[[Any], None]] = {}
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
        diagnostics = parameters.diagnostics_frequency(min(self.settings.frequency, 1.0))
        self._period = 1 / ros.parameter(diagnostics)
        for each in self.parameters:
            self._read(each)
        with transport.loop.lock:
            for connection in self.connections:
                connection.open(self)
            self._is_open = True
            self.component.start()
            for connection in self.connections:
                connection.watch()
            self._next_diagnostics = self.loop.now() + self._period
            self.loop.call_at(self._next_diagnostics, self._diagnose)

    def close(self) -> None:
        """Releases control and cancels events; the ROS side is closed afterwards."""
        self.component.stop()
        self._is_open = False

    def on_not_ready(self) -> None:
        """The bridge left Ready: topics fed by commands become safe."""
        for connection in self.connections:
            connection.on_not_ready()

    def on_control_lost(self) -> None:
        """Another controls the bridge, or nobody: what its controller commanded must not stand."""
        for connection in self.connections:
            connection.on_control_lost()

    # ------------------------------------------------------------------ for translations

    def now(self) -> Time:
        """Time of the ROS clock, or of the system while the bridge is not open."""
        return self.ros.now() if self._is_open else Time(*divmod(time.time_ns(), 10**9))

    # ------------------------------------------------------------------ for connections

    @property
    def loop(self) -> Loop:
        """The loop of the JAUS side."""
        return self.component.loop

    def publisher(self, message_type: type[Any], topic: Topic) -> Callable[[Any], None]:
        """Returns what publishes on a topic; connections that name it alike share its publisher."""
        key = (message_type, topic)
        if key not in self._publishers:
            self._publishers[key] = self.ros.publisher(message_type, topic)
        return self._publishers[key]

    def subscribe(self, message_type: type[Any], topic: Topic, take: Callable[[Any], None]) -> None:
        """Subscribes to a topic; connections that name it alike share its subscription."""
        key = (message_type, topic)
        takers = self._takers.setdefault(key, [])
        takers.append(take)
        if len(takers) == 1:
            self.ros.subscribe(message_type, topic, lambda message: _each(takers, message))

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
        self.ros.publish_diagnostics([connection.status() for connection in self.connections])


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
        self._bridge.on_not_ready()

    def on_control_lost(self) -> None:
        self._bridge.on_control_lost()


def _each(takers: Sequence[Callable[..., None]], *arguments: object) -> None:
    for take in takers:
        take(*arguments)

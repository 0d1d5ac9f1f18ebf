"""Host of services and clients: the component as they see it, with messages and hooks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from datetime import datetime, timedelta
from types import MappingProxyType
from typing import Any, Protocol, TypeVar, cast

from ..base.address import JausAddress
from ..base.clocks import HostClock, Timing
from ..base.counters import Counters
from ..base.fast_path import FastPath
from ..base.loop import Loop
from ..transports.packets.packet import Priority
from ..transports.transport import Transport
from ..wire.message import DecodeError, EncodeError, Message, asked_for, asked_for_in
from .definitions import (
    VERSION_1_1,
    Completion,
    ComponentSettings,
    Guard,
    HandoffRequest,
    ServiceIdentity,
)
from .dispatch import Handler, Provision, Router

M = TypeVar("M", bound=Message)
Q = TypeVar("Q", bound=Message)
R = TypeVar("R", bound=Message)
P = TypeVar("P")

GREETING_PATIENCE = 3  # greetings without an answer after which a warning is logged


class CoreService(Protocol):
    """A core service of a component."""

    @property
    def urns(self) -> frozenset[str]:
        """Identifiers of the service in its versions."""

    def attach(self) -> None:
        """Takes the messages of the service, for a component that provides it."""


class Hooks:
    """Hooks of a component, which do nothing by default; an override must not block."""

    def on_initialize(self) -> None:
        """Prepares or resets the component: at the start and after Reset; Standby follows."""

    def on_ready(self) -> None:
        """The controller has resumed the component: commands are obeyed from now on."""

    def on_not_ready(self) -> None:
        """The component has left Ready for any reason: stop all motion."""

    def on_control_lost(self) -> None:
        """The controller has lost control: end its commands.

        It has released control or let it lapse, a higher authority has taken over, or the component
        has ended control. The component may still be in Ready, for its new controller; otherwise
        ``on_not_ready`` was called before. ``on_controller_changed`` follows.
        """

    def on_controller_changed(self, controller: JausAddress | None) -> None:
        """Another component controls this one, or no component does (None)."""

    def on_handoff_requested(
        self, target: JausAddress, requests: tuple[HandoffRequest, ...]
    ) -> None:
        """Other clients request control of a component that this one controls.

        A person should decide, and ``decide_handoff`` sends the decision. Without one, the target
        denies the requests after its time-out.

        Args:
            target: The controlled component.
            requests: All pending requests; none when the last one has ended.
        """

    def on_emergency(self, active: bool) -> None:  # noqa: FBT001
        """An emergency was set, or the last one was cleared."""

    def on_shutdown(self) -> None:
        """The component has entered Shutdown, by command of its controller or by ``stop``."""

    def on_set_time(self, time: datetime) -> None:
        """The controller has set the component's clock in UTC; that of the host does not change."""

    def core_state_changed(self) -> None:
        """The status, the controller, or the availability of control has changed."""

    def core_event(self, name: str) -> None:
        """An internal event of a core service has happened; for modelled state machines."""


class Host(Hooks):
    """The messages of a component, and its parts: services and clients.

    Attributes:
        time_offset: Difference between the clock set by SetTime and that of the host.
        may_control: Whether the component may control others now; see ``permit_control``.
        event_path: Returns the fast path of an event by its provider and id, or None.
        unanswered_greetings: Number of greetings to each greeted peer since its last message.
    """

    transport: Transport
    address: JausAddress
    name: str
    services: tuple[ServiceIdentity, ...]
    component_type: int
    settings: ComponentSettings
    clock: HostClock
    event_clock: Timing
    may_control = True
    time_offset = timedelta()
    event_path: Callable[[JausAddress, int], FastPath | None] | None = None
    unanswered_greetings: Mapping[JausAddress, int] = MappingProxyType({})
    # The prefix avoids clashes with private attributes of user code in subclasses.
    _jaus_running: bool
    _jaus_starters: list[Callable[[], None]]
    _jaus_enders: list[Callable[[], None]]
    _jaus_stoppers: list[Callable[[], None]]
    _jaus_permits: list[Callable[[bool], None]]
    _jaus_parts: dict[Callable[[Any], object], object]
    _jaus_versions: dict[str, tuple[int, int]]
    _jaus_router: Router

    @property
    def loop(self) -> Loop:
        """The loop on whose thread callbacks run."""
        return self.transport.loop

    @property
    def counters(self) -> Counters:
        """Counters of dropped and ignored messages, and of failures."""
        return self.transport.counters

    @property
    def running(self) -> bool:
        """Whether the component is between ``start`` and ``stop``."""
        return self._jaus_running

    @property
    def current_time(self) -> datetime:
        """The component's clock in UTC: ``host_time`` plus ``time_offset``."""
        return self.host_time() + self.time_offset

    # ---- parts ------------------------------------------------------------------------------

    def part(self, kind: Callable[[Host], P]) -> P:
        """Returns the part of the component that is of a class; the first call makes it.

        So a workspace need not contain parts that its components do not use.
        """
        with self.loop.lock:
            if kind not in self._jaus_parts:
                self._jaus_parts[kind] = kind(self)
            return cast("P", self._jaus_parts[kind])

    # ---- messages ---------------------------------------------------------------------------

    def handle(
        self,
        message_class: type[M],
        handler: Callable[[M, JausAddress], Completion | None],
        *,
        when: Guard | Callable[[M], Guard] = Guard.ANY,
        counts_each: bool | None = None,
    ) -> None:
        """Calls ``handler(message, sender)`` for each such input message.

        Args:
            handler: Handles the message. It returns a new ``Completion`` if the command takes time,
                for the client of a command event.
            when: The senders to obey; messages of others are counted and ignored, since AS5710 has
                no error reply. A function returns the guard of a message, e.g. to take the limits
                of a SetVelocityCommand in Standby, but its current command only in Ready.
            counts_each: Whether a message is handled that comes after a newer one of its sender.
                Otherwise it is counted and ignored, unless it requested acknowledgement; that is
                the default for messages with a guard, as a command replaces the one before.

        Raises:
            ValueError: The message has a handler or a provider already.
        """
        with self.loop.lock:
            is_each = when is Guard.ANY if counts_each is None else counts_each
            self._jaus_router.set_handler(
                Handler(message_class, handler, when, counts_each=is_each)
            )

    def handle_payload(
        self,
        message_class: type[M],
        handler: Callable[[bytes, JausAddress], Completion | None],
        *,
        when: Guard | Callable[[M], Guard] = Guard.ANY,
        is_robust: bool = False,
    ) -> None:
        """Calls ``handler(payload, sender)`` for each such input message, as ``handle`` does.

        The payload is the encoded message with its code. A handler that cannot decode it raises
        DecodeError, which is counted as with ``handle``.

        Args:
            when: The senders to obey. A function is only called, with the decoded message, if the
                sender is not the controller in Ready, so it cannot be stricter than that.
            is_robust: Whether the handler never raises, and checks itself for blocking: the call is
                then a little faster.

        Raises:
            ValueError: The message has a handler or a provider already.
        """
        with self.loop.lock:
            is_each = when is Guard.ANY
            self._jaus_router.set_handler(
                Handler(message_class, handler, when, True, is_robust, is_each)  # noqa: FBT003
            )

    def provide(
        self,
        query_class: type[Q],
        report_class: type[R],
        provider: Callable[[Q, JausAddress], R | bytes | None],
        *,
        periodic: bool = True,
        every_change: bool = True,
    ) -> None:
        """Answers a query, and events on it, with what ``provider(query, sender)`` returns.

        Args:
            provider: Returns the present report, or its bytes with the message code, which are sent
                unchanged if the query selects all of their fields. None means that there is no
                report now: the query is not answered and no event is sent.
            periodic: Whether clients may request periodic events.
            every_change: Whether clients may request events on every change; the component
                then calls ``report_changed`` when the report may have changed.

        Raises:
            ValueError: The query has a handler or a provider already.
        """
        with self.loop.lock:
            provision = Provision(query_class, report_class, provider, periodic, every_change)
            self._jaus_router.set_provision(provision, self._jaus_answer)

    def on_message(
        self, message_class: type[M], callback: Callable[[M, JausAddress], None]
    ) -> None:
        """Calls ``callback(message, sender)`` for each such message, solicited or not.

        A message may have any number of callbacks besides its handler.
        """
        with self.loop.lock:
            self._jaus_router.add_listener(message_class, callback)

    def on_payload(
        self,
        message_class: type[Message],
        callback: Callable[[bytes, JausAddress], None],
        *,
        is_robust: bool = False,
        counts_each: bool = True,
    ) -> None:
        """Calls ``callback(payload, sender)`` for each such message, as ``on_message`` does.

        Payload, ``is_robust`` and ``counts_each`` are as with ``handle_payload`` and ``handle``.
        """
        with self.loop.lock:
            self._jaus_router.add_payload_listener(
                message_class, callback, is_robust=is_robust, counts_each=counts_each
            )

    def watch_unwanted(
        self, message_class: type[Message], callback: Callable[[bytes, JausAddress], None]
    ) -> None:
        """Calls ``callback(payload, sender)`` for each such message that nothing else takes."""
        with self.loop.lock:
            self._jaus_router.unwanted[message_class.CODE] = callback

    def send(
        self,
        message: Message,
        destination: JausAddress,
        *,
        priority: Priority = Priority.STANDARD,
        acknowledge: bool = False,
    ) -> None:
        """Sends a message to a component or a wildcard; raises EncodeError for an unfit value."""
        self.transport.send(
            self.address, destination, message.encode(), priority=priority, acknowledge=acknowledge
        )

    def _jaus_answer(
        self, provision: Provision[Any, Any], query: Message, sender: JausAddress
    ) -> None:
        _, report = self._jaus_router.attempt(provision.provider, query, sender)
        payload = None if report is None else self.encoded_report(provision, query, report)
        if payload is not None:
            self.transport.send(self.address, sender, payload)

    def command_handler(self, code: int) -> Handler | None:
        """Returns the handler of a message by code; None without one."""
        return self._jaus_router.handler(code)

    def provision(self, query_code: int) -> Provision[Any, Any] | None:
        """Returns the provision of a query by code; None without one."""
        return self._jaus_router.provision(query_code)

    def encoded_report(
        self, provision: Provision[Any, Any], query: Message, report: Message | bytes
    ) -> bytes | None:
        """Returns the fields of a report that a query selects, encoded; None after an error."""
        try:
            if isinstance(report, bytes):
                return asked_for_in(query, provision.report_class, report)
            return asked_for(query, report).encode()
        except (DecodeError, EncodeError) as error:
            self.counters.count("component.report_not_encodable", str(error))
            return None

    def drops_of(self, sender: JausAddress) -> dict[str, int]:
        """Returns how many messages of a sender were dropped, by reason and name of the message.

        Reasons are: out of order, refused, unreadable, unknown. The caller holds the lock of the
        loop.
        """
        return {
            f"{reason} {message}": count
            for (address, reason, message), count in self._jaus_router.drops.items()
            if address == sender
        }

    def drops_before(self, message: str) -> list[tuple[JausAddress, str, int]]:
        """Returns the drops of messages of a name: sender, reason and number."""
        return [
            (sender, reason, count)
            for (sender, reason, kind), count in self._jaus_router.drops.items()
            if kind == message
        ]

    # ---- user code --------------------------------------------------------------------------

    def call(self, function: Callable[..., Any], *arguments: object) -> Any:
        """Calls user code and returns its result; None after an error, which is counted."""
        return self._jaus_router.call(function, *arguments)

    def payload_caller(
        self,
        function: Callable[[bytes, JausAddress], object],
        on_bad: Callable[[JausAddress, DecodeError], None],
    ) -> Callable[[bytes, JausAddress], None]:
        """Returns a function that calls user code with payloads, and `on_bad` on a DecodeError."""
        return self._jaus_router.payload_caller(function, on_bad)

    def attempt(self, function: Callable[..., Any], *arguments: object) -> tuple[bool, Any]:
        """Calls user code; returns whether it succeeded, and its result."""
        return self._jaus_router.attempt(function, *arguments)

    def when_started(self, action: Callable[[], None]) -> None:
        """Runs an action now if the component runs, otherwise at its start."""
        if self._jaus_running:
            action()
        else:
            self._jaus_starters.append(action)

    def when_stopped(self, action: Callable[[], None]) -> None:
        """Adds an action for the stop of the component, to be run before those added earlier."""
        self._jaus_stoppers.append(action)

    def when_permitted(self, action: Callable[[bool], None]) -> None:
        """Adds an action that is called with whether the component may control others."""
        self._jaus_permits.append(action)

    def when_shut_down(self, action: Callable[[], None]) -> None:
        """Adds an action for when the component enters Shutdown."""
        self._jaus_enders.append(action)

    def shut_down(self) -> None:
        """Runs the hook and the actions of Shutdown; called by the Management service."""
        for action in (self.on_shutdown, *self._jaus_enders):
            self.call(action)

    def core_version(self, name: str) -> tuple[int, int]:
        """Returns the version of a core service that the component provides; 1.1 if it does not."""
        return self._jaus_versions.get(name, VERSION_1_1)

    # ---- for the services and clients -------------------------------------------------------

    def allows(self, guard: Guard, sender: JausAddress) -> bool:
        """Returns whether a guard allows messages of a sender."""
        raise NotImplementedError

    def permissions_changed(self) -> None:
        """Ends commands under way that are not allowed any more; called by the services."""
        raise NotImplementedError

    def _jaus_stand_by(self, provider: JausAddress, on_silence: Callable[[], None] | None) -> None:
        """Leaves Ready for Standby, as a report of `provider` that Ready requires is missing."""
        raise NotImplementedError

    def report_changed(self, report_class: type[Message]) -> None:
        """Sends the report to every-change events whose report differs from the last one sent."""
        raise NotImplementedError

    def permit_control(self, permitted: bool) -> None:  # noqa: FBT001
        """Releases the components that this one controls, or acquires control again.

        That happens in the next turn of the loop, after stops that hooks have sent.
        """
        self.loop.call_soon(lambda: self._jaus_permit(permitted))

    def _jaus_permit(self, permitted: bool) -> None:  # noqa: FBT001
        self.may_control = permitted
        for action in self._jaus_permits:
            action(permitted)

    # ---- hooks with a default ---------------------------------------------------------------

    def host_time(self) -> datetime:
        """Returns the time in UTC of ``clock``, on which the component's clock is based.

        Override it for a component in simulated time.
        """
        return self.clock.utc()

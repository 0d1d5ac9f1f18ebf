"""Host of services and clients: a component as they see it, which has none of them yet."""

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

GREETING_PATIENCE = 3
"""Greetings without an answer after which somebody is told, once in each silence."""


class CoreService(Protocol):
    """A core service of a component."""

    @property
    def urns(self) -> frozenset[str]:
        """Identifiers of the service; some had several over the years."""

    def attach(self) -> None:
        """Takes the messages of the service, for a component that provides it."""


class Hooks:
    """Hooks of a component; they do nothing unless they are overridden, and must not block."""

    def on_initialize(self) -> None:
        """Prepares or resets the component: at the start and after Reset; Standby follows."""

    def on_ready(self) -> None:
        """The controller resumed the component: commands are obeyed from now on."""

    def on_not_ready(self) -> None:
        """The component left Ready, for whatever reason: stop all motion."""

    def on_control_lost(self) -> None:
        """The controller is the controller no more: what it commanded must not stand.

        It released control or let it lapse, a higher authority took over, or the component gave
        control up. The component may still be in Ready, for its new controller; where it was left,
        ``on_not_ready`` ran before. ``on_controller_changed`` follows.
        """

    def on_controller_changed(self, controller: JausAddress | None) -> None:
        """Another component controls this one, or none does (None)."""

    def on_handoff_requested(
        self, target: JausAddress, requests: tuple[HandoffRequest, ...]
    ) -> None:
        """Others ask for control of a component that this one controls: have a person decide.

        ``decide_handoff`` tells the target. Without a decision nobody gets control, and the target
        tells them after its time-out.

        Args:
            requests: All that wait now; none when the last one has ended.
        """

    def on_emergency(self, active: bool) -> None:  # noqa: FBT001
        """An emergency was set, or the last one was cleared."""

    def on_shutdown(self) -> None:
        """The component entered Shutdown, by its controller's command or by ``stop``."""

    def on_set_time(self, time: datetime) -> None:
        """The controller has set the component's clock in UTC; the host's is left as it is."""

    def core_state_changed(self) -> None:
        """The status changed, who controls the component, or whether control is to be had."""

    def core_event(self, name: str) -> None:
        """An internal event of a core service happened; for modelled state machines."""


class Host(Hooks):
    """Messages of a component, its user code, and its parts: services and clients.

    Attributes:
        time_offset: What SetTime has added to the clock of the host.
        may_control: Whether the component may control others now; see ``permit_control``.
        event_path: The fast path of an event, by its provider and id; None without one.
        unanswered_greetings: How often each peer that is to be greeted was so since it spoke last.
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
    # Sub-classes are user code: the prefix keeps their private attributes apart from these.
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
        """The loop on whose thread everything happens."""
        return self.transport.loop

    @property
    def counters(self) -> Counters:
        """Counts of what was dropped, ignored or failed."""
        return self.transport.counters

    @property
    def running(self) -> bool:
        """Whether the component is between ``start`` and ``stop``."""
        return self._jaus_running

    @property
    def current_time(self) -> datetime:
        """The component's clock in UTC: ``host_time`` and what SetTime has added to it."""
        return self.host_time() + self.time_offset

    # ---- parts ------------------------------------------------------------------------------

    def part(self, kind: Callable[[Host], P]) -> P:
        """Returns a part of the component, made by its class when it is first asked for.

        What a component does not use is thus not made, and a workspace need not have it.
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
            handler: Acts on the message. It returns a new ``Completion`` when the command takes
                time, for the client of a command event.
            when: Whom to obey; messages of others are counted and ignored, since AS5710 knows
                no error reply. A function tells it from the message, e.g. to take the limits of
                a SetVelocityCommand in Standby and its current command in Ready alone.
            counts_each: Whether a message is of use that a newer one of its sender came before.
                If not, such a one is counted and ignored, unless it asked for acknowledgement. So
                it is by default with what has a guard: a command replaces the one before.

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

        The payload, the message code and the body, is not decoded. A handler that finds it wrong
        raises DecodeError; the message is counted then as one that ``handle`` cannot decode.

        Args:
            when: Whom to obey. A function is only asked, about the decoded message, when the sender
                is not obeyed in Ready; it can thus not be stricter than that.
            is_robust: Whether the handler raises nothing and tells itself when it takes too long:
                nothing else looks after it then, which is a little faster.

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
            provider: Returns the present report, or the bytes of it with the message code. They
                are sent as they are where the query asks for all that is in them. None means that
                there is no report now: the query stays unanswered and no event is sent.
            periodic: Whether clients may have the report at a rate.
            every_change: Whether clients may have the report at every change; the component
                then calls ``report_changed`` when it may have changed.

        Raises:
            ValueError: The query has a handler or a provider already.
        """
        with self.loop.lock:
            provision = Provision(query_class, report_class, provider, periodic, every_change)
            self._jaus_router.set_provision(provision, self._jaus_answer)

    def on_message(
        self, message_class: type[M], callback: Callable[[M, JausAddress], None]
    ) -> None:
        """Calls ``callback(message, sender)`` for each such message, asked for or not.

        Any number of callbacks may listen to one message, next to its handler.
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

        The payload, the message code and the body, is not decoded. A callback that finds it wrong
        raises DecodeError; the message is counted then as one that cannot be decoded.

        Args:
            is_robust: Whether the callback raises nothing and tells itself when it takes too long.
            counts_each: Whether a message is of use that a newer one of its sender came before;
                as with ``handle``.
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
        """Sends a message to a component or a wildcard; EncodeError where a value does not fit."""
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
        """Returns what acts on a message."""
        return self._jaus_router.handler(code)

    def provision(self, query_code: int) -> Provision[Any, Any] | None:
        """Returns what answers a query."""
        return self._jaus_router.provision(query_code)

    def encoded_report(
        self, provision: Provision[Any, Any], query: Message, report: Message | bytes
    ) -> bytes | None:
        """Returns what a query asks for of a report as bytes, or None when that is impossible."""
        try:
            if isinstance(report, bytes):
                return asked_for_in(query, provision.report_class, report)
            return asked_for(query, report).encode()
        except (DecodeError, EncodeError) as error:
            self.counters.count("component.report_not_encodable", str(error))
            return None

    def drops_of(self, sender: JausAddress) -> dict[str, int]:
        """Returns how many messages of a sender were dropped before they were acted on, by reason.

        Those that came out of order, were refused, could not be read or are not known, each with
        the name of the message. With the lock of the loop, as it changes while messages come.
        """
        return {
            f"{reason} {message}": count
            for (address, reason, message), count in self._jaus_router.drops.items()
            if address == sender
        }

    def drops_before(self, message: str) -> list[tuple[JausAddress, str, int]]:
        """Returns the drops of ``drops_of`` for one kind of message: sender, reason and number."""
        return [
            (sender, reason, count)
            for (sender, reason, kind), count in self._jaus_router.drops.items()
            if kind == message
        ]

    # ---- user code --------------------------------------------------------------------------

    def call(self, function: Callable[..., Any], *arguments: object) -> Any:
        """Calls user code; an error is logged and counted, and None returned."""
        return self._jaus_router.call(function, *arguments)

    def payload_caller(
        self,
        function: Callable[[bytes, JausAddress], object],
        on_bad: Callable[[JausAddress, DecodeError], None],
    ) -> Callable[[bytes, JausAddress], None]:
        """Returns what calls user code with encoded messages, and tells of those it cannot read."""
        return self._jaus_router.payload_caller(function, on_bad)

    def attempt(self, function: Callable[..., Any], *arguments: object) -> tuple[bool, Any]:
        """Calls user code; tells whether it raised no error, and what it returned."""
        return self._jaus_router.attempt(function, *arguments)

    def when_started(self, action: Callable[[], None]) -> None:
        """Runs an action now, or at the start of a component that does not run yet."""
        if self._jaus_running:
            action()
        else:
            self._jaus_starters.append(action)

    def when_stopped(self, action: Callable[[], None]) -> None:
        """Also run an action when the component stops, before those that were given earlier."""
        self._jaus_stoppers.append(action)

    def when_permitted(self, action: Callable[[bool], None]) -> None:
        """Also run an action when the component may control others, or may not any more."""
        self._jaus_permits.append(action)

    def when_shut_down(self, action: Callable[[], None]) -> None:
        """Also run an action when the component enters Shutdown."""
        self._jaus_enders.append(action)

    def shut_down(self) -> None:
        """Runs the hook and the actions of Shutdown; called by the Management service."""
        for action in (self.on_shutdown, *self._jaus_enders):
            self.call(action)

    def core_version(self, name: str) -> tuple[int, int]:
        """Returns the version of a core service that the component provides, 1.1 if of none."""
        return self._jaus_versions.get(name, VERSION_1_1)

    # ---- what services and clients decide ---------------------------------------------------

    def allows(self, guard: Guard, sender: JausAddress) -> bool:
        """Whether a message of ``sender`` is obeyed under ``guard``."""
        raise NotImplementedError

    def permissions_changed(self) -> None:
        """Ends the commands under way that are not allowed any more; called by the services."""
        raise NotImplementedError

    def _jaus_stand_by(self, provider: JausAddress, on_silence: Callable[[], None] | None) -> None:
        """Leaves Ready for Standby, as a report that is needed there does not come."""
        raise NotImplementedError

    def report_changed(self, report_class: type[Message]) -> None:
        """Sends the report to every-change events whose report differs from the last one sent."""
        raise NotImplementedError

    def permit_control(self, permitted: bool) -> None:  # noqa: FBT001
        """Lets go of the components that this one controls, or takes them back.

        It happens in the next round of the loop: what hooks send to stop them comes before.
        """
        self.loop.call_soon(lambda: self._jaus_permit(permitted))

    def _jaus_permit(self, permitted: bool) -> None:  # noqa: FBT001
        self.may_control = permitted
        for action in self._jaus_permits:
            action(permitted)

    # ---- hooks with a default ---------------------------------------------------------------

    def host_time(self) -> datetime:
        """Returns the time in UTC that the component's clock runs by; ``clock`` has it by default.

        Override it for a component that lives in simulated time.
        """
        return self.clock.utc()

"""Base of a component, which serves others: dispatch, core services, life cycle."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from ..base.clocks import HostClock
from ..clients.clients import Clients
from ..clients.presence import SILENCE
from ..messages import Event
from ..services.core import CoreServices
from ..services.definitions import (
    CORE,
    VERSION_1_1,
    ComponentSettings,
    Guard,
    ServiceIdentity,
    Status,
)
from ..services.dispatch import Provision, Router
from ..services.ordering import Ordering
from ..transports.delivery import MESSAGE_CODE_SIZE
from ..transports.packets.packet import Priority
from ..wire.message import DecodeError, EncodeError, Message
from ..wire.selection import asked_for, asked_for_in
from .accounts import log_accounts
from .hooks import ComponentHooks

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from datetime import datetime

    from ..base.address import JausAddress
    from ..base.clocks import Timing
    from ..base.counters import Counters
    from ..base.fast_path import FastPath
    from ..base.loop import Loop
    from ..services.completion import Completion
    from ..services.dispatch import Handler
    from ..services.element_list import ElementList, ListElement
    from ..transports.delivery import ReceivedMessage, Take
    from ..transports.transport import Transport

COMPONENT_TYPE = 60001
"""Type of a plain component (AS5710, ReportIdentification)."""

M = TypeVar("M", bound=Message)
Q = TypeVar("Q", bound=Message)
R = TypeVar("R", bound=Message)


class ComponentBase(ComponentHooks):
    """A component that handles commands and answers queries; see ``JausComponent``.

    Attributes:
        clock: The time, for user code that shall run in virtual time as well.
    """

    def __init__(
        self,
        transport: Transport,
        address: JausAddress,
        *,
        name: str,
        services: Sequence[ServiceIdentity],
        component_type: int = COMPONENT_TYPE,
        settings: ComponentSettings | None = None,
    ) -> None:
        """Describe a component; nothing is sent or received before ``start``.

        Args:
            component_type: Type that Discovery reports (AS5710, ReportIdentification), e.g.
                10001 vehicle, 20001 operator control unit, 60001 component.

        Raises:
            ValueError: The address does not name one component.
        """
        if not address.is_concrete:
            raise ValueError(f"{address} does not name one component")
        self.transport = transport
        self.address = address
        self.name = name
        self.services = tuple(services)
        self.component_type = component_type
        self.settings = ComponentSettings() if settings is None else settings
        self.event_clock: Timing = transport.loop
        self.clock = HostClock(transport.loop)
        # Sub-classes are user code: the prefix keeps their private attributes apart from these.
        self._jaus_running = False
        self._jaus_starters: list[Callable[[], None]] = []
        self._jaus_enders: list[Callable[[], None]] = []
        self._jaus_router = Router(
            transport.counters,
            self.allows,
            lambda: Ordering(transport.arrival, transport.loop.now),
            transport.loop.stopwatch,
            transport.loop.revision.changed,
        )
        self._jaus_versions = {
            service.urn.removeprefix(CORE): (service.major, service.minor)
            for service in self.services
        }
        self._jaus_core = CoreServices(self)
        self._jaus_clients = Clients(self)
        self._jaus_dispatch = self._jaus_dispatcher()

    # ---- messages of the component's own services -------------------------------------------

    def handle(
        self,
        message_class: type[M],
        handler: Callable[[M, JausAddress], Completion | None],
        *,
        when: Guard | Callable[[M], Guard] = Guard.ANY,
        counts_each: bool | None = None,
    ) -> None:
        """Call ``handler(message, sender)`` for each such input message.

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
            each = when is Guard.ANY if counts_each is None else counts_each
            self._jaus_router.set_handler(message_class, handler, when, counts_each=each)

    def handle_payload(
        self,
        message_class: type[M],
        handler: Callable[[bytes, JausAddress], Completion | None],
        *,
        when: Guard | Callable[[M], Guard] = Guard.ANY,
        is_robust: bool = False,
    ) -> None:
        """Call ``handler(payload, sender)`` for each such input message, as ``handle`` does.

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
            self._jaus_router.set_handler(
                message_class,
                handler,
                when,
                takes_payload=True,
                is_robust=is_robust,
                counts_each=when is Guard.ANY,
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
        """Answer a query, and events on it, with what ``provider(query, sender)`` returns.

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

    def report_changed(self, report_class: type[Message]) -> None:
        """Send the report to every-change events whose report differs from the last one sent."""
        with self.loop.lock:
            self._jaus_core.events.report_changed(report_class)

    def on_message(
        self, message_class: type[M], callback: Callable[[M, JausAddress], None]
    ) -> None:
        """Call ``callback(message, sender)`` for each such message, asked for or not.

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
        """Call ``callback(payload, sender)`` for each such message, as ``on_message`` does.

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
        """Call ``callback(payload, sender)`` for each such message that nothing else takes.

        Args:
            callback: Takes an encoded message and its sender; there is one for each message.
        """
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
        """Send one message.

        Args:
            destination: A component, or a wildcard address.

        Raises:
            EncodeError: A value does not fit its field.
        """
        self.transport.send(
            self.address,
            destination,
            message.encode(),
            priority=priority,
            acknowledge=acknowledge,
        )

    # ---- life cycle -------------------------------------------------------------------------

    def start(self) -> None:
        """Receive messages, initialise, and begin subscriptions and sessions.

        Raises:
            RuntimeError: The component runs already.
            ValueError: Another component of this process has the address.
        """
        with self.loop.lock:
            if self._jaus_running:
                raise RuntimeError(f"component {self.address} runs already")
            self.transport.attach(self.address, self._jaus_receive, self._jaus_dispatch)
            self._jaus_running = True
            self.core_state_changed()
            self._jaus_core.management.initialize()
            if not self._jaus_running:
                return  # a hook has stopped it
            starters, self._jaus_starters = self._jaus_starters, []
            for starter in starters:
                starter()
            self._jaus_core.liveness.start()
            if self._jaus_running:
                self._jaus_clients.start()

    def stop(self) -> None:
        """Leave in good order; no effect when the component does not run.

        Releases control that is held, cancels subscriptions, tells the controller that control
        is released and reports the status SHUTDOWN to whoever watches it.
        """
        with self.loop.lock:
            if self._jaus_running:
                self._jaus_clients.stop()
                self._jaus_core.management.shut_down()
                self._jaus_core.events.stop()
                self._jaus_core.liveness.stop()
                self._jaus_running = False
                log_accounts(self)
                self.transport.detach(self.address)

    def fail(self, reason: str) -> None:
        """Enter Failure (AS5710, Management, internal event Failure)."""
        with self.loop.lock:
            self._jaus_core.management.fail(reason)

    def lift_emergency(self, clients: JausAddress) -> None:
        """Lift emergencies whose clients are gone, by the decision of a person at the robot.

        The component is then in Standby without a controller.

        Args:
            clients: Who set them; a wildcard means several.

        Raises:
            JausError: Nobody of them set one, or somebody of them was heard within 10 s.
        """
        with self.loop.lock:
            self._jaus_core.management.lift(clients)

    def check_lift(self, clients: JausAddress) -> None:
        """Raise what ``lift_emergency`` would, and do nothing else."""
        with self.loop.lock:
            self._jaus_core.management.check_lift(clients)

    # ---- hooks with a default ---------------------------------------------------------------

    def host_time(self) -> datetime:
        """Return the time in UTC that the component's clock runs by; ``clock`` has it by default.

        Override it for a component that lives in simulated time.
        """
        return self.clock.utc()

    def supports_element(self, element: ListElement) -> bool:
        """Return whether the component's list may hold an element (AS5710, ListManager).

        By default these are the messages that the component's list drivers execute, e.g.
        SetGlobalWaypoint for a GlobalWaypointListDriver; a ListManager alone takes none.
        """
        return self._jaus_core.list_manager.is_of_driver(element)

    # ---- state ------------------------------------------------------------------------------

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
    def status(self) -> Status:
        """Management state (AS5710, ReportStatus)."""
        return self._jaus_core.management.status

    @property
    def controller(self) -> JausAddress | None:
        """The component that controls this one."""
        return self._jaus_core.access_control.controller

    @property
    def has_control_lapsed(self) -> bool:
        """Whether the last controller let control lapse: it did not request it again in time."""
        return self._jaus_core.access_control.has_lapsed

    @property
    def authority(self) -> int:
        """Authority code of the controller, or the default authority without one."""
        return self._jaus_core.access_control.authority

    @property
    def control_available(self) -> bool:
        """Whether control may be requested: not in Init, Failure, Shutdown or Emergency."""
        return self._jaus_core.access_control.available

    @control_available.setter
    def control_available(self, available: bool) -> None:
        with self.loop.lock:
            self._jaus_core.access_control.offered = available

    @property
    def current_time(self) -> datetime:
        """The component's clock in UTC: ``host_time`` and what SetTime has added to it."""
        return self._jaus_core.time.now()

    @property
    def elements(self) -> ElementList:
        """The list that the controller edits (AS5710, ListManager); not to be changed here."""
        return self._jaus_core.list_manager.elements

    def allows(self, guard: Guard, sender: JausAddress) -> bool:
        """Whether a message of ``sender`` is obeyed under ``guard``."""
        if guard is Guard.ANY:
            return True
        access = self._jaus_core.access_control
        if sender != access.controller or not access.managed:
            return False
        return guard is Guard.CONTROLLED or self._jaus_core.management.status is Status.READY

    # ---- for the services and clients of the component --------------------------------------

    def permit_control(self, permitted: bool) -> None:  # noqa: FBT001
        """Let go of the components that this one controls, or take them back.

        It happens in the next round of the loop: what hooks send to stop them comes before.
        """
        self.loop.call_soon(lambda: self._jaus_clients.control.permit(permitted))

    def when_started(self, action: Callable[[], None]) -> None:
        """Run an action now, or at the start of a component that does not run yet."""
        if self._jaus_running:
            action()
        else:
            self._jaus_starters.append(action)

    def when_shut_down(self, action: Callable[[], None]) -> None:
        """Also run an action when the component enters Shutdown."""
        self._jaus_enders.append(action)

    def shut_down(self) -> None:
        """Run the hook and the actions of Shutdown; called by the Management service."""
        for action in (self.on_shutdown, *self._jaus_enders):
            self.call(action)

    def core_version(self, name: str) -> tuple[int, int]:
        """Return the version of a core service that the component provides, 1.1 if of none."""
        return self._jaus_versions.get(name, VERSION_1_1)

    def call(self, function: Callable[..., Any], *arguments: object) -> Any:
        """Call user code; an error is logged and counted, and None returned."""
        return self._jaus_router.call(function, *arguments)

    def payload_caller(
        self,
        function: Callable[[bytes, JausAddress], object],
        on_bad: Callable[[JausAddress, DecodeError], None],
    ) -> Callable[[bytes, JausAddress], None]:
        """Return what calls user code with encoded messages, and tells of those it cannot read."""
        return self._jaus_router.payload_caller(function, on_bad)

    def attempt(self, function: Callable[..., Any], *arguments: object) -> tuple[bool, Any]:
        """Call user code; tell whether it raised no error, and what it returned."""
        return self._jaus_router.attempt(function, *arguments)

    @property
    def unanswered_greetings(self) -> dict[JausAddress, int]:
        """How often each peer that is to be greeted was so since it spoke last."""
        return self._jaus_clients.greeter.unanswered

    def drops_of(self, sender: JausAddress) -> dict[str, int]:
        """Return how many messages of a sender were dropped before they were acted on, by reason.

        Those that came out of order, were refused, could not be read or are not known, each with
        the name of the message. With the lock of the loop, as it changes while messages come.
        """
        return {
            f"{reason} {message}": count
            for (each, reason, message), count in self._jaus_router.drops.items()
            if each == sender
        }

    def drops_before(self, message: str) -> list[tuple[JausAddress, str, int]]:
        """Return the drops of ``drops_of`` for one kind of message: sender, reason and number."""
        return [
            (sender, reason, count)
            for (sender, reason, each), count in self._jaus_router.drops.items()
            if each == message
        ]

    def permissions_changed(self) -> None:
        """End the commands under way that are not allowed any more; called by the services."""
        self.loop.revision.changed()
        self._jaus_core.events.permissions_changed()

    def command_handler(self, code: int) -> Handler | None:
        """Return what acts on a message."""
        return self._jaus_router.handler(code)

    def provision(self, query_code: int) -> Provision[Any, Any] | None:
        """Return what answers a query."""
        return self._jaus_router.provision(query_code)

    def encoded_report(
        self, provision: Provision[Any, Any], query: Message, report: Message | bytes
    ) -> bytes | None:
        """Return what a query asks for of a report as bytes, or None when that is impossible."""
        try:
            if isinstance(report, bytes):
                return asked_for_in(query, provision.report_class, report)
            return asked_for(query, report).encode()
        except (DecodeError, EncodeError) as error:
            self.counters.count("component.report_not_encodable", str(error))
            return None

    def _jaus_receive(self, received: ReceivedMessage) -> None:
        if len(received.payload) >= MESSAGE_CODE_SIZE:
            self._jaus_dispatch(received.payload, received.source)
        else:
            self.counters.add("component.unknown_message")

    def _jaus_dispatcher(self) -> Take:
        """Return what takes every message for the component, payload and sender."""
        takers, unknown = self._jaus_router.takers, self._jaus_router.unknown
        heard, returned = self._jaus_clients.presence.heard, self._jaus_clients.presence.returned
        clock = self.loop.now

        def take(payload: bytes, sender: JausAddress) -> None:
            last = heard.get(sender)
            if last is not None:
                now = heard[sender] = clock()
                if now - last > SILENCE:
                    returned(sender)
            code = payload[0] | payload[1] << 8
            for act in takers.get(code, unknown):
                act(payload, sender)

        return take

    def fast_path(self, code: int, event_id: int, sender: JausAddress) -> FastPath | None:
        """The fast path of messages of a component, by code and for events by id, None without."""
        if code != Event.CODE:
            return self._jaus_router.fast_path(code, sender)
        if len(self._jaus_router.takers.get(code, ())) != 1:
            return None
        return self._jaus_clients.events.fast_path(sender, event_id)

    def note_heard(self, sender: JausAddress, at: float) -> None:
        """Note a message of a component that has taken the fast path."""
        self._jaus_clients.presence.note(sender, at)

    def _jaus_answer(
        self, provision: Provision[Any, Any], query: Message, sender: JausAddress
    ) -> None:
        _, report = self._jaus_router.attempt(provision.provider, query, sender)
        payload = None if report is None else self.encoded_report(provision, query, report)
        if payload is not None:
            self.transport.send(self.address, sender, payload)

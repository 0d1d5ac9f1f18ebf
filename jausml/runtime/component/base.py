"""Base of a component, which serves others: its messages and its life cycle."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from ..base.clocks import HostClock
from ..clients.discovery_client import SILENCE
from ..messages import Event
from ..services.definitions import CORE, ComponentSettings, Guard, ServiceIdentity
from ..services.dispatch import Provision, Router
from ..transports.delivery import MESSAGE_CODE_SIZE, Ordering
from ..transports.packets.packet import Priority
from ..transports.transport import log_accounts
from ..wire.message import Message
from .state import Clients, ComponentState, CoreServices

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from datetime import datetime

    from ..base.address import JausAddress
    from ..base.clocks import Timing
    from ..base.fast_path import FastPath
    from ..services.definitions import Completion, ListElement
    from ..transports.delivery import ReceivedMessage, Take
    from ..transports.transport import Transport

COMPONENT_TYPE = 60001
"""Type of a plain component (AS5710, ReportIdentification)."""

M = TypeVar("M", bound=Message)
Q = TypeVar("Q", bound=Message)
R = TypeVar("R", bound=Message)


class ComponentBase(ComponentState):
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
        self._jaus_running = False
        self._jaus_starters = []
        self._jaus_enders = []
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

    # ---- what comes in -----------------------------------------------------------------------

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

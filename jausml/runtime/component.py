"""A JAUS component: dispatch of its messages, its core services and its use of others'."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

from .clients.control_session import ControlClient, ControlSession, ControlState
from .clients.discovery_client import DiscoveryClient, FoundComponent
from .clients.event_subscription import EventClient, EventSubscription
from .clients.query import PendingQuery, QueryClient
from .dispatch import Provision, Router
from .message import EncodeError, Message
from .packet import Priority
from .services.access_control import AccessControlService
from .services.definitions import (
    CORE,
    ComponentSettings,
    Guard,
    Scope,
    ServiceIdentity,
    Status,
)
from .services.discovery import DiscoveryService
from .services.events import EventsService
from .services.liveness import LivenessService
from .services.management import ManagementService

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .address import JausAddress
    from .counters import Counters
    from .loop import Loop
    from .transport import ReceivedMessage, Transport

__all__ = [
    "COMPONENT_TYPE",
    "ComponentSettings",
    "ControlSession",
    "ControlState",
    "EventSubscription",
    "FoundComponent",
    "Guard",
    "JausComponent",
    "PendingQuery",
    "Scope",
    "ServiceIdentity",
    "Status",
]

COMPONENT_TYPE = 60001
"""Type of a plain component (AS5710, ReportIdentification)."""

M = TypeVar("M", bound=Message)
Q = TypeVar("Q", bound=Message)
R = TypeVar("R", bound=Message)


class JausComponent:
    """One JAUS component of this process.

    The core services among ``services`` are provided: Events, AccessControl, Management,
    Liveness and Discovery; every other message is handled by what ``handle`` and ``provide``
    are given. All methods may be called from any thread. Handlers, providers, callbacks and
    hooks run on the loop's thread and hold ``loop.lock``; they must not block. When one raises,
    the error is logged and counted as ``component.handler_failed``.

    A generated component derives from this class, calls ``handle``, ``provide``, ``subscribe``
    and ``control`` in its constructor, and overrides the ``on_...`` hooks.
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
            transport: Carries the messages; it may serve several components.
            address: Address of the component.
            name: Identification that Discovery reports.
            services: Every service of the component, inherited ones included.
            component_type: Type that Discovery reports (AS5710, ReportIdentification), e.g.
                10001 vehicle, 20001 operator control unit, 60001 component.
            settings: Behaviour; the defaults suit a component that is not a Discovery server.

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
        self._running = False
        self._starters: list[Callable[[], None]] = []
        self._enders: list[Callable[[], None]] = []
        self._router = Router(transport.counters, self.allows)
        provided = {service.urn.removeprefix(CORE) for service in self.services}
        self._events = EventsService(self, enabled="Events" in provided)
        self._access = AccessControlService(self, enabled="AccessControl" in provided)
        self._management = ManagementService(self, self._access, enabled="Management" in provided)
        if "Liveness" in provided:
            LivenessService(self)
        if "Discovery" in provided:
            DiscoveryService(self)
        self._event_client = EventClient(self)
        self._control_client = ControlClient(self)
        self._query_client = QueryClient(self)
        self._discovery_client = DiscoveryClient(self)

    # ---- messages of the component's own services -------------------------------------------

    def handle(
        self,
        message_class: type[M],
        handler: Callable[[M, JausAddress], None],
        *,
        when: Guard = Guard.ANY,
    ) -> None:
        """Call ``handler(message, sender)`` for each such input message.

        Args:
            message_class: Generated codec of the message.
            handler: Acts on the message.
            when: Whom to obey; messages of others are counted and ignored, since AS5710 knows
                no error reply.

        Raises:
            ValueError: The message has a handler or a provider already.
        """
        with self.loop.lock:
            self._router.set_handler(message_class, handler, when)

    def provide(
        self,
        query_class: type[Q],
        report_class: type[R],
        provider: Callable[[Q, JausAddress], R | None],
        *,
        periodic: bool = True,
        every_change: bool = True,
    ) -> None:
        """Answer a query, and events on it, with what ``provider(query, sender)`` returns.

        Args:
            query_class: Generated codec of the query.
            report_class: Generated codec of the report.
            provider: Returns the present report; None means that there is none now, the query
                then stays unanswered and no event is sent.
            periodic: Whether clients may have the report at a rate.
            every_change: Whether clients may have the report at every change; the component
                then calls ``report_changed`` when it may have changed.

        Raises:
            ValueError: The query has a handler or a provider already.
        """
        with self.loop.lock:
            provision = Provision(
                query_class, report_class, provider, periodic, every_change
            )
            self._router.set_provision(provision, self._answer)

    def report_changed(self, report_class: type[Message]) -> None:
        """Send the report to every-change events whose report differs from the last one sent."""
        with self.loop.lock:
            self._events.report_changed(report_class)

    def on_message(
        self, message_class: type[M], callback: Callable[[M, JausAddress], None]
    ) -> None:
        """Call ``callback(message, sender)`` for each such message, asked for or not.

        Any number of callbacks may listen to one message, next to its handler.
        """
        with self.loop.lock:
            self._router.add_listener(message_class, callback)

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
            message: What to send.
            destination: A component, or a wildcard address.
            priority: Priority of the message (AS5669A).
            acknowledge: Whether the receiver's transport shall acknowledge it.

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

    # ---- use of other components ------------------------------------------------------------

    def subscribe(
        self,
        provider: JausAddress,
        query: Message,
        report_class: type[R],
        on_report: Callable[[R, JausAddress], None],
        *,
        rate: float | None = None,
        silence_timeout: float = 0.0,
        on_silence: Callable[[], None] | None = None,
    ) -> EventSubscription:
        """Receive a report of another component over an AS5710 event.

        The event is created as soon as the provider answers, renewed, and created anew when the
        provider was restarted. Subscriptions of this component to the same provider and query
        share one event: periodic at the highest rate asked for, or every change when nobody
        asks for a rate. A later subscriber gets the last report at once.

        Args:
            provider: The component that provides the report.
            query: Asks for the report; its presence vector selects the fields.
            report_class: Generated codec of the report.
            on_report: Takes each report and the provider's address.
            rate: Reports each second, above 0 and up to 1092; None means every change.
            silence_timeout: Seconds without a report before ``on_silence``; 0 means never.
            on_silence: Called once each time the provider falls silent.

        Returns:
            A handle to cancel the subscription with.

        Raises:
            EncodeError: A value of the query does not fit its field.
            ValueError: The rate is out of range or the provider is not one component.
        """
        with self.loop.lock:
            return self._event_client.subscribe(
                provider, query, report_class, on_report, rate, silence_timeout, on_silence
            )

    def control(
        self,
        target: JausAddress,
        *,
        authority: int,
        resume: bool = True,
        on_change: Callable[[ControlState], None] | None = None,
    ) -> ControlSession:
        """Acquire and keep control of another component (AS5710, AccessControl).

        Sessions of this component with the same target share one exchange, with the highest
        authority asked for.

        Args:
            target: The component to control.
            authority: Authority code to request control with, 0 to 255.
            resume: Whether to take the target from Standby to Ready whenever it is found there.
            on_change: Called with each new state.

        Returns:
            A handle to read the state from and to release control with.

        Raises:
            ValueError: The authority is out of range or the target is not one component.
        """
        with self.loop.lock:
            return self._control_client.control(target, authority, resume, on_change)

    def query(
        self,
        target: JausAddress,
        query: Message,
        report_class: type[R],
        on_report: Callable[[R, JausAddress], None],
        *,
        on_failure: Callable[[], None] | None = None,
        timeout: float = 1.0,
        retries: int = 3,
    ) -> PendingQuery:
        """Ask another component for a report once.

        Args:
            target: The component to ask.
            query: Asks for the report.
            report_class: Generated codec of the report.
            on_report: Takes the report and the sender's address.
            on_failure: Called when every attempt stayed unanswered.
            timeout: Seconds to wait for the report before the query is repeated.
            retries: Repetitions of an unanswered query.

        Returns:
            A handle to cancel the query with.

        Raises:
            EncodeError: A value of the query does not fit its field.
            ValueError: The target is not one component.
        """
        with self.loop.lock:
            return self._query_client.ask(
                target, query, report_class, on_report, on_failure, timeout, retries
            )

    def discover(self, urn: str, on_found: Callable[[FoundComponent], None]) -> None:
        """Report each component that provides a service, once for each component found.

        Args:
            urn: Identifier of the service, e.g. ``urn:jaus:jss:mobility:VelocityStateSensor``.
            on_found: Takes the component.
        """
        with self.loop.lock:
            self._discovery_client.discover(urn, on_found)

    # ---- life cycle -------------------------------------------------------------------------

    def start(self) -> None:
        """Receive messages, initialise, and begin subscriptions and sessions.

        Raises:
            RuntimeError: The component was started already.
        """
        with self.loop.lock:
            if self._running:
                raise RuntimeError(f"component {self.address} runs already")
            self._running = True
            self.transport.attach(self.address, self._receive)
            self._management.initialize()
            starters, self._starters = self._starters, []
            for starter in starters:
                starter()
            self._discovery_client.start()

    def stop(self) -> None:
        """Leave in good order; no effect when the component does not run.

        Releases control that is held, cancels subscriptions, tells the controller that control
        is released and reports the status SHUTDOWN to whoever watches it.
        """
        with self.loop.lock:
            if not self._running:
                return
            self._query_client.stop()
            self._discovery_client.stop()
            self._control_client.stop()
            self._event_client.stop()
            self._management.shut_down()
            self._events.stop()
            self._running = False
            self.transport.detach(self.address)

    def fail(self, reason: str) -> None:
        """Enter Failure (AS5710, Management, internal event Failure).

        Args:
            reason: For the log.
        """
        with self.loop.lock:
            self._management.fail(reason)

    # ---- hooks ------------------------------------------------------------------------------

    def on_initialize(self) -> None:
        """Prepare or reset the component: at the start and after Reset; Standby follows."""

    def on_ready(self) -> None:
        """The controller resumed the component: commands are obeyed from now on."""

    def on_not_ready(self) -> None:
        """The component left Ready, for whatever reason: stop all motion."""

    def on_controller_changed(self, controller: JausAddress | None) -> None:
        """Another component controls this one, or none does (None)."""

    def on_emergency(self, active: bool) -> None:  # noqa: FBT001
        """An emergency was set, or the last one was cleared."""

    def on_shutdown(self) -> None:
        """The component entered Shutdown, by its controller's command or by ``stop``."""

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
        return self._running

    @property
    def status(self) -> Status:
        """Management state (AS5710, ReportStatus)."""
        return self._management.status

    @property
    def controller(self) -> JausAddress | None:
        """The component that controls this one."""
        return self._access.controller

    @property
    def authority(self) -> int:
        """Authority code of the controller, or the default authority without one."""
        return self._access.authority

    @property
    def control_available(self) -> bool:
        """Whether control may be requested: not in Init, Failure, Shutdown or Emergency."""
        return self._access.available

    @control_available.setter
    def control_available(self, available: bool) -> None:
        with self.loop.lock:
            self._access.offered = available

    def allows(self, guard: Guard, sender: JausAddress) -> bool:
        """Whether a message of ``sender`` is obeyed under ``guard``."""
        if guard is Guard.ANY:
            return True
        if sender != self._access.controller:
            return False
        return guard is Guard.CONTROLLED or self._management.status is Status.READY

    # ---- for the services and clients of the component --------------------------------------

    def when_started(self, action: Callable[[], None]) -> None:
        """Run an action now, or at the start of a component that does not run yet."""
        if self._running:
            action()
        else:
            self._starters.append(action)

    def when_shut_down(self, action: Callable[[], None]) -> None:
        """Also run an action when the component enters Shutdown."""
        self._enders.append(action)

    def shut_down(self) -> None:
        """Run the hook and the actions of Shutdown; called by the Management service."""
        for action in (self.on_shutdown, *self._enders):
            self.call(action)

    def call(self, function: Callable[..., Any], *arguments: object) -> Any:
        """Call user code; an error is logged and counted, and None returned."""
        return self._router.call(function, *arguments)

    def provision(self, query_code: int) -> Provision | None:
        """Return what answers a query."""
        return self._router.provision(query_code)

    def report(self, provision: Provision, query: Message, sender: JausAddress) -> bytes | None:
        """Return the encoded report that answers a query now, or None without one."""
        report = self._router.call(provision.provider, query, sender)
        if report is None:
            return None
        try:
            return bytes(report.encode())
        except EncodeError as error:
            self.counters.count("component.report_not_encodable", str(error))
            return None

    def _receive(self, received: ReceivedMessage) -> None:
        self._router.receive(received.payload, received.source)

    def _answer(self, provision: Provision, query: Message, sender: JausAddress) -> None:
        payload = self.report(provision, query, sender)
        if payload is not None:
            self.transport.send(self.address, sender, payload)

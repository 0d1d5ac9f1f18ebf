"""A JAUS component: what it provides to others and how it uses others."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from .clients.control_session import ControlClient, ControlSession, ControlState
from .clients.discovery_client import DiscoveryClient, FoundComponent
from .clients.event_subscription import EventClient, EventSubscription
from .clients.query import PendingQuery, QueryClient
from .component_base import COMPONENT_TYPE, ComponentBase
from .message import Message
from .services.definitions import ComponentSettings, Guard, Scope, ServiceIdentity, Status

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from .address import JausAddress
    from .transport import Transport

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

R = TypeVar("R", bound=Message)


class JausComponent(ComponentBase):
    """One JAUS component of this process.

    The core services among ``services`` are provided: Events, AccessControl, Management,
    Liveness and Discovery; every other message is handled by what ``handle`` and ``provide``
    are given. All methods may be called from any thread. Handlers, providers, callbacks and
    hooks hold ``loop.lock`` and must not block; they run on the loop's thread, or on the thread
    that calls ``start``, ``stop``, ``fail`` or ``report_changed``. When one raises, the error is
    logged and counted as ``component.handler_failed``.

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
        super().__init__(
            transport,
            address,
            name=name,
            services=services,
            component_type=component_type,
            settings=settings,
        )
        self._jaus_event_client = EventClient(self)
        self._jaus_control_client = ControlClient(self)
        self._jaus_query_client = QueryClient(self)
        self._jaus_discovery_client = DiscoveryClient(self)

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
            return self._jaus_event_client.subscribe(
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
            return self._jaus_control_client.control(target, authority, resume, on_change)

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
            return self._jaus_query_client.ask(
                target, query, report_class, on_report, on_failure, timeout, retries
            )

    def discover(self, urn: str, on_found: Callable[[FoundComponent], None]) -> None:
        """Report each component that provides a service, once for each component found.

        Args:
            urn: Identifier of the service, e.g. ``urn:jaus:jss:mobility:VelocityStateSensor``.
            on_found: Takes the component.
        """
        with self.loop.lock:
            self._jaus_discovery_client.discover(urn, on_found)

    def start(self) -> None:
        """Receive messages, initialise, and begin subscriptions and sessions.

        Raises:
            RuntimeError: The component runs already.
            ValueError: Another component of this process has the address.
        """
        with self.loop.lock:
            super().start()
            self._jaus_discovery_client.start()

    def stop(self) -> None:
        """Leave in good order; no effect when the component does not run.

        Releases control that is held, cancels subscriptions, tells the controller that control
        is released and reports the status SHUTDOWN to whoever watches it.
        """
        with self.loop.lock:
            if self._jaus_running:
                self._jaus_query_client.stop()
                self._jaus_discovery_client.stop()
                self._jaus_control_client.stop()
                self._jaus_event_client.stop()
                super().stop()

"""Base of a component, which serves others: its state and its life cycle."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..base.clocks import HostClock
from ..clients.discovery_client import SILENCE
from ..messages import Event
from ..services.definitions import CORE, ComponentSettings, Guard, ServiceIdentity, Status
from ..services.dispatch import Router
from ..services.host import Host
from ..transports.delivery import MESSAGE_CODE_SIZE, Ordering
from ..transports.transport import log_accounts
from .parts import Clients, CoreServices

if TYPE_CHECKING:
    from collections.abc import Sequence
    from datetime import datetime

    from ..base.address import JausAddress
    from ..base.clocks import Timing
    from ..base.fast_path import FastPath
    from ..services.definitions import ListElement
    from ..services.dispatch import Take as TakeMessage
    from ..services.list_manager import ElementList
    from ..transports.delivery import ReceivedMessage, Take
    from ..transports.transport import Transport
    from ..wire.message import Message

COMPONENT_TYPE = 60001
"""Type of a plain component (AS5710, ReportIdentification)."""


class ComponentBase(Host):
    """A component that handles commands and answers queries; see ``JausComponent``.

    Attributes:
        clock: The time, for user code that shall run in virtual time as well.
    """

    _jaus_core: CoreServices
    _jaus_clients: Clients

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

    # ---- state -------------------------------------------------------------------------------

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
            if self._jaus_running:
                self.core_state_changed()

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

    @property
    def unanswered_greetings(self) -> dict[JausAddress, int]:
        """How often each peer that is to be greeted was so since it spoke last."""
        return self._jaus_clients.greeter.unanswered

    def permissions_changed(self) -> None:
        """End the commands under way that are not allowed any more; called by the services."""
        self.loop.revision.changed()
        self._jaus_core.events.permissions_changed()

    def report_changed(self, report_class: type[Message]) -> None:
        """Send the report to every-change events whose report differs from the last one sent."""
        with self.loop.lock:
            self._jaus_core.events.report_changed(report_class)

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

    def watch_emergency(self, message_class: type[Message], take: TakeMessage) -> None:
        """Give an action SetEmergency when an emergency has begun, ClearEmergency when it ended.

        Args:
            message_class: One of the two.
            take: Takes the encoded message, and whoever made the difference.
        """
        with self.loop.lock:
            self._jaus_core.management.watch_emergency(message_class, take)

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

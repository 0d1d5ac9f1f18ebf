"""Base class of components: core services, state and life cycle."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ..base.address import JausAddress
from ..base.api import optional_part
from ..base.clocks import HostClock, Timing
from ..base.counters import LOGGER
from ..base.fast_path import FastPath
from ..clients.presence import SILENCE, Presence
from ..clients.registration import Registration
from ..messages import ClearEmergency, Event, SetEmergency
from ..services.access_control import AccessControlService
from ..services.definitions import (
    CORE,
    DIGITAL_RESOURCE_DISCOVERY,
    ComponentSettings,
    Guard,
    ServiceIdentity,
    Status,
)
from ..services.discovery import DiscoveryService
from ..services.dispatch import Router
from ..services.events import EventsService
from ..services.host import CoreService, Host
from ..services.liveness import LivenessService
from ..services.management import ManagementService
from ..transports.delivery import Ordering, Take
from ..transports.packets.packet import Priority
from ..transports.transport import Transport, log_accounts
from ..wire.message import Message

COMPONENT_TYPE = 60001  # type of a plain component (AS5710, ReportIdentification)


class Component(Host):
    """One JAUS component of this process.

    It provides the core services among ``services``: Events, AccessControl, Management, Time,
    Liveness, Discovery and ListManager, in the versions given there. Handlers and providers of
    other messages are registered by ``handle`` and ``provide``. All methods may be called from any
    thread. Handlers, providers, callbacks and hooks hold ``loop.lock`` and must not block; they run
    on the thread of the loop, or on the thread that calls ``start``, ``stop``, ``fail`` or
    ``report_changed``. An error of one is logged and counted as ``component.handler_failed``.
    Methods raise EncodeError for a value that does not fit its field, and ValueError for an address
    that is not one component or a number out of range. Objects that they return have ``cancel``.

    A generated component derives from this class, and from others that its model needs, such as
    ``EventSubscriber``. It calls ``handle``, ``provide``, ``subscribe`` and ``control`` in its
    constructor, and overrides the ``on_...`` hooks.

    Attributes:
        core_services: Classes of the core services that the component can provide; those among
            ``services`` are.
        clients: Classes of clients of other components that are made at the start.
        clock: The time, for user code that may also run in virtual time.
    """

    core_services: Sequence[Callable[[Host], CoreService]] = (
        EventsService,
        AccessControlService,
        ManagementService,
        LivenessService,
        DiscoveryService,
    )
    clients: Sequence[Callable[[Host], object]] = ()

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
        """Makes a component, which neither sends nor receives before ``start``.

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
        self._jaus_stoppers = []
        self._jaus_permits = []
        self._jaus_parts = {}
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
        # Made even if they are not provided, since they hold the state: a component without
        # Management is never Ready, one without AccessControl never controlled.
        self._jaus_events = self.part(EventsService)
        self._jaus_access = self.part(AccessControlService)
        self._jaus_management = self.part(ManagementService)
        self._jaus_liveness = self.part(LivenessService)
        self._jaus_presence = self.part(Presence)
        self._jaus_registration = self.part(Registration)
        provided = {service.urn for service in self.services}
        if self.settings.digital_resources and DIGITAL_RESOURCE_DISCOVERY not in provided:
            self.part(optional_part("clients.resource_client", "ResourceClient"))
        if self.settings.greeted:
            self.part(optional_part("clients.greeter", "Greeter"))
        for service in map(self.part, self.core_services):
            if not provided.isdisjoint(service.urns):
                service.attach()
        for client in self.clients:
            self.part(client)
        self._jaus_dispatch = self._jaus_dispatcher()

    # ---- state -------------------------------------------------------------------------------

    @property
    def status(self) -> Status:
        """Management state (AS5710, ReportStatus)."""
        return self._jaus_management.status

    @property
    def controller(self) -> JausAddress | None:
        """The component that controls this one; None without one."""
        return self._jaus_access.controller

    @property
    def has_control_lapsed(self) -> bool:
        """Whether the last controller lost control because it did not request it again in time."""
        return self._jaus_access.has_lapsed

    @property
    def authority(self) -> int:
        """Authority code of the controller, or the default authority without one."""
        return self._jaus_access.authority

    @property
    def control_available(self) -> bool:
        """Whether control may be requested: not in Init, Failure, Shutdown or Emergency."""
        return self._jaus_access.available

    @control_available.setter
    def control_available(self, available: bool) -> None:
        with self.loop.lock:
            self._jaus_access.offered = available
            if self._jaus_running:
                self.core_state_changed()

    def allows(self, guard: Guard, sender: JausAddress) -> bool:
        """Returns whether a message of ``sender`` is obeyed under ``guard``."""
        if guard is Guard.ANY:
            return True
        access = self._jaus_access
        if sender != access.controller or not access.managed:
            return False
        return guard is Guard.CONTROLLED or self._jaus_management.status is Status.READY

    # ---- others -----------------------------------------------------------------------------

    def set_emergency(self, target: JausAddress) -> None:
        """Sets an emergency of another component, without control of it (AS5710, SetEmergency)."""
        self.send(SetEmergency(), target, priority=Priority.SAFETY_CRITICAL, acknowledge=True)

    def clear_emergency(self, target: JausAddress) -> None:
        """Clears an emergency that this component has set (AS5710, ClearEmergency)."""
        self.send(ClearEmergency(), target, priority=Priority.SAFETY_CRITICAL, acknowledge=True)

    @property
    def discovery_server(self) -> JausAddress | None:
        """The component with which this one has registered its services; None before."""
        return self._jaus_registration.server

    def _jaus_stand_by(self, provider: JausAddress, on_silence: Callable[[], None] | None) -> None:
        """Leaves Ready for Standby, as a report of `provider` that Ready requires is missing."""
        if self.status is Status.READY:
            LOGGER.warning("%s stands by: %s is silent", self.address, provider)
            self._jaus_management.stand_by()
        if on_silence is not None:
            on_silence()

    # ---- for the services and clients of the component --------------------------------------

    def permissions_changed(self) -> None:
        """Ends commands under way that are not allowed any more; called by the services."""
        self.loop.revision.changed()
        self._jaus_events.permissions_changed()

    def report_changed(self, report_class: type[Message]) -> None:
        """Sends the report to every-change events whose report differs from the last one sent."""
        with self.loop.lock:
            self._jaus_events.report_changed(report_class)

    # ---- life cycle -------------------------------------------------------------------------

    def start(self) -> None:
        """Receives messages, initialises, and begins subscriptions and sessions.

        Raises:
            RuntimeError: The component runs already.
            ValueError: Another component of this process has the address.
        """
        with self.loop.lock:
            if self._jaus_running:
                raise RuntimeError(f"component {self.address} runs already")
            self.transport.attach(self.address, self._jaus_dispatch)
            self._jaus_running = True
            self.core_state_changed()
            self._jaus_management.initialize()
            if not self._jaus_running:
                return  # a hook has stopped it
            starters, self._jaus_starters = self._jaus_starters, []
            for starter in starters:
                starter()
            if self._jaus_running:
                self._jaus_liveness.start()
                self._jaus_registration.start()

    def stop(self) -> None:
        """Stops the component; no effect when it does not run.

        It releases control of others, cancels subscriptions, rejects its controller, and reports
        the status SHUTDOWN to subscribers.
        """
        with self.loop.lock:
            if self._jaus_running:
                for stop in reversed(self._jaus_stoppers):
                    stop()
                self._jaus_management.shut_down()
                self._jaus_events.stop()
                self._jaus_liveness.stop()
                self._jaus_running = False
                log_accounts(self)
                self.transport.detach(self.address)

    def fail(self, reason: str) -> None:
        """Enters Failure (AS5710, Management, internal event Failure)."""
        with self.loop.lock:
            self._jaus_management.fail(reason)

    def lift_emergency(self, clients: JausAddress) -> None:
        """Lifts emergencies whose clients have gone, by the decision of a person at the robot.

        The component is then in Standby without a controller.

        Args:
            clients: The clients that set them; a wildcard means several.

        Raises:
            JausError: None of the clients has set one, or one of them was heard within 10 s.
        """
        with self.loop.lock:
            self._jaus_management.lift(clients)

    # ---- received messages -------------------------------------------------------------------

    def _jaus_dispatcher(self) -> Take:
        """Returns the function that takes each message for the component: payload and sender."""
        takers, unknown = self._jaus_router.takers, self._jaus_router.unknown
        heard, returned = self._jaus_presence.heard, self._jaus_presence.returned
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
        """Returns the fast path of messages of a sender and code, or of an event; None without."""
        if code != Event.CODE:
            return self._jaus_router.fast_path(code, sender)
        if self.event_path is None or len(self._jaus_router.takers.get(code, ())) != 1:
            return None
        return self.event_path(sender, event_id)

    def note_heard(self, sender: JausAddress, at: float) -> None:
        """Records that a message of a sender has come on the fast path."""
        self._jaus_presence.note(sender, at)

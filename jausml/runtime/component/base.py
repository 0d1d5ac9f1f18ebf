"""Base of a component, which serves others: its state and its life cycle."""

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

    The core services among ``services`` are provided: Events, AccessControl, Management, Time,
    Liveness, Discovery and ListManager, as their versions say; every other message is handled by
    what ``handle`` and ``provide`` are given. All methods may be called from any thread.
    Handlers, providers, callbacks and hooks hold ``loop.lock`` and must not block; they run on
    the loop's thread, or on the thread that calls ``start``, ``stop``, ``fail`` or
    ``report_changed``. When one raises, the error is logged and counted as
    ``component.handler_failed``. A value that does not fit its field is an EncodeError; an address
    that is not one component, or a number out of its range, a ValueError. What is returned can be
    cancelled.

    A generated component derives from this class, and from what its model asks for besides, such as
    ``EventSubscriber``. It calls ``handle``, ``provide``, ``subscribe`` and ``control`` in its
    constructor, and overrides the ``on_...`` hooks.

    Attributes:
        core_services: The core services that it may provide; ``services`` says which it does.
        clients: Clients of others that it has from the start, used or not.
        clock: The time, for user code that shall run in virtual time as well.
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
        """Describes a component; nothing is sent or received before ``start``.

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
        # Each keeps a part of the state whatever is provided: one without Management is ready for
        # nobody, one without AccessControl is never controlled.
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
        """The component that controls this one."""
        return self._jaus_access.controller

    @property
    def has_control_lapsed(self) -> bool:
        """Whether the last controller let control lapse: it did not request it again in time."""
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
        """Whether a message of ``sender`` is obeyed under ``guard``."""
        if guard is Guard.ANY:
            return True
        access = self._jaus_access
        if sender != access.controller or not access.managed:
            return False
        return guard is Guard.CONTROLLED or self._jaus_management.status is Status.READY

    # ---- others -----------------------------------------------------------------------------

    def set_emergency(self, target: JausAddress) -> None:
        """Stops another component; no control is needed (AS5710, SetEmergency)."""
        self.send(SetEmergency(), target, priority=Priority.SAFETY_CRITICAL, acknowledge=True)

    def clear_emergency(self, target: JausAddress) -> None:
        """Takes back the emergency that this component has set (AS5710, ClearEmergency)."""
        self.send(ClearEmergency(), target, priority=Priority.SAFETY_CRITICAL, acknowledge=True)

    @property
    def discovery_server(self) -> JausAddress | None:
        """Where the component is registered: the Discovery service of its subsystem, if known."""
        return self._jaus_registration.server

    def _jaus_stand_by(self, provider: JausAddress, on_silence: Callable[[], None] | None) -> None:
        """Leaves Ready for Standby, as a report that is needed there does not come."""
        if self.status is Status.READY:
            LOGGER.warning("%s stands by: %s is silent", self.address, provider)
            self._jaus_management.stand_by()
        if on_silence is not None:
            on_silence()

    # ---- for the services and clients of the component --------------------------------------

    def permissions_changed(self) -> None:
        """Ends the commands under way that are not allowed any more; called by the services."""
        self.loop.revision.changed()
        self._jaus_events.permissions_changed()

    def report_changed(self, report_class: type[Message]) -> None:
        """Sends the report to every-change events whose report differs from the last one sent."""
        with self.loop.lock:
            self._jaus_events.report_changed(report_class)

    # ---- life cycle -------------------------------------------------------------------------

    def start(self) -> None:
        """Receives messages, initialises, and begins subscriptions and sessions.

        A RuntimeError says that the component runs already, a ValueError that another one of this
        process has the address.
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
            self._jaus_liveness.start()
            if self._jaus_running:
                self._jaus_registration.start()

    def stop(self) -> None:
        """Leaves in good order; no effect when the component does not run.

        Releases control that is held, cancels subscriptions, tells the controller that control
        is released and reports the status SHUTDOWN to whoever watches it.
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
        """Lifts emergencies whose clients are gone, by the decision of a person at the robot.

        The component is then in Standby without a controller.

        Args:
            clients: Who set them; a wildcard means several.

        Raises:
            JausError: Nobody of them set one, or somebody of them was heard within 10 s.
        """
        with self.loop.lock:
            self._jaus_management.lift(clients)

    # ---- what comes in -----------------------------------------------------------------------

    def _jaus_dispatcher(self) -> Take:
        """Returns what takes every message for the component, payload and sender."""
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
        """The fast path of messages of a component, by code and for events by id, None without."""
        if code != Event.CODE:
            return self._jaus_router.fast_path(code, sender)
        if self.event_path is None or len(self._jaus_router.takers.get(code, ())) != 1:
            return None
        return self.event_path(sender, event_id)

    def note_heard(self, sender: JausAddress, at: float) -> None:
        """Notes a message of a component that has taken the fast path."""
        self._jaus_presence.note(sender, at)

"""What a component is made of: hooks, core services, clients, and what these ask of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

from ..clients.command_client import CommandClient
from ..clients.control_session import ControlClient, HandoffClient
from ..clients.discovery_client import DiscoveryClient, Greeter, Presence
from ..clients.event_client import EventClient
from ..clients.list_client import ListClient
from ..clients.peer_search import PeerClient
from ..clients.query import QueryClient
from ..clients.resource_client import ResourceClient
from ..services.access_control import AccessControlService
from ..services.definitions import VERSION_1_1, Guard, Status
from ..services.discovery import DigitalResourceService, DiscoveryService
from ..services.events import EventsService
from ..services.handoff import HandoffService
from ..services.list_manager import ListManagerService
from ..services.liveness_and_time import LivenessService, TimeService
from ..services.management import MachineStatesService, ManagementService
from ..wire.message import DecodeError, EncodeError, Message, asked_for, asked_for_in

if TYPE_CHECKING:
    from collections.abc import Callable
    from datetime import datetime

    from ..base.address import JausAddress
    from ..base.counters import Counters
    from ..base.loop import Loop
    from ..services.definitions import HandoffRequest
    from ..services.dispatch import Handler, Provision, Router
    from ..services.host import Host
    from ..services.list_manager import ElementList
    from ..transports.transport import Transport


class Clients:
    """The clients of one component."""

    def __init__(self, host: Host) -> None:
        self.presence = Presence(host.loop)
        self.queries = QueryClient(host)
        self.events = EventClient(host, self.presence, self.queries)
        self.control = ControlClient(host, self.presence, self.events)
        self.handoff = HandoffClient(host, self.control)
        self.discovery = DiscoveryClient(host)
        self.greeter = Greeter(host, self.presence)
        self.peers = PeerClient(host, self.discovery)
        self.commands = CommandClient(host)
        self.lists = ListClient(host, self.queries)
        self.resources = ResourceClient(host, self.peers, self.queries)

    def start(self) -> None:
        """Look around for others, and speak to those that wait for it."""
        self.discovery.start()
        self.greeter.start()

    def stop(self) -> None:
        """Wait for nothing any more, release control and cancel subscriptions."""
        self.resources.stop()
        self.queries.stop()
        self.commands.stop()
        self.lists.stop()
        self.peers.stop()
        self.greeter.stop()
        self.discovery.stop()
        self.handoff.stop()
        self.control.stop()
        self.events.stop()


class CoreService(Protocol):
    """One core service."""

    @property
    def urns(self) -> frozenset[str]:
        """Identifiers of the service; some had several over the years."""

    def attach(self) -> None:
        """Take the messages of the service, for a component that provides it."""


class CoreServices:
    """The part of a component's state that core services keep.

    It is there whatever the component provides: one without Management is ready for nobody, one
    without AccessControl is never controlled. Only services that are provided take messages.
    """

    def __init__(self, host: Host) -> None:
        self.events = EventsService(host)
        self.access_control = AccessControlService(host)
        self.management = ManagementService(host, self.access_control)
        self.handoff = HandoffService(host, self.access_control)
        self.time = TimeService(host)
        self.list_manager = ListManagerService(host)
        self.liveness = LivenessService(host)
        self.discovery = DiscoveryService(host)
        self.digital_resources = DigitalResourceService(host)
        self.machine_states = MachineStatesService(host)
        every: tuple[CoreService, ...] = (
            self.events,
            self.access_control,
            self.handoff,
            self.management,
            self.time,
            self.list_manager,
            self.liveness,
            self.discovery,
            self.digital_resources,
            self.machine_states,
        )
        provided = {service.urn for service in host.services}
        for service in every:
            if not provided.isdisjoint(service.urns):
                service.attach()


class ComponentHooks:
    """Hooks of a component; they do nothing unless they are overridden, and must not block."""

    def on_initialize(self) -> None:
        """Prepare or reset the component: at the start and after Reset; Standby follows."""

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
        """The controller has set the component's clock (AS5710, Time, SetTime).

        Args:
            time: What it was set to, in UTC. The host's clock is left as it is.
        """

    def on_list_changed(self) -> None:
        """The controller has changed ``elements`` (AS5710, ListManager)."""

    def core_state_changed(self) -> None:
        """The status changed, who controls the component, or whether control is to be had."""

    def core_event(self, name: str) -> None:
        """An internal event of a core service happened; for modelled state machines."""


class ComponentState(ComponentHooks):
    """The state of a component; `ComponentBase` makes its parts."""

    transport: Transport
    # Sub-classes are user code: the prefix keeps their private attributes apart from these.
    _jaus_running: bool
    _jaus_starters: list[Callable[[], None]]
    _jaus_enders: list[Callable[[], None]]
    _jaus_versions: dict[str, tuple[int, int]]
    _jaus_router: Router
    _jaus_core: CoreServices
    _jaus_clients: Clients

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

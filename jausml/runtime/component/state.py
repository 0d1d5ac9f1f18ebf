"""What is known of a component, and what its services and clients ask of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..services.definitions import VERSION_1_1, Guard, Status
from ..wire.message import DecodeError, EncodeError, Message
from ..wire.selection import asked_for, asked_for_in
from .hooks import ComponentHooks

if TYPE_CHECKING:
    from collections.abc import Callable
    from datetime import datetime

    from ..base.address import JausAddress
    from ..base.counters import Counters
    from ..base.loop import Loop
    from ..clients.clients import Clients
    from ..services.core import CoreServices
    from ..services.dispatch import Handler, Provision, Router
    from ..services.element_list import ElementList
    from ..transports.transport import Transport


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

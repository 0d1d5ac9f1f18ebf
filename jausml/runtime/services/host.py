"""Host of services and clients: what they need of the component that they belong to."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from ..wire.message import Message
from .definitions import Guard

if TYPE_CHECKING:
    from collections.abc import Callable
    from datetime import datetime

    from ..base.address import JausAddress
    from ..base.clocks import Timing
    from ..base.counters import Counters
    from ..base.loop import Loop
    from ..transports.transport import Transport
    from ..wire.message import DecodeError
    from .definitions import (
        Completion,
        ComponentSettings,
        HandoffRequest,
        ListElement,
        ServiceIdentity,
    )
    from .dispatch import Handler, Provision

M = TypeVar("M", bound=Message)
Q = TypeVar("Q", bound=Message)
R = TypeVar("R", bound=Message)


class Host(Protocol):
    """A component as its core services and clients see it; ``JausComponent`` is the one."""

    transport: Transport
    address: JausAddress
    name: str
    services: tuple[ServiceIdentity, ...]
    component_type: int
    settings: ComponentSettings
    event_clock: Timing

    @property
    def loop(self) -> Loop:
        """The loop on whose thread everything happens."""

    @property
    def counters(self) -> Counters:
        """Counts of what was dropped, ignored or failed."""

    @property
    def running(self) -> bool:
        """Whether the component is between its start and its stop."""

    # ---- messages ---------------------------------------------------------------------------

    def handle(
        self,
        message_class: type[M],
        handler: Callable[[M, JausAddress], Completion | None],
        *,
        when: Guard | Callable[[M], Guard] = Guard.ANY,
        counts_each: bool | None = None,
    ) -> None:
        """Call a handler for each message of a class whose sender is obeyed."""

    def provide(
        self,
        query_class: type[Q],
        report_class: type[R],
        provider: Callable[[Q, JausAddress], R | bytes | None],
        *,
        periodic: bool = True,
        every_change: bool = True,
    ) -> None:
        """Answer a query, and events on it, with what a provider returns."""

    def on_message(
        self, message_class: type[M], callback: Callable[[M, JausAddress], None]
    ) -> None:
        """Call a callback for each message of a class, next to its handler."""

    def on_payload(
        self,
        message_class: type[Message],
        callback: Callable[[bytes, JausAddress], None],
        *,
        is_robust: bool = False,
    ) -> None:
        """Call a callback with the bytes of each message of a class, next to its handler."""

    def send(
        self, message: Message, destination: JausAddress, *, acknowledge: bool = False
    ) -> None:
        """Send one message."""

    def report_changed(self, report_class: type[Message]) -> None:
        """Send a report to every-change events if it differs from the last one sent."""

    def command_handler(self, code: int) -> Handler | None:
        """Return what acts on a message."""

    def provision(self, query_code: int) -> Provision[Any, Any] | None:
        """Return what answers a query."""

    def encoded_report(
        self, provision: Provision[Any, Any], query: Message, report: Message | bytes
    ) -> bytes | None:
        """Return what a query asks for of a report as bytes, or None when that is impossible."""

    # ---- user code --------------------------------------------------------------------------

    def call(self, function: Callable[..., Any], *arguments: object) -> Any:
        """Call user code; an error is logged and counted, and None returned."""

    def payload_caller(
        self,
        function: Callable[[bytes, JausAddress], object],
        on_bad: Callable[[JausAddress, DecodeError], None],
    ) -> Callable[[bytes, JausAddress], None]:
        """Return what calls user code with encoded messages, and tells of those it cannot read."""

    def attempt(self, function: Callable[..., Any], *arguments: object) -> tuple[bool, Any]:
        """Call user code; tell whether it raised no error, and what it returned."""

    # ---- state ------------------------------------------------------------------------------

    def core_version(self, name: str) -> tuple[int, int]:
        """Return the version of a core service that the component provides, 1.1 if of none."""

    def allows(self, guard: Guard, sender: JausAddress) -> bool:
        """Return whether a message of a sender is obeyed under a guard."""

    def permissions_changed(self) -> None:
        """End the commands under way that are not allowed any more."""

    def permit_control(self, permitted: bool) -> None:  # noqa: FBT001
        """Let go of the components that this one controls, or take them back."""

    def when_started(self, action: Callable[[], None]) -> None:
        """Run an action now, or at the start of a component that does not run yet."""

    def shut_down(self) -> None:
        """Run the hook and the actions of Shutdown."""

    # ---- hooks ------------------------------------------------------------------------------

    def on_initialize(self) -> None:
        """Prepare or reset."""

    def on_ready(self) -> None:
        """Obey commands from now on."""

    def on_not_ready(self) -> None:
        """Stop all motion: Ready was left."""

    def on_control_lost(self) -> None:
        """Let nothing stand that the former controller commanded."""

    def on_controller_changed(self, controller: JausAddress | None) -> None:
        """Learn who controls the component."""

    def on_handoff_requested(
        self, target: JausAddress, requests: tuple[HandoffRequest, ...]
    ) -> None:
        """Have a person decide who controls a target that this component controls."""

    def on_emergency(self, active: bool) -> None:  # noqa: FBT001
        """Learn that an emergency was set, or the last one cleared."""

    def on_set_time(self, time: datetime) -> None:
        """Learn what the component's clock was set to."""

    def host_time(self) -> datetime:
        """Return the time in UTC that the component's clock runs by."""

    def on_list_changed(self) -> None:
        """Learn that the list was edited."""

    def supports_element(self, element: ListElement) -> bool:
        """Return whether the list may hold an element."""

    def core_state_changed(self) -> None:
        """Learn that the status changed, or who controls the component."""

    def core_event(self, name: str) -> None:
        """Learn of an internal event of a core service."""

"""A JAUS component: what it provides to others and how it uses others."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, TypeVar

from ..base.counters import LOGGER
from ..clients.list_client import deletion, replacement
from ..clients.peer_search import PeerBinding
from ..messages import ClearEmergency, SetEmergency
from ..services.definitions import Status
from ..transports.packets.packet import Priority
from ..wire.message import Message
from .base import ComponentBase

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from ..base.address import JausAddress
    from ..clients.command_client import PendingCommand
    from ..clients.control_session import ControlSession, HandoffAnswer, PendingHandoff
    from ..clients.control_state import ControlState
    from ..clients.discovery_client import FoundComponent
    from ..clients.event_subscription import EventSubscription
    from ..clients.list_client import ListRequest
    from ..clients.peer_search import PeerSearch
    from ..clients.query import PendingQuery
    from ..messages.access_control import HandoffDecision
    from ..services.definitions import HandoffRequest, ListElement

R = TypeVar("R", bound=Message)


class JausComponent(ComponentBase):
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

    A generated component derives from this class, calls ``handle``, ``provide``, ``subscribe``
    and ``control`` in its constructor, and overrides the ``on_...`` hooks.
    """

    def subscribe(
        self,
        provider: JausAddress,
        query: Message,
        report_class: type[R],
        on_report: Callable[[R, JausAddress], None] | Callable[[bytes, JausAddress], None],
        *,
        rate: float | None = None,
        silence_timeout: float = 0.0,
        on_silence: Callable[[], None] | None = None,
        stands_by: bool = False,
        payloads: bool = False,
    ) -> EventSubscription:
        """Receive a report of another component over an AS5710 event.

        The event is created as soon as the provider answers, renewed, and created anew when the
        provider was restarted. Subscriptions of this component to the same provider and query
        share one event, and each has its own rate of it: the event comes at the highest rate, or
        at every change when anybody wants that; who then asks for a rate is served by queries. A
        later subscriber gets the last report at once.

        Args:
            query: Asks for the report; its presence vector selects the fields.
            rate: Reports each second, above 0 and up to 1092; None means every change.
            silence_timeout: Seconds without a report before ``on_silence``; 0 means never.
            on_silence: Called once each time the provider falls silent.
            stands_by: Whether the component leaves Ready for Standby then, before that call.
            payloads: Whether ``on_report`` takes the encoded report, message code and body, as it
                came. It raises DecodeError for one that it cannot read, which is counted.
        """
        if stands_by:
            on_silence = partial(self._jaus_stand_by, provider, on_silence)
        with self.loop.lock:
            return self._jaus_clients.events.subscribe(
                provider,
                query,
                report_class,
                on_report,
                rate,
                silence_timeout,
                on_silence,
                payloads=payloads,
            )

    def _jaus_stand_by(self, provider: JausAddress, on_silence: Callable[[], None] | None) -> None:
        """Leave Ready for Standby, as a report that is needed there does not come."""
        if self.status is Status.READY:
            LOGGER.warning("%s stands by: %s is silent", self.address, provider)
            self._jaus_core.management.stand_by()
        if on_silence is not None:
            on_silence()

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
            authority: Authority code to request control with, 0 to 255.
            resume: Whether to take the target from Standby to Ready whenever it is found there.

        Returns:
            A handle to read the state from and to release control with.
        """
        with self.loop.lock:
            return self._jaus_clients.control.control(target, authority, resume, on_change)

    def request_handoff(
        self,
        target: JausAddress,
        *,
        authority: int,
        explanation: str = "",
        on_answer: Callable[[HandoffAnswer], None] | None = None,
    ) -> PendingHandoff:
        """Ask for control of another component that somebody else controls (IOP).

        The target has its controller decide. The request is sent again until that is done or it is
        cancelled. Once it is granted, sessions of ``control`` with the target go on at once.

        Args:
            authority: Authority code to control the target with, 0 to 255.
            explanation: Why, for the person who decides; at most 255 bytes of Latin-1.
            on_answer: Told each answer; after QUEUED and DEFERRED others follow.

        Returns:
            A handle to take the request back with.

        Raises:
            EncodeError: The authority or the explanation does not fit.
            ValueError: The target is not one component.
        """
        with self.loop.lock:
            return self._jaus_clients.handoff.request(target, authority, explanation, on_answer)

    def decide_handoff(self, request: HandoffRequest, decision: HandoffDecision) -> None:
        """Tell a controlled component what a person has decided of a request (IOP).

        Who grants controls the target no more: its sessions wait until a request of their own is
        granted, or ``control`` is called again. All other requests are denied then.

        Raises:
            JausError: Nobody asks for that any more.
        """
        with self.loop.lock:
            self._jaus_clients.handoff.decide(request, decision)

    def query(
        self,
        target: JausAddress,
        query: Message,
        report_class: type[R],
        on_report: Callable[[R, JausAddress], None] | Callable[[bytes, JausAddress], None],
        *,
        on_failure: Callable[[], None] | None = None,
        timeout: float = 1.0,
        retries: int = 3,
        payloads: bool = False,
    ) -> PendingQuery:
        """Ask another component for a report once.

        Args:
            on_failure: Called when every attempt stayed unanswered.
            timeout: Seconds to wait for the report before the query is repeated.
            payloads: Whether ``on_report`` takes the encoded report, message code and body, as it
                came. It raises DecodeError for one that it cannot read, which is counted.
        """
        with self.loop.lock:
            return self._jaus_clients.queries.ask(
                target,
                query,
                report_class,
                on_report,
                on_failure,
                timeout,
                retries,
                payloads=payloads,
            )

    def command(
        self,
        target: JausAddress,
        command: Message,
        *,
        on_done: Callable[[bool], None] | None = None,
        on_refused: Callable[[int | None, str], None] | None = None,
        max_duration: int = 60,
        timeout: float = 3.0,
    ) -> PendingCommand:
        """Send a command and learn when it is done (AS5710 v1.1, CreateCommandEvent).

        Components of core v1.0 do not know command events; they answer nothing, and the command
        is not executed.

        Args:
            target: The component to command; it must be controlled if the command needs that.
            on_done: Told whether the command was done; False also when it took too long, or when
                the same command of this component took its place at the target.
            on_refused: Told the code of RejectEventRequest and its text; the code is None when
                the target did not answer.
            max_duration: Seconds that the command may take.
            timeout: Seconds to wait for the confirmation.
        """
        with self.loop.lock:
            return self._jaus_clients.commands.command(
                target, command, on_done, on_refused, max_duration, timeout
            )

    def set_list(
        self,
        target: JausAddress,
        elements: Iterable[ListElement],
        *,
        on_done: Callable[[], None] | None = None,
        on_refused: Callable[[int | None], None] | None = None,
        timeout: float = 1.0,
        retries: int = 3,
    ) -> ListRequest:
        """Replace the list of another component, which must be controlled (AS5710, SetElement).

        Args:
            elements: The list, in order; see ``chain``.
            on_done: Called when the whole list is confirmed.
            on_refused: Told the code of RejectElementRequest, or None when the target did not
                answer; the list may then be set in part.
            timeout: Seconds to wait for each answer before the request is repeated.
        """
        with self.loop.lock:
            return self._jaus_clients.lists.change(
                target, replacement(list(elements)), on_done, on_refused, timeout, retries
            )

    def delete_elements(
        self,
        target: JausAddress,
        uids: Sequence[int],
        *,
        on_done: Callable[[], None] | None = None,
        on_refused: Callable[[int | None], None] | None = None,
        timeout: float = 1.0,
        retries: int = 3,
    ) -> ListRequest:
        """Delete elements of another component's list, which must be controlled.

        Args:
            uids: The elements, at most 255; 65535 means all.
            on_refused: Told the code of RejectElementRequest, or None without an answer.
            timeout: Seconds to wait for each answer before the request is repeated.
        """
        with self.loop.lock:
            return self._jaus_clients.lists.change(
                target, [deletion(uids)], on_done, on_refused, timeout, retries
            )

    def read_list(
        self,
        target: JausAddress,
        on_list: Callable[[tuple[ListElement, ...]], None],
        *,
        on_failure: Callable[[], None] | None = None,
        timeout: float = 1.0,
        retries: int = 3,
    ) -> None:
        """Read the list of another component; control is not needed.

        Args:
            on_failure: Called when a query stayed unanswered, for example because the list was
                changed meanwhile.
            timeout: Seconds to wait for each report before the query is repeated.
        """
        with self.loop.lock:
            self._jaus_clients.lists.read(target, on_list, on_failure, timeout, retries)

    def set_emergency(self, target: JausAddress) -> None:
        """Stop another component; no control is needed (AS5710, SetEmergency)."""
        self.send(SetEmergency(), target, priority=Priority.SAFETY_CRITICAL, acknowledge=True)

    def clear_emergency(self, target: JausAddress) -> None:
        """Take back the emergency that this component has set (AS5710, ClearEmergency)."""
        self.send(ClearEmergency(), target, priority=Priority.SAFETY_CRITICAL, acknowledge=True)

    def discover(self, urn: str, on_found: Callable[[FoundComponent], None]) -> None:
        """Report each component that provides a service, once for each component found.

        Args:
            urn: Identifier of the service, e.g. ``urn:jaus:jss:mobility:VelocityStateSensor``.
        """
        with self.loop.lock:
            self._jaus_clients.discovery.discover(urn, on_found)

    def find_peers(
        self, search: PeerSearch, on_change: Callable[[Sequence[JausAddress]], None]
    ) -> None:
        """Find components by what they provide, and look after them, until the component stops.

        Discovery tells who provides the services; a component is taken when its transport
        acknowledges a message, and let go when three in a row stay unacknowledged. One that is
        taken is kept while it lives, also when a nearer one appears.

        Args:
            on_change: Told all of them, in order, whenever they change; none when they are gone.
        """
        with self.loop.lock:
            self._jaus_clients.peers.find(search, on_change)

    def subscribe_to_found(
        self,
        search: PeerSearch,
        query: Message,
        report_class: type[R],
        on_report: Callable[[R, JausAddress], None],
        *,
        rate: float | None = None,
        silence_timeout: float = 0.0,
        on_silence: Callable[[JausAddress], None] | None = None,
        stands_by: bool = False,
    ) -> None:
        """Receive a report of what a search finds, as ``subscribe`` does of one provider.

        Args:
            rate: Reports each second of each provider; None means every change.
            silence_timeout: Seconds without a report before ``on_silence``; 0 means never.
            on_silence: Told a provider each time that it falls silent.
            stands_by: Whether the component leaves Ready for Standby then, before that call, and
                when a provider is gone.
        """
        subscriptions: dict[JausAddress, EventSubscription] = {}

        def join(peer: JausAddress) -> None:
            silent = None if on_silence is None else partial(on_silence, peer)
            subscriptions[peer] = self.subscribe(
                peer,
                query,
                report_class,
                on_report,
                rate=rate,
                silence_timeout=silence_timeout,
                on_silence=silent,
                stands_by=stands_by,
            )

        def leave(peer: JausAddress) -> None:
            subscriptions.pop(peer).cancel()
            if stands_by:
                self._jaus_stand_by(peer, None)

        PeerBinding(search).follow(self.find_peers, join, leave)

    def query_found(
        self,
        search: PeerSearch,
        query: Message,
        report_class: type[R],
        on_report: Callable[[R, JausAddress], None],
    ) -> None:
        """Ask each component that a search finds for a report once, when it is found."""

        def join(peer: JausAddress) -> None:
            self.query(peer, query, report_class, on_report)

        PeerBinding(search).follow(self.find_peers, join, lambda _peer: None)

    @property
    def discovery_server(self) -> JausAddress | None:
        """Where the component is registered: the Discovery service of its subsystem, if known."""
        return self._jaus_clients.discovery.server

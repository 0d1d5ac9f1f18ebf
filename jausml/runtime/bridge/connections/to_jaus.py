"""Connections that send ROS messages to JAUS peers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Any, Concatenate, TypeVar

from ...base.address import JausAddress
from ...clients.peer_binding import Search
from ...services.definitions import Guard
from ...transports.packets.packet import Priority
from ...wire.message import Message
from ..ends.ends import Ends
from ..reports.states import Standing, StopReason
from .connection import NO_PEER, NOT_READY
from .controlled_peers import ControlledPeers, RepeatedStops
from .from_topics import FromTopics

Send = Callable[[bytes], None]

SourceT = TypeVar("SourceT")
TargetT = TypeVar("TargetT", bound="Message")

_BUSY = 3.0  # seconds without a packet of a peer, to which messages go, before it counts as silent


class TopicsToMessage(FromTopics[SourceT, TargetT]):
    """Sends a JAUS message for each ROS message."""

    def __init__(
        self,
        name: str,
        translate: Callable[Concatenate[SourceT, ...], TargetT | None],
        *,
        peers: Sequence[JausAddress] | Search,
        control: Guard = Guard.ANY,
        priority: Priority = Priority.STANDARD,
        acknowledge: bool = False,
        filters: bool = False,
        **options: Any,
    ) -> None:
        """Prepares the connection.

        Args:
            translate: Returns the JAUS message, or None to pass nothing on.
            peers: JAUS components that receive the message, or how they are found.
            control: Guard of the peers for their senders. Unless that is ANY, control
                of them is acquired and kept, they are resumed for READY, and the message is sent
                to a peer only while it obeys.
            filters: Whether messages with values out of range are dropped on purpose.
        """
        super().__init__(name, translate, **options)
        self.filters = filters
        self._peers = ControlledPeers(peers, control)
        self._priority = priority
        self._acknowledge = acknowledge
        self._sender_by_peer: dict[JausAddress, Send] = {}
        self._senders: tuple[Send, ...] = ()  # to the peers that obey
        self._refusing: tuple[JausAddress, ...] = ()
        self._reference = self._sink.latest
        self._silent_since: dict[JausAddress, float] = {}
        self._stops = RepeatedStops(self._peers, lambda _: self.is_silent, self._stop_again)

    @property
    def peers(self) -> tuple[JausAddress, ...]:
        """JAUS components that receive the message."""
        return self._peers.present

    def open(self, ends: Ends) -> None:
        """Makes the subscriptions and starts to acquire control."""
        super().open(ends)
        self._stops.open(ends)
        self._peers.open(
            ends, self.name, join=self._join, leave=self._leave, changed=self._control_changed
        )
        self.guard()

    def seconds_waited(self, origin: Any) -> float | None:
        """Returns how much later a message arrived than the last one before a standstill would.

        Only times between the two messages are used, as the publisher may have another clock.
        """
        stamp, arrival = self._reference
        if not (stamp and origin) or self._ends.simulation is not None:
            return None
        return self._ends.clock.now() - arrival - float(origin - stamp) * 1e-9

    def _backlog_changed(self) -> None:
        # Later messages are compared with the last one before the standstill.
        self._reference = self._sink.latest
        super()._backlog_changed()

    def _join(self, peer: JausAddress) -> None:
        self._sender_by_peer[peer] = self._sender(peer)
        self._find_route()

    def _leave(self, peer: JausAddress) -> None:
        del self._sender_by_peer[peer]
        self._find_route()
        if self._guarded is not None:
            # First the stop of the peer is removed: its slot may be given to another peer.
            self._guarded.send()
            self._ends.ward.slots.give_back(self, (self._ends.component.address, peer))

    def _sender(self, peer: JausAddress) -> Send:
        """Returns the function that sends a message to a peer."""
        component = self._ends.component
        transport, own = component.transport, component.address
        if self._acknowledge:
            return partial(transport.send, own, peer, priority=self._priority, acknowledge=True)
        return transport.sender(own, peer, self._priority)

    def _find_route(self) -> None:
        """Selects the peers that get messages, after a change of peers, control or halt."""
        senders = self._sender_by_peer
        obeying = [peer for peer in senders if self._peers.obeys(peer)]
        self._senders = tuple(senders[peer] for peer in obeying)
        self._refusing = tuple(peer for peer in senders if peer not in obeying)
        is_simple = len(obeying) == 1 and not self._refusing and self._halt is None
        # One peer, and it obeys: its sender is called without another function between.
        self._sink.deliver = self._senders[0] if is_simple else self.deliver
        self._ends.loop.revision.changed()

    def handling_changed(self) -> None:
        """Tells the core and the guardian of a change, and selects the peers anew."""
        super().handling_changed()
        self._find_route()

    def lacks_peers(self) -> str:
        """Returns which peer is searched for and not found."""
        return self._peers.lacking()

    def refusal(self) -> str:
        """Returns why no peer obeys; empty while one does."""
        if not self._refusing or self._senders:
            return ""
        return f"no peer obeys: {self._peers.reason(self._refusing[0])}"

    def disobeying(self) -> str:
        """Returns which of several peers do not obey."""
        if not self._senders or not self._refusing:
            return ""
        return f"does not obey: {', '.join(map(str, self._refusing))}"

    def follow(self, standing: Standing, lost: StopReason | None) -> bool:
        """Stops commands while the bridge may not command."""
        return self.halt(standing.halt) if self.is_command else super().follow(standing, lost)

    def deliver(self, payload: bytes) -> bool:
        """Sends a message to each peer that obeys; returns False when none does."""
        if self._halt is not None:  # since the message was taken: the stop must stay the last one
            self.refuse_halted(self._halt)
            return False
        if not self._sender_by_peer:
            self.drop(NO_PEER)
            return False
        for send in self._senders:
            send(payload)
        if not self._senders:
            self.drop(NOT_READY, ", ".join(map(str, self._refusing)))
            return False
        self.statistics.withheld.update(self._refusing)
        return True

    def deliver_stop(self, payload: bytes) -> bool:
        """Sends the stop to each peer that obeys, repeated until it is acknowledged.

        The other peers get it when they obey again. Returns False when no peer obeys.
        """
        obeying = [peer for peer in self.peers if self._peers.obeys(peer)]
        return self._send_stop(obeying, payload)

    def guarded_stops(self, payload: bytes) -> dict[str, Any]:
        """Returns the datagram of the stop for each peer that obeys and is reached by UDP.

        There is none for a peer behind a node manager or TCP, or if the page of the guardian is
        full: such a peer stops when its control lapses.
        """
        component = self._ends.component
        transport, own, datagrams = component.transport, component.address, []
        for peer in filter(self._peers.obeys, self.peers):
            pair = transport.datagram(own, peer, payload, self._priority)
            if pair is None:
                continue
            number = partial(transport.next_number, own, peer)
            slot = self._ends.ward.slots.take(self, (own, peer), number)
            if slot is not None:
                datagram, endpoint = pair
                datagrams.append({"data": datagram.hex(), "endpoint": endpoint, "slot": slot})
        return {"datagrams": datagrams}

    def _send_stop(self, peers: Sequence[JausAddress], payload: bytes) -> bool:
        component = self._ends.component
        for peer in peers:
            component.transport.send(
                component.address,
                peer,
                payload,
                priority=self._priority,
                # Acknowledged even where commands are not, so that a lost stop is sent again.
                acknowledge=True,
                on_result=partial(self._stop_sent, peer),
                # Earlier commands are neither sent nor repeated any more.
                supersedes=True,
            )
        return bool(peers)

    def _stop_sent(self, peer: JausAddress, acknowledged: bool) -> None:  # noqa: FBT001 - a fact
        self._stops.sent(peer, self._stops.has_arrived(peer, acknowledged))

    def end(self) -> bool:
        """Sends the safe value for good; returns whether a message of the source was in effect."""
        self._stops.end()
        return super().end()

    def _stop_again(self, peer: JausAddress) -> None:
        self.send_safe_value(partial(self._send_stop, [peer]))

    def silent_peers(self) -> Iterable[JausAddress]:
        """Returns peers that are sent messages, and from which no packet comes."""
        now, latest = self._ends.clock.now(), self.statistics.last_arrival
        is_busy = self._halt is None and latest is not None and now - latest < _BUSY
        unheard = self._ends.component.transport.is_unheard
        silent = [peer for peer in self._sender_by_peer if is_busy and unheard(peer)]
        self._silent_since = {peer: self._silent_since.get(peer, now) for peer in silent}
        return [peer for peer, since in self._silent_since.items() if now - since >= _BUSY]

    def describe_peers(self) -> list[tuple[str, str]]:
        """Returns the JAUS components and the state of their control."""
        return self._peers.describe()

    def _control_changed(self, peer: JausAddress) -> None:
        self._find_route()
        # The guardian has to send its stops to the peers that obey now.
        if self._guarded is not None:
            self._guarded.send()
        self._stops.changed(peer)

"""Connections that carry ROS topics to JAUS as messages that are sent."""

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


_BUSY = 3.0  # seconds after a message in which its receivers should be heard, if nothing was before


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
            translate: Makes the JAUS message, or None to pass nothing on.
            filters: Whether values out of range choose the messages that pass.
            control: What the peers demand of a sender that they obey. Unless that is ANY, control
                of them is acquired and kept, they are resumed for READY, and the message is sent
                to a peer only while it obeys.
        """
        super().__init__(name, translate, **options)
        self.filters = filters
        self._peers = ControlledPeers(peers, control)
        self._priority = priority
        self._acknowledge = acknowledge
        self._prepared: dict[JausAddress, Send] = {}
        self._senders: tuple[Send, ...] = ()  # to the peers that obey
        self._refusing: tuple[JausAddress, ...] = ()
        self._before = self._sink.latest
        self._doubted: dict[JausAddress, float] = {}
        self._stops = RepeatedStops(self._peers, lambda _: self.is_silent, self._stop_again)

    @property
    def peers(self) -> tuple[JausAddress, ...]:
        """JAUS components that receive it."""
        return self._peers.present

    def open(self, ends: Ends) -> None:
        """Makes the subscriptions and starts to acquire control."""
        super().open(ends)
        self._stops.open(ends)
        self._peers.open(
            ends, self.name, join=self._join, leave=self._leave, changed=self._control_changed
        )
        self.guard()

    def waited(self, origin: Any) -> float | None:
        """Returns the seconds since a message was published, by the last one before a standstill.

        The clock of its publisher may be another one, so only what passed between both counts.
        """
        stamp, at = self._before
        if not (stamp and origin) or self._ends.simulation is not None:
            return None
        return self._ends.clock.now() - at - float(origin - stamp) * 1e-9

    def _backlog_changed(self) -> None:
        # What comes later is compared with the last one before the standstill.
        self._before = self._sink.latest
        super()._backlog_changed()

    def _join(self, peer: JausAddress) -> None:
        self._prepared[peer] = self._sender(peer)
        self._find_route()

    def _leave(self, peer: JausAddress) -> None:
        del self._prepared[peer]
        self._find_route()
        if self._guarded is not None:
            # First the stop of the peer goes: the place may become that of another.
            self._guarded.hand()
            self._ends.ward.slots.give_back(self, (self._ends.component.address, peer))

    def _sender(self, peer: JausAddress) -> Send:
        """Returns what sends a message to a peer, whether it obeys or not."""
        component = self._ends.component
        transport, own = component.transport, component.address
        if self._acknowledge:
            return partial(transport.send, own, peer, priority=self._priority, acknowledge=True)
        return transport.sender(own, peer, self._priority)

    def _find_route(self) -> None:
        """Finds out who gets the messages, now that peers, their control or a halt changed."""
        prepared = self._prepared
        obeying = [peer for peer in prepared if self._peers.obeys(peer)]
        self._senders = tuple(prepared[peer] for peer in obeying)
        self._refusing = tuple(peer for peer in prepared if not self._peers.obeys(peer))
        is_simple = len(obeying) == 1 and not self._refusing and self._halt is None
        # One peer, and it obeys: its sender is called without another function between.
        self._sink.deliver = self._senders[0] if is_simple else self.deliver
        self._ends.loop.revision.changed()

    def note_case(self) -> None:
        """Tells others that the case changed, and finds out who gets the messages now."""
        super().note_case()
        self._find_route()

    def lacks_peers(self) -> str:
        """What is searched for and not found."""
        return self._peers.lacking()

    def refusal(self) -> str:
        """Why no peer obeys."""
        if not self._refusing or self._senders:
            return ""
        return f"no peer obeys: {self._peers.reason(self._refusing[0])}"

    def unwilling(self) -> str:
        """Which of several peers do not obey."""
        if not self._senders or not self._refusing:
            return ""
        return f"does not obey: {', '.join(map(str, self._refusing))}"

    def follow(self, standing: Standing, lost: StopReason | None) -> bool:
        """Stops what the bridge commands while it may not command."""
        return self.halt(standing.halt) if self.is_command else super().follow(standing, lost)

    def deliver(self, payload: bytes) -> bool:
        """Sends to each peer that obeys; False when none does."""
        if self._halt is not None:  # since the message was taken; the stop is the last word
            self.refuse_halted(self._halt)
            return False
        if not self._prepared:
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
        """Sends the stop to each peer that obeys, again until it is acknowledged or obeys no more.

        The others get it when they obey again.
        """
        obeying = [peer for peer in self.peers if self._peers.obeys(peer)]
        return self._send_stop(obeying, payload)

    def guarded_stops(self, payload: bytes) -> dict[str, Any]:
        """Returns the datagram of the stop for each peer that obeys and has a known place.

        Behind a node manager or TCP there is none: there, control lapses. So it does where the
        page of the guardian is full, which the ward tells.
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
                # Whatever the model says of the commands: a stop that gets lost is sent again.
                acknowledge=True,
                on_result=partial(self._stop_sent, peer),
                # No command before it is repeated or sent from now on.
                supersedes=True,
            )
        return bool(peers)

    def _stop_sent(self, peer: JausAddress, acknowledged: bool) -> None:  # noqa: FBT001 - a fact
        self._stops.sent(peer, self._stops.has_arrived(peer, acknowledged))

    def end(self) -> bool:
        """Sends the safe value for good; whether messages of the source stood until now."""
        self._stops.end()
        return super().end()

    def _stop_again(self, peer: JausAddress) -> None:
        self.send_safe_value(partial(self._send_stop, [peer]))

    def silent_peers(self) -> Iterable[JausAddress]:
        """Peers of which nothing is heard, though messages go to them: they may not be there."""
        now, latest = self._ends.clock.now(), self.statistics.last_arrival
        is_busy = self._halt is None and latest is not None and now - latest < _BUSY
        unheard = self._ends.component.transport.is_unheard
        silent = [peer for peer in self._prepared if is_busy and unheard(peer)]
        self._doubted = {peer: self._doubted.get(peer, now) for peer in silent}
        return [peer for peer, since in self._doubted.items() if now - since >= _BUSY]

    def describe_peers(self) -> list[tuple[str, str]]:
        """The JAUS components and the state of their control."""
        return self._peers.describe()

    def _control_changed(self, peer: JausAddress) -> None:
        self._find_route()
        # Others obey now, so the guardian has to say its stops to others.
        if self._guarded is not None:
            self._guarded.hand()
        self._stops.changed(peer)

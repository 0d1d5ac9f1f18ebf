"""Interface of transports, and accounts of the traffic with each peer."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple, Protocol

from ..base.address import JausAddress
from ..base.counters import LOGGER, Counters
from ..base.loop import Loop
from ..base.quirks import Learnt, Quirks
from ..base.settings import Endpoint, TransportSettings
from .delivery import Arrival, Double, OnResult, Take, report
from .packets.messenger import Messenger, PeerTraffic
from .packets.packet import Priority


class Transport(ABC):
    """Connects the components of this process to a network.

    ``JudpTransport`` uses UDP, ``JtcpTransport`` TCP, and ``NodeManagerTransport`` the node manager
    of the host.
    """

    def __init__(self, settings: TransportSettings, loop: Loop) -> None:
        self.loop = loop
        self.counters: Counters = loop.counters
        self.arrival = Arrival()
        self.quirks = Quirks()
        self._settings = settings

    @abstractmethod
    def open(self) -> None:
        """Begins to send and receive; raises OSError if the network refuses."""

    @abstractmethod
    def close(self) -> None:
        """Closes the transport; waiting messages are reported as lost."""

    def attach(self, address: JausAddress, take: Take) -> None:
        """Receives messages for a component of this process from now on.

        Raises:
            ValueError: The address is not one component, or is attached already.
            OSError: Another process is known to have the address.
        """
        with self.loop.lock:
            self._attach(address, take)

    def detach(self, address: JausAddress) -> None:
        """Stops receiving messages for a component; no effect for an unknown one."""
        with self.loop.lock:
            self._detach(address)

    def double_of(self, address: JausAddress) -> Double | None:
        """Returns another component with the address of one of this process; None without one."""
        with self.loop.lock:
            messenger = self._messenger_of(address)
            return None if messenger is None else messenger.inbox.doubles.get(address)

    def traffic(self, address: JausAddress) -> list[PeerTraffic]:
        """Returns the traffic of a component with each peer, in packets."""
        with self.loop.lock:
            messenger = self._messenger_of(address)
            traffic = [] if messenger is None else messenger.traffic()
            return [peer for peer in traffic if peer.own == address]

    def is_unheard(self, address: JausAddress) -> bool:  # noqa: ARG002
        """Returns whether a component is known not to be reached, as it would have been heard.

        Only a transport that requests acknowledgements of silent components knows.
        """
        return False

    def answered(self, address: JausAddress, peer: JausAddress, start: bytes) -> None:
        """Ends the repetition of messages with a begin of their payload, as they were answered."""
        with self.loop.lock:
            messenger = self._messenger_of(address)
            if messenger is not None:
                messenger.outbox.answered(address, peer, start)

    def withdraw(self, address: JausAddress, peer: JausAddress, start: bytes) -> None:
        """Ends messages with a begin of their payload: they are neither sent nor repeated.

        They are reported as not acknowledged now, but may have arrived.
        """
        with self.loop.lock:
            messenger = self._messenger_of(address)
            if messenger is not None:
                messenger.outbox.withdraw(address, peer, start)

    def datagram(
        self, source: JausAddress, destination: JausAddress, payload: bytes, priority: Priority
    ) -> tuple[bytes, Endpoint] | None:
        """Returns a datagram for another process to send, and its endpoint; None if impossible.

        It requests acknowledgement, so that only newer datagrams that do so make it late. Its
        sequence number is 0.
        """
        del source, destination, payload, priority
        return None

    def next_number(self, source: JausAddress, destination: JausAddress) -> int:  # noqa: ARG002
        """Returns the sequence number of the next packet from one component to another."""
        return 0

    # ---- strangers --------------------------------------------------------------------------

    def is_proved(self, address: JausAddress) -> bool:  # noqa: ARG002
        """Returns whether a component has proved its endpoint; always true except with UDP."""
        return True

    def place_of(self, address: JausAddress) -> tuple[str, str]:  # noqa: ARG002
        """Returns host and endpoint of a component, for budgets; empty texts if unknown."""
        return "", ""

    def is_kept(self, address: JausAddress) -> bool:  # noqa: ARG002
        """Returns whether a component is always kept: it is configured or in control."""
        return False

    def keep_place(self, owner: JausAddress, address: JausAddress | None) -> None:  # noqa: B027
        """Keeps the controller of an own component, instead of the one before."""

    def when_proved(self, listener: Callable[[JausAddress], None]) -> None:  # noqa: B027
        """Calls a listener on the thread of the loop when a component has proved its endpoint."""

    def silence_of(self, address: JausAddress) -> float:  # noqa: ARG002
        """Returns the seconds since the last packet of a component; infinity without one."""
        return math.inf

    # ---- messages ---------------------------------------------------------------------------

    def send(
        self,
        source: JausAddress,
        destination: JausAddress,
        payload: bytes,
        *,
        priority: Priority = Priority.STANDARD,
        acknowledge: bool = False,
        on_result: OnResult | None = None,
        supersedes: bool = False,
    ) -> None:
        """Sends one message; callable from any thread, never blocks.

        Acknowledged messages of several packets are sent to a destination one after the other;
        messages of one packet do not wait for them. Failures of the network are counted and
        reported to ``on_result``.

        Args:
            destination: Component, or a wildcard for several.
            payload: Little-endian 16-bit message code and body.
            acknowledge: Whether to repeat the message until one receiver has acknowledged it. A
                message of more than ten packets is repeated in any case.
            on_result: Called once with whether the message was acknowledged or delivered in this
                process; without acknowledgement, whether it was sent.
            supersedes: Whether to withdraw earlier messages with the same code to the destination,
                and send this one first; for a stop, which is acknowledged.

        Raises:
            ValueError: The source is not one component or the payload has no message code.
        """
        messenger = self._messenger_of(source)
        if messenger is None:
            self.counters.count("transport.not_attached", f"a message of {source} is lost")
            report(self.loop, on_result, success=False)
        else:
            messenger.send(
                source, destination, payload, priority, acknowledge, on_result, supersedes
            )

    def sender(
        self, source: JausAddress, destination: JausAddress, priority: Priority = Priority.STANDARD
    ) -> Callable[[bytes], None]:
        """Returns a function that sends payloads without acknowledgement, as ``send`` does.

        It costs less than ``send``, and is callable from any thread. The transport need not be open
        yet.
        """
        return partial(self.send, source, destination, priority=priority)

    @abstractmethod
    def _attach(self, address: JausAddress, take: Take) -> None:
        """Attaches a component; called by ``attach`` with the lock."""

    def _detach(self, address: JausAddress) -> None:
        messenger = self._messenger_of(address)
        if messenger is not None:
            messenger.inbox.detach(address)

    @abstractmethod
    def _messenger_of(self, source: JausAddress) -> Messenger[Any] | None:
        """Returns the messenger of a component; None if it is not attached."""


MAX_PEERS = 16  # peers with accounts: those that are always kept, then those heard last

_EXACT = "by destination: what was lost is exact"
_NOT_KNOWN = "not known: what was lost is that much at most"


class Accountable(Protocol):
    """The attributes of a component that its accounts need."""

    transport: Transport
    address: JausAddress

    def drops_of(self, sender: JausAddress) -> dict[str, int]:
        """Returns how many messages of a sender were dropped, by reason."""


class PeerAccount(NamedTuple):
    """Traffic of a component with a peer, its dropped messages and quirks."""

    traffic: PeerTraffic
    drops: Mapping[str, int]
    quirks: Sequence[Learnt]

    def counts(self) -> dict[str, int]:
        """Returns the counts by the names that diagnostics and logs show."""
        account, outcome = self.traffic.account, self.traffic.outcome
        return {
            "sent by it": account.came + account.lost,
            "came": account.came,
            "lost on the way, at most": account.lost,
            "came late": account.late,
            "came twice": account.duplicates,
            "came again": account.repeated,
            "began anew": account.restarts,
            **{f"dropped: {reason}": count for reason, count in sorted(self.drops.items())},
            "sent to it": self.traffic.sent,
            "acknowledged": outcome.acknowledged,
            "acknowledged late": outcome.late,
            "answered, not acknowledged": outcome.answered,
            "not acknowledged": outcome.unacknowledged,
        }

    def facts(self) -> list[tuple[str, str]]:
        """Returns the counts and the quirks of the peer, for `/diagnostics`."""
        counts = [(name, str(count)) for name, count in self.counts().items()]
        quirks = [
            (learnt.quirk.does, f"{learnt.how}: {learnt.quirk.instead}") for learnt in self.quirks
        ]
        numbered = ("numbered", _EXACT if self.traffic.account.is_exact else _NOT_KNOWN)
        return [*counts, numbered, *quirks]

    def __str__(self) -> str:
        counts = [f"{name} {count}" for name, count in self.counts().items() if count]
        description = "; ".join([*counts, *map(str, self.quirks)])
        return f"account of {self.traffic.peer}: {description or 'nothing'}"


def accounts_of(component: Accountable) -> list[PeerAccount]:
    """Returns the accounts of peers, sorted by address; called with the lock of the loop."""
    transport = component.transport
    # The last heard peer is last, before those that are always kept.
    by_time = transport.traffic(component.address)
    peers = sorted(by_time, key=lambda traffic: transport.is_kept(traffic.peer))[-MAX_PEERS:]
    return [
        PeerAccount(traffic, component.drops_of(traffic.peer), transport.quirks.of(traffic.peer))
        for traffic in sorted(peers, key=lambda traffic: traffic.peer)
    ]


def log_accounts(component: Accountable) -> None:
    """Logs the accounts of a component at its end."""
    for account in accounts_of(component):
        LOGGER.info("%s", account)

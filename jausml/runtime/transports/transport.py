"""Transport as components need it, and accounts of what they exchanged with each peer."""

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
    """Components of this process on a network.

    ``JudpTransport`` is that of UDP, ``JtcpTransport`` of TCP, and ``NodeManagerTransport`` goes
    through the host's node manager.
    """

    def __init__(self, settings: TransportSettings, loop: Loop) -> None:
        self.loop = loop
        self.counters: Counters = loop.counters
        self.arrival = Arrival()
        self.quirks = Quirks()
        self._settings = settings

    @abstractmethod
    def open(self) -> None:
        """Begins to send and receive; OSError where the network cannot be used like this."""

    @abstractmethod
    def close(self) -> None:
        """Ends; messages that wait are reported as lost."""

    def attach(self, address: JausAddress, take: Take) -> None:
        """Receives messages for a component of this process from now on.

        Raises:
            ValueError: The address is not one component, or is attached already.
            OSError: Another process has the address, as far as the network tells.
        """
        with self.loop.lock:
            self._attach(address, take)

    def detach(self, address: JausAddress) -> None:
        """Stops to receive messages for a component; no effect when it is unknown."""
        with self.loop.lock:
            self._detach(address)

    def double_of(self, address: JausAddress) -> Double | None:
        """Returns who else was heard with the address of a component, None when nobody was."""
        with self.loop.lock:
            messenger = self._messenger_of(address)
            return None if messenger is None else messenger.inbox.doubles.get(address)

    def traffic(self, address: JausAddress) -> list[PeerTraffic]:
        """Returns what a component has exchanged with each other one, in packets."""
        with self.loop.lock:
            messenger = self._messenger_of(address)
            known = [] if messenger is None else messenger.traffic()
            return [peer for peer in known if peer.own == address]

    def is_unheard(self, address: JausAddress) -> bool:  # noqa: ARG002
        """Returns whether a component would have been heard by now if messages reached it.

        Only a transport that asks silent components for acknowledgement knows.
        """
        return False

    def answered(self, address: JausAddress, peer: JausAddress, start: bytes) -> None:
        """Takes the answer to a message that begins so for its acknowledgement."""
        with self.loop.lock:
            messenger = self._messenger_of(address)
            if messenger is not None:
                messenger.outbox.answered(address, peer, start)

    def withdraw(self, address: JausAddress, peer: JausAddress, start: bytes) -> None:
        """Repeats messages that begin so to a component no more, and does not send those that wait.

        They count as not acknowledged, which is told at once; they may have arrived all the same.
        """
        with self.loop.lock:
            messenger = self._messenger_of(address)
            if messenger is not None:
                messenger.outbox.withdraw(address, peer, start)

    def datagram(
        self, source: JausAddress, destination: JausAddress, payload: bytes, priority: Priority
    ) -> tuple[bytes, Endpoint] | None:
        """Returns what another process may send for a component, and where, if one does.

        It asks for acknowledgement, so that only newer ones that do make it late. Its number is 0.
        """
        del source, destination, payload, priority
        return None

    def next_number(self, source: JausAddress, destination: JausAddress) -> int:  # noqa: ARG002
        """Returns the sequence number of the next packet from one component to another."""
        return 0

    # ---- strangers --------------------------------------------------------------------------

    def is_proved(self, address: JausAddress) -> bool:  # noqa: ARG002
        """Returns whether a component has proved where it is, or need not.

        Only UDP has addresses that can be forged.
        """
        return True

    def place_of(self, address: JausAddress) -> tuple[str, str]:  # noqa: ARG002
        """Returns the host and the endpoint of a component, as budgets share what there is."""
        return "", ""

    def is_kept(self, address: JausAddress) -> bool:  # noqa: ARG002
        """Returns whether a component gives way to nobody: it is configured or in control."""
        return False

    def keep_place(self, owner: JausAddress, address: JausAddress | None) -> None:  # noqa: B027
        """Lets the controller of an owner give way to nobody, instead of the one before."""

    def when_proved(self, listener: Callable[[JausAddress], None]) -> None:  # noqa: B027
        """Calls a listener on the loop's thread when a component has proved where it is."""

    def silence_of(self, address: JausAddress) -> float:  # noqa: ARG002
        """Returns for how many seconds nothing came from a component; infinite if nothing did."""
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
        """Sends one message; callable from any thread, sends on it, never blocks.

        Messages of several packets that are acknowledged go to one destination one after the
        other; messages of one packet do not wait for them. Failures of the network are counted
        and reported to ``on_result``.

        Args:
            destination: Component, or a wildcard for several.
            payload: Little-endian 16-bit message code and body.
            acknowledge: Repeat until acknowledged; of several receivers one is enough. A message
                of more than ten packets is repeated in any case.
            on_result: Told once whether the message was acknowledged or received in this
                process; where no acknowledgement is asked for, whether it was put on the network.
            supersedes: Withdraw what was sent before with the same code to the destination, and go
                before all that waits; for a stop, which is acknowledged.

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
        """Returns what sends payloads without acknowledgement, as ``send`` does.

        It is prepared for one way, and costs less than ``send``; callable from any thread. It may
        be asked for before the transport is open.
        """
        return partial(self.send, source, destination, priority=priority)

    @abstractmethod
    def _attach(self, address: JausAddress, take: Take) -> None:
        """Attaches a component; see ``attach``, which holds the lock."""

    def _detach(self, address: JausAddress) -> None:
        messenger = self._messenger_of(address)
        if messenger is not None:
            messenger.inbox.detach(address)

    @abstractmethod
    def _messenger_of(self, source: JausAddress) -> Messenger[Any] | None:
        """Returns the message layer of a component; None when it cannot send."""


MOST_PEERS = 16
"""Peers that are told of: those with a place of their own, then those that were heard last."""

_EXACT = "by destination: what was lost is exact"
_NOT_KNOWN = "not known: what was lost is that much at most"


class Accountable(Protocol):
    """A component as its accounts see it."""

    transport: Transport
    address: JausAddress

    def drops_of(self, sender: JausAddress) -> dict[str, int]:
        """Returns what was dropped of a sender before it was acted on."""


class PeerAccount(NamedTuple):
    """What a component and a peer exchanged."""

    traffic: PeerTraffic
    drops: Mapping[str, int]
    quirks: Sequence[Learnt]

    def counts(self) -> dict[str, int]:
        """Returns the counts by the names that people see."""
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
        """Returns the counts, and what the peer does otherwise than others, as `/diagnostics`."""
        counts = [(name, str(count)) for name, count in self.counts().items()]
        quirks = [
            (quirk.quirk.does, f"{quirk.how}: {quirk.quirk.instead}") for quirk in self.quirks
        ]
        numbered = ("numbered", _EXACT if self.traffic.account.is_exact else _NOT_KNOWN)
        return [*counts, numbered, *quirks]

    def __str__(self) -> str:
        counts = [f"{name} {count}" for name, count in self.counts().items() if count]
        description = "; ".join([*counts, *map(str, self.quirks)])
        return f"account of {self.traffic.peer}: {description or 'nothing'}"


def accounts_of(component: Accountable) -> list[PeerAccount]:
    """Returns the accounts of the peers, by address; with the lock of the loop."""
    transport = component.transport
    # Those of no place are in the order in which they were heard, the latest last.
    peers = sorted(
        transport.traffic(component.address), key=lambda peer: transport.is_kept(peer.peer)
    )
    latest_peers = sorted(peers[-MOST_PEERS:], key=lambda peer: peer.peer)
    return [
        PeerAccount(peer, component.drops_of(peer.peer), transport.quirks.of(peer.peer))
        for peer in latest_peers
    ]


def log_accounts(component: Accountable) -> None:
    """Logs the accounts, as the last word of a component on what it exchanged."""
    for account in accounts_of(component):
        LOGGER.info("%s", account)

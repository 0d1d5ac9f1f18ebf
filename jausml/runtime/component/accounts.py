"""The accounts of a component: what it exchanged with each peer, and what became of that."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol

from ..base.counters import LOGGER

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ..base.address import JausAddress
    from ..base.quirks import Learnt
    from ..transports.delivery import PeerTraffic
    from ..transports.transport import Transport

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
        traffic = self.traffic
        return {
            "sent by it": traffic.came + traffic.lost,
            "came": traffic.came,
            "lost on the way, at most": traffic.lost,
            "came late": traffic.late,
            "came again": traffic.repeated,
            "began anew": traffic.restarts,
            **{f"dropped: {reason}": count for reason, count in sorted(self.drops.items())},
            "sent to it": traffic.sent,
            "acknowledged": traffic.acknowledged,
            "acknowledged late": traffic.acknowledged_late,
            "answered, not acknowledged": traffic.answered,
            "not acknowledged": traffic.unacknowledged,
        }

    def told(self) -> list[tuple[str, str]]:
        """Returns the counts, and what the peer does otherwise than others, as `/diagnostics`."""
        counts = [(name, str(count)) for name, count in self.counts().items()]
        quirks = [(each.quirk.does, f"{each.how}: {each.quirk.instead}") for each in self.quirks]
        numbered = ("numbered", _EXACT if self.traffic.is_exact else _NOT_KNOWN)
        return [*counts, numbered, *quirks]

    def __str__(self) -> str:
        """Return the counts that are not 0 and the quirks, for a line of the log."""
        counts = [f"{name} {count}" for name, count in self.counts().items() if count]
        told = "; ".join([*counts, *map(str, self.quirks)])
        return f"account of {self.traffic.peer}: {told or 'nothing'}"


def accounts_of(component: Accountable) -> list[PeerAccount]:
    """Returns the accounts of the peers, by address; with the lock of the loop."""
    transport = component.transport
    # Those of no place are in the order in which they were heard, the latest last.
    found = sorted(
        transport.traffic(component.address), key=lambda each: transport.is_kept(each.peer)
    )
    told = sorted(found[-MOST_PEERS:], key=lambda each: each.peer)
    return [
        PeerAccount(each, component.drops_of(each.peer), transport.quirks.of(each.peer))
        for each in told
    ]


def log_accounts(component: Accountable) -> None:
    """Logs the accounts, as the last word of a component on what it exchanged."""
    for each in accounts_of(component):
        LOGGER.info("%s", each)

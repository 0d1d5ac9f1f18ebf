"""Quirks: deviations of peers from the standard, and their workarounds.

All parts of the runtime note the quirks of peers here, and look them up here. No quirk is needed
where a message that all providers know replaces one that crashes some peers: events are renewed by
CreateEvent, and UpdateEvent is never sent.
"""

from __future__ import annotations

from collections import OrderedDict
from enum import Enum
from typing import NamedTuple

from .address import JausAddress
from .counters import LOGGER

MAX_PEERS = 256  # peers whose quirks are remembered; the first one noted gives way


class Quirk(Enum):
    """A deviation of a peer from the standard, and its workaround, in words."""

    OTHER_VERSION = (
        "acknowledges without the version of JUDP",
        "an acknowledgement counts where a packet waits for it",
    )
    NO_ACKNOWLEDGEMENTS = ("answers, and acknowledges nothing", "an answer ends the repetition")
    NO_DUPLICATE_FILTER = ("acts on repetitions too", "an answer ends the repetition")
    NUMBERS_ANEW = ("begins its numbers anew", "repetitions are told by their content")
    FLAGLESS = (
        "sets all flags of its messages",
        "they are taken for messages of low priority, if they are whole",
    )
    NO_WILDCARDS = (
        "knows no wildcards in QueryServices",
        "it is asked for its services by its own id",
    )
    DOUBLED_EVENTS = (
        "makes another event of each CreateEvent",
        "the former event is cancelled, and the peer not taken for restarted",
    )

    @property
    def does(self) -> str:
        """The deviation of the peer."""
        return self.value[0]

    @property
    def instead(self) -> str:
        """The workaround."""
        return self.value[1]


class Learnt(NamedTuple):
    """A quirk that a peer has shown."""

    quirk: Quirk
    how: str  # the evidence

    def __str__(self) -> str:
        return f"{self.quirk.does} ({self.how}): {self.quirk.instead}"


class Quirks:
    """The quirks of all peers. All methods run on the loop, or with its lock."""

    def __init__(self) -> None:
        self._by_peer: OrderedDict[int, dict[Quirk, str]] = OrderedDict()
        self._reported = 0

    def learn(self, peer: JausAddress, quirk: Quirk, how: str) -> None:
        """Remembers a quirk of a peer and its evidence; logs it the first time."""
        quirks = self._by_peer.get(peer)
        if quirks is None:
            if len(self._by_peer) >= MAX_PEERS:
                self._by_peer.popitem(last=False)
            quirks = self._by_peer[peer] = {}
        is_new = quirk not in quirks
        quirks[quirk] = how
        if is_new and self._reported < MAX_PEERS:
            self._reported += 1  # invented ids must not fill the log
            LOGGER.info("%s %s", peer, Learnt(quirk, how))

    def has(self, peer: JausAddress, quirk: Quirk) -> bool:
        """Returns whether a peer has shown a quirk."""
        return quirk in self._by_peer.get(peer, ())

    def of(self, peer: JausAddress) -> tuple[Learnt, ...]:
        """Returns the quirks of a peer, in the order of `Quirk`."""
        quirks = self._by_peer.get(peer, {})
        return tuple(Learnt(quirk, quirks[quirk]) for quirk in Quirk if quirk in quirks)

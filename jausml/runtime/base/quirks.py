"""Quirks: what peers do otherwise than the standard has it, and what is done instead.

This is the one place where it stands what was learnt of each peer. Who meets a quirk says so here,
and who has to do without what a peer cannot do asks here. A message that every provider must know
is used for all where it does the same as another one that some peers die of: events are renewed
by CreateEvent, and UpdateEvent is sent to nobody.
"""

from __future__ import annotations

from collections import OrderedDict
from enum import Enum
from typing import NamedTuple

from .address import JausAddress
from .counters import LOGGER

MOST_PEERS = 256
"""Peers of which something is remembered; the one that was learnt of first gives way."""


class Quirk(Enum):
    """What a peer does, and what is done instead of what would be done with others."""

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
        """What a peer does."""
        return self.value[0]

    @property
    def instead(self) -> str:
        """What is done instead."""
        return self.value[1]


class Learnt(NamedTuple):
    """A quirk that a peer has shown."""

    quirk: Quirk
    how: str

    def __str__(self) -> str:
        return f"{self.quirk.does} ({self.how}): {self.quirk.instead}"


class Quirks:
    """What was learnt of each peer. All of it runs on the loop, or with its lock."""

    def __init__(self) -> None:
        self._known: OrderedDict[int, dict[Quirk, str]] = OrderedDict()
        self._reported = 0

    def learn(self, peer: JausAddress, quirk: Quirk, how: str) -> None:
        """Remembers a quirk of a peer; the log tells of it once."""
        known = self._known.get(peer)
        if known is None:
            if len(self._known) >= MOST_PEERS:
                self._known.popitem(last=False)
            known = self._known[peer] = {}
        is_new = quirk not in known
        known[quirk] = how
        if is_new and self._reported < MOST_PEERS:
            self._reported += 1  # invented ids must not fill the log
            LOGGER.info("%s %s", peer, Learnt(quirk, how))

    def has(self, peer: JausAddress, quirk: Quirk) -> bool:
        """Returns whether a peer has shown a quirk."""
        return quirk in self._known.get(peer, ())

    def of(self, peer: JausAddress) -> tuple[Learnt, ...]:
        """Returns what was learnt of a peer, in the order of `Quirk`."""
        known = self._known.get(peer, {})
        return tuple(Learnt(quirk, known[quirk]) for quirk in Quirk if quirk in known)

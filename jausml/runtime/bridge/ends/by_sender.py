"""Messages of one kind, given to the connections that want those of their sender."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...base.address import JausAddress
    from ...clients.peer_search import PeerBinding

    Take = Callable[[bytes, Any], None]

_MOST_SENDERS = 1024


@dataclass(frozen=True)
class Taker:
    """A connection that takes messages.

    Attributes:
        senders: Whose messages it takes; None for those of anybody.
    """

    take: Take
    senders: PeerBinding | None = None
    refuse: Take | None = None
    is_command: bool = False


class BySender:
    """Finds the connections for a sender once, however many there are.

    A message that no connection wants is counted by the first one that names its senders, once.
    """

    def __init__(self) -> None:
        self._takers: list[Taker] = []
        self._known: dict[JausAddress, tuple[Take, ...]] = {}

    def add(self, taker: Taker) -> None:
        """Adds a connection."""
        self._takers.append(taker)
        self._known.clear()
        if taker.senders is not None:
            taker.senders.on_change(self._known.clear)

    @property
    def are_commands(self) -> bool:
        """Whether a message takes the place of the one before, for any of the connections."""
        return any(each.is_command for each in self._takers)

    def taking(self) -> Take:
        """Returns what takes all messages: the connection itself that alone takes anybody's."""
        if len(self._takers) == 1 and self._takers[0].senders is None:
            return self._takers[0].take
        known, find = self._known, self._find

        def take(data: bytes, sender: JausAddress) -> None:
            for each in known.get(sender) or find(sender):
                each(data, sender)

        return take

    def _find(self, sender: JausAddress) -> tuple[Take, ...]:
        wanting = [
            each.take
            for each in self._takers
            if each.senders is None or sender in each.senders.present
        ]
        refusing = [each.refuse for each in self._takers if each.refuse is not None]
        found = self._known[sender] = tuple(wanting or refusing[:1])
        if len(self._known) > _MOST_SENDERS:  # inventions of a peer must not fill the memory
            self._known.clear()
        return found

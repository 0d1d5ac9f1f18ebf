"""Messages of one kind, given to the connections that want those of their sender."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...base.fast_path import fast_path_of, through

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...base.address import JausAddress
    from ...base.fast_path import FastPath
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

    def __init__(self, changed: Callable[[], None]) -> None:
        """Has no connections yet.

        Args:
            changed: Told when messages of a sender may go to others than before.
        """
        self._changed = changed
        self._takers: list[Taker] = []
        self._known: dict[JausAddress, tuple[Take, ...]] = {}

    def add(self, taker: Taker) -> None:
        """Adds a connection."""
        self._takers.append(taker)
        self._forget()
        if taker.senders is not None:
            taker.senders.on_change(self._forget)

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

        def fast_path(sender: JausAddress) -> FastPath | None:
            takers = known.get(sender, ())
            return fast_path_of(takers[0], sender) if len(takers) == 1 else None

        return through(take, fast_path)

    def _forget(self) -> None:
        self._known.clear()
        self._changed()

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

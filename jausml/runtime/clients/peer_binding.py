"""The peers of a connection: named components, or those that a search finds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

from ..base.address import JausAddress
from ..services.host import Host

OnChange = Callable[[Sequence["JausAddress"]], None]


class Search(Protocol):
    """A search for components, as `PeerSearch` is."""

    def find(self, component: Host, on_change: OnChange) -> None:
        """Searches until a component stops; calls `on_change` with all peers at each change."""


class PeerBinding:
    """The peers of a connection at present."""

    def __init__(self, peers: Sequence[JausAddress] | Search) -> None:
        self.search = None if isinstance(peers, Sequence) else peers
        # Any thread may read it: a change replaces the tuple.
        self.present: tuple[JausAddress, ...] = tuple(peers) if isinstance(peers, Sequence) else ()
        self._on_change: list[Callable[[], None]] = []

    def on_change(self, action: Callable[[], None]) -> None:
        """Has a function called when the peers have changed, before `join` and `leave`."""
        self._on_change.append(action)

    def follow(
        self,
        component: Host,
        join: Callable[[JausAddress], None],
        leave: Callable[[JausAddress], None],
    ) -> None:
        """Calls `join` with each named or found peer, and `leave` with each one that is lost."""

        def change(peers: Sequence[JausAddress]) -> None:
            before, self.present = self.present, tuple(peers)
            for action in self._on_change:
                action()
            for peer in before:
                if peer not in self.present:
                    leave(peer)
            for peer in self.present:
                if peer not in before:
                    join(peer)

        if self.search is not None:
            self.search.find(component, change)
        for peer in self.present:
            join(peer)

    @property
    def is_anybody(self) -> bool:
        """Whether no peer is named or searched for: any component is a peer."""
        return self.search is None and not self.present

    @property
    def is_lacking(self) -> bool:
        """Whether a search has found no peer."""
        return self.search is not None and not self.present

    def describe(self) -> list[tuple[str, str]]:
        """Returns keys and values for diagnostics: the peers of a search; none for named peers."""
        if self.search is None:
            return []
        bound = ", ".join(map(str, self.present))
        return [("search", f"bound to {bound}" if bound else f"searching {self.search}")]

"""Who is at the other end of a connection: components that are named, or what a search finds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

from ..base.address import JausAddress
from ..services.host import Host

OnChange = Callable[[Sequence["JausAddress"]], None]


class Search(Protocol):
    """A search for components; `PeerSearch` is the one."""

    def find(self, component: Host, on_change: OnChange) -> None:
        """Looks for them until a component stops, and tells all of them whenever they change."""


class PeerBinding:
    """Who is at the other end of a connection now."""

    def __init__(self, peers: Sequence[JausAddress] | Search) -> None:
        self.search = None if isinstance(peers, Sequence) else peers
        # Replaced when it changes, so any thread may read it.
        self.present: tuple[JausAddress, ...] = tuple(peers) if isinstance(peers, Sequence) else ()
        self._on_change: list[Callable[[], None]] = []

    def on_change(self, action: Callable[[], None]) -> None:
        """Calls a function whenever they are others, before who comes is met."""
        self._on_change.append(action)

    def follow(
        self,
        component: Host,
        join: Callable[[JausAddress], None],
        leave: Callable[[JausAddress], None],
    ) -> None:
        """Meets those that are named, or each that is found from now on."""

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
        """Whether nobody is named or searched for: messages of anybody are meant."""
        return self.search is None and not self.present

    @property
    def is_lacking(self) -> bool:
        """Whether a search has found nobody."""
        return self.search is not None and not self.present

    def describe(self) -> list[tuple[str, str]]:
        """What a search has found, for diagnostics; nothing for named peers."""
        if self.search is None:
            return []
        bound = ", ".join(map(str, self.present))
        return [("search", f"bound to {bound}" if bound else f"searching {self.search}")]

"""The components at the other end of a connection: named ones, or those that a search finds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .peer_search import PeerSearch

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ..base.address import JausAddress

    OnChange = Callable[[Sequence[JausAddress]], None]


class PeerBinding:
    """Who is at the other end of a connection now.

    Attributes:
        present: They; replaced when it changes, so any thread may read it.
    """

    def __init__(self, peers: Sequence[JausAddress] | PeerSearch) -> None:
        self.search = peers if isinstance(peers, PeerSearch) else None
        self.present: tuple[JausAddress, ...] = (
            () if isinstance(peers, PeerSearch) else tuple(peers)
        )
        self._on_change: list[Callable[[], None]] = []

    def on_change(self, action: Callable[[], None]) -> None:
        """Calls a function whenever they are others, before who comes is met."""
        self._on_change.append(action)

    def follow(
        self,
        find_peers: Callable[[PeerSearch, OnChange], None],
        join: Callable[[JausAddress], None],
        leave: Callable[[JausAddress], None],
    ) -> None:
        """Meets those that are named, or each that is found from now on."""

        def change(found: Sequence[JausAddress]) -> None:
            before, self.present = self.present, tuple(found)
            for action in self._on_change:
                action()
            for peer in before:
                if peer not in self.present:
                    leave(peer)
            for peer in self.present:
                if peer not in before:
                    join(peer)

        if self.search is not None:
            find_peers(self.search, change)
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

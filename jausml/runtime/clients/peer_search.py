"""Peers that are named, or found by the services that they provide."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

from ..base.address import WILDCARD_COMPONENT, WILDCARD_NODE, WILDCARD_SUBSYSTEM, JausAddress
from ..services.definitions import Scope

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    OnChange = Callable[[Sequence[JausAddress]], None]


class PeerChoice(Enum):
    """Which of the components that a search finds are taken."""

    NEAREST = "nearest"
    """One: of the same node, else of the same subsystem, else any; then the lowest address."""
    FIRST = "first"
    """One: that which answers first."""
    ALL = "all"
    """Every one."""


@dataclass(frozen=True)
class PeerSearch:
    """A search for components by what they provide and where they are.

    Attributes:
        services: URNs of services that a component must provide, all of them, of any version.
        subsystem: Where it must be, 1 to 65534; 0 means any subsystem.
        node: Where it must be, 1 to 254; 0 means any node.
        within: Where it must be, as seen from who searches: SYSTEM means anywhere, SUBSYSTEM in
            the same subsystem, NODE on the same node.
        choice: Which of those that are found are taken.

    Raises:
        ValueError: A number is out of its range, or the scope is COMPONENT.
    """

    services: tuple[str, ...]
    subsystem: int = 0
    node: int = 0
    within: Scope = Scope.SYSTEM
    choice: PeerChoice = PeerChoice.NEAREST

    def __post_init__(self) -> None:
        """Refuse what no address can meet."""
        if not (
            0 <= self.subsystem < WILDCARD_SUBSYSTEM
            and 0 <= self.node < WILDCARD_NODE
            and self.within < Scope.COMPONENT
        ):
            raise ValueError(f"nothing can be found: {self}")

    def matches(self, own: JausAddress, address: JausAddress, urns: Collection[str]) -> bool:
        """Return whether a component is one that the search looks for.

        Args:
            own: Who searches; never found by itself.
        """
        return (
            address != own
            and self.subsystem in (0, address.subsystem)
            and self.node in (0, address.node)
            and self.within + distance(own, address) <= Scope.NODE
            and all(urn in urns for urn in self.services)
        )

    def where_to_ask(self, own: JausAddress) -> JausAddress:
        """Return the wildcard address of those who may know such components.

        Every node of a subsystem is asked, since one component may answer for all of them.
        """
        subsystem = self.subsystem if self.within is Scope.SYSTEM else own.subsystem
        return JausAddress(subsystem or WILDCARD_SUBSYSTEM, WILDCARD_NODE, WILDCARD_COMPONENT)

    def __str__(self) -> str:
        """Return what is searched for, for people."""
        places = [
            f"on node {self.node}" if self.node else "",
            f"in subsystem {self.subsystem}" if self.subsystem else "",
            f"of the same {self.within.name.lower()}" if self.within > Scope.SYSTEM else "",
        ]
        services = " and ".join(urn.rpartition(":")[2] for urn in self.services)
        return " ".join(filter(None, [services, *places]))


def distance(own: JausAddress, address: JausAddress) -> int:
    """Return how far another component is: 0 on the same node, 1 in the same subsystem, else 2."""
    if address.subsystem != own.subsystem:
        return 2
    return 0 if address.node == own.node else 1


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

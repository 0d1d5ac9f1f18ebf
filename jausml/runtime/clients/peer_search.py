"""What is looked for when the peers of a connection are found by the services they provide."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

from ..base.address import WILDCARD_COMPONENT, WILDCARD_NODE, WILDCARD_SUBSYSTEM, JausAddress
from ..services.definitions import Scope

if TYPE_CHECKING:
    from collections.abc import Collection


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

"""A peer on Junior that keeps what it receives."""

from jausml.live.peers.makes.junior import JuniorPeer
from jausml.live.peers.makes.vehicle import Place
from jausml.runtime.base.address import JausAddress


class KeepingPeer(JuniorPeer):
    """One component of another host that runs Junior and answers nothing.

    Attributes:
        received: What the application received, with its sources.
    """

    def __init__(self, address: JausAddress, place: Place) -> None:
        """Starts the component."""
        self.received: list[tuple[JausAddress, bytes]] = []
        super().__init__(address, place)

    def on_message(self, source: JausAddress, payload: bytes) -> None:
        """Keeps it."""
        self.received.append((source, payload))

    @property
    def payloads(self) -> list[bytes]:
        """The payloads that came, without their sources."""
        return [payload for _, payload in list(self.received)]

"""Bridges whose peers others may ask for: a person decides who gets control (IOP)."""

from __future__ import annotations

from ..clients.handoff_client import HandoffClient
from ..messages.handoff import HandoffDecision
from ..services.definitions import HandoffRequest
from .bridge import Bridge


class HandoffBridge(Bridge):
    """A bridge that provides HandoffController: it is told who asks for control of its peers."""

    clients = (HandoffClient,)

    def decide_handoff(self, request: HandoffRequest, decision: HandoffDecision) -> None:
        """Tells a controlled peer what a person has decided of a request (IOP).

        Who grants controls the peer no more until a request of its own is granted.

        Raises:
            JausError: Nobody asks for that any more.
        """
        with self.loop.lock:
            self.component.part(HandoffClient).decide(request, decision)

"""Bridges with HandoffController (IOP): a person decides on requests for control of a peer."""

from __future__ import annotations

from ..clients.handoff_client import HandoffClient
from ..messages.handoff import HandoffDecision
from ..services.definitions import HandoffRequest
from .bridge import Bridge


class HandoffBridge(Bridge):
    """A bridge that is asked by other clients to hand over control of its peers."""

    clients = (HandoffClient,)

    def decide_handoff(self, request: HandoffRequest, decision: HandoffDecision) -> None:
        """Sends the decision of a person on a request to the controlled peer.

        A bridge that grants a request has lost control of the peer.

        Raises:
            JausError: The request is not pending any more.
        """
        with self.loop.lock:
            self.component.part(HandoffClient).decide(request, decision)

"""Components that control other components."""

from __future__ import annotations

from collections.abc import Callable

from ..base.address import JausAddress
from ..messages.handoff import HandoffDecision
from ..services.definitions import HandoffRequest
from ..services.host import Host
from .control_session import ControlClient, ControlSession
from .control_state import ControlState
from .handoff_client import HandoffAnswer, HandoffClient, PendingHandoff


class PeerController(Host):
    """A component that controls other components."""

    def control(
        self,
        target: JausAddress,
        *,
        authority: int,
        resume: bool = True,
        on_change: Callable[[ControlState], None] | None = None,
    ) -> ControlSession:
        """Acquires and keeps control of another component (AS5710, AccessControl).

        Sessions of this component with the same target share one exchange, with the highest
        authority asked for.

        Args:
            authority: Authority code to request control with, 0 to 255.
            resume: Whether to take the target from Standby to Ready whenever it is in Standby.

        Returns:
            A handle to read the state from and to release control with.
        """
        with self.loop.lock:
            self.part(HandoffClient)  # takes the handoff requests of other clients
            return self.part(ControlClient).control(
                target, authority, resume=resume, on_change=on_change
            )

    def request_handoff(
        self,
        target: JausAddress,
        *,
        authority: int,
        explanation: str = "",
        on_answer: Callable[[HandoffAnswer], None] | None = None,
    ) -> PendingHandoff:
        """Requests control of a component that another client controls (IOP).

        The controller of the target decides. The request is repeated until it is decided or
        cancelled. Once it is granted, sessions of ``control`` with the target go on at once.

        Args:
            authority: Authority code to control the target with, 0 to 255.
            explanation: The reason, for the operator who decides; at most 255 bytes of Latin-1.
            on_answer: Called with each answer; after QUEUED and DEFERRED others follow.

        Returns:
            A handle to withdraw the request.

        Raises:
            EncodeError: The authority or the explanation does not fit.
            ValueError: The target is not one component.
        """
        with self.loop.lock:
            return self.part(HandoffClient).request(target, authority, explanation, on_answer)

    def decide_handoff(self, request: HandoffRequest, decision: HandoffDecision) -> None:
        """Sends an operator's decision on a handoff request to the controlled target (IOP).

        GRANTED ends control of the target: sessions of this component with it wait until its own
        request is granted, or ``control`` is called again. All other requests are denied then.

        Raises:
            JausError: The request is not open any more.
        """
        with self.loop.lock:
            self.part(HandoffClient).decide(request, decision)

"""Components that control others."""

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
    """A component that controls others."""

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
            resume: Whether to take the target from Standby to Ready whenever it is found there.

        Returns:
            A handle to read the state from and to release control with.
        """
        with self.loop.lock:
            self.part(HandoffClient)  # others may ask for what is controlled
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
        """Asks for control of another component that somebody else controls (IOP).

        The target has its controller decide. The request is sent again until that is done or it is
        cancelled. Once it is granted, sessions of ``control`` with the target go on at once.

        Args:
            authority: Authority code to control the target with, 0 to 255.
            explanation: Why, for the person who decides; at most 255 bytes of Latin-1.
            on_answer: Told each answer; after QUEUED and DEFERRED others follow.

        Returns:
            A handle to take the request back with.

        Raises:
            EncodeError: The authority or the explanation does not fit.
            ValueError: The target is not one component.
        """
        with self.loop.lock:
            return self.part(HandoffClient).request(target, authority, explanation, on_answer)

    def decide_handoff(self, request: HandoffRequest, decision: HandoffDecision) -> None:
        """Tells a controlled component what a person has decided of a request (IOP).

        Who grants controls the target no more: its sessions wait until a request of their own is
        granted, or ``control`` is called again. All other requests are denied then.

        Raises:
            JausError: Nobody asks for that any more.
        """
        with self.loop.lock:
            self.part(HandoffClient).decide(request, decision)

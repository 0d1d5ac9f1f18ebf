"""Handoff of control, as a person sees it: who asks for it, and what comes of asking (IOP)."""

from __future__ import annotations

from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING

from jausml.live.peers.query_client import Refused
from jausml.runtime import HandoffAnswer, HandoffDecision

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.live.peers.query_client import NoAnswer
    from jausml.runtime import HandoffRequest, JausComponent
    from jausml.runtime.base.address import JausAddress

PATIENCE = 20.0
"""Seconds without a word after which a component that lets us wait is taken for lost."""

_WAITS = (HandoffAnswer.QUEUED, HandoffAnswer.DEFERRED)


class Handoffs:
    """What a person is asked, and asks for."""

    def __init__(self, component: JausComponent) -> None:
        """Shows nobody anything yet."""
        self._component = component
        self._waiting: dict[JausAddress, tuple[HandoffRequest, ...]] = {}
        self.on_news: Callable[[str], None] = lambda _: None

    @property
    def waiting(self) -> tuple[HandoffRequest, ...]:
        """Who asks for control of components that we control, or did when we lost it."""
        return tuple(each for asked in list(self._waiting.values()) for each in asked)

    def asked(self, target: JausAddress, requests: tuple[HandoffRequest, ...]) -> None:
        """Takes who asks for control of a component that we control; on the loop's thread."""
        self._waiting[target] = requests
        for each in requests:
            self.on_news(
                f"{each.client} asks for control of {target} with authority {each.authority}: "
                f"{each.explanation!a}; 'grant {target} {each.number}', 'deny' or 'defer'"
            )
        if not requests:
            self.on_news(f"nobody asks for control of {target} any more")

    def decide(self, target: JausAddress, number: int, decision: HandoffDecision) -> HandoffRequest:
        """Tells a component what was decided, and returns the request.

        Raises:
            JausError: The request has ended.
            Refused: There is none with the number.
        """
        for each in self._waiting.get(target, ()):
            if each.number == number:
                self._component.decide_handoff(each, decision)
                if decision is not HandoffDecision.WAIT:
                    left = (other for other in self._waiting[target] if other is not each)
                    self._waiting[target] = tuple(left)
                return each
        raise Refused(f"nobody asks for control of {target} under number {number}")

    def request(
        self,
        target: JausAddress,
        authority: int,
        explanation: str,
        unanswered: Callable[[], NoAnswer],
        timeout: float,
    ) -> None:
        """Asks for control, and waits until a person has granted it.

        Args:
            unanswered: Says that the component does not answer.
            timeout: Seconds to wait for the first answer.

        Raises:
            NoAnswer: It does not answer, or does not any more.
            Refused: It does not hand control over.
        """
        answers: SimpleQueue[HandoffAnswer] = SimpleQueue()
        pending = self._component.request_handoff(
            target, authority=authority, explanation=explanation, on_answer=answers.put
        )
        last, patience = None, timeout
        try:
            while (answer := answers.get(timeout=patience)) in _WAITS:
                if answer is not last:
                    self.on_news(f"{target} lets us wait: {answer.name}")
                last, patience = answer, PATIENCE
        except Empty:
            raise unanswered() from None
        finally:
            pending.cancel()
        if answer is not HandoffAnswer.GRANTED:
            raise Refused(f"{target} is not handed over: {answer.name}")

"""A question that is on its way to a component."""

from __future__ import annotations

import math
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jausml.runtime import JausComponent, PendingQuery
    from jausml.runtime.base.address import JausAddress
    from jausml.runtime.wire.message import Message

ATTEMPTS = 3
"""Fewest times that a question is asked; of long times for an answer, once each second."""


class Question:
    """A question that waits for its answer."""

    def __init__(self, pending: PendingQuery, answers: SimpleQueue[Any]) -> None:
        self._pending = pending
        self._answers = answers

    @property
    def is_over(self) -> bool:
        """Whether the answer is there, or none came in time."""
        return not self._answers.empty()

    def cancel(self) -> None:
        """Asks no more."""
        self._pending.cancel()

    def within(self, seconds: float | None) -> Any:
        """Returns the answer, or None when none comes in time; then it is asked no more."""
        try:
            return self._answers.get(timeout=seconds)
        except Empty:
            self._pending.cancel()
            return None


def asked(
    component: JausComponent,
    target: JausAddress,
    query: Message,
    report_class: type[Message],
    seconds: float,
) -> Question:
    """Has a component ask, without waiting for the answer.

    Args:
        seconds: How long an answer is waited for.
    """
    attempts = max(ATTEMPTS, math.ceil(seconds))
    answers: SimpleQueue[Any] = SimpleQueue()
    pending = component.query(
        target,
        query,
        report_class,
        lambda report, _: answers.put(report),
        on_failure=lambda: answers.put(None),
        timeout=seconds / attempts,
        retries=attempts - 1,
    )
    return Question(pending, answers)

"""One command: sent once or again and again, for as long as the component obeys."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.live.peers.query_client import NoAnswer
from jausml.live.peers.rendering import status_line
from jausml.runtime.services.definitions import Status

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.live.peers.holding import Hold
    from jausml.live.peers.operator import Operator
    from jausml.runtime.wire.message import Message


@dataclass(frozen=True)
class Course:
    """How a command is to be sent (`duration`: seconds to hold control after the first one)."""

    rate: float | None = None
    duration: float = 0.0
    keep_sending: bool = False

    def next_due(self, last: float, now: float) -> float | None:
        """Returns when the next message is due, None when there is none.

        Times are in seconds since the first message. What was missed is left out, not made up for.
        """
        if not self.rate:
            return None
        due = max(round(last * self.rate) + 1, math.ceil(now * self.rate)) / self.rate
        return due if due < self.duration else None


def command(
    operator: Operator, hold: Hold, message: Message, course: Course, tell: Callable[[str], None]
) -> None:
    """Sends a message to a component that we control, and watches that it stays Ready and ours."""
    begin = time.monotonic()
    is_lost = False
    due: float | None = 0.0
    while due is not None:
        operator.send(hold.target, message)
        due = course.next_due(due, time.monotonic() - begin)
        until = begin + (course.duration if due is None else due)
        if not is_lost and hold.wait_for_loss(until - time.monotonic()):
            is_lost = True
            tell(f"{hold.target} is lost: {_standing(operator, hold)}")
            if not course.keep_sending:
                return
        time.sleep(max(0.0, until - time.monotonic()))
    if not is_lost:
        _look_once_more(operator, hold, tell)


def _look_once_more(operator: Operator, hold: Hold, tell: Callable[[str], None]) -> None:
    """Notices a loss that happened after the last look, before control is released."""
    try:
        state, _ = operator.status(hold.target)
    except NoAnswer:
        hold.lose()
        tell(f"{hold.target} is lost: it does not answer any more")
        return
    if hold.is_lost or (hold.was_ready and state is not None and state is not Status.READY):
        hold.lose()
        tell(f"{hold.target} is lost: {_standing(operator, hold)}")


def _standing(operator: Operator, hold: Hold) -> str:
    try:
        return status_line(*operator.status(hold.target))
    except NoAnswer:
        return "it does not answer any more"


def outcome(name: str, hold: Hold) -> str:
    """Returns what was sent, and how much of it may have had no effect."""
    times = f" {hold.sent} times" if hold.sent != 1 else ""
    text = f"{name} sent to {hold.target}{times}"
    if hold.doubtful:
        wanted = "READY and ours" if hold.was_ready else "ours"
        text += f", {hold.doubtful} of them when it may not have been {wanted}"
    return text

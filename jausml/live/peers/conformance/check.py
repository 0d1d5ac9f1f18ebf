"""Checks of conformance: what is sent, what must come back within a time, and how it must be.

Functions with `@step` make the steps; they get the session when the check runs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from functools import wraps
from typing import Concatenate, ParamSpec

from jausml.live.peers.conformance.evidence import TraceLine, Verdict
from jausml.live.peers.conformance.session import Session

P = ParamSpec("P")

Step = Callable[[Session], None]
"""A part of a check: returns when all is well; raises CheckFailed or CheckSkipped otherwise."""


@dataclass(frozen=True, slots=True)
class Check:
    """One check with a stable id: what is sent and what must come back, step by step.

    Attributes:
        id: Group and name, e.g. `access.equal-authority`; an id is never used for another check.
        source: Where the standard demands it.
        explanation: Why it matters.
        destructive: Whether the target cannot go on afterwards; such checks run last, if at all.
        risky: Whether a target that is not robust may not survive it; such checks run after all
            others that leave the target alive.
    """

    id: str
    title: str
    source: str
    explanation: str
    steps: tuple[Step, ...]
    destructive: bool = False
    risky: bool = False

    @property
    def group(self) -> str:
        """The part of the id before the first dot."""
        return self.id.partition(".")[0]

    def run(self, session: Session) -> None:
        """Takes the steps; the first that raises CheckFailed or CheckSkipped ends the check."""
        for check_step in self.steps:
            check_step(session)


def step(function: Callable[Concatenate[Session, P], object]) -> Callable[P, Step]:
    """Turns a function of a session into one of its other arguments that returns a step.

    `answers(1, QueryStatus)` is a step that calls `answers(session, 1, QueryStatus)` when the check
    runs. The first argument of most of them is the number of the client that acts.
    """

    @wraps(function)
    def make_step(*args: P.args, **kwargs: P.kwargs) -> Step:
        def run(session: Session) -> None:
            function(session, *args, **kwargs)

        return run

    return make_step


@dataclass(frozen=True, slots=True)
class CheckResult:
    """The outcome of one check.

    Attributes:
        begun: Time of day at which it began, by which a recording of the run is compared.
    """

    check: Check
    verdict: Verdict
    messages: tuple[str, ...] = ()
    evidence: tuple[TraceLine, ...] = ()
    seconds: float = 0.0
    left_silent: bool = False
    begun: datetime | None = None


@dataclass(frozen=True, slots=True)
class ConformanceReport:
    """The outcome of a run."""

    target: str
    endpoint: str
    services: tuple[str, ...]
    results: tuple[CheckResult, ...] = ()
    interrupted: bool = False

    def count(self, verdict: Verdict) -> int:
        """Returns how many checks have this verdict."""
        return sum(result.verdict is verdict for result in self.results)

    @property
    def passed(self) -> bool:
        """Whether the run came to its end, there were checks, and none failed."""
        return bool(self.results) and not self.interrupted and self.count(Verdict.FAIL) == 0

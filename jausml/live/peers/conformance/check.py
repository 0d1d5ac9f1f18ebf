"""Checks of conformance: documented functions that talk to the target, with their results."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from jausml.live.peers.conformance.verdicts import Verdict

if TYPE_CHECKING:
    from jausml.live.peers.conformance.session import Session
    from jausml.live.peers.conformance.trace import Line


CheckFunction = Callable[["Session"], None]
"""Returns when all is well; raises CheckFailed or CheckSkipped otherwise."""


@dataclass(frozen=True, slots=True)
class Check:
    """One check with a stable id.

    Attributes:
        id: Group and name, e.g. `access.equal-authority`; an id is never used for another check.
        destructive: Whether the target cannot go on afterwards; such checks run last, if at all.
        risky: Whether a target that is not robust may not survive it; such checks run after all
            others that leave the target alive.
    """

    id: str
    title: str
    source: str
    body: CheckFunction
    destructive: bool = False
    risky: bool = False

    @property
    def group(self) -> str:
        """The part of the id before the first dot."""
        return self.id.partition(".")[0]

    @property
    def explanation(self) -> str:
        """What is sent and what must come back."""
        return inspect.getdoc(self.body) or ""


def check(
    check_id: str, title: str, source: str, *, destructive: bool = False, risky: bool = False
) -> Callable[[CheckFunction], Check]:
    """Makes a check of a function, whose docstring is its explanation."""

    def make(body: CheckFunction) -> Check:
        return Check(check_id, title, source, body, destructive, risky)

    return make


@dataclass(frozen=True, slots=True)
class Result:
    """The outcome of one check."""

    check: Check
    verdict: Verdict
    messages: tuple[str, ...] = ()
    evidence: tuple[Line, ...] = ()
    seconds: float = 0.0
    left_silent: bool = False


@dataclass(frozen=True, slots=True)
class ConformanceReport:
    """The outcome of a run.

    Attributes:
        results: One result for each check, in the order of the checks.
    """

    target: str
    endpoint: str
    services: tuple[str, ...]
    results: tuple[Result, ...] = field(default=())
    interrupted: bool = False

    def count(self, verdict: Verdict) -> int:
        """Returns how many checks ended so."""
        return sum(result.verdict is verdict for result in self.results)

    @property
    def passed(self) -> bool:
        """Whether nothing failed."""
        return self.count(Verdict.FAIL) == 0

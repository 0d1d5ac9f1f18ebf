"""A safety case that is checked in, against the model and the evidence as they are now."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from jausml.language.model.diagnostics import Diagnostic, Location, Severity
from jausml.safety_case.argument import SafetyCase, to_plain
from jausml.safety_case.rules import ANSWER, LOST, OLD, STALE


class CaseError(Exception):
    """A file is no safety case; the message says why."""


@dataclass(frozen=True)
class Former:
    """A case that is checked in.

    Attributes:
        evidence: What it says of its files of evidence, by their paths.
        goals: Ids and elements of the goals that it answers.
    """

    path: str
    text: str
    plain: dict[str, Any]
    evidence: dict[str, dict[str, str]]
    goals: list[str]

    def place(self, value: str) -> Location:
        """Returns where a text stands."""
        before, separator, _ = self.text.partition(json.dumps(value))
        return Location(self.path, before.count("\n") + 1 if separator else 1)


def former_case(path: str, data: bytes) -> Former:
    """Returns the case that a file has; raises CaseError."""
    try:
        text = data.decode()
        plain = json.loads(text)
        evidence = {str(entry["path"]): entry for entry in plain["evidence"] if entry["path"]}
        known = [entry[key] for entry in evidence.values() for key in ("sha256", "stale")]
        goals = [goal for hazard in plain["hazards"] for goal in hazard["goals"]]
        shown = [str(goal["id"]) for goal in goals if goal["answered"]]
    except (ValueError, RecursionError, KeyError, TypeError) as error:
        raise CaseError(f"is no safety case: {type(error).__name__} {error}") from error
    if not all(isinstance(digest, str) for digest in known):
        raise CaseError("is no safety case: a digest is no text")
    return Former(path, text, plain, evidence, shown)


def findings(former: Former, case: SafetyCase, unread: Mapping[str, str]) -> list[Diagnostic]:
    """Returns the losses of a case, compared with one that is made now of the same files."""
    diagnostics = [*_of_evidence(former, case, unread), *_of_goals(former, case)]
    if not diagnostics and to_plain(case) != former.plain:
        diagnostics = [_finding(OLD, Location(former.path), "the case is not what is found now")]
    return diagnostics


def _of_evidence(
    former: Former, case: SafetyCase, unread: Mapping[str, str]
) -> Iterator[Diagnostic]:
    now = {evidence.path: evidence for evidence in case.evidence}
    for path, before in former.evidence.items():
        place, name = former.place(path), f"evidence {path}"
        if path in unread:
            yield _finding(LOST, place, f"{name} {unread[path]}")
        elif now[path].stale and not before["stale"]:
            yield _finding(STALE, place, f"{name} {now[path].stale}")
        elif now[path].sha256 != before["sha256"]:
            yield _finding(LOST, place, f"{name} is another file than it was")


def _of_goals(former: Former, case: SafetyCase) -> Iterator[Diagnostic]:
    goals = {case_goal.id: case_goal for case_goal in case.goals}
    for id_ in former.goals:
        goal = goals.get(id_)
        if goal is None:
            text = f"goal {id_} is gone: the model has no such element"
            yield _finding(ANSWER, former.place(id_), text)
        elif not goal.answered:
            text = f"{goal.claim}: {'; '.join(goal.against)}"
            yield _finding(ANSWER, goal.location, text, goal.element)


def _finding(rule: str, place: Location, message: str, element: str = "") -> Diagnostic:
    return Diagnostic(rule, Severity.ERROR, place, message, element=element)

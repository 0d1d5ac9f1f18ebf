"""Questions about what is generated: the plan, its differences, and carrying it out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio import shown
from jausml.authoring.studio.answers.planning import Planned, diff, execute, out_folder, plan
from jausml.authoring.studio.encoding import as_json
from jausml.authoring.studio.methods import Method

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from jausml.authoring.studio.checking import Verdict
    from jausml.authoring.studio.desk import Desk
    from jausml.language.validation.report import Report


@dataclass(frozen=True)
class Asked:
    """What shall be generated."""

    file: str
    out: str = ""
    force: bool = False


@dataclass(frozen=True)
class OfPath:
    """A file of the plan; see `Asked`."""

    file: str
    out: str
    path: str
    force: bool = False


@dataclass(frozen=True)
class Shown:
    """The plan that was shown, by its digest; see `Asked`."""

    file: str
    out: str
    digest: str
    force: bool = False


def methods(desk: Desk) -> Mapping[str, Method[Any]]:
    """Returns the methods by name."""
    return {
        "plan": Method(Asked, lambda asked: _plan(desk, asked)),
        "diff": Method(OfPath, lambda asked: _diff(desk, asked)),
        "generate": Method(Shown, lambda asked: _generate(desk, asked), in_turn=True),
    }


def _out(desk: Desk, file: str, out: str) -> Path:
    return out_folder(desk.project.root, file, out, desk.out)


def _plan(desk: Desk, asked: Asked) -> object:
    verdict = desk.verdicts.of(asked.file)
    out = _out(desk, asked.file, asked.out)
    why = _obstacle(desk, verdict)
    planned = (
        Planned(str(out), problems=why) if why else plan(verdict.report, out, force=asked.force)
    )
    freshness = shown.freshness(desk.freshness(verdict))
    return {**as_json(planned), "revision": verdict.revision, "freshness": freshness}


def _obstacle(desk: Desk, verdict: Verdict) -> str:
    """Returns why no code may be made whatever was found, empty when it may."""
    return verdict.fault or desk.freshness(verdict).why


def _report(desk: Desk, file: str) -> Report:
    """Returns what was found about a file, of which code may be made if that has no errors."""
    verdict = desk.verdicts.of(file)
    why = _obstacle(desk, verdict)
    if why:
        raise AnswerError(why)
    return verdict.report


def _diff(desk: Desk, asked: OfPath) -> object:
    report = _report(desk, asked.file)
    out = _out(desk, asked.file, asked.out)
    return {"diff": diff(report, out, asked.path, force=asked.force)}


def _generate(desk: Desk, asked: Shown) -> object:
    # Also what another program has saved this very moment counts.
    desk.refresh()
    report = _report(desk, asked.file)
    out = _out(desk, asked.file, asked.out)
    return execute(report, out, asked.digest, force=asked.force)

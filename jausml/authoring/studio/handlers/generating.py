"""Requests about what is generated: the plan, its differences, and carrying it out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.json_values import as_json, freshness_as_json
from jausml.authoring.studio.rpc import Method
from jausml.authoring.studio.views.planning import Planned, diff, execute, out_folder, plan

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from jausml.authoring.studio.checking import Verdict
    from jausml.authoring.studio.context import StudioContext
    from jausml.language.validation.rule import Report


@dataclass(frozen=True)
class GenerateRequest:
    """What shall be generated."""

    file: str
    out: str = ""
    force: bool = False


@dataclass(frozen=True)
class OfPath:
    """A file of the plan; see `GenerateRequest`."""

    file: str
    out: str
    path: str
    force: bool = False


@dataclass(frozen=True)
class Shown:
    """The plan that was shown, by its digest; see `GenerateRequest`."""

    file: str
    out: str
    digest: str
    force: bool = False


def methods(context: StudioContext) -> Mapping[str, Method[Any]]:
    """Returns the methods by name."""
    return {
        "plan": Method(GenerateRequest, lambda request: _plan(context, request)),
        "diff": Method(OfPath, lambda request: _diff(context, request)),
        "generate": Method(Shown, lambda request: _generate(context, request), in_turn=True),
    }


def _out(context: StudioContext, file: str, out: str) -> Path:
    return out_folder(context.project.root, file, out, context.out)


def _plan(context: StudioContext, request: GenerateRequest) -> object:
    verdict = context.verdicts.of(request.file)
    out = _out(context, request.file, request.out)
    why = _obstacle(context, verdict)
    planned = (
        Planned(str(out), problems=why) if why else plan(verdict.report, out, force=request.force)
    )
    freshness = freshness_as_json(context.freshness(verdict))
    return {**as_json(planned), "revision": verdict.revision, "freshness": freshness}


def _obstacle(context: StudioContext, verdict: Verdict) -> str:
    """Returns why no code may be made whatever was found, empty when it may."""
    return verdict.fault or context.freshness(verdict).why


def _report(context: StudioContext, file: str) -> Report:
    """Returns what was found about a file, of which code may be made if that has no errors."""
    verdict = context.verdicts.of(file)
    why = _obstacle(context, verdict)
    if why:
        raise AnswerError(why)
    return verdict.report


def _diff(context: StudioContext, request: OfPath) -> object:
    report = _report(context, request.file)
    out = _out(context, request.file, request.out)
    return {"diff": diff(report, out, request.path, force=request.force)}


def _generate(context: StudioContext, request: Shown) -> object:
    # Also what another program has saved this very moment counts.
    context.refresh()
    report = _report(context, request.file)
    out = _out(context, request.file, request.out)
    return execute(report, out, request.digest, force=request.force)

"""Requests for what is generated of a file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.checking import Verdict
from jausml.authoring.studio.context import StudioContext
from jausml.authoring.studio.views.planning import Planned, diff, execute, out_folder, plan
from jausml.language.validation.rule import Report


def _out(context: StudioContext, file: str, out: str) -> Path:
    return out_folder(context.project.root, file, out, context.out)


def _plan(
    context: StudioContext,
    file: str,
    out: str = "",
    force: bool = False,  # noqa: FBT001, FBT002
) -> object:
    verdict = context.verdicts.of(file)
    folder = _out(context, file, out)
    if why := _obstacle(context, verdict):
        return Planned(str(folder), problems=why)
    return plan(verdict.report, folder, force=force)


def _obstacle(context: StudioContext, verdict: Verdict) -> str:
    """Returns why no code may be made, whatever was found; empty when it may."""
    return verdict.fault or context.freshness(verdict).why


def _report(context: StudioContext, file: str) -> Report:
    """Returns the report on a file, of which code may be made if that has no errors."""
    verdict = context.verdicts.of(file)
    if why := _obstacle(context, verdict):
        raise AnswerError(why)
    return verdict.report


def _diff(
    context: StudioContext,
    file: str,
    out: str,
    path: str,
    force: bool = False,  # noqa: FBT001, FBT002
) -> object:
    report = _report(context, file)
    return {"diff": diff(report, _out(context, file, out), path, force=force)}


def _generate(
    context: StudioContext,
    file: str,
    out: str,
    digest: str,
    force: bool = False,  # noqa: FBT001, FBT002
) -> object:
    """Carries out the plan that was shown, by its digest."""
    # Also what another program has saved this very moment counts.
    context.refresh()
    report = _report(context, file)
    return execute(report, _out(context, file, out), digest, force=force)


METHODS: Mapping[str, Callable[..., object]] = {"plan": _plan, "diff": _diff}
"""The functions that answer questions, by name."""

CHANGES: Mapping[str, Callable[..., object]] = {"generate": _generate}
"""The functions that answer requests which change something, in turn."""

"""The report of a run: what is found in the model, in users' code and in generated files."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from jausml.generation.contract.finding import CODE_RULES, STALE
from jausml.language.model.diagnostics import Diagnostic, Location, Severity

if TYPE_CHECKING:
    from pathlib import Path

    from jausml.generation.workspace import Result
    from jausml.language.validation.rule import Report


def with_code(report: Report, result: Result, out: Path) -> Report:
    """Returns the report of a model with what does not fit it in the workspace.

    Args:
        out: The workspace, as the user names it.
    """
    plan = result.plan
    found = [each.diagnostic(out) for each in result.drift]
    for each in (*plan.changes, *plan.refused):
        place = Location(str(out / each.path))
        message = f"{each.kind.value}: {each.reason}"
        found.append(Diagnostic(STALE, Severity.ERROR, place, message))
    paths = (each.location.path for each in found)
    return replace(
        report,
        files=tuple(dict.fromkeys((*report.files, *paths))),
        diagnostics=(*report.diagnostics, *sorted(found)),
        rules=CODE_RULES,
    )

"""Planning: what `jausml generate` would do, and doing exactly that."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from jausml.authoring.proposals.elements import AnswerError
from jausml.generation.contract.finding import Finding
from jausml.generation.errors import GenerationError
from jausml.generation.plan import Action, ActionKind, Plan, unified_diff
from jausml.generation.target import load_targets
from jausml.generation.workspace import Result, generate, select
from jausml.generation.writer import apply, locked
from jausml.language.model import Severity
from jausml.language.validation.formats import text
from jausml.language.validation.rule import Report

_WORDS = {
    ActionKind.CREATE: "create",
    ActionKind.UPDATE: "change",
    ActionKind.DELETE: "remove",
    ActionKind.ORPHAN: "keep",
    ActionKind.REFUSE: "refuse",
}


@dataclass(frozen=True, slots=True)
class PlannedFile:
    """The action for a file.

    `action`: `create`, `change`, `keep`, `same`, `remove` or `refuse`.
    """

    path: str
    action: str
    reason: str


@dataclass(frozen=True, slots=True)
class Drifted:
    """Where a file of the user no longer fits the model."""

    path: str
    line: int
    severity: str
    message: str
    stub: str


@dataclass(frozen=True, slots=True)
class Planned:
    """The plan of a run.

    `problems`: why nothing can be generated, empty when something can. `digest`: tells this plan
    from any other; empty with problems.
    """

    out: str
    files: tuple[PlannedFile, ...] = ()
    drift: tuple[Drifted, ...] = ()
    problems: str = ""
    digest: str = ""


@dataclass(frozen=True, slots=True)
class Written:
    """The number of files that were written or removed, in words too."""

    written: int
    message: str


def out_folder(root: Path, file: str, out: str = "", chosen: str = "") -> Path:
    """Returns the folder that is generated into.

    `out`: what the page asks for, relative to the root; empty for the usual one. `chosen`: what the
    user said when the studio was started; nothing else may lie outside of the root.
    """
    usual = Path(chosen) if chosen else root / f"{PurePosixPath(file).stem}_ws" / "src"
    folder = Path(os.path.realpath(root / out if out else usual))
    own = Path(os.path.realpath(usual))
    if folder != own and not folder.is_relative_to(os.path.realpath(root)):
        raise AnswerError(f"{out} lies outside of the opened folder")
    if folder.exists() and not folder.is_dir():
        raise AnswerError(f"{folder} is no folder")
    return folder


def plan(report: Report, out: Path, *, force: bool = False) -> Planned:
    """Returns the effect of generating from a model into a folder; nothing is written."""
    try:
        result = _checked(report, out, force=force)
    except AnswerError as error:
        return Planned(str(out), problems=str(error))
    return Planned(
        str(out),
        tuple(map(_file, result.plan.actions)),
        tuple(map(_drifted, result.drift)),
        digest=digest(result.plan),
    )


def diff(report: Report, out: Path, path: str, *, force: bool = False) -> str:
    """Returns the patch of one file, empty for no change."""
    actions = [
        action for action in _checked(report, out, force=force).plan.actions if action.path == path
    ]
    if not actions:
        raise AnswerError(f"{path} is no file of the plan")
    return unified_diff(Plan(out, tuple(actions)))


def execute(report: Report, out: Path, shown: str, *, force: bool = False) -> Written:
    """Generates, if that does what was shown.

    `shown`: the digest of the plan that was shown. `AnswerError`: the model or a file has changed
    since, a file is refused, or the operating system refuses.
    """
    try:
        with locked(out):
            result = _checked(report, out, force=force)
            if digest(result.plan) != shown:
                raise AnswerError("the model or the files have changed: look at the plan again")
            apply(result.plan)
    except GenerationError as error:
        raise AnswerError(f"cannot write into {out}: {error}") from error
    changes = result.plan.changes
    words = [
        f"{count} {word}"
        for kind, word in (
            (ActionKind.CREATE, "created"),
            (ActionKind.UPDATE, "changed"),
            (ActionKind.DELETE, "removed"),
        )
        if (count := len(result.plan.of(kind)))
    ]
    return Written(len(changes), f"{', '.join(words) or 'nothing to do'} in {out}")


def digest(planned: Plan) -> str:
    """Returns the checksum of a plan."""
    summary = hashlib.sha256(planned.manifest.encode())
    for action in planned.actions:
        for part in (
            action.kind.value,
            action.path,
            action.reason,
            action.old,
            action.new,
            action.backup,
        ):
            data = b"-" if part is None else part.encode("utf-8", "surrogatepass")
            summary.update(b"%d:" % len(data) + data)
    return summary.hexdigest()


def _checked(report: Report, out: Path, *, force: bool) -> Result:
    problems = _problems(report)
    if problems:
        raise AnswerError(problems)
    selection = select(load_targets())
    try:
        return generate(
            report.model,
            selection.targets,
            out,
            kept=selection.kept,
            renewed=selection.renewed,
            force=force,
            write=False,
        )
    except GenerationError as error:
        raise AnswerError(str(error)) from error


def _problems(report: Report) -> str:
    if not report.has_errors:
        return ""
    errors = [
        diagnostic for diagnostic in report.diagnostics if diagnostic.severity is Severity.ERROR
    ]
    first = text.one_line(str(errors[0]))
    others = f" and {len(errors) - 1} more" if len(errors) > 1 else ""
    return f"errors come first: {first}{others}"


def _file(action: Action) -> PlannedFile:
    word = _WORDS.get(action.kind, "same" if action.reason == "unchanged" else "keep")
    return PlannedFile(action.path, word, action.reason)


def _drifted(finding: Finding) -> Drifted:
    return Drifted(
        finding.path, finding.line, finding.severity.value, finding.message, finding.stub
    )

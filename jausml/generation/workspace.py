"""Workspaces: from a valid model, some targets and a folder to files and a report of findings."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from jausml.generation.artifact import DIGEST_MARK, Artifact, Kind
from jausml.generation.contract.finding import CODE_RULES, STALE, Finding, Fix, fix_files
from jausml.generation.contract.interface import Interface
from jausml.generation.contract.renames import former_names
from jausml.generation.drift import drift
from jausml.generation.errors import GenerationError, OwnershipError, SelectionError
from jausml.generation.manifest import Manifest, find_python, inspect, read_manifest
from jausml.generation.plan import Plan, make_plan
from jausml.generation.rendering import render
from jausml.generation.target import Target, name_of, system_of
from jausml.generation.writer import apply, locked
from jausml.language.model.diagnostics import Diagnostic, Location, Severity
from jausml.language.model.model import Model
from jausml.language.validation.rule import Report


@dataclass(frozen=True)
class Selection:
    """The targets of a run.

    Attributes:
        kept: Names of targets that do not run and whose files stay; None means every other.
    """

    targets: tuple[Target[Any], ...]
    kept: frozenset[str] | None
    renewed: tuple[Target[Any], ...] = ()


@dataclass(frozen=True)
class Result:
    """The outcome of a run, or of one that writes nothing."""

    plan: Plan
    drift: tuple[Finding, ...]
    is_written: bool
    fixed: tuple[Fix, ...] = ()


def select(
    installed: Mapping[str, Target[Any]],
    names: Collection[str] = (),
    *,
    whole_library: bool = False,
) -> Selection:
    """Chooses targets."""
    unknown = [name for name in names if name not in installed]
    if unknown:
        known = ", ".join(installed) or "none"
        raise SelectionError(f"no target '{unknown[0]}'; installed: {known}")
    asked = frozenset(name for name, target in installed.items() if target.is_on_request)
    targets = [installed[name] for name in sorted(set(names) or set(installed) - asked)]
    if whole_library:
        if all(target.whole_library is None for target in targets):
            able = [name for name, target in installed.items() if target.whole_library]
            raise SelectionError(f"--all is an option of --target {' and '.join(able) or 'none'}")
        targets = [target.for_whole_library() for target in targets]
    if names:
        return Selection(tuple(targets), None)
    renewed = tuple(target for _, target in sorted(installed.items()) if target.is_renewed)
    return Selection(tuple(targets), asked, renewed)


def generate(
    model: Model,
    targets: Sequence[Target[Any]],
    out: Path,
    *,
    kept: Collection[str] | None = (),
    renewed: Sequence[Target[Any]] = (),
    adopt: str = "",
    force: bool = False,
    write: bool = True,
    fix: bool = False,
) -> Result:
    """Generates a workspace; writes nothing when a file is refused.

    Args:
        kept: Names of targets that do not run and whose files stay; None means every other.
        force: Overwrite edited generated files after a copy to `<file>.orig`. Skeletons are never
            overwritten.
        fix: Make users' files fit where it is certain how.

    Raises:
        OwnershipError: The workspace has no model of the name to adopt.
    """
    if any(target.needs_system for target in targets):
        system_of(model)
    # What is shared depends on what stands beside: no other run writes between the two.
    with locked(out) if write else nullcontext():
        if renewed:
            there = _generated_targets(out, {name_of(model), adopt})
            again = [target for target in renewed if target.name in there]
            _check_again(model, again)
            targets = [*targets, *again]
        artifacts = render(model, targets, _beside(out, name_of(model), targets, kept))
        return _generate(
            model, targets, artifacts, out, kept, adopt, force=force, write=write, fix=fix
        )


def broken_code(old: Model, new: Model, targets: Sequence[Target[Any]], out: Path) -> list[Finding]:
    """Returns the findings about users' files after a change of a model; writes nothing."""
    beside = _beside(out, name_of(new), targets, None)
    before, after = render(old, targets, beside), render(new, targets, beside)
    manifest = read_manifest(out)
    paths = [{artifact.path for artifact in state} for state in (before, after)]
    added, removed = frozenset(paths[1] - paths[0]), frozenset(paths[0] - paths[1])
    interfaces = Interface(before, out, manifest, added), Interface(after, out, manifest, removed)
    former = former_names(*interfaces)
    known = {
        (finding.kind, finding.path, finding.line, finding.column)
        for finding in drift(before, out, manifest, deleted=added)
    }
    return [
        finding
        for finding in drift(after, out, manifest, deleted=removed, former=former)
        if finding.severity is not Severity.INFO
        and (finding.kind, finding.path, finding.line, finding.column) not in known
    ]


def _check_again(model: Model, again: Sequence[Target[Any]]) -> None:
    """Looks whether targets that nobody named in this run can generate the model."""
    for target in again:
        try:
            target.tasks(model)
        except GenerationError as error:
            cure = f"to go without, delete what --target {target.name} generated here before"
            raise GenerationError(f"{error} ({cure})") from error


def _generated_targets(out: Path, names: Collection[str]) -> set[str]:
    """Returns the names of the targets of which a folder has files, made of models of a name."""
    return {
        entry.target
        for path, entry in read_manifest(out).files.items()
        if not set(names).isdisjoint(entry.models) and (out / path).exists()
    }


def _generate(
    model: Model,
    targets: Sequence[Target[Any]],
    artifacts: Sequence[Artifact],
    out: Path,
    kept: Collection[str] | None,
    adopt: str,
    *,
    force: bool,
    write: bool,
    fix: bool,
) -> Result:
    name = name_of(model)
    manifest = _manifest(out, name, adopt)
    covered = _covered(manifest, targets, kept)
    launching = [target.processes for target in targets if target.processes is not None]
    processes = [dict(process) for list_processes in launching for process in list_processes(model)]
    former: dict[str, str] = {}

    def facts(deleted: frozenset[str]) -> dict[str, Any]:
        remembered = manifest.models.get(name, {}).get("former")
        after = Interface(artifacts, out, manifest, deleted)
        former.update(former_names(Interface((), out, manifest), after, remembered))
        stored: dict[str, Any] = {"processes": processes} if launching else {}
        return {**stored, "former": former} if former or remembered else stored

    plan = make_plan(
        artifacts, out, manifest, model=name, targets=covered, force=force, model_facts=facts
    )
    compare = partial(drift, artifacts, out, manifest, deleted=plan.deleted, former=former)
    findings = compare()
    is_written = write and not plan.refused
    if is_written:
        apply(plan)
    fixed: list[Fix] = []
    while is_written and fix and (done := fix_files(out, findings)):
        fixed += done
        findings = compare()
    return Result(plan, tuple(findings), is_written, tuple(fixed))


def _covered(
    manifest: Manifest, targets: Sequence[Target[Any]], kept: Collection[str] | None
) -> set[str]:
    """Returns the names of the targets all of whose files of a model a run decides."""
    written = {entry.target for entry in manifest.files.values()}
    others = frozenset() if kept is None else written - frozenset(kept)
    return {target.name for target in targets} | others


def _beside(
    out: Path, name: str, targets: Sequence[Target[Any]], kept: Collection[str] | None
) -> list[tuple[str, str]]:
    """Returns path and text of the Python that stays beside what a run makes of a model.

    That is what users wrote, and what was generated of other models or by other targets.
    """
    manifest = read_manifest(out)
    covered = _covered(manifest, targets, kept)
    shared = {target.name for target in targets if target.is_shared}
    kept_paths = {
        path
        for path, entry in manifest.files.items()
        if entry.target not in shared and (entry.target not in covered or {*entry.models} - {name})
    }
    listed = {path for path, entry in manifest.files.items() if entry.kind is Kind.GENERATED}
    texts = ((path, inspect(out, path).text or "") for path in find_python(out))
    return [
        (path, text)
        for path, text in texts
        # What has a header and is not listed was left by an older run.
        if path in kept_paths or (path not in listed and DIGEST_MARK not in text)
    ]


def _manifest(out: Path, name: str, adopt: str) -> Manifest:
    """Returns the manifest of a folder, in which a model may take over the files of another."""
    manifest = read_manifest(out)
    if not adopt:
        return manifest
    if adopt not in manifest.models:
        names = ", ".join(sorted(manifest.models)) or "none"
        raise OwnershipError(f"{out} knows no model '{adopt}' to adopt; there are: {names}")
    return manifest.adopted(name, adopt)


def with_code(report: Report, result: Result, out: Path) -> Report:
    """Returns the report of a model with the findings about the workspace."""
    plan = result.plan
    diagnostics = [finding.diagnostic(out) for finding in result.drift]
    for change in (*plan.changes, *plan.refused):
        place = Location(str(out / change.path))
        message = f"{change.kind.value}: {change.reason}"
        diagnostics.append(Diagnostic(STALE, Severity.ERROR, place, message))
    paths = (diagnostic.location.path for diagnostic in diagnostics)
    return replace(
        report,
        files=tuple(dict.fromkeys((*report.files, *paths))),
        diagnostics=(*report.diagnostics, *sorted(diagnostics)),
        rules=CODE_RULES,
    )

"""Plan of a run: one plan for writing, `--check`, `--diff` and `--dry-run`."""

from __future__ import annotations

import difflib
import io
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from typing import Any

from jausml.generation.artifact import Artifact, Kind, find_problems, has_valid_header, text_digest
from jausml.generation.manifest import (
    MANIFEST_PATH,
    PENDING_PATH,
    Entry,
    FileState,
    Manifest,
    find_generated,
    inspect,
    new_entry,
    temporary,
)


class ActionKind(Enum):
    """Kinds of actions for a file."""

    CREATE = "create"
    UPDATE = "update"
    KEEP = "keep"
    DELETE = "delete"
    ORPHAN = "orphan"  # reported only
    REFUSE = "refuse"  # one of these stops the whole plan


@dataclass(frozen=True)
class Action:
    """The action for one file, and its reason.

    Attributes:
        old: Text that stands there (LF line ends); None for no file or one not readable as text.
        backup: Where the old bytes are copied before an overwrite, or empty.
    """

    kind: ActionKind
    path: str
    reason: str
    old: str | None = None
    new: str | None = None
    backup: str = ""
    executable: bool = False


@dataclass(frozen=True)
class Plan:
    """All actions of a run; the manifest's is the last.

    Attributes:
        manifest: Text of the new manifest; the pending file gets it even where it stays the same.
    """

    out: Path
    actions: tuple[Action, ...]
    manifest: str = ""

    @property
    def changes(self) -> tuple[Action, ...]:
        """The actions that write or delete."""
        return self.of(ActionKind.CREATE, ActionKind.UPDATE, ActionKind.DELETE)

    @property
    def refused(self) -> tuple[Action, ...]:
        """The refusals; with one of them nothing is written."""
        return self.of(ActionKind.REFUSE)

    @property
    def orphans(self) -> tuple[Action, ...]:
        """Files that no longer belong to the model but are not ours to delete."""
        return self.of(ActionKind.ORPHAN)

    @property
    def deleted(self) -> frozenset[str]:
        """The paths that are deleted."""
        return frozenset(action.path for action in self.of(ActionKind.DELETE))

    @property
    def is_up_to_date(self) -> bool:
        """Whether writing would change nothing (exit status 0 of `--check`)."""
        return not self.changes and not self.refused

    def of(self, *kinds: ActionKind) -> tuple[Action, ...]:
        """Returns the actions of some kinds."""
        return tuple(action for action in self.actions if action.kind in kinds)


def make_plan(
    artifacts: Sequence[Artifact],
    out: Path,
    manifest: Manifest,
    *,
    model: str,
    targets: Collection[str] | None,
    force: bool = False,
    model_facts: Callable[[frozenset[str]], Mapping[str, Any]] | None = None,
) -> Plan:
    """Compares rendered files with the output folder. Reads only.

    Args:
        targets: Names of the targets that were run, so that files of others stay; None means all:
            each file that is not among the artifacts is no longer produced.
        force: Overwrite edited generated files after a copy to `<file>.orig`. Skeletons are never
            overwritten.
        model_facts: Called with the paths to be deleted; returns what the manifest stores of the
            model.
    """
    out = out.resolve()
    by_path = {artifact.path: artifact for artifact in artifacts}
    problems = find_problems(artifacts)
    files: dict[str, Entry] = {}
    actions: list[Action] = []
    for path, artifact in by_path.items():
        entry, state = manifest.files.get(path), inspect(out, path)
        problem = problems.get(path) or _other_target_problem(entry, targets)
        problem = problem or _other_model_problem(entry, artifact, state, model)
        if problem:
            actions.append(Action(ActionKind.REFUSE, path, problem))
        else:
            actions.append(_compare(artifact, state, manifest, out, force=force))
            # What is new and shared was rendered for the code of all.
            is_for_all = artifact.is_shared and entry is None
            sharing = manifest.models if is_for_all else ()
            files[path] = new_entry(artifact, entry, {model, *sharing})
    for file in _not_produced(by_path, out, manifest, model, targets):
        if file.entry is not None:
            files[file.path] = file.entry
        if file.action is not None:
            actions.append(file.action)
    actions += _unlisted_generated(out, manifest, by_path)
    actions += _left_by_killed_run(out, manifest)
    actions.sort(key=lambda action: action.path)
    deleted = frozenset(deletion.path for deletion in actions if deletion.kind is ActionKind.DELETE)
    facts = model_facts(deleted) if model_facts else {}
    models = {**manifest.models, model: {**manifest.models.get(model, {}), **facts}}
    new = Manifest(files=files, models=models)
    return Plan(out, (*actions, _manifest_action(out, manifest, new)), new.dump())


@dataclass(frozen=True)
class _NotProduced:
    """A file of the old manifest that a run does not produce.

    Attributes:
        entry: Its entry in the new manifest; None when that forgets it.
        action: What happens to it; None when nothing does.
    """

    path: str
    entry: Entry | None
    action: Action | None = None


def _not_produced(
    by_path: Mapping[str, Artifact],
    out: Path,
    manifest: Manifest,
    model: str,
    targets: Collection[str] | None,
) -> Iterator[_NotProduced]:
    shared = {artifact.target for artifact in by_path.values() if artifact.is_shared}
    for path, entry in manifest.files.items():
        if path in by_path:
            continue
        other_models = tuple(name for name in entry.models if name != model)
        if _other_target_problem(entry, targets) or model not in entry.models:
            yield _NotProduced(path, entry)
        elif other_models and entry.target not in shared:
            yield _NotProduced(path, replace(entry, models=other_models))
        else:
            successor = _successor(entry, by_path.values())
            action = _action_for_unproduced(path, manifest, inspect(out, path), successor)
            is_orphan = action is not None and action.kind is ActionKind.ORPHAN
            yield _NotProduced(path, entry if is_orphan else None, action)


def unified_diff(plan: Plan) -> str:
    """Returns the changes of a plan as one patch (`patch -p1`), empty when there are none."""
    return "".join(_diff(action) for action in plan.changes)


def _other_target_problem(entry: Entry | None, targets: Collection[str] | None) -> str:
    if entry is None or targets is None or entry.target in targets:
        return ""
    return f"the file belongs to target '{entry.target}', which is not part of this run"


def _other_model_problem(
    entry: Entry | None, artifact: Artifact, state: FileState, model: str
) -> str:
    """Says which other model has a file that would have another text; empty when none has."""
    others = [name for name in entry.models if name != model] if entry else []
    if entry is None or not others or artifact.is_shared or state.text in (None, artifact.text):
        return ""
    return (
        f"{artifact.element_id} of '{model}' asks for the file of {entry.element} of the model"
        f" '{others[0]}' ({entry.source}); rename one of them, or generate into another folder"
    )


def _compare(
    artifact: Artifact, state: FileState, manifest: Manifest, out: Path, *, force: bool
) -> Action:
    """Returns the action for a produced file; the first case that fits counts."""
    path = artifact.path
    entry = manifest.files.get(path)
    if state.obstacle:
        return Action(ActionKind.REFUSE, path, state.obstacle)
    if not state.exists:
        return _write(ActionKind.CREATE, artifact, state, "new")
    if artifact.kind is Kind.SKELETON:
        return Action(ActionKind.KEEP, path, "yours")
    if state.text == artifact.text:
        return Action(ActionKind.KEEP, path, "unchanged")
    if entry is not None and entry.kind is Kind.SKELETON:
        return Action(ActionKind.REFUSE, path, "this was a skeleton and is yours; move it away")
    if _is_untouched(state, manifest.hashes(path)):
        return _write(ActionKind.UPDATE, artifact, state, "the model or jausml changed")
    if force:
        backup = _backup_path(out, path)
        reason = f"edited by hand, overwritten (copy in {backup})"
        return _write(ActionKind.UPDATE, artifact, state, reason, backup)
    hint = "move the change to the skeleton beside it, or overwrite it with --force"
    return Action(ActionKind.REFUSE, path, f"edited by hand or not written by jausml; {hint}")


def _write(
    kind: ActionKind, artifact: Artifact, state: FileState, reason: str, backup: str = ""
) -> Action:
    return Action(
        kind=kind,
        path=artifact.path,
        reason=reason,
        old=state.text,
        new=artifact.text,
        backup=backup,
        executable=artifact.executable,
    )


def _is_untouched(state: FileState, hashes: Collection[str]) -> bool:
    """Whether a file is as some run wrote it.

    The header tells it, where the file has one: after a merge the manifest may be of one branch
    and the file of the other. The manifest knows the others.
    """
    if state.text is None:
        return False
    return has_valid_header(state.text) or text_digest(state.text) in hashes


def _action_for_unproduced(
    path: str, manifest: Manifest, state: FileState, successor: str
) -> Action | None:
    """Returns the action for a file that is no longer produced; None when it is not there."""
    entry = manifest.files[path]
    if state.obstacle:
        return Action(ActionKind.ORPHAN, path, f"no longer produced; {state.obstacle}")
    if not state.exists:
        return None
    if entry.kind is Kind.SKELETON:
        moved = f", whose code is now expected in {successor}" if successor else ""
        return Action(ActionKind.ORPHAN, path, f"yours; was for '{entry.element}'{moved}")
    if not _is_untouched(state, manifest.hashes(path)):
        return Action(ActionKind.ORPHAN, path, "no longer produced, but edited by hand")
    return Action(ActionKind.DELETE, path, "no longer produced", old=state.text)


def _successor(entry: Entry, artifacts: Iterable[Artifact]) -> str:
    """Returns the skeleton that the same element now has under another path, or empty."""
    paths = (
        artifact.path
        for artifact in artifacts
        if artifact.kind is Kind.SKELETON
        and (artifact.target, artifact.element_id) == (entry.target, entry.element)
    )
    return min(paths, default="")


def _unlisted_generated(
    out: Path, manifest: Manifest, by_path: Mapping[str, Artifact]
) -> Iterator[Action]:
    """Yields the generated files that this run does not produce, where no manifest lists them."""
    if not manifest.problem:
        return
    reason = f"generated by jausml, but not of this run ({manifest.problem}); delete it if unused"
    for path in find_generated(out):
        if path not in by_path:
            yield Action(ActionKind.ORPHAN, path, reason)


def _left_by_killed_run(out: Path, manifest: Manifest) -> Iterator[Action]:
    """Yields the deletions of files that a killed run left besides its output."""
    for path in (*map(temporary, manifest.unfinished), PENDING_PATH):
        state = inspect(out, path)
        if state.exists:
            yield Action(ActionKind.DELETE, path, "of a run that was killed", old=state.text)


def _backup_path(out: Path, path: str) -> str:
    """Returns the first free name: an older copy holds work of the user too."""
    number = 1
    backup = f"{path}.orig"
    while (out / backup).exists() or (out / backup).is_symlink():
        number += 1
        backup = f"{path}.orig{number}"
    return backup


def _manifest_action(out: Path, old: Manifest, new: Manifest) -> Action:
    state = inspect(out, MANIFEST_PATH)
    if state.obstacle:
        return Action(ActionKind.REFUSE, MANIFEST_PATH, state.obstacle)
    text = new.dump()
    if state.text == text:
        return Action(ActionKind.KEEP, MANIFEST_PATH, "unchanged")
    kind = ActionKind.UPDATE if state.exists else ActionKind.CREATE
    reason = old.problem or "the list of files changed"
    return Action(kind, MANIFEST_PATH, reason, old=state.text, new=text)


def _diff(action: Action) -> str:
    # Of lines `patch` knows \n alone; `splitlines` also cuts at a form feed, which Python may have.
    before, after = (list(io.StringIO(text or "")) for text in (action.old, action.new))
    lines = difflib.unified_diff(
        before,
        after,
        "/dev/null" if action.kind is ActionKind.CREATE else f"a/{action.path}",
        "/dev/null" if action.kind is ActionKind.DELETE else f"b/{action.path}",
    )
    return "".join(
        line if line.endswith("\n") else f"{line}\n\\ No newline at end of file\n" for line in lines
    )

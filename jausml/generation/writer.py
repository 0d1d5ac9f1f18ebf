"""Writer of plans: each file is either old or new at any moment, the manifest comes last."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from jausml.generation.errors import RefusedError, WriteError
from jausml.generation.plan import Action, ActionKind, Plan

if TYPE_CHECKING:
    from pathlib import Path

_TEMPORARY_SUFFIX = ".jausml-tmp"


def apply(plan: Plan) -> None:
    """Writes and deletes what the plan says.

    Deletions come first, so that a file whose name changed in upper and lower case only survives
    on a file system that does not tell them apart. After a failure the same run, repeated, ends
    in the same tree.

    Args:
        plan: A fresh plan.

    Raises:
        RefusedError: The plan has a refusal; nothing was written.
        WriteError: The operating system refused, or a new file appeared since the plan was made.
    """
    if plan.refused:
        reasons = "; ".join(f"{action.path}: {action.reason}" for action in plan.refused)
        raise RefusedError(f"nothing was written: {reasons}")
    for action in plan.of(ActionKind.DELETE):
        _attempt(plan.out, action)
    for action in plan.of(ActionKind.CREATE, ActionKind.UPDATE):
        _attempt(plan.out, action)


def _attempt(out: Path, action: Action) -> None:
    try:
        if action.kind is ActionKind.DELETE:
            _delete(out, action.path)
        else:
            _write(out, action)
    except OSError as error:
        raise WriteError(action.path, error.strerror or str(error)) from error


def _write(out: Path, action: Action) -> None:
    path = out / action.path
    path.parent.mkdir(parents=True, exist_ok=True)
    if action.kind is ActionKind.CREATE and os.path.lexists(path):
        # A skeleton is never opened for writing, not even one that is a second old.
        raise WriteError(action.path, "the file appeared while jausml was running")
    if action.backup:
        _replace(out / action.backup, path.read_bytes())
    _replace(path, (action.new or "").encode("utf-8"), executable=action.executable)


def _replace(path: Path, data: bytes, *, executable: bool = False) -> None:
    temporary = path.with_name(f".{path.name}{_TEMPORARY_SUFFIX}")
    temporary.unlink(missing_ok=True)  # left by a run that was killed
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
    descriptor = os.open(temporary, flags, 0o777 if executable else 0o666)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)
        temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def _delete(out: Path, path: str) -> None:
    (out / path).unlink(missing_ok=True)
    for folder in (out / path).parents:
        if folder == out or any(folder.iterdir()):
            return
        folder.rmdir()

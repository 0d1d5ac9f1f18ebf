"""Models: read, validated, generated from."""

from __future__ import annotations

import os
from collections.abc import Collection
from pathlib import Path

from jausml.generation.target import load_targets
from jausml.generation.workspace import Result, select
from jausml.generation.workspace import generate as generate_workspace
from jausml.language.model.reading.reader import ReadResult, read_models
from jausml.language.text.notation import NOTATIONS
from jausml.language.validation.engine import check
from jausml.language.validation.formats import text
from jausml.language.validation.rule import Report


class ModelError(Exception):
    """A model has errors; the text lists them with their places."""

    def __init__(self, report: Report) -> None:
        super().__init__(text.render(report).rstrip())
        self.report = report


def read(
    *paths: str | os.PathLike[str],
    project_root: str | os.PathLike[str] | None = None,
    allow_outside: bool = False,
) -> ReadResult:
    """Reads models, XMI or ros2jaus text, and all that they refer to.

    Args:
        project_root: The folder that references may not leave; found by itself when None.

    Returns:
        The model, as far as it can be read, and what is wrong with it.
    """
    return read_models(
        paths, project_root=project_root, allow_outside=allow_outside, notations=NOTATIONS
    )


def validate(
    *paths: str | os.PathLike[str],
    project_root: str | os.PathLike[str] | None = None,
    allow_outside: bool = False,
) -> Report:
    """Reads models and checks them by all rules.

    Args:
        project_root: The folder that references may not leave; found by itself when None.

    Returns:
        The findings, with their places, hints and rules.
    """
    return check(read(*paths, project_root=project_root, allow_outside=allow_outside))


def generate(
    path: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    targets: Collection[str] = (),
    force: bool = False,
    write: bool = True,
) -> Result:
    """Generates the workspace of a model.

    Args:
        targets: Names of targets; all that need not be asked for by name when there is none.
        force: Whether to overwrite edited generated files, after a copy. Skeletons stay.

    Returns:
        What happened to each file.

    Raises:
        GenerationError: A target is unknown, or cannot generate what the model has.
        OwnershipError: A file is not ours to overwrite.
    """
    report = validate(path)
    if report.has_errors:
        raise ModelError(report)
    chosen = select(load_targets(), targets)
    return generate_workspace(
        report.model,
        chosen.targets,
        Path(out),
        kept=chosen.kept,
        renewed=chosen.renewed,
        force=force,
        write=write,
    )
